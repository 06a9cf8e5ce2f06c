//! Thrust of a propeller of fixed pitch over the airspeed along it.

use crate::math;

/// Thrust over static thrust at full throttle and x = u/u_0 is s² − 0.6 s x − 0.4 x², where s² is the throttle: the static thrust it
/// commands, over the greatest. Propellers of published tables lie within 0.5 to 0.7 and 0.3 to 0.5.
const HALF_LINEAR: f32 = 0.3;
/// 0.3² + 0.4.
const QUADRATIC: f32 = 0.49;
/// Thrust over the greatest below which the command goes to none: a propeller that turns without thrust costs energy.
const IDLE: f32 = 0.02;

/// Thrust over airspeed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Propeller {
    /// 1/u_0 [s/m]; 0 for thrust that does not fall.
    pub per_speed: f32,
    /// Greatest static thrust \[N\].
    pub most: f32,
}

impl Propeller {
    /// Part of the greatest static thrust that is there at an airspeed `along` the nose [m/s].
    #[inline(always)]
    pub fn available(&self, along: f32) -> f32 {
        let x = math::clamp(along * self.per_speed, 0.0, 1.0);
        1.0 - x * (2.0 * HALF_LINEAR + (QUADRATIC - HALF_LINEAR * HALF_LINEAR) * x)
    }

    /// Least thrust that a turning propeller gives at an airspeed `along` the nose [m/s], over the greatest static one: it brakes.
    #[inline(always)]
    pub fn least(&self, along: f32) -> f32 {
        let x = math::clamp(along * self.per_speed, 0.0, 1.0);
        -QUADRATIC * x * x
    }

    /// Static thrust \[N\] to command for a `thrust` \[N\] at an airspeed `along` the nose [m/s]. Zero stops the motors, a negative thrust brakes with them.
    /// What brakes more than a turning propeller is left as it is: that takes motors that reverse.
    #[inline(always)]
    pub fn command(&self, thrust: f32, along: f32) -> f32 {
        let x = math::clamp(along * self.per_speed, 0.0, 1.0);
        if (x == 0.0) | (thrust == 0.0) {
            return thrust;
        }
        let (share, least) = (thrust / self.most, self.least(along));
        // Below the idle thrust the command fades to zero.
        let (held, turning) = if thrust > 0.0 {
            (math::max(share, IDLE), math::min(share / IDLE, 1.0))
        } else if share < least {
            return thrust;
        } else {
            (share, 1.0)
        };
        // The absolute value of what is positive: the root then needs no call of the C library.
        let s = HALF_LINEAR * x + math::sqrt((held - least).abs());
        self.most * math::min(s * s, 1.0) * turning
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::parameters::Parameters;
    use crate::vehicle::VehicleParameters;

    fn propeller(zero_thrust_speed: f32) -> Propeller {
        VehicleParameters {
            zero_thrust_speed,
            thrust_max: 40.0,
            ..VehicleParameters::DEFAULT
        }
        .propeller()
    }

    /// Without a speed of no thrust the command is the thrust, to the bit.
    #[test]
    fn thrust_that_does_not_fall_is_its_own_command() {
        let p = propeller(0.0);
        for (thrust, along) in [(13.7, 25.0), (-3.0, 25.0), (0.3, -4.0)] {
            assert_eq!(
                (p.command(thrust, along), p.available(along)),
                (thrust, 1.0)
            );
        }
        // Tail first thrust is taken for static.
        assert_eq!(
            (
                propeller(30.0).command(13.7, -8.0),
                propeller(30.0).available(-8.0)
            ),
            (13.7, 1.0)
        );
    }

    /// The command gives the thrust by the quadratic of C_T(J): ρD⁴(c0 n² + c1 n u/D + c2 u²/D²), in double precision.
    #[test]
    fn the_command_inverts_the_thrust_coefficient() {
        let (rho, d, c0) = (1.225_f64, 0.3, 0.12);
        let n_max = (40.0 / (rho * f64::powi(d, 4) * c0)).sqrt();
        // C_T = c0 (1 − 0.6 x/s − 0.4 x²/s²) where J = (x/s) u_0/(n_max D).
        let u_0 = 26.0;
        let j_0 = u_0 / (n_max * d);
        let (c1, c2) = (-0.6 * c0 / j_0, -0.4 * c0 / (j_0 * j_0));
        let p = propeller(u_0 as f32);
        for along in [0.0, 4.0, 13.0, 20.0, 25.0] {
            let most = 40.0 * f64::from(p.available(along));
            for share in [0.1, 0.5, 0.9, 1.0] {
                let wanted = share * most;
                // Below 2 % of the greatest static thrust the command goes to none.
                if wanted < 0.8 {
                    continue;
                }
                let n = n_max * (f64::from(p.command(wanted as f32, along)) / 40.0).sqrt();
                let j = f64::from(along) / (n * d);
                let thrust = rho * n * n * d.powi(4) * (c0 + c1 * j + c2 * j * j);
                // 1e-4 N: single precision of a root of a share, times 40 N.
                assert!(
                    (thrust - wanted).abs() < 1e-4,
                    "{along} {share}: {thrust} {wanted}"
                );
            }
        }
        // At the speed of no thrust there is none left, but for rounding.
        assert!(p.available(26.0).abs() < 1e-6);
    }

    /// A negative thrust is that of the same coefficient, down to the least that a turning propeller gives.
    #[test]
    fn the_command_inverts_the_thrust_that_brakes() {
        let (p, u_0) = (propeller(26.0), 26.0_f64);
        for along in [8.0, 20.0, 26.0] {
            // Thrust over the greatest static one, of a part s of the greatest speed of the motor.
            let x = f64::from(along) / u_0;
            let thrust = |s: f64| s * s - 0.6 * x * s - 0.4 * x * x;
            let least = (0..=1000).map(|n| thrust(0.001 * f64::from(n)));
            let least = least.fold(f64::INFINITY, f64::min);
            assert!((f64::from(p.least(along)) - least).abs() < 1e-6);
            for part in [0.1, 0.5, 0.9] {
                let wanted = 40.0 * part * least;
                let s = (f64::from(p.command(wanted as f32, along)) / 40.0).sqrt();
                // As above.
                assert!((40.0 * thrust(s) - wanted).abs() < 1e-4, "{along} {part}");
            }
        }
        assert_eq!((p.command(0.0, 20.0), p.least(-5.0)), (0.0, 0.0));
        // Motors that reverse, in slow air.
        assert_eq!(p.command(-3.0, 1.0), -3.0);
    }

    /// The command grows with the thrust, begins at none, and stays within the greatest static thrust.
    #[test]
    fn the_command_is_monotone() {
        let p = propeller(20.0);
        for along in [0.5, 10.0, 19.9, 40.0] {
            let mut last = 0.0;
            for n in 0..=100u8 {
                let command = p.command(0.4 * f32::from(n), along);
                assert!((last..=40.0).contains(&command), "{along} {n}");
                last = command;
            }
        }
    }
}
