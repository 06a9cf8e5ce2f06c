//! Parameters of the guidance for a vehicle, by rules.
//!
//! Each parameter has one rule and its reason, in one list. What is not a function of the vehicle stays at its default, and the reason
//! says why it may.

use super::construction::check_thrust;
use super::parameters::GuidanceParameters;
use crate::error::ParameterError;
use crate::math;
use crate::parameters::Parameters;
use crate::vehicle::VehicleParameters;

crate::parameters! {
    /// How fast a vehicle answers, and how fast it is to fly: what [`GuidanceParameters::for_vehicle`] needs besides the vehicle.
    #[non_exhaustive]
    pub struct ResponseParameters, "Response" {
        rate_lag: "s", 0.0, 1.0, f32::NAN, "ALU_RATE_LAG",
            "Lag of the rate loop: time until 63 % of a step of the rate commanded is there.";
        thrust_lag: "s", 1e-3, 1.0, f32::NAN, "ALU_THR_LAG",
            "Lag of the thrust: time until 63 % of a step of the thrust commanded is there.";
        control_rate: "Hz", 5.0, 1e4, 100.0, "ALU_CTL_RATE",
            "Rate of the guidance's steps.";
        cruise_speed: "m/s", 1.0, 340.0, f32::NAN, "ALU_CRUISE",
            "Speed of cruise.";
    }
}

/// Part of the airspeed across the wing that what turns the vehicle in hover holds, up to which it catches up with a place.
const CAUGHT_UP: f32 = 0.6;

/// What the rules are about.
struct Known {
    /// Lag of the rate loop and of the thrust, and the time between steps \[s\].
    rate_lag: f32,
    thrust_lag: f32,
    period: f32,
    /// Rate of the loop around the thrust [1/s].
    thrust_rate: f32,
    /// Angular acceleration in pitch that there is in hover [rad/s²].
    authority: f32,
    /// Speed that the propellers give the air in hover [m/s]; 0 if no surface needs it.
    downwash: f32,
    /// Speed of cruise [m/s].
    cruise: f32,
    /// Speed at which it is to catch up with a place [m/s].
    catching_up: f32,
}

/// Makes the function that gives every parameter, and the list of reasons, from one list.
macro_rules! rules {
    ($known:ident, $default:ident; $( $name:ident = $value:expr, $reason:literal; )*) => {
        /// Why [`GuidanceParameters::for_vehicle`] chooses what it does: each parameter's name and its reason, in the order of the parameters.
        ///
        $( #[doc = concat!("- `", stringify!($name), "`: ", $reason)] )*
        pub const REASONS: &[(&str, &str)] = &[$( (stringify!($name), $reason), )*];

        fn ruled($known: &Known) -> GuidanceParameters {
            let $default = GuidanceParameters::DEFAULT;
            GuidanceParameters { $( $name: $value, )* }
        }
    };
}

rules! { known, default;
    natural_frequency = math::min(
        math::min(4.0, 0.95 / (known.rate_lag + known.period)),
        math::sqrt((0.6 * known.authority).abs()),
    ),
        "At most 4 rad/s, the fastest that was flown. With a slow rate loop 0.95 over the sum of its lag and one step: at the damping ratio of 0.8 the loop is stable up to 1.6. Less where the vehicle in hover has too little to turn back from 0.6 rad: it would swing.";
    damping = default.damping,
        "Little overshoot where the lag has taken a part of it.";
    thrust_rate = known.thrust_rate,
        "The fastest that was flown. With slow motors 0.75 over the sum of their lag and one step, which leaves a damping ratio of 0.6.";
    gain_schedule_floor = default.gain_schedule_floor,
        "A multiple of the weight: the same for every vehicle.";
    tau = default.tau,
        "A multiple of the weight: the same for every vehicle.";
    altitude_band = default.altitude_band,
        "What may be seen of a crossing: for the pilot to choose, not the vehicle.";
    velocity_band_down = default.velocity_band_down,
        "As the altitude band.";
    velocity_band_forward = default.velocity_band_forward,
        "As the altitude band.";
    rate_lag = known.rate_lag,
        "As measured.";
    thrust_lag = known.thrust_lag,
        "As measured.";
    position_gain_down = default.position_gain_down / default.thrust_rate * known.thrust_rate,
        "A little less than half of thrust_rate at any lag: the loop around the thrust is twice as fast.";
    position_gain_forward = default.position_gain_forward,
        "A fifth of the fastest natural frequency: the loop around the attitude is faster by far.";
    max_velocity_down = default.max_velocity_down,
        "A sink that every vehicle can stop within a few metres.";
    max_sink = if known.downwash > 0.0 {
        math::min(default.max_sink, 0.15 * known.downwash)
    } else {
        default.max_sink
    },
        "Less where surfaces need the slipstream: tail first at 0.6 of the speed that the propellers give the air they have no effect.";
    max_velocity_forward = math::min(default.max_velocity_forward, known.catching_up),
        "A fifth of cruise: catching up is not a flight of its own. At most 0.6 of the airspeed across the wing that what turns the vehicle holds: in hover it catches up with its wing across the air.";
    integral_gain_down = default.integral_gain_down,
        "A fifth of position_gain_down at its fastest.";
    integral_gain_forward = default.integral_gain_forward,
        "An eighth of position_gain_forward.";
    max_integral_down = default.max_integral_down,
        "Times thrust_rate it is an acceleration of 6 m/s² at its fastest: a mass that is believed wrongly by half.";
    max_integral_forward = math::min(default.max_integral_forward, known.catching_up),
        "Holds an angle of 7° and more against a belief that is wrong.";
    max_lateral_acceleration = default.max_lateral_acceleration,
        "The guidance itself stays below what thrust and wing carry.";
    max_load_factor = default.max_load_factor,
        "None: the airframe says what it bears. With less than 6 g a wing that has become too fast pulls out late.";
    max_rate = greatest_rate(known.authority),
        "Crosses the stall in half a second; the plans of the guidance are laid out for it. Less where the surfaces could not stop it within 2°.";
    max_slew = math::min(
        math::clamp(3.0 / known.rate_lag, default.max_slew, 2.0 * default.max_slew),
        0.7 * known.authority,
    ),
        "At most 0.7 of what turns the vehicle in hover. Reaches the greatest rate within the lag of the rate loop, between a twentieth and a tenth of a second: with 30 rad/s² a vehicle of 60 ms climbed by a metre where it braked. A slower rate loop smooths it.";
    hold = math::max(0.1, 5.0 * known.period),
        "Five steps, and a tenth of a second at least: a frame that is lost now and then.";
    recovery = math::max(0.05, 3.0 * known.period),
        "Three good steps, and 50 ms at least.";
    state_age = math::max(0.05, 2.5 * known.period),
        "Two steps and a half, and 50 ms at least: older than that a state says nothing of a turning vehicle.";
    reference_age = default.reference_age,
        "Half a second: a link that stutters.";
    air_hold = default.air_hold,
        "The wind changes within seconds.";
    max_wind = math::max(40.0, known.cruise),
        "No vehicle flies in more; air data that imply more are wrong.";
    max_wind_step = default.max_wind_step,
        "No gust grows so fast.";
    safe_thrust = default.safe_thrust,
        "Hover thrust less a twentieth, for when inputs have failed for longer than `hold`. In hover the vehicle keeps its attitude and sinks, where its mass is known at 2.4 m/s after 5 s and at 7 m/s after 15 s. With the nose forward it glides. Zero cuts the thrust.";
}

/// The rule of `max_rate` [rad/s], from the angular acceleration in pitch that there is in hover [rad/s²].
pub(crate) fn greatest_rate(authority: f32) -> f32 {
    let held = math::sqrt((0.056 * authority).abs());
    math::min(GuidanceParameters::DEFAULT.max_rate, held)
}

impl GuidanceParameters {
    /// The parameters for `vehicle`, by the rules and for the [`REASONS`] given there. A start for every vehicle from 0.3 to 50 kg and 8 to
    /// 40 m/s with lags up to 0.2 s: the campaign `vehicles` flies them with beliefs that are wrong.
    ///
    /// # Errors
    /// A number that is outside its range; `thrust_max` of a vehicle that does not carry its weight, or `thrust_min` of one
    /// that cannot sink.
    pub fn for_vehicle(
        vehicle: &VehicleParameters,
        response: &ResponseParameters,
    ) -> Result<Self, ParameterError> {
        vehicle.check()?;
        response.check()?;
        let weight = vehicle.mass * vehicle.gravity;
        check_thrust(weight, vehicle.thrust_min, vehicle.thrust_max)?;
        let period = 1.0 / response.control_rate;
        let pitch = vehicle.pitch_authority();
        let authority = pitch.in_hover(weight, vehicle.thrust_max);
        let held = pitch.airspeed_held(authority);
        Ok(ruled(&Known {
            rate_lag: response.rate_lag,
            thrust_lag: response.thrust_lag,
            period,
            thrust_rate: math::min(3.0, 0.75 / (response.thrust_lag + period)),
            cruise: response.cruise_speed,
            authority,
            catching_up: math::min(response.cruise_speed / 5.0, CAUGHT_UP * held),
            downwash: if vehicle.authority_slipstream > 0.0 {
                vehicle.hover_downwash
            } else {
                0.0
            },
        }))
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{Combined, CombinedParameters};
    use crate::guidance::Guidance;
    use crate::vehicle::Vehicle;

    const PAPER: ResponseParameters = ResponseParameters {
        rate_lag: 0.1,
        thrust_lag: 0.05,
        control_rate: 100.0,
        cruise_speed: 20.0,
    };

    fn ruled(response: &ResponseParameters) -> GuidanceParameters {
        GuidanceParameters::for_vehicle(&VehicleParameters::PAPER, response).unwrap()
    }

    /// The defaults are those of the vehicle that they were found with.
    #[test]
    fn the_papers_vehicle_gets_the_defaults() {
        let (ruled, default) = (ruled(&PAPER), GuidanceParameters::default());
        for (i, row) in GuidanceParameters::ROWS.iter().enumerate() {
            assert_eq!(ruled.get(i), default.get(i), "{}", row.name);
        }
    }

    /// A vehicle of 10 rad/s² turns back from 0.6 rad with all that it has.
    #[test]
    fn the_loop_asks_for_no_more_than_there_is_to_turn_with() {
        let vehicle = VehicleParameters {
            authority: 10.0,
            ..VehicleParameters::PAPER
        };
        let p = GuidanceParameters::for_vehicle(&vehicle, &PAPER).unwrap();
        // 1e-3 rad/s²: roundings.
        assert!((p.natural_frequency * p.natural_frequency - 6.0).abs() < 1e-3);
        assert!(p.max_slew <= 7.0 + 1e-3 && p.max_rate < 1.0);
    }

    /// 10 rad/s² hold a wing that takes 0.5 w² at 4.5 m/s.
    #[test]
    fn it_catches_up_no_faster_than_its_wing_is_held() {
        let catching_up = |wing_moment: f32| {
            let vehicle = VehicleParameters {
                authority: 10.0,
                wing_moment,
                ..VehicleParameters::PAPER
            };
            let p = GuidanceParameters::for_vehicle(&vehicle, &PAPER).unwrap();
            (p.max_velocity_forward, p.max_integral_forward)
        };
        assert!((catching_up(0.5).0 - 0.6 * 4.472).abs() < 1e-3);
        assert_eq!(catching_up(0.0).0, 3.9);
        // The integral is never the greater one.
        let (velocity, integral) = catching_up(40.0);
        assert!(integral <= velocity && velocity < 0.5);
    }

    /// At every corner of what is accepted a guidance can be made of what comes out, and the loops are stable by what the gains' own page
    /// says: T ω_n < 2ζ.
    #[test]
    fn every_corner_makes_a_guidance() {
        let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        let rows = ResponseParameters::RANGES;
        for corner in 0..1 << rows.len() {
            let mut response = PAPER;
            for (i, range) in rows.iter().enumerate() {
                response.set(
                    i,
                    if corner >> i & 1 == 0 {
                        range.min
                    } else {
                        range.max
                    },
                );
            }
            let p = ruled(&response);
            let vehicle = Vehicle::new(VehicleParameters::PAPER, model).unwrap();
            assert!(Guidance::new(vehicle, &p).is_ok(), "{response:?}");
            assert!(response.rate_lag * p.natural_frequency < 1.2 * p.damping);
            assert!(4.0 * response.thrust_lag * p.thrust_rate <= 3.0);
            assert!(p.hold >= p.recovery && p.state_age > 1.0 / response.control_rate);
        }
    }

    #[test]
    fn slow_actuators_get_slower_loops() {
        let slow = ruled(&ResponseParameters {
            rate_lag: 0.4,
            thrust_lag: 0.5,
            ..PAPER
        });
        let quick = ruled(&PAPER);
        assert!(slow.natural_frequency < 0.6 * quick.natural_frequency);
        assert!(slow.thrust_rate < 0.6 * quick.thrust_rate);
        let share = |p: &GuidanceParameters| p.position_gain_down / p.thrust_rate;
        assert!((share(&slow) / share(&quick) - 1.0).abs() < 1e-6);
        let rare = ruled(&ResponseParameters {
            control_rate: 10.0,
            ..PAPER
        });
        assert!(rare.state_age > 0.2 && rare.hold >= 0.5);
    }

    /// The greatest rate is reached within the lag, where that is 50 to 100 ms.
    #[test]
    fn quick_rate_loops_may_slew_faster() {
        let slew = |rate_lag: f32| ruled(&ResponseParameters { rate_lag, ..PAPER }).max_slew;
        assert_eq!((slew(0.2), slew(0.1), slew(0.01)), (30.0, 30.0, 60.0));
        assert!((slew(0.06) - 50.0).abs() < 1e-4);
        assert_eq!(slew(0.0), 60.0);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let refused = |change: &dyn Fn(&mut VehicleParameters, &mut ResponseParameters)| {
            let (mut vehicle, mut response) = (VehicleParameters::PAPER, PAPER);
            change(&mut vehicle, &mut response);
            let error = GuidanceParameters::for_vehicle(&vehicle, &response).unwrap_err();
            (error.parameter, error.problem)
        };
        use crate::error::Problem::*;
        assert_eq!(refused(&|v, _| v.mass = -1.0), ("mass", NotPositive));
        assert_eq!(
            refused(&|v, _| v.thrust_max = 90.0),
            ("thrust_max", Contradiction)
        );
        assert_eq!(
            refused(&|v, _| v.thrust_min = 99.0),
            ("thrust_min", Contradiction)
        );
        assert_eq!(
            refused(&|_, r| r.rate_lag = f32::NAN),
            ("rate_lag", NotFinite)
        );
        assert_eq!(
            refused(&|_, r| r.thrust_lag = 2.0),
            ("thrust_lag", OutOfRange)
        );
        assert_eq!(
            refused(&|_, r| r.control_rate = 0.0),
            ("control_rate", NotPositive)
        );
        assert_eq!(
            refused(&|_, r| r.cruise_speed = -8.0),
            ("cruise_speed", NotPositive)
        );
    }

    #[test]
    fn every_parameter_has_a_reason() {
        let names: std::vec::Vec<_> = REASONS.iter().map(|(name, _)| *name).collect();
        let rows: std::vec::Vec<_> = GuidanceParameters::ROWS
            .iter()
            .map(|row| row.name)
            .collect();
        assert_eq!(names, rows);
    }
}
