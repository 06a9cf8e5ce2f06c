//! The air velocity from what vehicles have: a wind that follows slowly or not at all, a pitot tube along the nose, the accelerometer.
//!
//! What the known wind leaves out is a gust. Each step moves it by a part of one damped Gauss–Newton step towards what is measured:
//! along the nose the airspeed, across the chord the normal force of the believed wing, along the wing its side force. At the top
//! of its curve the normal force does not tell the angle of attack, and the damping leaves nothing of the step. What is not told
//! fades, and the known wind is left. A gust that does not explain the force there is not believed: it goes back to the known wind at
//! once. Else an estimate that a slipstream or a jump has put behind the stall stays there, and a wing without lift is flown as a stalled one.
//! A gust that the force does not tell goes back too where the belief has explained the force without it for a while, or better than with it.
//! Else an estimate stays at the top of the curve, where some scale of the air's force fits any force. Behind the stall it goes back even
//! where the force tells it: there less force than believed is taken for an angle of attack that is larger still. A gust that is there is
//! explained away by chance, and never for long.
//!
//! Nor does the force tell anything of who is held at the stall with surfaces at their stop: what these take of the lift nobody believes in.
//!
//! A gust is fast, and an error of the belief lasts: the force of a gust that lasts is handed to the scale of the air's force, so that a
//! wing that is better than believed is not taken for one that is near its stall.

use super::memory::memory;
use crate::aero::{Aerodynamics, Coefficients};
use crate::air::AirData;
use crate::frame;
use crate::math;
use crate::ned::Ned;
use crate::spatial::{Body, Orientation};
use crate::vehicle::Vehicle;

/// Time constant of the gust, and that in which it fades \[s\].
const TIME: f32 = 0.07;
const FADING: f32 = 8.0;
/// Part of the step towards the airspeed: what blows along the nose stalls no wing, and a tube is noisy. With all of it an eighth of the
/// flights of `campaign cruise` crosses the stall in place of a twelfth.
const AIRSPEED_SHARE: f32 = 0.25;
/// Slope of the normal force coefficient below which it tells less of the angle of attack \[1/rad\].
const LEAST_SLOPE: f32 = 2.5;
/// Force k_a|v_a|² below which forces tell less, in multiples of the weight: that at which c_L = 0.7 carries it. Slower, the slipstream on a real wing
/// makes as much force as the air that is believed in.
const AIR_FORCE: f32 = 1.5;
/// The same of the side force, which is that of fins and fuselage.
const SIDE_FORCE: f32 = 0.3;
/// Normal force coefficient that may be left unexplained: from twice of it on a gust of which the force tells nothing goes back to the known wind
/// as fast as it is made. With 0.5, 8 of 100 random tail-sitters were lost; with less than 0.3 a gust of moderate turbulence is not believed either.
const UNEXPLAINED: f32 = 0.3;
/// Normal force coefficient up to which the belief explains a force without the gust. With 0.15, 8 % of the flights of `campaign cruise` cross the
/// stall in place of 5 %.
const EXPLAINED: f32 = 0.75 * UNEXPLAINED;
/// Time \[s\] over which that is averaged, and in which the gust goes back from [`LONG_EXPLAINED`] of it on. Without the return, wings of 25 kg
/// at 22 to 28 m/s were believed to be at the top of their curve, with 0.6 of their lift: they dived up to 260 m at an angle of attack of 4°.
/// Without the average, 15 % of the flights of `campaign cruise` cross the stall: near it a force is explained without its gust by chance.
const EXPLAINED_TIME: f32 = 0.3;
const LONG_EXPLAINED: f32 = 0.8;
/// Least scale of the air's force that the angle of attack is told by. Less fits a wing behind its stall as well, with twice the angle of attack: an estimate that
/// learns it from a gust that lasts believes the gust.
const LEAST_SCALE: f32 = 0.8;
/// Greatest gust \[m/s\]. An airspeed that is farther from that of the known wind is no airspeed: the tube is blocked.
const MOST: f32 = 10.0;
/// Greatest step towards what is measured \[m/s\].
const MOST_STEP: f32 = 5.0;

/// What is remembered.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct AirEstimateState {
    /// Wind less the known wind \[m/s\].
    pub gust: Ned,
    /// Part of the time of late in which the belief explained the force without the gust.
    pub explained: f32,
}

memory!(AirEstimateState {
    gust: Ned,
    explained: f32,
});

/// What is known in a step.
pub(super) struct AirSample {
    /// Velocity less the known wind \[m/s\].
    pub air: Ned,
    /// Attitude.
    pub orientation: Orientation,
    /// Airspeed along the nose \[m/s\]; NaN where it is not measured.
    pub airspeed: f32,
    /// Specific force \[m/s²\], if it is measured.
    pub specific_force: Option<Body>,
    /// Force of the air over what is believed of it.
    pub scale: f32,
    /// Whether the stall holds the vehicle. What its surfaces take of the lift at their stop nobody believes in, and a wing at 20° then makes the
    /// normal force of one at 6°.
    pub held: bool,
    /// Whether a wind is known. Of one that is not the normal force does not tell enough: it may be from anywhere.
    pub wind_known: bool,
}

/// Coefficient of the force along the belly.
#[inline(always)]
fn normal_force(c: &Coefficients, air: &AirData) -> f32 {
    -(c.c_l * air.cos + c.c_d * air.sin)
}

/// Normal force coefficient of this specific force \[m/s²\] that `vehicle`, as it is believed to be, leaves unexplained at this velocity through the
/// air \[m/s\].
fn unexplained<A: Aerodynamics>(vehicle: &Vehicle<A>, air: Body, felt: Body) -> f32 {
    let air = AirData::new(frame::Body::new(air.i, air.j), vehicle.thrust_line());
    let c = vehicle.model().coefficients(air.alpha);
    let pressure = vehicle.k_a() * air.speed * air.speed;
    let left = vehicle.mass() * felt.j - normal_force(&c, &air) * pressure;
    left.abs() / (pressure + f32::MIN_POSITIVE)
}

impl AirEstimateState {
    /// Whether these are numbers that a step can have left. NaN is not.
    #[inline(always)]
    pub fn is_sound(&self) -> bool {
        (self.gust.norm_squared() <= 1.000_01 * MOST * MOST) & (0.0..=1.0).contains(&self.explained)
    }

    /// One step of `dt` \[s\] of what is believed to be `vehicle`; gives the part of the force along the belly that is taken for the
    /// gust's \[N\].
    #[inline(never)]
    pub fn update<A: Aerodynamics>(
        &mut self,
        vehicle: &Vehicle<A>,
        sample: &AirSample,
        dt: f32,
    ) -> f32 {
        let known = sample.orientation.to_axes(sample.air);
        let gust = sample.orientation.to_axes(self.gust);
        let Body { i, j, w } = known - gust;
        let (mut step, mut force) = (Body::default(), 0.0);
        // A NaN is not within anything.
        if (sample.airspeed + known.i).abs() <= MOST {
            step.i -= AIRSPEED_SHARE * (sample.airspeed + i);
        }
        if let Some(felt) = sample.specific_force {
            let air = AirData::new(frame::Body::new(i, j), vehicle.thrust_line());
            let c = vehicle.model().coefficients(air.alpha);
            // k_a|v_a|², the normal force over it, and the slope of that over the angle of attack where the airspeed along the nose
            // stays as it is.
            let scale = math::max(sample.scale, LEAST_SCALE);
            let pressure = scale * vehicle.k_a() * air.speed * air.speed;
            let normal = normal_force(&c, &air);
            let turned = (c.c_l - c.dc_d) * air.sin - (c.dc_l + c.c_d) * air.cos;
            let slope = pressure * (turned * air.cos + 2.0 * air.sin * normal);
            let damping = LEAST_SLOPE * pressure;
            let floor = AIR_FORCE * vehicle.weight();
            let over = slope / (slope * slope + damping * damping + floor * floor);
            let told = slope * over;
            let left = vehicle.mass() * felt.j - normal * pressure;
            if sample.wind_known && sample.held {
                step.j += gust.j * ((TIME + dt) / EXPLAINED_TIME);
            } else if sample.wind_known {
                step.j += math::clamp(air.speed * left * over, -MOST_STEP, MOST_STEP);
                // Neither root nor slope: the gust is on the other side of the stall.
                let beyond = left.abs() / (UNEXPLAINED * pressure + f32::MIN_POSITIVE) - 1.0;
                let mut back = math::clamp(beyond, 0.0, 1.0);
                let without = unexplained(vehicle, known, felt);
                // The scale of the air's force is no part of the belief.
                let with = vehicle.mass() * felt.j * scale / (pressure + f32::MIN_POSITIVE);
                let is_explained = without < math::max(EXPLAINED, (with - normal).abs());
                let explained = f32::from(u8::from(is_explained));
                self.explained += (explained - self.explained) * (dt / (EXPLAINED_TIME + dt));
                let mut kept = told;
                if self.explained > LONG_EXPLAINED {
                    back = math::max(back, (TIME + dt) / EXPLAINED_TIME);
                    // Lift falls with the angle of attack.
                    if slope > 0.0 {
                        (step.j, kept) = (0.0, 0.0);
                    }
                }
                step.j += (1.0 - kept) * back * gust.j;
                // As far as the force tells it.
                force = -told * slope * gust.j / (air.speed + 1.0);
            }
            let side = sample.scale * vehicle.side() * air.speed;
            if side > 0.0 {
                let left = -vehicle.mass() * felt.w / side - w;
                let floor = SIDE_FORCE * vehicle.weight();
                let told = pressure * pressure / (pressure * pressure + floor * floor);
                step.w += told * math::clamp(left, -MOST_STEP, MOST_STEP);
            }
        }
        let gust =
            self.gust * (1.0 - dt / FADING) - sample.orientation.of_axes(step * (dt / (TIME + dt)));
        // The rest of it is not told, and would turn with the vehicle.
        let gust = if sample.wind_known {
            gust
        } else {
            let wing = sample.orientation.w();
            wing * wing.dot(gust)
        };
        let square = gust.norm_squared();
        self.gust = if square <= MOST * MOST {
            gust
        } else if square.is_finite() {
            gust * (MOST / math::sqrt(square.abs()))
        } else {
            Ned::ZERO
        };
        if force.is_finite() { force } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aero::{Combined, CombinedParameters};
    use crate::vehicle::VehicleParameters;

    const DT: f32 = 0.01;

    fn vehicle() -> Vehicle<Combined> {
        let p = VehicleParameters {
            c_y: 0.5,
            ..VehicleParameters::PAPER
        };
        Vehicle::new(
            p,
            Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap(),
        )
        .unwrap()
    }

    /// Specific force of the vehicle, without thrust, with the nose level and its air velocity `v_a` in body components.
    fn felt(v_a: Body) -> Body {
        let vehicle = vehicle();
        let air = AirData::new(frame::Body::new(v_a.i, v_a.j), vehicle.thrust_line());
        let force = vehicle.aerodynamic_force(&air);
        let side = -vehicle.side() * math::sqrt(v_a.norm_squared()) * v_a.w;
        Body::new(force.i(), force.j(), side) * (1.0 / vehicle.mass())
    }

    /// Level at 20 m/s to the north with the nose level, in no wind that is known, while the wind is `wind`.
    fn fly(state: &mut AirEstimateState, wind: Ned, pitot: bool, accelerometer: bool, time: f32) {
        let orientation = level();
        let ground = Ned::new(20.0, 0.0, 0.0);
        let v_a = orientation.to_axes(ground - wind);
        for _ in 0..(time / DT) as usize {
            let sample = AirSample {
                air: ground,
                orientation,
                airspeed: if pitot { -v_a.i } else { f32::NAN },
                specific_force: accelerometer.then(|| felt(v_a)),
                scale: 1.0,
                held: false,
                wind_known: true,
            };
            state.update(&vehicle(), &sample, DT);
            assert!(state.is_sound());
        }
    }

    /// Nose to the north, belly down.
    fn level() -> Orientation {
        Orientation::from_directions(Ned::new(1.0, 0.0, 0.0), Ned::new(0.0, 0.0, 1.0)).unwrap()
    }

    fn near(gust: Ned, wind: Ned, by: f32) -> bool {
        (gust - wind).norm_squared() <= by * by
    }

    /// An updraught of 2 m/s, 3 m/s of wind from ahead and 2 m/s from the side, within 0.9 s to a tenth, and then to what a
    /// fading of 8 s leaves.
    #[test]
    fn pitot_and_forces_tell_the_gust() {
        let wind = Ned::new(-3.0, 2.0, -1.0);
        let mut state = AirEstimateState::default();
        fly(&mut state, wind, true, true, 0.9);
        assert!(near(state.gust, wind, 0.3), "{:?}", state.gust);
        fly(&mut state, wind, true, true, 3.0);
        assert!(near(state.gust, wind, 0.15), "{:?}", state.gust);
    }

    /// Without the tube the part along the nose is not known; without the accelerometer it is all that is.
    #[test]
    fn each_tells_its_own_part() {
        let wind = Ned::new(-3.0, 2.0, -1.0);
        let mut state = AirEstimateState::default();
        fly(&mut state, wind, true, false, 2.0);
        assert!(
            near(state.gust, Ned::new(-3.0, 0.0, 0.0), 0.15),
            "{:?}",
            state.gust
        );
        let mut state = AirEstimateState::default();
        fly(&mut state, Ned::new(0.0, 2.0, -1.0), false, true, 2.0);
        assert!(
            near(state.gust, Ned::new(0.0, 2.0, -1.0), 0.1),
            "{:?}",
            state.gust
        );
    }

    /// A gust of which nothing is told any more is half gone after 8 s · ln 2.
    #[test]
    fn what_is_not_told_fades() {
        let mut state = AirEstimateState {
            explained: 0.0,
            gust: Ned::new(1.0, -2.0, 2.0),
        };
        fly(&mut state, Ned::ZERO, false, false, 5.5);
        assert!(
            near(state.gust, Ned::new(0.5, -1.0, 1.0), 0.03),
            "{:?}",
            state.gust
        );
    }

    /// An estimate behind the stall, of a wing that has no lift: at the top of its curve the force has no slope that would lead back. Without
    /// the return 5.9 of its 7.5 m/s were there after 0.5 s.
    #[test]
    fn a_gust_that_does_not_explain_the_force_goes_back() {
        let mut state = AirEstimateState {
            explained: 0.0,
            gust: Ned::new(0.0, 0.0, -7.5),
        };
        fly(&mut state, Ned::ZERO, true, true, 0.5);
        assert!(near(state.gust, Ned::ZERO, 0.5), "{:?}", state.gust);
    }

    /// At the top of the curve 0.6 of the believed force is the same as all of it at 5°. An estimate that begins there, with that scale, goes back:
    /// the belief explains the force without a gust.
    #[test]
    fn a_gust_that_nothing_asks_for_goes_back() {
        let (mut state, orientation) = (AirEstimateState::default(), level());
        let air = Ned::new(20.0, 0.0, 1.7);
        state.gust.down = -4.8;
        for _ in 0..200 {
            let sample = AirSample {
                air,
                orientation,
                airspeed: 20.0,
                specific_force: Some(felt(orientation.to_axes(air))),
                scale: 0.6,
                held: false,
                wind_known: true,
            };
            state.update(&vehicle(), &sample, DT);
        }
        // Attached, 0.4 m/s make up for the 0.8 that is left of that scale. Without the return 4.2 m/s stay.
        assert!(near(state.gust, Ned::ZERO, 2.0), "{:?}", state.gust);
    }

    /// A scale that a lasting gust has taught is not believed below 0.8: the estimate is that of 0.8, to the bit. One above is.
    #[test]
    fn no_angle_of_attack_is_told_by_less_than_the_least_scale() {
        let told_by = |scale: f32| {
            let (mut state, orientation) = (AirEstimateState::default(), level());
            for _ in 0..50 {
                let sample = AirSample {
                    air: Ned::new(20.0, 0.0, 1.0),
                    orientation,
                    airspeed: 20.0,
                    specific_force: Some(felt(orientation.to_axes(Ned::new(20.0, 0.0, 2.0)))),
                    scale,
                    held: false,
                    wind_known: true,
                };
                state.update(&vehicle(), &sample, DT);
            }
            state.gust
        };
        assert_eq!(told_by(0.6), told_by(LEAST_SCALE));
        assert_ne!(told_by(1.0), told_by(LEAST_SCALE));
    }

    /// Behind the stall, where lift falls with the angle of attack, less force than believed asks for a larger one. An attitude that is wrong by 2 or 3° does
    /// not keep an estimate there: with -2° all of these stay without the return whatever the slope, with 3° where the belief has to explain the force within
    /// a bound, in place of better than with the gust.
    #[test]
    fn an_estimate_behind_the_stall_comes_back() {
        let orientation = level();
        let felt = felt(orientation.to_axes(Ned::new(24.0, 0.0, 1.2)));
        for wrong in [-0.8, 1.2] {
            for scale in [0.6, 0.8] {
                for gust in [-5.0, -6.0, -7.0, -8.0, -9.5] {
                    let mut state = AirEstimateState::default();
                    state.gust.down = gust;
                    for _ in 0..200 {
                        let sample = AirSample {
                            air: Ned::new(24.0, 0.0, 1.2 + wrong),
                            orientation,
                            airspeed: 24.0,
                            specific_force: Some(felt),
                            scale,
                            held: false,
                            wind_known: true,
                        };
                        state.update(&vehicle(), &sample, DT);
                    }
                    // It is 3°, the stall is at 14°, and what stays does so at 14° or more.
                    let alpha = (1.2 + wrong - state.gust.down) / 24.0;
                    assert!(alpha < 0.2, "{wrong} {scale} {gust}: {alpha}");
                }
            }
        }
    }

    /// A blocked tube tells 0 m/s at 20, and is not believed.
    #[test]
    fn a_blocked_tube_is_not_believed() {
        let mut state = AirEstimateState::default();
        let sample = AirSample {
            air: Ned::new(20.0, 0.0, 0.0),
            orientation: level(),
            airspeed: 0.0,
            specific_force: None,
            scale: 1.0,
            held: false,
            wind_known: true,
        };
        for _ in 0..100 {
            state.update(&vehicle(), &sample, DT);
        }
        assert_eq!(state.gust, Ned::ZERO);
    }

    /// Behind the stall the normal force grows with the angle of attack again, and is told by the slope there.
    #[test]
    fn it_is_bounded_and_leaves_nonsense_out() {
        let mut state = AirEstimateState::default();
        for (n, force) in [1e3, -1e3, 3e38, f32::NAN, 0.0].into_iter().enumerate() {
            for airspeed in [f32::INFINITY, f32::NEG_INFINITY, 15.0, 25.0] {
                let sample = AirSample {
                    air: Ned::new(20.0, n as f32, -3.0),
                    orientation: level(),
                    airspeed,
                    specific_force: Some(Body::new(force, -force, force)),
                    scale: 1.6,
                    held: false,
                    wind_known: true,
                };
                for _ in 0..50 {
                    assert!(state.update(&vehicle(), &sample, DT).is_finite());
                    assert!(state.is_sound());
                }
            }
        }
        let gust = Ned::new(f32::NAN, 0.0, 0.0);
        assert!(
            !AirEstimateState {
                gust,
                explained: 0.0
            }
            .is_sound()
        );
        let gust = Ned::new(0.0, 0.0, 10.1);
        assert!(
            !AirEstimateState {
                gust,
                explained: 0.0
            }
            .is_sound()
        );
    }

    /// A wing at 20° whose surfaces take so much of its lift that it makes the normal force of one at 4°, as it seemed to be when it stalled: the force alone
    /// keeps the estimate within 2° of those 4°, and where it is known to be held it goes to within 1° of the 20° that the known wind tells.
    #[test]
    fn the_force_of_surfaces_at_their_stop_tells_no_angle() {
        let at = |alpha_deg: f32| {
            let (sin, cos) = math::sin_cos(alpha_deg.to_radians());
            Body::new(-17.0 * cos, -17.0 * sin, 0.0)
        };
        let orientation = level();
        let estimate = |held: bool| {
            let gust = orientation.of_axes(at(20.0) - at(4.0));
            let mut state = AirEstimateState {
                gust,
                explained: 0.0,
            };
            for _ in 0..500 {
                let sample = AirSample {
                    air: orientation.of_axes(at(20.0)),
                    orientation,
                    airspeed: -at(20.0).i,
                    specific_force: Some(felt(at(4.0))),
                    scale: 1.0,
                    held,
                    wind_known: true,
                };
                state.update(&vehicle(), &sample, DT);
            }
            let through = at(20.0) - orientation.to_axes(state.gust);
            math::atan2(-through.j, -through.i).to_degrees()
        };
        assert!((estimate(false) - 4.0).abs() < 2.0, "{}", estimate(false));
        assert!((estimate(true) - 20.0).abs() < 1.0, "{}", estimate(true));
    }
}
