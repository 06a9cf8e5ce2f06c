//! What plans are to mind, for the time being.

use crate::parameters::setters;

/// How a reference is to be flown, where that can be chosen. The default is what the parameters say, and nothing besides.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PlannerOptions {
    /// Altitude error \[m\] that a plan may cost as much as an error of one velocity band, in place of the parameter
    /// `altitude_band`: a narrow band keeps the altitude, a wide one gives it up to stop sooner. Outside [1e-3, 1e3], as zero
    /// is, or not a number: the parameter's.
    pub altitude_band: f32,
    /// Whether the nose stays short of the vertical while the vehicle flies forward through the air: it then brakes with the
    /// wing across the flow at most, and not by its thrust. For what may not be turned over: a camera, a load, a passenger.
    pub nose_below_vertical: bool,
    /// Whether the place does not matter, but the altitude: position errors to the north and east are those of a reference
    /// that goes along with the vehicle, as in a stop, and the reference model goes along, too. Else it would be left ahead and
    /// pull the vehicle after it.
    pub hold_altitude_only: bool,
}

setters! {
    PlannerOptions {
        altitude_band: f32,
        nose_below_vertical: bool,
        hold_altitude_only: bool,
    }
}

/// Bands an option may give, as the parameter \[m\].
pub(super) const LEAST_BAND: f32 = 1e-3;
pub(super) const MOST_BAND: f32 = 1e3;

/// Attitude θ \[rad\] up to which a nose is short of the vertical. Leaning back by so much takes the last of the velocity, where
/// the wing brakes no more: with 0 the vehicle would go on for long.
const UPRIGHT: f32 = 0.1;

/// The altitude band of the options, or else the `parameter`'s \[m\].
#[inline(always)]
pub(super) fn altitude_band(option: f32, parameter: f32) -> f32 {
    if (LEAST_BAND..=MOST_BAND).contains(&option) {
        option
    } else {
        parameter
    }
}

/// The greatest attitude θ \[rad\] of a flight forward, which may be to stay short of the vertical.
#[inline(always)]
pub(super) fn most_theta(nose_below_vertical: bool) -> f32 {
    // Else the compiler makes two steps of one, for either value: 3 KB.
    core::hint::black_box(if nose_below_vertical {
        UPRIGHT
    } else {
        f32::INFINITY
    })
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{Combined, CombinedParameters};
    use crate::air::AirData;
    use crate::frame::{Attitude, Body, Inertial};
    use crate::guidance::plane::PlanarGuidanceInput;
    use crate::guidance::{
        Air, Goal, GoalOutput, GoalState, Goals, Guidance, GuidanceParameters, GuidanceState, Mode,
        Preferences,
    };
    use crate::math;
    use crate::ned::Ned;
    use crate::reference::Reference;
    use crate::vehicle::{Vehicle, VehicleParameters};

    const DT: f32 = 0.01;

    /// How a stop is flown.
    #[derive(Clone, Copy)]
    struct How {
        planner_options: PlannerOptions,
        /// Wind from ahead [m/s].
        wind: f32,
        /// Whether the options go by way of the goals, and are checked there.
        checked: bool,
        /// Whether the guidance is not told that the place does not matter.
        held: bool,
    }

    impl Default for How {
        fn default() -> Self {
            Self {
                planner_options: PlannerOptions::default(),
                wind: 0.0,
                checked: true,
                held: false,
            }
        }
    }

    /// What a stop from 20 m/s came to.
    #[derive(Default)]
    struct Stop {
        /// Way until there was less than 1 m/s, and at most \[m\].
        way: f32,
        farthest: f32,
        /// Greatest altitude error \[m\].
        off: f32,
        /// Greatest attitude of the reference model and of the vehicle \[rad\] while it flew forward.
        theta: f32,
        real: f32,
        /// Speed at the end [m/s].
        speed: f32,
        /// Sum of the bits of all commands.
        commands: u64,
    }

    /// Level at 20 m/s over ground, and a stop `phase` steps later: the believed vehicle with the lags that the guidance is told.
    fn stop(how: How, phase: usize) -> Stop {
        let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        let vehicle = Vehicle::new(VehicleParameters::PAPER, model).unwrap();
        let p = GuidanceParameters::default();
        let guidance = Guidance::new(vehicle, &p).unwrap();
        let preferred = if how.checked {
            how.planner_options
        } else {
            PlannerOptions::default()
        };
        let goals = Goals::new(Preferences::default().planner_options(preferred)).unwrap();
        let (mut state, mut goal) = (GuidanceState::default(), GoalState::default());
        let wind = Inertial::new(0.0, -how.wind);
        let (mut velocity, mut position) = (Inertial::new(0.0, 20.0), Inertial::ZERO);
        let (mut theta, mut rate, mut thrust) = (-1.5, 0.0, 10.0);
        let (begins, mut began) = (500 + phase, Inertial::ZERO);
        let mut s = Stop {
            theta: -1.5,
            real: -1.5,
            ..Stop::default()
        };
        for n in 0..begins + 1600 {
            let asked = if n < begins {
                Goal::Velocity(Ned::new(20.0, 0.0, 0.0))
            } else {
                Goal::Stop
            };
            if n == begins {
                began = position;
            }
            let (at, v) = (Ned::in_plane(position), Ned::in_plane(velocity));
            let GoalOutput {
                reference,
                position_error: error,
                mut planner_options,
            } = goals.step(&mut goal, &asked, at, v, DT);
            if !how.checked {
                planner_options = PlannerOptions {
                    hold_altitude_only: planner_options.hold_altitude_only,
                    ..how.planner_options
                };
            }
            planner_options.hold_altitude_only &= !how.held;
            let input = PlanarGuidanceInput {
                velocity,
                attitude: Attitude::from_angle(theta),
                air: Air::Wind(wind),
                position_error: Some(error.to_plane()),
                reference: Reference {
                    velocity: reference.velocity.to_plane(),
                    acceleration: reference.acceleration.to_plane(),
                },
                planner_options,
                ..PlanarGuidanceInput::default()
            };
            let guided = guidance.update_in_plane(&mut state, &input, DT);
            if guided.plan_due {
                guidance.plan(&mut state);
            }
            assert!(guided.mode == Mode::Flying || n < 10);
            let bits = [guided.command.thrust, guided.command.rate].map(f32::to_bits);
            for bits in bits {
                s.commands = s.commands.rotate_left(5).wrapping_add(bits.into());
            }
            rate += (guided.command.rate - rate) * (DT / p.rate_lag);
            thrust += (guided.command.thrust - thrust) * (DT / p.thrust_lag);
            let air = AirData::new(
                input.attitude.to_body(velocity - wind),
                vehicle.thrust_line(),
            );
            let force = vehicle.aerodynamic_force(&air) - Body::new(thrust, 0.0);
            velocity += (input.attitude.to_inertial(force) / vehicle.mass()
                + Inertial::new(vehicle.gravity(), 0.0))
                * DT;
            position += velocity * DT;
            theta += rate * DT;
            if n >= begins {
                let gone = position - began;
                s.farthest = math::max(s.farthest, gone.forward());
                s.off = math::max(s.off, gone.down().abs());
                if s.way == 0.0 && velocity.forward() < 1.0 {
                    s.way = gone.forward();
                }
                let (model_velocity, virtual_theta) = state.reference_model();
                if model_velocity.north > wind.forward() {
                    s.theta = math::max(s.theta, virtual_theta);
                    s.real = math::max(s.real, theta);
                }
                s.speed = velocity.norm();
            }
        }
        s
    }

    /// Stops at many places of the planner's cycle: figure `f` of each, the least first.
    fn spread(how: How, f: impl Fn(&Stop) -> f32) -> std::vec::Vec<f32> {
        let mut figures: std::vec::Vec<_> = (0..40).step_by(5).map(|n| f(&stop(how, n))).collect();
        figures.sort_by(f32::total_cmp);
        figures
    }

    fn middle(figures: &[f32]) -> f32 {
        figures[figures.len() / 2]
    }

    fn last(figures: &[f32]) -> f32 {
        figures[figures.len() - 1]
    }

    const SHORT: PlannerOptions = PlannerOptions {
        altitude_band: 0.0,
        nose_below_vertical: true,
        hold_altitude_only: false,
    };

    /// 27 m without wind, in place of 23 m; against 3 m/s of wind 22 m in place of 21 m. The altitude is the same.
    #[test]
    fn a_stop_short_of_the_vertical_is_longer_and_a_stop() {
        for (wind, farthest, off) in [(0.0, 30.0, 1.2), (3.0, 25.0, 2.2)] {
            let how = How {
                wind,
                ..How::default()
            };
            assert!(middle(&spread(how, |s| s.theta)) > 0.25);
            let how = How {
                planner_options: SHORT,
                ..how
            };
            // 0.01 rad: where the limit is met the rate takes a few steps to end.
            assert!(last(&spread(how, |s| s.theta)) <= UPRIGHT + 0.01);
            // The vehicle follows with its lag.
            assert!(last(&spread(how, |s| s.real)) < 0.2);
            assert!(last(&spread(how, |s| s.farthest)) < farthest);
            assert!(last(&spread(how, |s| s.off)) < off);
            assert!(last(&spread(how, |s| s.speed)) < 0.05);
        }
    }

    /// A stop begins with the same plan whichever the planner looks at next: 1 cm of the way and 1 mm of the altitude are of where
    /// in its step the flight is.
    #[test]
    fn a_stop_is_the_same_at_every_moment() {
        let range = |figures: &[f32]| last(figures) - figures[0];
        assert!(range(&spread(How::default(), |s| s.farthest)) < 0.01);
        assert!(range(&spread(How::default(), |s| s.off)) < 0.001);
    }

    /// In wind from either side a stop ends, and does not drift on: at most 8 mm/s are left.
    #[test]
    fn a_stop_in_wind_is_a_stop() {
        for (wind, farthest) in [(-5.0, 36.0), (-3.0, 30.0), (3.0, 26.0), (5.0, 26.0)] {
            let how = How {
                wind,
                ..How::default()
            };
            assert!(last(&spread(how, |s| s.speed)) < 0.05, "{wind}");
            assert!(last(&spread(how, |s| s.farthest)) < farthest, "{wind}");
        }
    }

    /// The altitude is off by 0.70 m with a band of 1 cm, which takes 27 m, and by 0.90 m with the parameter's, which takes 23 m.
    #[test]
    fn a_narrow_band_keeps_the_altitude() {
        let narrow = How {
            planner_options: PlannerOptions {
                altitude_band: 0.01,
                ..PlannerOptions::default()
            },
            ..How::default()
        };
        let off = |how| spread(how, |s| s.off);
        let (narrow_off, usual_off) = (off(narrow), off(How::default()));
        assert!(last(&narrow_off) < 0.85 * usual_off[0]);
        let way = |how| spread(how, |s| s.way);
        assert!(last(&way(How::default())) < 24.0);
        assert!(last(&way(narrow)) < 28.0);
        assert!(last(&spread(narrow, |s| s.speed)) < 0.05);
    }

    /// Without it the reference model is left ahead, and pulls: the altitude is then off by 2.4 m, and it takes 29 m.
    #[test]
    fn a_stop_is_held_nowhere_before_it_ends() {
        let held = How {
            held: true,
            ..How::default()
        };
        let both =
            |f: fn(&Stop) -> f32| (middle(&spread(How::default(), f)), middle(&spread(held, f)));
        let (free, pulled) = both(|s| s.off);
        assert!(free < 0.7 * pulled, "{free} {pulled}");
        let (free, pulled) = both(|s| s.farthest);
        assert!(free < 0.9 * pulled, "{free} {pulled}");
    }

    /// A band that is none is the parameter's, and so is one that equals it: to the bit.
    #[test]
    fn a_band_that_is_none_is_the_parameters() {
        let output = |altitude_band: f32, nose_below_vertical: bool| {
            let planner_options = PlannerOptions {
                altitude_band,
                nose_below_vertical,
                hold_altitude_only: false,
            };
            let how = How {
                checked: false,
                planner_options,
                ..How::default()
            };
            stop(how, 0).commands
        };
        let usual = output(0.0, false);
        let parameter = GuidanceParameters::default().altitude_band;
        for none in [parameter, -0.0, -1.0, 9e-4, 1.1e3, f32::NAN, f32::INFINITY] {
            assert_eq!(output(none, false), usual, "{none}");
        }
        assert_ne!(output(0.01, false), usual);
        assert_ne!(output(0.0, true), usual);
    }
}
