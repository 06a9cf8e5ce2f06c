//! What the accelerometer tells of the vehicle: the force that the believed one leaves out. What it tells of the air is in
//! [`air_estimate`](super::air_estimate).

use super::memory::memory;
use super::parameters::GuidanceParameters;
use crate::aero::Aerodynamics;
use crate::math;
use crate::ned::Ned;
use crate::spatial::{
    Body, Command, Correction, ForceError, ForceErrorParameters, ForceErrorState, ForceSample,
    Orientation,
};
use crate::vehicle::Vehicle;

/// Time constant of the force error \[s\], and the least of it in multiples of the rate loop's lag. The wing's force turns with the vehicle: an
/// error of it that was followed faster than the vehicle turns made a slow one of 25 kg swing in wind, at 0.4 Hz.
const TIME: f32 = 0.2;
const LAGS: f32 = 2.0;
/// What is taken out of the force error for the force of the surfaces that turn the vehicle, over what is believed of that force. Too little drives a nod, too
/// much damps it. With 1.0 of it 16 of 100 elevon wings on an independent plant nodded in calm hover at 1.6 Hz, and one did without an accelerometer. With 2.0
/// a vehicle of elevons without an integral, which turns by less than is commanded, sank by 3.5 m after it was taken over. What tells the air keeps 1.0: with more,
/// wings of 25 kg nod more often.
const TAKEN_OUT: f32 = 1.5;
/// Greatest force error that is believed, in multiples of the weight.
const MOST: f32 = 0.6;
/// Time in which the force of the air takes over what is left of the force error along it \[s\], and the bounds of what is
/// believed of it.
const AIR_TIME: f32 = 0.5;
/// Time in which the force of the air takes over what is taken for a gust \[s\]: no gust lasts as long.
const GUST_TIME: f32 = 5.0;
const LEAST_EXCESS: f32 = -0.4;
const MOST_EXCESS: f32 = 0.6;
/// Force of the air, in multiples of the weight, below which it counts less.
const AIR_FORCE: f32 = 0.3;
/// Airspeed at which half of a force across the nose is the air's, over the speed that the propellers give the air in hover. With 1.0 of it the force is followed
/// slowly in half of a braking, and a vehicle climbs there; with none of it more elevon wings nod in wind.
const SLIPSTREAM: f32 = 0.5;
/// Part of its pace at which a force across the nose is followed where none of it is the air's: below the bandwidth of the attitude, and fast enough to hold the
/// place in a wind that changes. With half of it `mapping` with PX4's elevons, which have no integral, sank by 11 m after it was taken over.
const SLOWEST: f32 = 0.2;
/// Greatest thrust that is taken for missing, and the least of the greatest thrust that is left, over the weight.
const MOST_MISSING: f32 = 0.2;
const LEAST_THRUST: f32 = 1.02;

/// The estimators.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Accelerometer {
    force: ForceError,
    most: f32,
    air_force: f32,
    /// Fourth power of the airspeed at which the air tells half [m⁴/s⁴]; 0 of a vehicle without a slipstream.
    slipstream: f32,
    rate_lag: f32,
    surface_reaction: f32,
}

/// What they remember.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct AccelerometerState {
    pub force: ForceErrorState,
    /// Force of the air that is measured, as a multiple of the believed one, less 1.
    pub excess: f32,
    /// Pitch rate that the commands should have given by now [rad/s].
    pub rate: f32,
}

memory!(AccelerometerState {
    force: ForceErrorState,
    excess: f32,
    rate: f32,
});
memory!(ForceErrorState {
    force: Ned,
    thrust: f32,
});

impl Accelerometer {
    /// The estimators for `vehicle`, with parameters that have been checked.
    pub fn new<A: Aerodynamics>(p: &GuidanceParameters, vehicle: &Vehicle<A>) -> Self {
        let most = math::clamp(MOST * vehicle.weight(), 1e-3, 1e6);
        let force = ForceErrorParameters {
            time: math::max(TIME, LAGS * p.rate_lag),
            thrust_lag: p.thrust_lag,
            most,
        };
        let slipstream =
            SLIPSTREAM * SLIPSTREAM * vehicle.authority().squared_downwash(vehicle.weight());
        Self {
            force: ForceError::of_checked(force, vehicle.mass()),
            most,
            air_force: AIR_FORCE * vehicle.weight(),
            slipstream: slipstream * slipstream,
            rate_lag: p.rate_lag,
            surface_reaction: vehicle.surface_reaction(),
        }
    }

    /// Whether every number is one that a step can have left. NaN is not.
    #[inline(always)]
    pub fn is_sound(&self, state: &AccelerometerState) -> bool {
        let AccelerometerState {
            force,
            excess,
            rate,
        } = state;
        force.force.norm_squared() <= 1.000_01 * self.most * self.most
            && force.thrust.abs() <= 1e7
            && (LEAST_EXCESS..=MOST_EXCESS).contains(excess)
            && rate.abs() <= 1e3
    }

    /// Begins with the thrust \[N\] that a specific force tells, within the limits of `vehicle`: which was commanded before is not known.
    /// Until the lag has passed, a hover would else look like a force of the vehicle's weight.
    pub fn begin<A: Aerodynamics>(
        &self,
        state: &mut AccelerometerState,
        specific_force: Option<Body>,
        vehicle: &Vehicle<A>,
    ) {
        if let Some(felt) = specific_force {
            let thrust = -vehicle.mass() * felt.i;
            state.force.thrust = math::clamp(thrust, vehicle.thrust_min(), vehicle.thrust_max());
        }
    }

    /// How far the force across the nose is the air's, at an `air` velocity [m/s]: 1 where it is all of it, 0 where it is the slipstream's, which makes more
    /// force on a real wing in slow air than the air that is believed in. So do the elevons that hold the wing's moment. Both turn with the vehicle: in steady wind
    /// a radian turned 0.5 to 0.8 of the weight in place of all of it. Followed at once, what is missing turns the vehicle on, and the scale of the air's force
    /// takes a damping for granted that is not there: a tenth of the elevon wings on an independent plant nodded at 0.6 Hz.
    #[inline(always)]
    pub fn share(&self, air: Ned) -> f32 {
        let square = air.norm_squared();
        let fourth = square * square + f32::MIN_POSITIVE;
        fourth / (fourth + self.slipstream)
    }

    /// What the law is to add where the air has this `share`: what is in proportion to the force of the air follows it at once, the rest by its low-pass.
    #[inline(always)]
    pub fn correction(&self, state: &AccelerometerState, share: f32) -> Correction {
        Correction::of_checked(state.force.force, share * state.excess)
    }

    /// Thrust \[N\] that the vehicle does not have for anything else: it holds the force along `down` that the belief leaves
    /// out. However large that is, the vehicle still hovers.
    #[inline(always)]
    pub fn missing<A: Aerodynamics>(
        &self,
        state: &AccelerometerState,
        down: Ned,
        vehicle: &Vehicle<A>,
    ) -> f32 {
        let weight = vehicle.weight();
        let left = vehicle.thrust_max() - LEAST_THRUST * weight;
        let most = math::min(MOST_MISSING * weight, left);
        math::clamp(down.dot(state.force.force), 0.0, most)
    }

    /// The specific force \[m/s²\] without that by which surfaces turn the vehicle, where this pitch rate was `commanded` last
    /// \[rad/s\], in a step of `dt` \[s\].
    #[inline(always)]
    pub fn without_surfaces(
        &self,
        state: &AccelerometerState,
        felt: Body,
        commanded: f32,
        dt: f32,
    ) -> Body {
        self.without(felt, self.change(state, commanded, dt))
    }

    /// The specific force \[m/s²\] without that of surfaces that change the pitch rate by this \[rad/s²\].
    #[inline(always)]
    fn without(&self, felt: Body, change: f32) -> Body {
        Body::new(felt.i, felt.j - self.surface_reaction * change, felt.w)
    }

    /// Change of the pitch rate \[rad/s²\] by which the rate loop follows this one `commanded` \[rad/s\], in a step of `dt` \[s\].
    #[inline(always)]
    fn change(&self, state: &AccelerometerState, commanded: f32, dt: f32) -> f32 {
        (commanded - state.rate) / (self.rate_lag + dt)
    }

    /// One step of `dt` \[s\] after a command of the law in this attitude, with the specific force \[m/s²\] if it is
    /// measured, the part of the force along the belly that is taken for a `gust`'s \[N\], and the [`share`](Self::share) of the air. Where
    /// nothing is measured nothing is added any more.
    #[expect(clippy::too_many_arguments)]
    #[inline(always)]
    pub fn update(
        &self,
        state: &mut AccelerometerState,
        specific_force: Option<Body>,
        orientation: Orientation,
        command: &Command,
        gust: f32,
        share: f32,
        dt: f32,
    ) {
        let commanded = command.rates.pitch;
        // The force by which surfaces turn the vehicle is no error of the belief.
        let change = self.change(state, commanded, dt);
        let felt = specific_force.map(|felt| self.without(felt, TAKEN_OUT * change));
        state.rate += change * dt;
        let Some(specific_force) = felt else {
            *state = AccelerometerState {
                rate: state.rate,
                ..AccelerometerState::default()
            };
            state.force.thrust = command.thrust;
            return;
        };
        let aerodynamic = Body::from(command.diagnostics.aerodynamic);
        let sample = ForceSample {
            specific_force: specific_force.into(),
            orientation,
            aerodynamic: command.diagnostics.aerodynamic,
            thrust: command.thrust,
        };
        let pace = math::max(share, SLOWEST);
        self.force.advance(&mut state.force, &sample, pace, dt);
        let force = aerodynamic.norm_squared() + self.air_force * self.air_force;
        let left = orientation.to_axes(state.force.force).dot(aerodynamic) / force;
        let lasting = gust * aerodynamic.j / force;
        state.excess = math::clamp(
            state.excess
                + share * left * math::min(dt / AIR_TIME, 1.0)
                + lasting * math::min(dt / GUST_TIME, 1.0),
            LEAST_EXCESS,
            MOST_EXCESS,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aero::{LargeAngle, LargeAngleParameters};
    use crate::ned::BodyRates;
    use crate::spatial::Diagnostics;
    use crate::vehicle::VehicleParameters;

    const DT: f32 = 0.01;

    /// 10 kg that weigh 98.1 N.
    fn vehicle(c_y: f32) -> Vehicle<LargeAngle> {
        let model = LargeAngle::new(LargeAngleParameters::NACA_0021_RE_160E3).unwrap();
        let p = VehicleParameters {
            c_y,
            ..VehicleParameters::PAPER
        };
        Vehicle::new(p, model).unwrap()
    }

    fn estimators(c_y: f32) -> Accelerometer {
        Accelerometer::new(&GuidanceParameters::default(), &vehicle(c_y))
    }

    /// Flies for some seconds nose up, the believed force of the air being `believed`, without thrust, while the accelerometer
    /// feels `felt` \[N\]. What of the force is taken over by the scale scales `believed` in turn.
    fn fly(
        estimators: &Accelerometer,
        state: &mut AccelerometerState,
        believed: Body,
        felt: Option<Body>,
        seconds: f32,
    ) {
        for _ in 0..(seconds / DT) as usize {
            let command = Command {
                diagnostics: Diagnostics {
                    aerodynamic: (believed * (1.0 + state.excess)).into(),
                    v_a: Body::new(0.0, -20.0, 0.0).into(),
                    ..Diagnostics::default()
                },
                ..Command::default()
            };
            let up = Orientation::NOSE_UP;
            estimators.update(state, felt.map(|f| f * 0.1), up, &command, 0.0, 1.0, DT);
            assert!(estimators.is_sound(state));
        }
    }

    /// Nose up at 8 m/s of downwash: in still air a force across the nose is followed five times as slowly as one along it, at 4 m/s half as fast, and of a
    /// vehicle without a slipstream at once.
    #[test]
    fn across_the_nose_it_is_followed_as_far_as_it_is_the_airs() {
        let model = LargeAngle::new(LargeAngleParameters::NACA_0021_RE_160E3).unwrap();
        let p = VehicleParameters {
            hover_downwash: 8.0,
            ..VehicleParameters::PAPER
        };
        let slow = Accelerometer::new(
            &GuidanceParameters::default(),
            &Vehicle::new(p, model).unwrap(),
        );
        let at = |speed: f32| slow.share(Ned::new(0.0, speed, 0.0));
        assert!(at(0.0) < 1e-30);
        assert!((at(4.0) - 0.5).abs() < 1e-5);
        assert!(at(10.0) > 0.97);
        let whole = estimators(0.0);
        assert_eq!(whole.share(Ned::ZERO), 1.0);
        let followed = |e: &Accelerometer, share: f32| {
            let mut state = AccelerometerState::default();
            let felt = Some(Body::new(1.0, 1.0, 0.0));
            let (up, command) = (Orientation::NOSE_UP, Command::default());
            e.update(&mut state, felt, up, &command, 0.0, share, DT);
            assert!(e.is_sound(&state));
            let force = up.to_axes(state.force.force);
            force.j / force.i
        };
        assert!((followed(&slow, 0.0) - 0.2).abs() < 1e-5);
        assert!((followed(&slow, 0.5) - 0.5).abs() < 1e-5);
        assert!((followed(&whole, 1.0) - 1.0).abs() < 1e-5);
        let state = AccelerometerState {
            excess: 0.4,
            ..AccelerometerState::default()
        };
        assert!((slow.correction(&state, 0.5).air() - 1.2).abs() < 1e-6);
    }

    /// A force along the believed one becomes a scale of it, and what is left of the force error goes.
    #[test]
    fn what_is_in_proportion_to_the_air_scales_it() {
        let (e, mut state) = (estimators(0.0), AccelerometerState::default());
        let believed = Body::new(0.0, -98.1, 0.0);
        fly(&e, &mut state, believed, Some(believed * 1.3), 10.0);
        assert!((state.excess - 0.3).abs() < 1e-3);
        assert!(state.force.force.norm_squared() < 0.1);
        assert!((e.correction(&state, 1.0).air() - 1.3).abs() < 1e-3);
    }

    /// The force by which surfaces turn the vehicle is no error of the belief. In a pitch to and fro at 1.5 Hz none of it is left where two thirds of it are
    /// believed. Where all of it is, half of what there was without holds the vehicle back.
    #[test]
    fn the_force_of_the_surfaces_turns_no_vehicle_on() {
        let turning_on = |surface_reaction: f32| {
            let model = LargeAngle::new(LargeAngleParameters::NACA_0021_RE_160E3).unwrap();
            let p = VehicleParameters {
                surface_reaction,
                ..VehicleParameters::PAPER
            };
            let parameters = GuidanceParameters::default();
            let e = Accelerometer::new(&parameters, &Vehicle::new(p, model).unwrap());
            let (mut state, mut rate, mut work) = (AccelerometerState::default(), 0.0, 0.0);
            for n in 0..400u16 {
                let command = Command {
                    rates: BodyRates {
                        pitch: 0.5 * math::sin_cos(1.5 * 2.0 * math::PI * f32::from(n) * DT).0,
                        ..BodyRates::default()
                    },
                    ..Command::default()
                };
                // A rate loop of the believed lag, and surfaces 0.15 m of reaction.
                let change = (command.rates.pitch - rate) / (parameters.rate_lag + DT);
                rate += change * DT;
                let felt = Some(Body::new(0.0, 0.15 * change, 0.0));
                let up = Orientation::NOSE_UP;
                e.update(&mut state, felt, up, &command, 0.0, 1.0, DT);
                if n >= 200 {
                    work += up.to_axes(state.force.force).j * rate;
                }
            }
            work
        };
        let unknown = turning_on(0.0);
        assert!(unknown > 1.0);
        assert!(turning_on(0.1).abs() < 0.01 * unknown);
        assert!((turning_on(0.15) / unknown + 0.5).abs() < 0.01);
    }

    /// A rate loop without lag divides by nothing.
    #[test]
    fn without_a_lag_there_is_still_a_force() {
        let mut e = estimators(0.0);
        (e.rate_lag, e.surface_reaction) = (0.0, 0.15);
        let state = AccelerometerState::default();
        let felt = Body::new(-9.8, 0.3, 0.0);
        assert_eq!(e.without_surfaces(&state, felt, 0.0, DT), felt);
        // 0.02 rad/s in a step are 2 rad/s².
        let j = e.without_surfaces(&state, felt, 0.02, DT).j;
        assert!(j.abs() < 1e-6, "{j}");
    }

    /// A force across the believed one stays a force; so does one beyond the bounds of the scale.
    #[test]
    fn the_rest_stays_a_force() {
        let (e, mut state) = (estimators(0.0), AccelerometerState::default());
        let believed = Body::new(0.0, -98.1, 0.0);
        let felt = believed + Body::new(20.0, 0.0, 0.0);
        fly(&e, &mut state, believed, Some(felt), 10.0);
        assert!(state.excess.abs() < 1e-3);
        // Nose up, i is down.
        assert!((state.force.force - Ned::new(0.0, 0.0, 20.0)).norm_squared() < 0.01);
        fly(&e, &mut state, believed, Some(believed * 2.0), 10.0);
        assert_eq!(state.excess, MOST_EXCESS);
        let left = state.force.force.norm_squared();
        assert!((left - 39.2 * 39.2).abs() < 10.0, "{left}");
    }

    /// 1 − 1/e of a force error is known after 0.2 s, where the rate loop is slow after twice its lag.
    #[test]
    fn a_slow_vehicle_follows_the_force_error_slowly() {
        for (rate_lag, time) in [(0.05, 0.2), (0.1, 0.2), (0.25, 0.5)] {
            let p = GuidanceParameters {
                rate_lag,
                ..GuidanceParameters::default()
            };
            let e = Accelerometer::new(&p, &vehicle(0.0));
            let mut state = AccelerometerState::default();
            let believed = Body::new(0.0, -98.1, 0.0);
            let felt = believed + Body::new(20.0, 0.0, 0.0);
            fly(&e, &mut state, believed, Some(felt), time);
            let down = state.force.force.down;
            assert!((down / 20.0 - 0.632).abs() < 1e-3, "{rate_lag}: {down}");
        }
    }

    /// Only a force down takes of the thrust, and never so much that the vehicle does not hover.
    #[test]
    fn what_holds_a_missing_force_is_missing() {
        let (e, model) = (
            estimators(0.0),
            LargeAngle::new(LargeAngleParameters::NACA_0021_RE_160E3).unwrap(),
        );
        let missing = |thrust_max: f32, force: Ned| {
            let p = VehicleParameters {
                thrust_max,
                ..VehicleParameters::PAPER
            };
            let mut state = AccelerometerState::default();
            state.force.force = force;
            let down = Ned::new(0.0, 0.0, 1.0);
            e.missing(&state, down, &Vehicle::new(p, model).unwrap())
        };
        let down = |force| Ned::new(7.0, 3.0, force);
        assert_eq!(missing(196.2, down(9.81)), 9.81);
        assert_eq!(missing(196.2, down(-9.81)), 0.0);
        // 1e-4 N: roundings of the weight.
        assert!((missing(196.2, down(50.0)) - 0.2 * 98.1).abs() < 1e-4);
        assert!((missing(105.0, down(50.0)) - (105.0 - 1.02 * 98.1)).abs() < 1e-4);
    }

    /// The force of a gust of a tenth of the air's force, that lasts, becomes a tenth of its scale after 5 s and more: what is not known
    /// of the wing is no gust.
    #[test]
    fn a_gust_that_lasts_scales_the_air() {
        let (e, mut state) = (estimators(0.0), AccelerometerState::default());
        let believed = Body::new(0.0, -98.1, 0.0);
        let mut scaled = |seconds: f32| {
            for _ in 0..(seconds / DT) as usize {
                let command = Command {
                    diagnostics: Diagnostics {
                        aerodynamic: believed.into(),
                        ..Diagnostics::default()
                    },
                    ..Command::default()
                };
                let gust = believed.j * (0.1 - state.excess);
                let felt = Some(believed * 0.1);
                e.update(
                    &mut state,
                    felt,
                    Orientation::NOSE_UP,
                    &command,
                    gust,
                    1.0,
                    DT,
                );
            }
            state.excess
        };
        // Of the force below 0.3 of the weight an eleventh is left out.
        assert!((scaled(5.0) - 0.06).abs() < 5e-3);
        assert!((scaled(25.0) - 0.1).abs() < 2e-3);
    }

    /// In hover there is no force of the air to scale: thrust that is not what was asked for leaves the scale alone.
    #[test]
    fn without_air_nothing_is_scaled() {
        let (e, mut state) = (estimators(0.0), AccelerometerState::default());
        let felt = Body::new(-10.0, 0.0, 0.0);
        fly(&e, &mut state, Body::default(), Some(felt), 5.0);
        assert_eq!(state.excess, 0.0);
        assert!((state.force.force.down + 10.0).abs() < 0.01);
    }

    /// A hover at power-on is a hover from the first sample on: no force is missing that the thrust before could explain.
    #[test]
    fn the_first_sample_tells_the_thrust() {
        let (e, mut state) = (estimators(0.0), AccelerometerState::default());
        let felt = Body::new(-9.81, 0.0, 0.0);
        e.begin(&mut state, Some(felt), &vehicle(0.0));
        // 1e-4 N: an ulp of the weight.
        assert!((state.force.thrust - 98.1).abs() < 1e-4);
        let command = Command {
            thrust: 98.1,
            ..Command::default()
        };
        let up = Orientation::NOSE_UP;
        e.update(&mut state, Some(felt), up, &command, 0.0, 1.0, DT);
        assert!(state.force.force.norm_squared() < 1e-8);
        e.begin(&mut state, Some(felt * 9.0), &vehicle(0.0));
        assert_eq!(state.force.thrust, 196.2);
        e.begin(&mut state, None, &vehicle(0.0));
        assert_eq!(state.force.thrust, 196.2);
    }

    #[test]
    fn without_a_specific_force_nothing_is_added() {
        let (e, mut state) = (estimators(0.5), AccelerometerState::default());
        let believed = Body::new(0.0, -98.1, 0.0);
        fly(&e, &mut state, believed, Some(believed * 1.3), 1.0);
        assert_ne!(e.correction(&state, 1.0), Correction::default());
        fly(&e, &mut state, believed, None, DT);
        assert_eq!(e.correction(&state, 1.0), Correction::default());
    }

    #[test]
    fn what_no_step_leaves_is_not_sound() {
        let e = estimators(0.5);
        let good = AccelerometerState::default();
        assert!(e.is_sound(&good));
        for excess in [f32::NAN, 0.7, -0.5] {
            assert!(!e.is_sound(&AccelerometerState { excess, ..good }));
        }
        let force = ForceErrorState {
            force: Ned::new(0.0, 0.0, 60.0),
            thrust: 0.0,
        };
        assert!(!e.is_sound(&AccelerometerState { force, ..good }));
    }
}
