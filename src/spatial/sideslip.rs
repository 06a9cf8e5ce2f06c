//! Sideslip from the lateral accelerometer: for places where the wind is poorly known.

use super::MAX_STEP;
use super::vector::Body;
use crate::aero::Aerodynamics;
use crate::error::{ParameterError, in_range};
use crate::math;
use crate::ned::Frd;
use crate::vehicle::Vehicle;

/// Parameters of the sideslip estimator.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SideslipParameters {
    /// Time constant of the low-pass \[s\].
    pub time: f32,
    /// Airspeed [m/s] below which the measurement loses weight, with its square.
    pub airspeed: f32,
    /// Largest lateral air velocity [m/s] that is believed.
    pub most: f32,
}

impl SideslipParameters {
    /// As flown.
    pub const DEFAULT: Self = Self {
        time: 0.2,
        airspeed: 10.0,
        most: 10.0,
    };
}

/// Estimates what the known wind leaves out of the air velocity along w.
///
/// Across the wing an accelerometer feels the side force alone, f_w = −(k_a c_Y/m) |v_a| v_aw, which gives v_aw. The
/// difference from the v_aw of the known wind is low-passed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sideslip {
    /// m/(k_a c_Y) \[m\].
    length: f32,
    time: f32,
    /// 1/V².
    over_square: f32,
    most: f32,
}

/// What the estimator remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SideslipState {
    /// Air velocity along w that the known wind leaves out [m/s].
    pub velocity: f32,
}

impl Sideslip {
    /// The estimator for what `vehicle` is believed to be.
    ///
    /// # Errors
    /// `c_y` of the vehicle below 1e-6, `time` outside [1e-3, 1e3] s, `airspeed` outside [1e-1, 1e3] m/s, `most`
    /// outside [1e-3, 1e3] m/s; or any not finite.
    pub fn new<A: Aerodynamics>(
        p: SideslipParameters,
        vehicle: &Vehicle<A>,
    ) -> Result<Self, ParameterError> {
        in_range("c_y", vehicle.c_y(), [1e-6, 1e3], "")?;
        in_range("airspeed", p.airspeed, [1e-1, 1e3], "m/s")?;
        in_range("time", p.time, [1e-3, 1e3], "s")?;
        in_range("most", p.most, [1e-3, 1e3], "m/s")?;
        Ok(Self::of_checked(p, vehicle))
    }

    /// The estimator with parameters and a vehicle that [`new`](Self::new) would take.
    pub(crate) fn of_checked<A: Aerodynamics>(p: SideslipParameters, vehicle: &Vehicle<A>) -> Self {
        Self {
            length: vehicle.mass() / (vehicle.k_a() * vehicle.c_y()),
            time: p.time,
            over_square: 1.0 / (p.airspeed * p.airspeed),
            most: p.most,
        }
    }

    /// One step of `dt` \[s\], with the air velocity `v_a` [m/s] of the known wind, and the specific force along the right
    /// wing [m/s²]. A measurement that is not finite, or a `dt` that is not positive, changes nothing.
    #[inline]
    pub fn update(&self, state: &mut SideslipState, v_a: Frd, specific_force: f32, dt: f32) {
        let v_a = Body::from(v_a);
        let square = v_a.norm_squared();
        let speed = math::sqrt(square);
        // Below 1 m/s there is nothing to measure, and the weight is close to zero.
        let over = 1.0 / if speed > 1.0 { speed } else { 1.0 };
        let measured = math::clamp(-self.length * specific_force * over, -self.most, self.most);
        let weight = math::min(square * self.over_square, 1.0);
        let step = (measured - v_a.w) * weight - state.velocity;
        let next = state.velocity + step * (dt / (self.time + dt));
        let timed = dt > 0.0 && dt <= MAX_STEP;
        if timed && next.is_finite() && square.is_finite() {
            state.velocity = math::clamp(next, -2.0 * self.most, 2.0 * self.most);
        } else if !state.velocity.is_finite() {
            state.velocity = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aero::{LargeAngle, LargeAngleParameters};
    use crate::vehicle::VehicleParameters;

    fn vehicle(c_y: f32) -> Vehicle<LargeAngle> {
        let model = LargeAngle::new(LargeAngleParameters::NACA_0021_RE_160E3).unwrap();
        let p = VehicleParameters {
            c_y,
            ..VehicleParameters::PAPER
        };
        Vehicle::new(p, model).unwrap()
    }

    fn estimator() -> Sideslip {
        Sideslip::new(SideslipParameters::DEFAULT, &vehicle(0.5)).unwrap()
    }

    /// At 20 m/s with 3 m/s of lateral air velocity that the known wind leaves out, what the side force says is believed
    /// after a few time constants; at 5 m/s a quarter of it.
    #[test]
    fn an_unknown_lateral_air_velocity_is_found() {
        for (speed, share) in [(20f32, 1.0), (5.0, 0.25)] {
            let known = Frd::new(speed, 1.0, 0.0);
            let airspeed = Body::from(known).norm_squared().sqrt();
            let felt = -0.6460 * 0.5 * airspeed * 4.0 / 10.0;
            let mut state = SideslipState::default();
            for _ in 0..300 {
                estimator().update(&mut state, known, felt, 0.01);
            }
            let weight = (airspeed / 10.0).powi(2).min(1.0);
            assert!((state.velocity - 3.0 * weight).abs() < 1e-3);
            assert!((weight - share).abs() < 0.02);
        }
    }

    #[test]
    fn it_is_bounded_and_leaves_nonsense_out() {
        let mut state = SideslipState::default();
        for _ in 0..10_000 {
            estimator().update(&mut state, Frd::new(20.0, -1e6, 0.0), 1e9, 0.01);
        }
        assert!(state.velocity.abs() <= 20.0);
        let before = state;
        let v_a = Frd::new(20.0, 0.0, 0.0);
        estimator().update(&mut state, v_a, f32::NAN, 0.01);
        estimator().update(&mut state, Frd::new(f32::INFINITY, 0.0, 0.0), 0.0, 0.01);
        for dt in [0.0, -0.01, f32::NAN, 1.0] {
            estimator().update(&mut state, v_a, 1.0, dt);
        }
        assert_eq!(state, before);
        state.velocity = f32::NAN;
        estimator().update(&mut state, v_a, 0.0, 0.01);
        assert_eq!(state.velocity, 0.0);
    }

    #[test]
    fn bad_parameters_are_named() {
        let good = SideslipParameters::DEFAULT;
        let name = |p, c_y| Sideslip::new(p, &vehicle(c_y)).unwrap_err().parameter;
        assert_eq!(name(good, 0.0), "c_y");
        assert_eq!(name(SideslipParameters { time: 0.0, ..good }, 0.5), "time");
        assert_eq!(
            name(
                SideslipParameters {
                    airspeed: f32::NAN,
                    ..good
                },
                0.5
            ),
            "airspeed"
        );
        assert_eq!(name(SideslipParameters { most: -1.0, ..good }, 0.5), "most");
    }
}
