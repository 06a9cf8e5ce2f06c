//! Coefficients of a wing strip with a trailing-edge flap, over ±180° of angle of attack.
//!
//! Short of stall the flow is attached: c_L of a wing of finite span with its vortex lift, centre of pressure at a quarter of the chord.
//! Behind stall the strip is a flat plate, bent at its hinge: its centre of pressure moves to half of the chord.
//! The forms are those of Khan and Nahon (W. Khan, *Dynamics Modeling of Agile Fixed-Wing Unmanned Aerial Vehicles*, McGill University, 2016, sections 3.1 to 3.3).

use std::f64::consts::PI;

use crate::experiment::tail_sitter::Section;

/// Drag coefficient of an infinite flat plate across the flow.
const C_D_90: f64 = 1.98;
/// Half-width of the change from attached flow to plate \[rad\].
const BLEND: f64 = 10.0 * PI / 180.0;
/// Greatest deflection that the flap's effectiveness was fitted to \[rad\].
const DEFLECTION_MAX: f64 = 70.0 * PI / 180.0;

/// Coefficients of a strip, referred to its area and chord.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    /// Lift, normal to the air velocity.
    pub c_l: f64,
    /// Drag, along the air velocity.
    pub c_d: f64,
    /// Moment about a quarter of the chord; positive turns the nose up.
    pub c_m: f64,
}

/// A flap at a deflection: what the flow has no part in. It is the same of a strip in the slipstream and beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bent {
    /// \[rad\].
    deflection: f64,
    /// Change of the zero-lift angle \[rad\].
    shift: f64,
    /// Change of c_m.
    moment: f64,
    /// Angle of the line from leading to trailing edge to the chord \[rad\].
    line: f64,
}

/// A [`Section`] on a wing of finite span, with a flap: what does not change in flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Profile {
    section: Section,
    /// Slope of c_L of the wing \[1/rad\].
    slope: f64,
    /// Induced drag over c_L².
    induced: f64,
    /// Relief of the plate by its finite span.
    relief: f64,
    flap: Flap,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Flap {
    /// Chord over the strip's chord.
    share: f64,
    /// Change of the zero-lift angle over deflection, without viscosity.
    effectiveness: f64,
    /// Change of c_m over deflection, without viscosity \[1/rad\].
    moment: f64,
}

impl Profile {
    /// A section on a wing of this aspect ratio, with a flap of `share` of its chord.
    pub fn new(section: Section, aspect_ratio: f64, share: f64) -> Self {
        let a = aspect_ratio;
        // Thin-airfoil theory of a flap whose hinge lies at cos θ = 2 share − 1.
        let hinge = libm::acos(2.0 * share - 1.0);
        Self {
            section,
            slope: section.slope_1_rad / (1.0 + 2.0 * (a + 4.0) / (a * (a + 2.0))),
            induced: 1.0 / (PI * 0.87 * a),
            relief: 0.41 * (1.0 - libm::exp(-17.0 / a)),
            flap: Flap {
                share,
                effectiveness: 1.0 - (hinge - libm::sin(hinge)) / PI,
                moment: -0.5 * libm::sin(hinge) * (1.0 - libm::cos(hinge)),
            },
        }
    }

    /// The flap at a deflection \[rad\], positive trailing edge towards the belly.
    pub fn bent(&self, deflection: f64) -> Bent {
        let deflection = deflection.clamp(-DEFLECTION_MAX, DEFLECTION_MAX);
        let size = deflection.abs();
        // Viscosity's share: a fit to flaps of up to 70°. What has no hinge in the flow is turned as a whole.
        let viscous = if self.flap.share < 1.0 {
            0.0535 * size * size - 0.2688 * size + 0.5817
        } else {
            1.0
        };
        let (nose, flap) = (1.0 - self.flap.share, self.flap.share);
        let (sin, cos) = libm::sincos(deflection);
        let chord = (nose * nose + flap * flap + 2.0 * nose * flap * cos).sqrt();
        Bent {
            deflection,
            shift: self.flap.effectiveness * viscous * deflection,
            moment: self.flap.moment * viscous * deflection,
            line: libm::asin(flap / chord * sin),
        }
    }

    /// The coefficients at an angle of attack in (−π, π].
    pub fn at(&self, alpha: f64, bent: &Bent) -> Coefficients {
        let effective = alpha + bent.shift;
        let attached = self.attached(effective, bent.moment);
        let plate = self.plate(alpha, bent);
        // The flap raises the greatest lift by less than the lift: stall comes at a smaller angle of the wing.
        let stall = self.section.stall_deg.to_radians();
        let raised = (1.0 - self.flap.share) * bent.shift;
        let beyond = (effective - raised).abs() - stall;
        let share = 0.5 * (1.0 - libm::tanh(4.0 * beyond / BLEND));
        let mix = |a: f64, p: f64| share * a + (1.0 - share) * p;
        Coefficients {
            c_l: mix(attached.c_l, plate.c_l),
            c_d: mix(attached.c_d, plate.c_d),
            c_m: mix(attached.c_m, plate.c_m),
        }
    }

    /// Attached flow: potential lift and vortex lift; drag by the share of suction that is kept.
    fn attached(&self, alpha: f64, flap_moment: f64) -> Coefficients {
        let (sin, cos) = libm::sincos(alpha);
        let vortex = PI * (1.0 - self.section.suction);
        let c_l = self.slope * sin * cos * cos + vortex * sin.abs() * sin * cos;
        let plate_drag = (c_l * sin / cos.abs().max(0.1)).abs();
        let induced = self.induced * c_l * c_l;
        let s = self.section.suction;
        Coefficients {
            c_l,
            c_d: self.section.c_d_0 + s * induced + (1.0 - s) * plate_drag,
            c_m: self.section.c_m_0 + flap_moment,
        }
    }

    /// A plate bent at the hinge: its chord line joins leading and trailing edge.
    fn plate(&self, alpha: f64, bent: &Bent) -> Coefficients {
        let alpha = alpha + bent.line;
        let (sin, cos) = libm::sincos(alpha);
        // A bend towards the flow holds more of it.
        let bend = bent.deflection * sin.signum();
        let across = C_D_90 + 0.21 * bend - 0.0426 * bend * bend;
        let normal = across * sin * (1.0 / (0.56 + 0.44 * sin.abs()) - self.relief);
        let tangential = 0.5 * self.section.c_d_0 * cos;
        let angle = libm::atan2(sin, cos).abs();
        let arm = 0.25 - 0.175 * (1.0 - 2.0 * angle / PI);
        Coefficients {
            c_l: normal * cos - tangential * sin,
            c_d: normal * sin + tangential * cos,
            c_m: -normal * arm,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLATE: Section = Section {
        slope_1_rad: 2.0 * PI,
        stall_deg: 20.0,
        c_d_0: 0.04,
        suction: 0.0,
        c_m_0: 0.0,
    };

    fn at(alpha_deg: f64, deflection_deg: f64) -> Coefficients {
        let profile = Profile::new(PLATE, 3.13, 0.4);
        profile.at(
            alpha_deg.to_radians(),
            &profile.bent(deflection_deg.to_radians()),
        )
    }

    /// A plate of any attitude and deflection never pushes itself along: c_D > 0 over the whole circle, at every deflection.
    #[test]
    fn drag_is_positive_everywhere() {
        for alpha in -180..=180 {
            for deflection in [-70, -40, -10, 0, 10, 40, 70] {
                let c = at(alpha.into(), deflection.into());
                assert!(c.c_d > 0.0, "α {alpha}°, δ {deflection}°: {}", c.c_d);
            }
        }
    }

    /// Seen from its back the strip is the same: coefficients of (−α, −δ) are those of (α, δ) with lift and moment turned.
    #[test]
    fn belly_and_back_are_alike() {
        for (alpha, deflection) in [(3.0, 12.0), (17.0, -30.0), (55.0, 40.0), (120.0, 5.0)] {
            let (a, b) = (at(alpha, deflection), at(-alpha, -deflection));
            assert!((a.c_l + b.c_l).abs() < 1e-12);
            assert!((a.c_d - b.c_d).abs() < 1e-12);
            assert!((a.c_m + b.c_m).abs() < 1e-12);
        }
    }

    /// Nothing jumps, at −180° = 180° either: 0.1° changes no coefficient by more than 0.03, a third of what the steepest slope
    /// of a stall within 10° would.
    #[test]
    fn coefficients_are_continuous() {
        for deflection in [-40.0, 0.0, 25.0] {
            for tenth in -1800..1800 {
                let (a, b) = (f64::from(tenth) / 10.0, f64::from(tenth + 1) / 10.0);
                let (a, b) = (at(a, deflection), at(b, deflection));
                let change = (a.c_l - b.c_l).abs() + (a.c_d - b.c_d).abs() + (a.c_m - b.c_m).abs();
                assert!(change < 0.03, "{deflection}° at {tenth}: {change}");
            }
            let (a, b) = (at(-180.0, deflection), at(180.0, deflection));
            assert!((a.c_l - b.c_l).abs() < 1e-9 && (a.c_m - b.c_m).abs() < 1e-9);
        }
    }

    /// Helmbold's slope, and thin-airfoil theory of the flap, written down another way: Glauert's integrals by the midpoint rule.
    #[test]
    fn slope_and_flap_are_those_of_thin_airfoil_theory() {
        let profile = Profile::new(PLATE, 3.13, 0.4);
        let a: f64 = 3.13;
        let slope = (at(0.5, 0.0).c_l - at(-0.5, 0.0).c_l) / 1.0_f64.to_radians();
        let expected = 2.0 * PI * a * (a + 2.0) / (a * (a + 2.0) + 2.0 * (a + 4.0));
        // 1e-2: sin α cos² α and vortex lift at half a degree.
        assert!((slope / expected - 1.0).abs() < 1e-2);
        // A0 = −(1/π) ∫ y' dθ and A_n = (2/π) ∫ y' cos nθ dθ, with y' = −δ behind the hinge at x = 1 − share = (1 − cos θ)/2.
        let hinge = (1.0_f64 - 2.0 * 0.6).acos();
        let n = 20_000;
        let step = (PI - hinge) / f64::from(n);
        let (mut a0, mut a1, mut a2) = (0.0, 0.0, 0.0);
        for k in 0..n {
            let theta = hinge + (f64::from(k) + 0.5) * step;
            a0 += step / PI;
            a1 -= 2.0 / PI * step * theta.cos();
            a2 -= 2.0 / PI * step * (2.0 * theta).cos();
        }
        // c_l = 2π A0 + π A1 and c_m,c/4 = −π/4 (A1 − A2), signs for y' = −δ.
        let effectiveness = (2.0 * PI * a0 + PI * a1) / (2.0 * PI);
        let moment = -PI / 4.0 * (a1 - a2);
        assert!((profile.flap.effectiveness - effectiveness).abs() < 1e-6);
        assert!((profile.flap.moment - moment).abs() < 1e-6);
    }

    /// Behind stall the centre of pressure moves from a quarter of the chord to its half: at 90° c_m = −c_N/4.
    #[test]
    fn the_centre_of_pressure_moves_to_half_chord() {
        let c = at(90.0, 0.0);
        assert!((c.c_m + 0.25 * c.c_d).abs() < 1e-6);
        // A quarter of the chord while attached.
        assert!(at(8.0, 0.0).c_m.abs() < 0.01);
    }
}
