//! What a baseline reads from one step's input.

use alula::PlanarGuidanceInput;
use alula::guidance::Air;

use crate::controllers::vector;
use crate::reference::Vector;

/// Time constant of the estimate of the wind from its measurements \[s\]: gusts are flown through, not followed.
const WIND: f64 = 5.0;

/// The measurements and the reference of one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// v \[m/s\].
    pub velocity: Vector,
    /// θ \[rad\].
    pub theta: f64,
    /// |v_a| \[m/s\]; the ground speed if nothing is known of the air.
    pub airspeed: f64,
    /// The part of v_a along the nose \[m/s\], which a pitot tube measures.
    pub nose_airspeed: f64,
    /// Position less reference position \[m\]; zero if it is not measured.
    pub position_error: Vector,
    /// v_r \[m/s\].
    pub reference: Vector,
    /// a_r \[m/s²\].
    pub acceleration: Vector,
    /// Reference airspeed \[m/s\]: the forward reference less the steady wind.
    pub reference_airspeed: f64,
}

/// The part of `v` along the nose.
fn along_nose(v: Vector, theta: f64) -> f64 {
    -(v.x * theta.cos() + v.y * theta.sin())
}

/// The forward wind, low-passed \[m/s\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wind(Option<f64>);

impl Wind {
    /// Reads `input`, `dt` \[s\] after the last; `None` if velocity, attitude or reference is not finite.
    pub fn read(&mut self, input: &PlanarGuidanceInput, dt: f64) -> Option<Measured> {
        let velocity = vector(input.velocity);
        let theta = f64::from(input.attitude.angle());
        let air_velocity = match input.air {
            Air::Velocity(v_a) => vector(v_a),
            Air::Wind(wind) => velocity - vector(wind),
            Air::Unknown => velocity - Vector::new(0.0, self.0.unwrap_or(0.0)),
        };
        let reference = vector(input.reference.velocity);
        let acceleration = vector(input.reference.acceleration);
        let known = velocity + air_velocity + reference + acceleration;
        if !(known.x.is_finite() && known.y.is_finite() && theta.is_finite()) {
            return None;
        }
        let wind = (velocity - air_velocity).y;
        let last = self.0.unwrap_or(wind);
        let wind = last + (wind - last) * dt / (WIND + dt);
        self.0 = Some(wind);
        let error = input.position_error.map(vector);
        let error = error.filter(|e| e.x.is_finite() && e.y.is_finite());
        Some(Measured {
            velocity,
            theta,
            airspeed: air_velocity.norm(),
            nose_airspeed: along_nose(air_velocity, theta),
            position_error: error.unwrap_or_default(),
            reference,
            acceleration,
            reference_airspeed: reference.y - wind,
        })
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use alula::{Attitude, Inertial, Reference};

    /// Steady flight at `velocity` and `theta` in place along a reference at the same velocity, in still air.
    pub(crate) fn steady(velocity: [f64; 2], theta: f64) -> Measured {
        Measured {
            velocity: velocity.into(),
            theta,
            airspeed: Vector::from(velocity).norm(),
            nose_airspeed: along_nose(velocity.into(), theta),
            position_error: Vector::zeros(),
            reference: velocity.into(),
            acceleration: Vector::zeros(),
            reference_airspeed: velocity[1],
        }
    }

    fn input(air: Air<Inertial>) -> PlanarGuidanceInput {
        PlanarGuidanceInput {
            velocity: Inertial::new(0.0, 12.0),
            attitude: Attitude::from_angle(-1.0),
            state_age: 0.0,
            air,
            specific_force: None,
            position_error: Some(Inertial::new(1.0, -2.0)),
            reference: Reference {
                velocity: Inertial::new(0.0, 15.0),
                acceleration: Inertial::new(0.0, 0.5),
            },
            reference_age: 0.0,
            ..PlanarGuidanceInput::default()
        }
    }

    #[test]
    fn a_headwind_adds_to_both_airspeeds() {
        for air in [
            Air::Velocity(Inertial::new(0.0, 17.0)),
            Air::Wind(Inertial::new(0.0, -5.0)),
        ] {
            let measured = Wind::default().read(&input(air), 0.01).unwrap();
            assert!((measured.airspeed - 17.0).abs() < 1e-6);
            assert!((measured.reference_airspeed - 20.0).abs() < 1e-6);
        }
        let still = Wind::default().read(&input(Air::Unknown), 0.01).unwrap();
        assert_eq!((still.airspeed, still.reference_airspeed), (12.0, 15.0));
        assert_eq!(still.position_error, Vector::new(1.0, -2.0));
    }

    #[test]
    fn a_gust_moves_the_wind_slowly() {
        let mut wind = Wind::default();
        wind.read(&input(Air::Wind(Inertial::new(0.0, 0.0))), 0.01);
        let mut last = 15.0;
        // One time constant at −5 m/s: 63 % of it is taken for wind.
        for _ in 0..500 {
            let gust = input(Air::Wind(Inertial::new(0.0, -5.0)));
            last = wind.read(&gust, 0.01).unwrap().reference_airspeed;
        }
        assert!((last - 15.0 - 5.0 * (1.0 - (-1.0_f64).exp())).abs() < 0.02);
    }

    #[test]
    fn inputs_that_are_not_finite_are_refused() {
        let mut bad = input(Air::Unknown);
        bad.velocity = Inertial::new(f32::NAN, 0.0);
        assert_eq!(Wind::default().read(&bad, 0.01), None);
        let mut lost = input(Air::Unknown);
        lost.position_error = Some(Inertial::new(f32::NAN, 0.0));
        let measured = Wind::default().read(&lost, 0.01).unwrap();
        assert_eq!(measured.position_error, Vector::zeros());
    }
}
