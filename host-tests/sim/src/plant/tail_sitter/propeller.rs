//! A fixed-pitch propeller: thrust and torque by C_T(J) and C_P(J), and its slipstream by momentum theory.

use std::f64::consts::PI;

use crate::experiment::tail_sitter::Propeller;

/// Axial velocity at the wing over that induced at the disc, at rest. 2 far behind; 1.5 to 1.9 at the trailing edge.
const DEVELOPMENT: f64 = 1.8;
/// Least advance ratio that the maps are read at: below, the propeller descends into its own slipstream.
const J_MIN: f64 = -0.2;

/// What a propeller gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thrust {
    /// Along the nose \[N\].
    pub thrust: f64,
    /// Shaft torque \[N·m\], at least 0.
    pub torque: f64,
    /// Shaft power \[W\].
    pub power: f64,
}

/// The slipstream of one propeller where it meets the wing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slipstream {
    /// Axial velocity that it adds \[m/s\].
    pub velocity: f64,
    /// Its radius \[m\].
    pub radius: f64,
}

impl Propeller {
    /// Disc area \[m²\].
    pub fn area(&self) -> f64 {
        PI / 4.0 * self.diameter_m * self.diameter_m
    }

    /// What it gives at `speed` \[rev/s\] with the air coming at `u` \[m/s\] along the nose, at density `rho` \[kg/m³\].
    pub fn at(&self, speed: f64, u: f64, rho: f64) -> Thrust {
        let d = self.diameter_m;
        if speed <= 0.0 {
            return Thrust {
                thrust: 0.0,
                torque: 0.0,
                power: 0.0,
            };
        }
        let j = (u / (speed * d)).max(J_MIN);
        let polynomial = |c: [f64; 3]| (c[0] + c[1] * j + c[2] * j * j).max(0.0);
        let pressure = rho * speed * speed * d.powi(4);
        let power = polynomial(self.c_p) * pressure * speed * d;
        Thrust {
            thrust: polynomial(self.c_t) * pressure,
            torque: power / (2.0 * PI * speed),
            power,
        }
    }

    /// Greatest thrust at rest \[N\].
    pub fn static_thrust(&self, rho: f64) -> f64 {
        self.at(self.speed_max_rev_s, 0.0, rho).thrust
    }

    /// The slipstream at the wing. Tail first it shrinks, and is gone at twice the induced velocity of hover.
    pub fn slipstream(&self, thrust: f64, u: f64, rho: f64) -> Slipstream {
        let hover = (thrust.max(0.0) / (2.0 * rho * self.area())).sqrt();
        let induced = if u >= 0.0 {
            -0.5 * u + (0.25 * u * u + hover * hover).sqrt()
        } else {
            hover * (1.0 + 0.5 * u / hover.max(1e-9)).max(0.0)
        };
        // Continuity between disc and wing; at rest the jet contracts to 1/√k of the disc's area.
        let (disc, wing) = (u.max(0.0) + induced, u.max(0.0) + DEVELOPMENT * induced);
        let contraction = if wing > 0.0 { disc / wing } else { 1.0 };
        Slipstream {
            velocity: DEVELOPMENT * induced,
            radius: 0.5 * self.diameter_m * contraction.sqrt(),
        }
    }
}

impl Slipstream {
    /// Share of the span from `left` to `right` that lies in this slipstream, whose axis is at `centre` and passes the strip at the height `above`, all \[m\].
    pub fn covers(&self, left: f64, right: f64, centre: f64, above: f64) -> f64 {
        let half = (self.radius * self.radius - above * above).max(0.0).sqrt();
        let overlap = right.min(centre + half) - left.max(centre - half);
        (overlap / (right - left)).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RHO: f64 = 1.225;
    /// Of PX4's simulated tail-sitter.
    const SMALL: Propeller = Propeller {
        position_m: [0.0, 0.143, 0.0],
        diameter_m: 0.127,
        c_t: [0.1342, -0.1196, -0.1281],
        c_p: [0.0522, -0.0146, -0.0602],
        speed_max_rev_s: 14000.0 / 60.0,
        turns: 1.0,
    };

    /// Momentum theory: T = 2 ρ A (u + w) w, for any speed.
    #[test]
    fn the_slipstream_has_the_momentum_of_the_thrust() {
        for u in [0.0, 3.0, 12.0] {
            let thrust = 1.3;
            let w = SMALL.slipstream(thrust, u, RHO).velocity / DEVELOPMENT;
            let momentum = 2.0 * RHO * SMALL.area() * (u + w) * w;
            assert!((momentum - thrust).abs() < 1e-12);
        }
    }

    /// No thrust or a fast descent on the tail: no slipstream, and never a NaN.
    #[test]
    fn without_thrust_or_tail_first_there_is_none() {
        assert_eq!(SMALL.slipstream(0.0, 10.0, RHO).velocity, 0.0);
        assert_eq!(SMALL.slipstream(0.0, -10.0, RHO).velocity, 0.0);
        assert_eq!(SMALL.slipstream(1.0, -30.0, RHO).velocity, 0.0);
        let (at_rest, sinking) = (
            SMALL.slipstream(1.0, 0.0, RHO),
            SMALL.slipstream(1.0, -1e-6, RHO),
        );
        assert!((at_rest.velocity - sinking.velocity).abs() < 1e-5);
    }

    /// Full throttle at 12 m/s gives some 40 to 60 % of the static thrust, and more speed gives none.
    #[test]
    fn thrust_fades_with_speed() {
        let n = SMALL.speed_max_rev_s;
        let at = |u| SMALL.at(n, u, RHO).thrust / SMALL.static_thrust(RHO);
        assert!((0.4..0.6).contains(&at(12.0)), "{}", at(12.0));
        assert_eq!(at(40.0), 0.0);
        // 2.33 N: 0.1342 ρ n² D⁴.
        assert!((SMALL.static_thrust(RHO) - 2.328).abs() < 2e-3);
    }

    /// A strip across the axis is covered by what the circle cuts from it; one beside it is not.
    #[test]
    fn overlap_is_the_chord_of_the_jet() {
        let jet = Slipstream {
            velocity: 1.0,
            radius: 0.1,
        };
        assert_eq!(jet.covers(-0.2, 0.2, 0.0, 0.0), 0.5);
        assert_eq!(jet.covers(0.15, 0.2, 0.0, 0.0), 0.0);
        assert!((jet.covers(-0.2, 0.2, 0.0, 0.06) - 0.4).abs() < 1e-12);
        assert_eq!(jet.covers(-0.2, 0.2, 0.0, 0.11), 0.0);
    }
}
