//! Air data: the air velocity seen from the body, and the angle of attack it makes.
//!
//! α = θ − γ + π − δ, γ the direction of the air velocity and δ the angle from the zero-lift line to the
//! thrust line (`eq:angleOfAttack`). In body components the air velocity is
//! |v_a|·(−cos(α+δ), sin(α+δ)) (`eq:VaComponents`): the sine and cosine of α + δ are quotients, and α itself
//! is needed only where a model depends on the angle and not on its sine and cosine.

use crate::error::{ParameterError, in_range};
use crate::frame::Body;
use crate::math;

/// Air velocities shorter than this [m/s] have no direction: α is taken as 0. Every force they make is
/// below 1e-24 N.
pub(crate) const STILL: f32 = 1e-12;

/// An angle of attack, with its sine and cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct AngleOfAttack {
    /// sin α.
    pub sin: f32,
    /// cos α.
    pub cos: f32,
    /// α \[rad\], in [−π, π].
    pub rad: f32,
}

impl AngleOfAttack {
    /// The angle of attack with this sine and cosine, a pair of unit length.
    #[inline(always)]
    pub const fn from_sin_cos(sin: f32, cos: f32) -> Self {
        Self {
            sin,
            cos,
            rad: math::angle(sin, cos),
        }
    }

    /// The angle of attack `alpha` \[rad\], wrapped to [−π, π].
    pub const fn from_radians(alpha: f32) -> Self {
        let (sin, cos) = math::sin_cos(alpha);
        // Inside the range the argument is the better value: it has not been through two functions.
        let rad = if alpha.abs() <= math::PI {
            alpha
        } else {
            math::angle(sin, cos)
        };
        Self { sin, cos, rad }
    }

    /// Sine and cosine of the sum with the angle of this sine and cosine.
    #[inline(always)]
    const fn of_sum(&self, sin: f32, cos: f32) -> (f32, f32) {
        (
            sin * self.cos + cos * self.sin,
            cos * self.cos - sin * self.sin,
        )
    }
}

/// The constant angle δ from the zero-lift line to the thrust line, with its sine and cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ThrustLine {
    delta: f32,
    sin: f32,
    cos: f32,
}

impl ThrustLine {
    /// The thrust line at `delta` \[rad\], in [−π, π].
    ///
    /// # Errors
    /// `delta` not finite or out of range.
    pub fn new(delta: f32) -> Result<Self, ParameterError> {
        in_range("delta", delta, [-math::PI, math::PI], "rad").map(Self::of_checked)
    }

    /// The thrust line at a `delta` that [`new`](Self::new) would take.
    pub(crate) fn of_checked(delta: f32) -> Self {
        let (sin, cos) = math::sin_cos(delta);
        Self { delta, sin, cos }
    }

    /// δ \[rad\].
    pub fn delta(&self) -> f32 {
        self.delta
    }
}

/// Speed and direction of the air velocity, seen from the body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct AirData {
    /// Airspeed |v_a| \[m/s\].
    pub speed: f32,
    /// sin(α + δ).
    pub sin: f32,
    /// cos(α + δ).
    pub cos: f32,
    /// Angle of attack.
    pub alpha: AngleOfAttack,
}

impl AirData {
    /// Air data at an airspeed [m/s] and an angle of attack.
    pub fn from_angle_of_attack(
        speed: f32,
        alpha: AngleOfAttack,
        thrust_line: &ThrustLine,
    ) -> Self {
        Self {
            speed,
            sin: alpha.sin * thrust_line.cos + alpha.cos * thrust_line.sin,
            cos: alpha.cos * thrust_line.cos - alpha.sin * thrust_line.sin,
            alpha,
        }
    }

    /// Air data of the same air velocity where the body is turned by `angle` about the wing: the angle of attack is larger by it.
    #[inline(always)]
    pub(crate) fn turned(&self, angle: &AngleOfAttack) -> Self {
        let rad = self.alpha.rad + angle.rad;
        let (sin, cos) = angle.of_sum(self.sin, self.cos);
        let (alpha_sin, alpha_cos) = angle.of_sum(self.alpha.sin, self.alpha.cos);
        Self {
            speed: self.speed,
            sin,
            cos,
            alpha: AngleOfAttack {
                sin: alpha_sin,
                cos: alpha_cos,
                rad: if rad.abs() > math::PI {
                    core::hint::cold_path();
                    rad - (2.0 * math::PI).copysign(rad)
                } else {
                    rad
                },
            },
        }
    }

    /// Air data of an air velocity `v_a` [m/s] (velocity less wind) in body components.
    ///
    /// Defined for every velocity. Speed and forces go smoothly to zero with it; where there is no air
    /// velocity there is no direction, and α = 0 is given.
    #[inline(always)]
    pub fn new(v_a: Body, thrust_line: &ThrustLine) -> Self {
        let speed = v_a.norm();
        if speed > STILL {
            // The air velocity by components across and along the zero-lift line: |v_a| (sin α, cos α).
            let across = v_a.j() * thrust_line.cos + v_a.i() * thrust_line.sin;
            let along = v_a.j() * thrust_line.sin - v_a.i() * thrust_line.cos;
            // 1/|v_a| and tan α/2 = across/(|v_a| + |along|), or its like from the other end, by one division.
            let sum = speed + along.abs();
            let common = 1.0 / (speed * sum);
            let inverse = common * sum;
            Self {
                speed,
                sin: v_a.j() * inverse,
                cos: -v_a.i() * inverse,
                alpha: AngleOfAttack {
                    sin: across * inverse,
                    cos: along * inverse,
                    rad: math::angle_of_half(across * (common * speed), along),
                },
            }
        } else {
            // Not flight: nothing of it is to be made ahead of the choice.
            core::hint::cold_path();
            Self {
                speed,
                sin: thrust_line.sin,
                cos: thrust_line.cos,
                alpha: AngleOfAttack {
                    sin: 0.0,
                    cos: 1.0,
                    rad: 0.0,
                },
            }
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::frame::{Attitude, Inertial};

    #[test]
    fn alpha_is_the_papers_difference_of_angles() {
        // eq:angleOfAttack by angles in f64, against quotients of body components.
        for n in 0..2000 {
            let x = f64::from(n);
            let (theta, delta) = (x * 0.37 % 6.2 - 3.1, (x * 0.73).sin() * 1.57);
            let (down, forward) = ((x * 1.1).cos() * 20.0, (x * 0.9).sin() * 20.0);
            let air = AirData::new(
                Attitude::from_angle(theta as f32)
                    .to_body(Inertial::new(down as f32, forward as f32)),
                &ThrustLine::new(delta as f32).unwrap(),
            );
            let alpha = theta - forward.atan2(down) + core::f64::consts::PI - delta;
            // 1e-6: a few roundings of angles up to π.
            let difference = f64::from(air.alpha.rad) - alpha;
            assert!(difference.sin().abs() < 1e-6 && difference.cos() > 0.0);
            assert!((f64::from(air.sin) - (alpha + delta).sin()).abs() < 1e-6);
            assert!((f64::from(air.cos) - (alpha + delta).cos()).abs() < 1e-6);
            assert!((f64::from(air.alpha.cos) - alpha.cos()).abs() < 1e-6);
            assert!((f64::from(air.speed) - down.hypot(forward)).abs() < 4e-6);
        }
    }

    #[test]
    fn no_air_velocity_is_no_trouble() {
        let line = ThrustLine::new(0.4).unwrap();
        for v in [0.0, 1e-38, 1e-20, 1e-13, 1e-11] {
            for (i, j) in [(v, 0.0), (0.0, -v), (-v, v)] {
                let air = AirData::new(Body::new(i, j), &line);
                assert!(air.speed <= 2e-11 && air.alpha.rad.is_finite());
                assert!((air.sin * air.sin + air.cos * air.cos - 1.0).abs() < 1e-6);
                let sum = air.alpha.sin * line.cos + air.alpha.cos * line.sin;
                assert!((sum - air.sin).abs() < 1e-6);
            }
        }
    }

    /// Of a body that is turned by an angle the air data are those of the velocity in its components.
    #[test]
    fn a_turned_body_has_its_own_air() {
        let line = ThrustLine::new(0.3).unwrap();
        for n in 0..200 {
            let (theta, by) = (n as f32 * 0.0631 - 6.3, [-0.6, 0.087][n % 2]);
            let v = Inertial::new(3.0, -14.0);
            let at = |theta| AirData::new(Attitude::from_angle(theta).to_body(v), &line);
            let (got, right) = (
                at(theta).turned(&AngleOfAttack::from_radians(by)),
                at(theta + by),
            );
            assert_eq!(got.speed, at(theta).speed);
            // 2e-6: some roundings of angles up to 2π.
            assert!(got.alpha.rad.abs() <= math::PI);
            assert!((got.alpha.rad - right.alpha.rad).sin().abs() < 2e-6);
            assert!((got.sin - right.sin).abs() + (got.cos - right.cos).abs() < 2e-6);
            let off = (got.alpha.sin - right.alpha.sin).abs();
            assert!(off + (got.alpha.cos - right.alpha.cos).abs() < 2e-6);
        }
    }

    #[test]
    fn angles_beyond_a_turn_wrap() {
        for n in -30..30 {
            let alpha = n as f32 * 0.33;
            let a = AngleOfAttack::from_radians(alpha);
            assert!(a.rad.abs() <= math::PI);
            let turns = f64::from(alpha - a.rad) / core::f64::consts::TAU;
            assert!((turns - turns.round()).abs() < 1e-6);
        }
        assert!(ThrustLine::new(3.2).is_err() && ThrustLine::new(f32::NAN).is_err());
    }
}
