//! Tilt and twist: the two rates that keep the plane of symmetry in the plane of flight.
//!
//! Thrust and the planar force lie in the plane of symmetry. So across the wing only weight, reference and side force
//! act. The lateral force is w·(W − k_a c_Y |v_a| v_a), whatever the attitude in the plane. Tilt turns the wing normal
//! to the vector F_y in which that is collected. Twist turns it about F_y until there is no sideslip; where there is
//! too little air to decide, towards the heading.

use super::vector::Body;
use crate::control::Guard;
use crate::error::{ParameterError, in_range};
use crate::math;
use crate::parameters::setters;

/// Added to an airspeed that is divided by [m/s]: where it counts there is no force.
const STILL: f32 = 1e-12;

/// Greatest sideslip that is asked for \[rad\]: half of that at which fins stall.
pub(crate) const SLIP: f32 = 0.1;

/// Parameters of the lateral law. Those of another vehicle are begun from [`PAPER_VEHICLE`](Self::PAPER_VEHICLE), and given by name.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct LateralParameters {
    /// k_F [1/s]: rate at which the wing becomes normal to F_y. With a rate loop of time constant T_ω keep
    /// T_ω k_F < 1.
    pub tilt: f32,
    /// K_y [1/s]: rate at which the lateral velocity error decays.
    pub velocity: f32,
    /// k_ψ [1/s]: rate of the twist towards air velocity or heading.
    pub twist: f32,
    /// a_y [m/s²]: most that a lateral velocity error may ask for. Keep it below g: above, it could turn F_y over.
    pub acceleration: f32,
    /// τ_y \[N\]: |F_y| below which tilt and twist fade.
    pub force: f32,
    /// V [m/s]: air velocity across F_y at which the air has taken over from the heading.
    pub airspeed: f32,
    /// η: sine of the angle between heading and F_y below which the heading fades.
    pub heading: f32,
}

setters! {
    LateralParameters {
        tilt: f32,
        velocity: f32,
        twist: f32,
        acceleration: f32,
        force: f32,
        airspeed: f32,
        heading: f32,
    }
}

impl LateralParameters {
    /// For the paper's vehicle with a rate loop of 100 ms: k_F = 2ζω and K_y = ω/(2ζ) of ω = 4 rad/s and ζ = 0.8.
    pub const PAPER_VEHICLE: Self = Self {
        tilt: 6.4,
        velocity: 2.5,
        twist: 5.0,
        acceleration: 5.0,
        force: 30.0,
        airspeed: 10.0,
        heading: 0.2,
    };
}

/// Validated gains of the lateral law.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LateralGains {
    tilt: f32,
    velocity: f32,
    twice_twist: f32,
    /// 1/a_y.
    over_acceleration: f32,
    force: Guard,
    airspeed: Guard,
    heading: Guard,
}

impl LateralGains {
    /// The gains with these parameters.
    ///
    /// # Errors
    /// `tilt`, `velocity` or `twist` outside [1e-3, 1e3], `acceleration` outside [1e-3, 1e3] m/s², `force` outside
    /// [1e-3, 1e6] N, `airspeed` outside [1e-3, 1e3] m/s, `heading` outside [1e-3, 1]; or any not finite or not
    /// positive.
    pub fn new(p: LateralParameters) -> Result<Self, ParameterError> {
        in_range("acceleration", p.acceleration, [1e-3, 1e3], "m/s^2")?;
        in_range("tilt", p.tilt, [1e-3, 1e3], "1/s")?;
        in_range("velocity", p.velocity, [1e-3, 1e3], "1/s")?;
        in_range("twist", p.twist, [1e-3, 1e3], "1/s")?;
        in_range("force", p.force, [1e-3, 1e6], "N")?;
        in_range("airspeed", p.airspeed, [1e-3, 1e3], "m/s")?;
        in_range("heading", p.heading, [1e-3, 1.0], "")?;
        Ok(Self::of_checked(p))
    }

    /// The gains with parameters that [`new`](Self::new) would take.
    pub(crate) fn of_checked(p: LateralParameters) -> Self {
        Self {
            tilt: p.tilt,
            velocity: p.velocity,
            twice_twist: 2.0 * p.twist,
            over_acceleration: 1.0 / p.acceleration,
            force: Guard::of_checked(p.force),
            airspeed: Guard::of_checked(p.airspeed),
            heading: Guard::of_checked(p.heading),
        }
    }
}

/// What the lateral law looks at, in body components.
pub(super) struct LateralInput {
    /// Mass m \[kg\].
    pub mass: f32,
    /// k_a c_Y [kg/m].
    pub side: f32,
    /// Rate about the nose that may be counted on, times airspeed and weight [rad N m/s²].
    pub roll: f32,
    /// Air velocity v_a [m/s], its sideslip corrected.
    pub v_a: Body,
    /// Apparent weight W = m (g − a_r), corrected \[N\].
    pub weight: Body,
    /// Lateral velocity error ṽ_w [m/s].
    pub error: f32,
    /// Heading h, a unit vector or zero.
    pub heading: Body,
    /// Derivative of the air velocity [m/s²], and the reference jerk along w [m/s³].
    pub feed_forward: Option<(Body, f32)>,
}

/// What the lateral law gives.
pub(crate) struct Lateral {
    /// ω_i [rad/s].
    pub i: f32,
    /// ω_j [rad/s].
    pub j: f32,
    /// F_y \[N\].
    pub f_y: Body,
}

impl LateralGains {
    /// Sideslip [m/s] whose side force carries what the roll does not come to at once of a `lateral` force \[N\]: none where there is no side force.
    #[inline(always)]
    fn slip(&self, at: &LateralInput, lateral: f32, speed: f32) -> f32 {
        let closing = self.tilt * speed;
        if closing * lateral.abs() <= at.roll {
            return 0.0;
        }
        core::hint::cold_path();
        let rolled = at.roll / closing;
        let drag = at.side * speed;
        // The side force of the greatest sideslip: where the roll closes more than that at once, it is not slipped for.
        let most = SLIP * speed;
        let carried = drag * most;
        let square = carried * carried;
        let most = most * (square / (square + rolled * rolled));
        // Without a side force the first is infinite.
        let slip = math::min((lateral.abs() - rolled) / drag, most);
        if lateral < 0.0 { -slip } else { slip }
    }

    /// ω_i and ω_j. Finite for every finite input: nothing is divided by what may vanish.
    #[inline(always)]
    pub(super) fn rates(&self, at: &LateralInput) -> Lateral {
        let speed = math::sqrt(at.v_a.norm_squared());
        let drag = at.side * speed;
        // m σ(K_y ṽ_w): what the velocity error asks for, bounded.
        let x = self.velocity * at.error;
        // Not x²/a_y² by a stored 1/a_y²: only of squares does the compiler know that they have a root.
        let bounded = x * self.over_acceleration;
        let push = at.mass * x / math::sqrt(1.0 + bounded * bounded);
        let slip = self.slip(at, at.weight.w + push, speed);
        let v_a = Body::new(at.v_a.i, at.v_a.j, at.v_a.w - slip);
        let f_y = Body::new(
            at.weight.i - drag * v_a.i,
            at.weight.j - drag * v_a.j,
            at.weight.w - drag * v_a.w + push,
        );
        // G = μ(|F_y|)/|F_y|², and with it z⊥ = z − G (z·F_y) F_y.
        let square = f_y.norm_squared();
        let g = self.force.over_square(square);
        let g_norm = g * math::sqrt(square);
        let along = g * v_a.dot(f_y);
        let u = v_a - f_y * along;
        let u_squared = u.norm_squared();
        let over = self.airspeed.over_square(u_squared);
        // s/|u|, the share of the air over its velocity across F_y.
        let share = math::sqrt(u_squared) * over;
        let h = at.heading - f_y * (g * at.heading.dot(f_y));
        let h_squared = h.norm_squared();
        let h_share = (1.0 - u_squared * over)
            * (math::sqrt(h_squared) * self.heading.over_square(h_squared));
        let b = u * share + h * h_share;
        let c = g_norm * (f_y.i * b.j - f_y.j * b.i);

        let mut tilt = self.tilt * f_y.w;
        let mut twist = self.twice_twist * b.w / (1.0 + if c > 0.0 { c } else { 0.0 });
        if let Some((a, jerk)) = &at.feed_forward {
            let turning = speed * a.w + (v_a.w / (speed + STILL)) * v_a.dot(*a);
            let f_rate = -at.mass * jerk - at.side * turning;
            tilt += f_rate;
            twist += share * c * (a.w - along * f_rate);
        }
        tilt *= g;
        twist *= g_norm;
        Lateral {
            i: tilt * f_y.j + twist * f_y.i,
            j: twist * f_y.j - tilt * f_y.i,
            f_y,
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    const WEIGHT: f32 = 98.1;

    fn gains() -> LateralGains {
        LateralGains::new(LateralParameters::PAPER_VEHICLE).unwrap()
    }

    /// Hover nose up in still air, heading asked for along the belly.
    fn hover() -> LateralInput {
        LateralInput {
            mass: 10.0,
            roll: 1e6,
            side: 0.32,
            v_a: Body::default(),
            weight: Body::new(WEIGHT, 0.0, 0.0),
            error: 0.0,
            heading: Body::new(0.0, 1.0, 0.0),
            feed_forward: None,
        }
    }

    #[test]
    fn aligned_hover_asks_for_no_rate() {
        let Lateral { i, j, f_y } = gains().rates(&hover());
        assert_eq!((i, j, f_y), (0.0, 0.0, Body::new(WEIGHT, 0.0, 0.0)));
    }

    /// Drifting to the right, F_y leans to the right: ω_j < 0 turns i, the tail, to the right (i' = −ω_j w), so that
    /// thrust pushes left. The lateral loop is m ṽ̇_w = −m K_y ṽ_w once the tilt has settled.
    #[test]
    fn a_drift_to_the_right_is_tilted_against() {
        let got = gains().rates(&LateralInput {
            error: 0.1,
            ..hover()
        });
        assert!(got.i == 0.0 && got.j < 0.0);
        let push = 10.0 * 2.5 * 0.1;
        // 1 %: σ is 0.1 % off its slope, and |F_y| grows with its square.
        assert!((got.j / (-6.4 * push / WEIGHT) - 1.0).abs() < 0.01);
        // However large the error, the push stays below m a_y.
        let far = gains().rates(&LateralInput {
            error: 300.0,
            ..hover()
        });
        assert!(far.f_y.w < 50.0 && far.f_y.w > 49.0);
    }

    /// A heading to the right of the belly is turned to at k_ψ per radian, with the belly's rate along w: j' = ω_i w.
    #[test]
    fn hover_turns_to_the_heading_the_short_way() {
        let at = |angle: f32| {
            let (sin, cos) = math::sin_cos(angle);
            gains().rates(&LateralInput {
                heading: Body::new(0.0, cos, sin),
                ..hover()
            })
        };
        assert!((at(0.01).i / 0.05 - 1.0).abs() < 1e-3);
        assert!((at(-0.01).i / -0.05 - 1.0).abs() < 1e-3);
        // From behind at 2 k_ψ y.
        assert!((at(3.1).i / (10.0 * 3.1f32.sin()) - 1.0).abs() < 1e-3);
        assert!(at(0.5).j.abs() < 1e-6);
    }

    /// A lateral force of 0.2 of the weight at 20 m/s, of which a roll of 0.1 rad/s closes little: the rest is a sideslip of at most 0.1 rad. With that it rolls
    /// on, until the bank alone carries it.
    #[test]
    fn who_rolls_slowly_slips() {
        let at = |roll: f32, push: f32, slip: f32| {
            let Lateral { i, j, .. } = gains().rates(&LateralInput {
                side: 0.32,
                roll: roll * WEIGHT,
                v_a: Body::new(-20.0, 0.0, slip),
                weight: Body::new(0.0, WEIGHT, push * WEIGHT),
                ..hover()
            });
            (i, j)
        };
        let (slow, quick) = (at(2.0, 0.2, 0.0), at(1e6, 0.2, 0.0));
        // The nose turns away from the side that air is to come from, at k_ψ per radian and more.
        assert!(slow.1 < quick.1 - 0.5, "{slow:?} {quick:?}");
        // As a quick one does without sideslip; 0.02 rad/s: the airspeed is 20.1 m/s.
        let slipping = at(2.0, 0.2, 2.0);
        assert!((slipping.0 - quick.0).abs() + (slipping.1 - quick.1).abs() < 0.02);
        // 0.1 rad/s at 20 m/s close 0.1/6.4 of the weight: less than that is left to the roll.
        assert_eq!(at(2.0, 0.014, 0.0), at(1e6, 0.014, 0.0));
        let other = at(2.0, -0.2, 0.0);
        assert!((other.0 + slow.0).abs() + (other.1 + slow.1).abs() < 1e-5);
    }

    /// At 20 m/s the greatest sideslip is 2 m/s, and the roll closes 1.53 N at once. It is asked for where its side force is the greater, half of it where
    /// that is the same, and none without one.
    #[test]
    fn who_slips_for_nothing_does_not() {
        let slip = |side: f32| {
            let at = LateralInput {
                side,
                roll: 2.0 * WEIGHT,
                ..hover()
            };
            gains().slip(&at, -0.2 * WEIGHT, 20.0)
        };
        assert_eq!(slip(0.0), 0.0);
        // 12.8 N.
        assert!((slip(0.32) + 2.0).abs() < 0.03, "{}", slip(0.32));
        assert!((slip(1.533 / 40.0) + 1.0).abs() < 1e-3);
        // Where less than the greatest carries all that is missing, no more than that: 18.1 N by 80 N s/m.
        assert!((slip(4.0) + 18.09 / 80.0).abs() < 1e-3, "{}", slip(4.0));
    }

    /// In cruise without side force F_y lies along j: tilt is a roll, ω_i, and sideslip is taken out by ω_j. (With it
    /// F_y leans back to i, and each is shared between the two rates.)
    #[test]
    fn in_cruise_tilt_rolls_and_twist_takes_out_sideslip() {
        let cruise = |right: f32, error: f32| {
            gains().rates(&LateralInput {
                v_a: Body::new(-20.0, 0.0, right),
                weight: Body::new(0.0, WEIGHT, 0.0),
                side: 0.0,
                error,
                ..hover()
            })
        };
        let drift = cruise(0.0, 0.1);
        assert!(drift.i > 0.1 && drift.j.abs() < 1e-6);
        // The air velocity leans to the right: the nose, −i, follows it, so i' = −ω_j w with ω_j > 0.
        let slip = cruise(0.2, 0.0);
        assert!((slip.j / (5.0 * 0.01) - 1.0).abs() < 0.02, "{}", slip.j);
    }

    /// Where nothing is to be normal to, nothing is asked for; and no input makes a result that is not finite.
    #[test]
    fn singular_places_are_finite() {
        let none = gains().rates(&LateralInput {
            weight: Body::default(),
            ..hover()
        });
        assert_eq!((none.i, none.j), (0.0, 0.0));
        let tiny = [0.0, 1e-38, 1e-30, 1e-20, 1e-12, 1e-6, 1.0, 1e3];
        for x in tiny {
            for y in tiny {
                for v_a in [Body::new(x, 0.0, -x), Body::new(0.0, x, 0.0)] {
                    let got = gains().rates(&LateralInput {
                        v_a,
                        weight: Body::new(y, -y, x),
                        error: -y,
                        heading: Body::new(1.0, 0.0, 0.0),
                        feed_forward: Some((Body::new(y, x, y), x)),
                        ..hover()
                    });
                    assert!(got.i.is_finite() && got.j.is_finite(), "{x} {y}");
                }
            }
        }
    }

    #[test]
    fn bad_parameters_are_named() {
        let good = LateralParameters::PAPER_VEHICLE;
        let name = |p| LateralGains::new(p).unwrap_err().parameter;
        assert_eq!(name(LateralParameters { tilt: 0.0, ..good }), "tilt");
        assert_eq!(
            name(LateralParameters {
                velocity: f32::NAN,
                ..good
            }),
            "velocity"
        );
        assert_eq!(
            name(LateralParameters {
                twist: -1.0,
                ..good
            }),
            "twist"
        );
        assert_eq!(
            name(LateralParameters {
                acceleration: 1e4,
                ..good
            }),
            "acceleration"
        );
        assert_eq!(name(LateralParameters { force: 1e7, ..good }), "force");
        assert_eq!(
            name(LateralParameters {
                airspeed: 0.0,
                ..good
            }),
            "airspeed"
        );
        assert_eq!(
            name(LateralParameters {
                heading: 2.0,
                ..good
            }),
            "heading"
        );
    }
}
