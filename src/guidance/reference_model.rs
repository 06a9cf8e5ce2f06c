//! The reference model: the vehicle as it is believed to be, flown ahead of the real one.
//!
//! Its attitude follows a target within the limits of rate and slew, its thrust stays within its limits, and its velocity
//! follows from the believed forces. So whatever it does can be flown, as far as the belief is right.

use super::memory::memory;
use super::parameters::GuidanceParameters;
use super::tuning::Tuning;
use crate::aero::Aerodynamics;
use crate::air::AirData;
use crate::authority::Airflow;
use crate::equivalency::lambda;
use crate::frame::{Attitude, Body, Inertial};
use crate::math;
use crate::parameters::Parameters;
use crate::reference::Reference;
use crate::vehicle::Vehicle;

/// Part of the actuators' limits that the reference model uses. The rest is left for corrections.
const SHARE_OF_RATE: f32 = 0.99;
const SHARE_OF_SLEW: f32 = 0.5;
/// Distance from the target of a turn \[rad\] beyond which it is gone to no faster. With [`ATTITUDE_STEP`], less than π/4 a
/// step.
const MAX_ROTATION: f32 = 1.0;
/// Angular acceleration [rad/s²] that is left to a vehicle that turns by its thrust, where it accelerates down.
const TURNING: f32 = 15.0;
/// Acceleration down, in g, that such a vehicle has in any case. With 1.24 g a third of the level brakings of an elevon wing did not end in
/// hover: at the top of their climb they had no thrust, and so no elevons.
const LEAST_DOWN: f32 = 0.4;
/// Distance from the target \[rad\] at which a turn is over.
const ARRIVED: f32 = 0.07;
/// Gains are lowered in steps longer than these products of gain and step, which would overshoot.
const ATTITUDE_STEP: f32 = 0.8;
const VERTICAL_STEP: f32 = 0.6;
/// Greatest angle \[rad\] by which the attitude is turned ahead with the course: 0.59 rad/s where it goes to its target at 9 1/s.
/// Without a limit one of 60 missions in turbulence of which only the steady wind is known sinks 43 m, in place of 20.
const MAX_AHEAD: f32 = 0.065;
/// Greatest rate to which the air turns the reference model [rad/s].
const MOST_RATE: f32 = 6.0;
/// Angular acceleration [rad/s²] that thrust is raised for, besides what the wing takes.
const RAISED: f32 = 5.0;
/// Pressure from which on the greatest force of the air is looked at, over that force: one eighth, since a wing across the air has a coefficient
/// of 2, and a turn that is looked at from 0.7 of the force on is not stopped in time.
const LOADED: f32 = 0.125;
/// Least angular acceleration [rad/s²] that a turn is stopped with.
const STOPPING: f32 = 1.0;
/// Squared airspeed [m²/s²] from which on the air has a course.
const SLOWEST_SQUARED: f32 = 0.1;

/// Where the reference model is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PlanarModelState {
    /// Velocity [m/s].
    pub velocity: Inertial,
    /// Position less reference position \[m\].
    pub position: Inertial,
    /// Attitude θ \[rad\].
    pub theta: f32,
    /// Its rate ω [rad/s].
    pub rate: f32,
    /// Thrust \[N\].
    pub thrust: f32,
}

/// What is to be done with the attitude: perhaps a push-over, perhaps a turn, and from then on the servo.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Plan {
    /// Time of push-over left before the turn \[s\].
    pub push: f32,
    /// Attitude to turn to \[rad\].
    pub target: f32,
    /// 1 until the turn is over. A number: every bit pattern has a meaning.
    pub turn: u8,
}

memory!(Plan {
    push: f32,
    target: f32,
    turn: u8,
});

memory!(PlanarModelState {
    velocity: Inertial,
    position: Inertial,
    theta: f32,
    rate: f32,
    thrust: f32,
});

/// The reference model.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ReferenceModel {
    rate: f32,
    slew: f32,
    pub(super) position_gain: Inertial,
    pub(super) max_velocity: Inertial,
    max_sink: f32,
    /// Airspeeds [m/s] between which the vehicle has too little to hold its nose with the wing across the air, and too little lift to fly on the
    /// wing: with the first half of what turns it in hover is to spare, at the second the wing carries the weight.
    pub(super) held: f32,
    carried: f32,
    /// Greatest acceleration down that the servo asks for, in g.
    max_down: f32,
    /// Square of the greatest force of the air per mass [m²/s⁴], and the airspeed from which on it is looked at [m/s]: infinite without a bound.
    most_air_force: f32,
    loaded_speed: f32,
    pub(super) tuning: Tuning,
}

/// A step's length \[s\], and the gains at that length [1/s]: they do not overshoot in it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct StepGains {
    pub h: f32,
    vertical_gain: f32,
    attitude_gain: f32,
    /// Greatest rates of a turn and of a step of the servo [rad/s].
    max_rotation_rate: f32,
    max_correction_rate: f32,
}

/// Forces, per mass.
struct Forces {
    /// g i0 + F_a/m: the acceleration without thrust [m/s²].
    free: Inertial,
    /// λ k_a|v_a|²/m [m/s²].
    change: f32,
    /// Derivative of F_a/m along i, per radian [m/s²]; of (F_a − T i)/m along j it is −(T + λ k_a|v_a|²)/m.
    slope: f32,
    /// Drag per velocity and mass [1/s].
    drag_rate: f32,
    /// Airspeed [m/s].
    speed: f32,
}

impl ReferenceModel {
    /// The model of `vehicle` with these parameters, which have been checked.
    pub fn new<A: Aerodynamics>(
        p: &GuidanceParameters,
        vehicle: &Vehicle<A>,
        tuning: &Tuning,
    ) -> Self {
        let left = vehicle.authority().thrust_to_turn(TURNING) / vehicle.weight();
        let max_down = if left > 0.0 {
            math::max(1.0 - left, LEAST_DOWN)
        } else {
            tuning.max_vertical
        };
        let most = p.max_load_factor * vehicle.gravity();
        // The default is none.
        let loaded_speed = if p.max_load_factor < GuidanceParameters::DEFAULT.max_load_factor {
            math::sqrt((LOADED * most * vehicle.mass() / vehicle.k_a()).abs())
        } else {
            f32::INFINITY
        };
        Self {
            rate: SHARE_OF_RATE * p.max_rate,
            slew: SHARE_OF_SLEW * p.max_slew,
            position_gain: Inertial::new(
                p.position_gain_down,
                p.easing(tuning) * p.position_gain_forward,
            ),
            max_velocity: Inertial::new(p.max_velocity_down, p.max_velocity_forward),
            max_sink: p.max_sink,
            held: vehicle.airspeed_held_in_hover(),
            carried: vehicle.stall_speed(),
            max_down,
            most_air_force: most * most,
            loaded_speed,
            tuning: *tuning,
        }
    }

    /// Whether the load factor is bounded: a step may then take half as many instructions again.
    pub(super) fn bounds_load(&self) -> bool {
        self.loaded_speed < f32::INFINITY
    }

    /// The gains of steps of `h` \[s\].
    #[inline(always)]
    pub(super) fn gains(&self, h: f32) -> StepGains {
        let attitude_gain = math::min(self.tuning.attitude_gain, ATTITUDE_STEP / h);
        StepGains {
            h,
            vertical_gain: math::min(self.tuning.vertical_gain, VERTICAL_STEP / h),
            attitude_gain,
            max_rotation_rate: attitude_gain * MAX_ROTATION,
            max_correction_rate: attitude_gain * self.tuning.max_correction,
        }
    }

    /// The velocity down to be had at a `position` error: the `reference`'s, and towards the reference position.
    #[inline(always)]
    pub fn desired_down(&self, position: f32, reference: f32) -> f32 {
        let towards = limited(
            self.position_gain.down() * position,
            self.max_velocity.down(),
        );
        reference - math::max(towards, -self.max_sink)
    }

    /// Of a velocity `forward` with the airspeed `air` [m/s]: through the air no faster than is held across the wing and as the `reference` itself
    /// goes over ground, or all of it where the wing carries.
    #[cold]
    #[inline(never)]
    fn held_velocity(&self, forward: f32, air: f32, reference: f32) -> f32 {
        let over = air.abs() - self.held - reference.abs();
        if over > 0.0 && air.abs() < self.carried {
            forward - over.copysign(air)
        } else {
            forward
        }
    }

    /// The velocity to be had at a `position` error in a `wind`: the reference's, and towards the reference position, with an airspeed that
    /// can be held.
    #[inline(always)]
    pub fn desired_velocity(
        &self,
        position: Inertial,
        reference: Inertial,
        wind: Inertial,
    ) -> Inertial {
        let forward = reference.forward()
            - limited(
                self.position_gain.forward() * position.forward(),
                self.max_velocity.forward(),
            );
        let air = forward - wind.forward();
        let forward = if air.abs() > self.held {
            self.held_velocity(forward, air, reference.forward())
        } else {
            forward
        };
        Inertial::new(
            self.desired_down(position.down(), reference.down()),
            forward,
        )
    }

    /// Lets `flight` pass for `h` \[s\] by `plan`, with an attitude of at most `most_theta` \[rad\] while it goes forward, and
    /// gives its acceleration [m/s²], the attitude it comes to, and the error of velocity that it began with [m/s].
    #[inline(always)]
    #[expect(clippy::too_many_arguments)]
    pub fn advance<A: Aerodynamics>(
        &self,
        vehicle: &Vehicle<A>,
        flight: &mut PlanarModelState,
        plan: &mut Plan,
        reference: &Reference,
        wind: Inertial,
        most_theta: f32,
        h: f32,
    ) -> (Inertial, Attitude, Inertial) {
        let mut attitude = Attitude::from_angle(flight.theta);
        let gains = self.gains(h);
        let error =
            flight.velocity - self.desired_velocity(flight.position, reference.velocity, wind);
        let desired =
            self.desired_acceleration(error, reference.acceleration, vehicle.gravity(), &gains);
        let acceleration = self.step::<A, true>(
            vehicle,
            flight,
            &mut attitude,
            plan,
            reference.velocity,
            desired,
            wind,
            most_theta,
            &gains,
            true,
        );
        (acceleration, attitude, error)
    }

    /// The acceleration that the servo wants [m/s²] at an `error` of velocity, velocity less velocity wanted [m/s].
    #[inline(always)]
    pub(super) fn desired_acceleration(
        &self,
        error: Inertial,
        acceleration: Inertial,
        gravity: f32,
        gains: &StepGains,
    ) -> Inertial {
        let down = acceleration.down() - gains.vertical_gain * error.down();
        Inertial::new(
            if down.abs() > self.max_down * gravity {
                core::hint::cold_path();
                math::clamp(
                    down,
                    -self.tuning.max_vertical * gravity,
                    self.max_down * gravity,
                )
            } else {
                down
            },
            limited(
                acceleration.forward() - self.tuning.forward_gain * error.forward(),
                self.tuning.max_forward * gravity,
            ),
        )
    }

    /// The rate [rad/s] that closes an `error` of attitude \[rad\], up to `most`.
    #[inline(always)]
    fn desired_rate(&self, error: f32, most: f32, gains: &StepGains) -> f32 {
        limited(gains.attitude_gain * error, math::min(most, self.rate))
    }

    /// The rate [rad/s] that is had after `h` \[s\], from `rate` on.
    #[inline(always)]
    fn slewed(&self, wanted: f32, rate: f32, h: f32) -> f32 {
        let slew = self.slew * h;
        math::clamp(wanted, rate - slew, rate + slew)
    }

    /// The rate up to `wanted` [rad/s] with which the air's force, that of `air` at an `attitude`, stays below its greatest. What it is made of
    /// is found again: kept from the step, it would cost every other step more.
    #[cold]
    #[inline(never)]
    fn unloaded<A: Aerodynamics>(
        &self,
        vehicle: &Vehicle<A>,
        attitude: Attitude,
        air: Inertial,
        gain: f32,
        wanted: f32,
    ) -> f32 {
        let forces = Forces::new(vehicle, attitude, air);
        let force = forces.free - Inertial::new(vehicle.gravity(), 0.0);
        let slope = attitude.to_inertial(Body::new(forces.slope, -forces.change));
        // Of the square, per radian.
        let growth = 2.0 * (force.down() * slope.down() + force.forward() * slope.forward());
        let room = gain * (self.most_air_force - force.norm_squared());
        if wanted * growth > room {
            limited(room / growth, self.rate)
        } else {
            wanted
        }
    }

    /// One step: `flight` and its `attitude` go on by `plan`, and where that leaves it to the servo, towards the acceleration
    /// that it `desired`es for [m/s²]. Gives the acceleration had [m/s²].
    ///
    /// The servo's step is one Gauss–Newton step over (θ, T), damped, with T in its limits: where thrust is free it goes to
    /// F̄_2 = 0 and T = F̄_1; where thrust stands at a limit it goes to the attitude with the least weighted error. It looks
    /// at no sign of a slope, so it holds equilibria of either branch. In a prediction it is not `slewed`, limited in slew:
    /// it takes a part of a step only.
    ///
    /// Flying forward with the nose above the horizon, neither turn nor servo goes beyond `most_theta`: from there on thrust
    /// alone is the servo's. Backward the vehicle leans against the air, and with the nose below the horizon it falls: that it
    /// leaves by the shorter way. Predictions know nothing of it: stops are the same if they do, and there is no time for it.
    #[inline(always)]
    #[expect(clippy::too_many_arguments)]
    pub(super) fn step<A: Aerodynamics, const STIFF: bool>(
        &self,
        vehicle: &Vehicle<A>,
        flight: &mut PlanarModelState,
        attitude: &mut Attitude,
        plan: &mut Plan,
        reference: Inertial,
        desired: Inertial,
        wind: Inertial,
        most_theta: f32,
        gains: &StepGains,
        slewed: bool,
    ) -> Inertial {
        let (mass, gravity) = (vehicle.mass(), vehicle.gravity());
        let pushing = plan.push > 0.0;
        let (desired, weight) = if pushing {
            // Rare: a few steps of some plans.
            core::hint::cold_path();
            (
                Inertial::new(self.tuning.push_over * gravity, desired.forward()),
                0.02 * self.tuning.forward_weight,
            )
        } else {
            (desired, self.tuning.forward_weight)
        };
        let air = flight.velocity - wind;
        let forces = Forces::new(vehicle, *attitude, air);
        let f = forces.free - desired;
        let flow = Airflow {
            along: -(air.down() * attitude.cos + air.forward() * attitude.sin),
            across: air.forward() * attitude.cos - air.down() * attitude.sin,
            speed: forces.speed,
        };
        let most = vehicle.thrust_max() / mass * vehicle.propeller().available(flow.along);
        let least = math::min(vehicle.thrust_min() / mass, most);

        // Least squares of F − T i, per mass, down and forward weighted: first over T alone,
        let ii = attitude.cos * attitude.cos + weight * attitude.sin * attitude.sin;
        let fi = f.down() * attitude.cos + weight * f.forward() * attitude.sin;
        let alone = math::clamp(fi / ii, least, most);
        // then over T and θ, where F − T i changes by d per radian.
        let d = attitude.to_inertial(Body::new(forces.slope, -(alone + forces.change)));
        let damping = self.tuning.damping * gravity;
        let steep = d.down() * d.down() + weight * (d.forward() * d.forward());
        let dd = steep + weight * (damping * damping);
        let di = d.down() * attitude.cos + weight * d.forward() * attitude.sin;
        let fd = f.down() * d.down() + weight * f.forward() * d.forward();
        let both = math::clamp((fi * dd - di * fd) / (dd * ii - di * di), least, most);
        let h = gains.h;
        // Without a branch: with one the whole step is compiled twice.
        let forward = slewed & (air.forward() > 0.0) & (flight.theta < 0.5 * math::PI);
        let room = if forward {
            most_theta - flight.theta
        } else {
            f32::INFINITY
        };
        // The rate belongs to this choice: one branch, where a flag kept for a second one costs registers.
        let (thrust, error, wanted, turning) = if plan.turn == 1 && !pushing {
            let error = plan.target - flight.theta;
            let error = math::min(room, error);
            let wanted = self.desired_rate(error, gains.max_rotation_rate, gains);
            (alone, error, wanted, true)
        } else {
            // The desired acceleration turns the course. The attitude has to turn with it by F_a's part of the forces that
            // the servo balances, d·(d + alone j)/d·d: without this it stays behind by that rate over its gain.
            let course = (desired.forward() * air.down() - desired.down() * air.forward())
                / (air.norm_squared() + SLOWEST_SQUARED);
            let dj = weight * d.forward() * attitude.cos - d.down() * attitude.sin;
            let ahead = limited(course / gains.attitude_gain, MAX_AHEAD) * (steep + alone * dj);
            let error = (di * both - fd + ahead) / dd;
            let (thrust, error) = if error > room {
                (alone, room)
            } else {
                (both, error)
            };
            let wanted = self.desired_rate(error, gains.max_correction_rate, gains);
            (thrust, error, wanted, false)
        };
        // What the surfaces cannot turn stays where the air holds it, and what they cannot stop does not begin to turn.
        let (asked, available) = (mass * thrust, mass * most);
        let authority = vehicle.authority();
        let mut allowed = authority.at(flow, asked, available);
        let stopping = if wanted > 0.0 {
            allowed.given - allowed.wing
        } else {
            allowed.given + allowed.wing
        };
        let reach = math::max(stopping, STOPPING) * error.abs();
        let wanted = if wanted * wanted > reach {
            core::hint::cold_path();
            let fastest = math::sqrt(reach.abs());
            if wanted < 0.0 { -fastest } else { fastest }
        } else {
            wanted
        };
        let wanted = if forces.speed > self.loaded_speed {
            // A copy, made here: by reference the vehicle itself would have to be in memory, every step.
            let vehicle = vehicle.as_flown(gravity, 1.0, 0.0);
            self.unloaded(&vehicle, *attitude, air, gains.attitude_gain, wanted)
        } else {
            wanted
        };
        let wanted = if turning | slewed {
            self.slewed(wanted, flight.rate, h)
        } else {
            wanted
        };
        let change = math::clamp(wanted - flight.rate, -RAISED * h, RAISED * h);
        let lacking = (change - h * allowed.wing).abs() - h * allowed.given;
        let mut thrust = thrust;
        if lacking > 0.0 {
            core::hint::cold_path();
            // Plans do not count on motors that brake.
            let raised = authority.thrust_giving(&allowed, lacking / h, asked, 0.0, available);
            allowed = authority.at(flow, raised, available);
            thrust = raised / mass;
        }
        let middle = flight.rate + h * allowed.wing;
        let span = h * allowed.given;
        let rate = math::clamp(wanted, middle - span, middle + span);
        let most_rate = math::max(MOST_RATE, self.rate);
        let rate = limited(rate, most_rate);

        let acceleration = forces.free - Inertial::new(attitude.cos, attitude.sin) * thrust;
        // Drag is stiff where the speed is high: implicit in it.
        let gained = acceleration * (h / (1.0 + h * forces.drag_rate));
        flight.velocity += gained;
        // So is lift where the wing is large for its weight (`STIFF`): no step across the air velocity goes farther than to
        // where the change of lift has stopped it.
        let turned = h * forces.change;
        if STIFF && turned > forces.speed {
            let square = forces.speed * forces.speed;
            let across = Inertial::new(-air.forward(), air.down());
            let part = across.down() * gained.down() + across.forward() * gained.forward();
            flight.velocity -= across * (part / square * (1.0 - forces.speed / turned));
        }
        flight.position += (flight.velocity - reference) * h;
        flight.rate = rate;
        let turned = flight.rate * h;
        flight.theta += turned;
        // By at most π/4: `MAX_ROTATION`.
        let (sin, cos) = math::sin_cos_near_zero(turned);
        *attitude = attitude.turned(sin, cos);
        flight.thrust = mass * thrust;

        if pushing {
            plan.push -= h;
        } else if error.abs() < ARRIVED {
            plan.turn = 0;
        }
        acceleration
    }
}

impl Forces {
    #[inline(always)]
    fn new<A: Aerodynamics>(
        vehicle: &Vehicle<A>,
        attitude: Attitude,
        air_velocity: Inertial,
    ) -> Self {
        let air = AirData::new(attitude.to_body(air_velocity), vehicle.thrust_line());
        let c = vehicle.model().coefficients(air.alpha);
        let drag_rate = vehicle.k_a() / vehicle.mass() * air.speed;
        let pressure = drag_rate * air.speed;
        let aerodynamic = attitude.to_inertial(Body::new(
            pressure * (c.c_d * air.cos - c.c_l * air.sin),
            -pressure * (c.c_l * air.cos + c.c_d * air.sin),
        ));
        Self {
            free: Inertial::new(
                vehicle.gravity() + aerodynamic.down(),
                aerodynamic.forward(),
            ),
            change: lambda(&c, &air) * pressure,
            slope: pressure * (c.dc_d * air.cos - c.dc_l * air.sin),
            drag_rate: drag_rate * c.c_d,
            speed: air.speed,
        }
    }
}

/// `x` within ±`bound`, which is not negative: by one comparison where nothing is limited, as most often.
#[inline(always)]
pub(super) fn limited(x: f32, bound: f32) -> f32 {
    if x.abs() > bound {
        core::hint::cold_path();
        if x < 0.0 { -bound } else { bound }
    } else {
        x
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{Combined, CombinedParameters};
    use crate::equivalency::ApparentForces;
    use crate::vehicle::VehicleParameters;
    use rand::{RngExt, SeedableRng};

    /// No limit of the attitude.
    const FREE: f32 = f32::INFINITY;
    const DT: f32 = 0.01;

    fn vehicle() -> Vehicle<Combined> {
        let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        Vehicle::new(VehicleParameters::PAPER, model).unwrap()
    }

    /// A step of the reference model of `vehicle` with the default parameters: its acceleration.
    fn advance(
        vehicle: &Vehicle<Combined>,
        flight: &mut PlanarModelState,
        plan: &mut Plan,
        reference: &Reference,
        wind: Inertial,
    ) -> Inertial {
        let model =
            ReferenceModel::new(&GuidanceParameters::default(), vehicle, &Tuning::default());
        model
            .advance(vehicle, flight, plan, reference, wind, FREE, DT)
            .0
    }

    fn still(down: f32, forward: f32) -> Reference {
        Reference {
            velocity: Inertial::new(down, forward),
            acceleration: Inertial::ZERO,
        }
    }

    /// The acceleration is that of the believed forces, thrust, rate and slew are inside their limits, whatever is asked.
    #[test]
    fn the_reference_model_can_be_flown() {
        let p = GuidanceParameters::default();
        let vehicle = vehicle();
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(3);
        for _ in 0..200 {
            let mut draw = |x: f32| random.random_range(-x..x);
            let mut flight = PlanarModelState {
                velocity: Inertial::new(draw(25.0), draw(25.0)),
                position: Inertial::new(draw(20.0), draw(50.0)),
                theta: draw(3.1),
                rate: draw(2.0),
                thrust: 0.0,
            };
            let mut plan = Plan {
                push: draw(0.3),
                target: flight.theta + draw(3.1),
                turn: 1,
            };
            let (reference, wind) = (still(draw(10.0), draw(20.0)), Inertial::new(0.0, draw(5.0)));
            for _ in 0..200 {
                let before = flight;
                let a = advance(&vehicle, &mut flight, &mut plan, &reference, wind);
                let attitude = Attitude::from_angle(before.theta);
                let body = attitude.to_body(before.velocity - wind);
                let air = AirData::new(body, vehicle.thrust_line());
                let force = attitude.to_inertial(vehicle.aerodynamic_force(&air))
                    - attitude.to_inertial(Body::new(flight.thrust, 0.0));
                let expected = force / vehicle.mass() + Inertial::new(vehicle.gravity(), 0.0);
                // 1e-2: roundings of forces of up to 5 kN, over 10 kg.
                assert!((a - expected).norm() < 1e-2);
                assert!((0.0..=196.2).contains(&flight.thrust));
                assert!((flight.rate - before.rate).abs() <= p.max_slew * DT);
                assert!(flight.rate.abs() <= p.max_rate);
                assert!(flight.velocity.norm() + flight.position.norm() < 1e5);
            }
        }
    }

    /// 10 kg with elevons in the slipstream, which turn the vehicle at up to 20 rad/s² in hover, and a wing whose centre of pressure moves aft.
    fn elevons(wing_moment: f32) -> Vehicle<Combined> {
        let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        let p = VehicleParameters {
            authority: 0.0,
            authority_slipstream: 20.0 / 0.7,
            wing_moment,
            hover_downwash: 8.0,
            ..VehicleParameters::PAPER
        };
        Vehicle::new(p, model).unwrap()
    }

    /// 20 rad/s² in hover, of which a wing across the air takes 0.5 w²: half is left at 4.47 m/s. Faster it is not held against a wind, and not
    /// brought back to its place, but driven off; with a reference that moves it is faster by as much, and on the wing any airspeed is flown. A vehicle whose wing does not turn it holds its place.
    #[test]
    fn what_the_wing_takes_is_not_asked_for() {
        let wanted = |wing: f32, wind: f32, reference: f32| {
            let model = ReferenceModel::new(
                &GuidanceParameters::default(),
                &elevons(wing),
                &Tuning::default(),
            );
            let far_behind = Inertial::new(0.0, -50.0);
            model
                .desired_velocity(
                    far_behind,
                    Inertial::new(0.0, reference),
                    Inertial::new(0.0, wind),
                )
                .forward()
        };
        let pull = GuidanceParameters::default().max_velocity_forward;
        assert!((wanted(0.5, -7.0, 0.0) - (4.47 - 7.0)).abs() < 0.01);
        assert!((wanted(0.5, 11.0, 0.0) - (11.0 - 4.47)).abs() < 0.01);
        assert!((wanted(0.5, -3.0, 0.5) - (4.47 + 0.5 - 3.0)).abs() < 0.01);
        assert_eq!(wanted(0.5, 0.0, 0.0), pull);
        assert_eq!(wanted(0.5, -7.0, 20.0), 20.0 + pull);
        assert_eq!(wanted(0.0, -7.0, 0.0), pull);
    }

    /// A turn to an attitude far away begins and ends within what the surfaces give, and does not go beyond it.
    #[test]
    fn a_turn_is_stopped_within_authority() {
        let vehicle = elevons(0.0);
        let mut flight = PlanarModelState {
            thrust: vehicle.weight(),
            ..PlanarModelState::default()
        };
        let mut plan = Plan {
            push: 0.0,
            target: -1.2,
            turn: 1,
        };
        let (mut last, mut farthest) = (0.0_f32, 0.0_f32);
        for _ in 0..200 {
            advance(
                &vehicle,
                &mut flight,
                &mut plan,
                &still(0.0, 0.0),
                Inertial::ZERO,
            );
            let change = (flight.rate - last).abs() / DT;
            // 20 rad/s² at the thrust of the weight, and 1 % for the rounding of a rate over a step.
            let most = 20.2 * flight.thrust / vehicle.weight();
            assert!(change <= most, "{change} {most}");
            last = flight.rate;
            farthest = math::min(farthest, flight.theta);
        }
        // 0.07 rad: where a turn is over, and the servo goes on.
        assert!(farthest > -1.27 && farthest < -1.13, "{farthest}");
    }

    /// At speed the wing holds the nose near the air velocity: a turn past stall does not get there, and asks for thrust.
    #[test]
    fn the_air_holds_the_attitude() {
        let turned = |vehicle: Vehicle<Combined>| {
            let level = -core::f32::consts::FRAC_PI_2;
            let mut flight = PlanarModelState {
                velocity: Inertial::new(0.0, 18.0),
                theta: level + 0.1,
                ..PlanarModelState::default()
            };
            let mut plan = Plan {
                push: 0.0,
                target: level + 1.4,
                turn: 1,
            };
            let mut farthest = level;
            let mut thrust = 0.0;
            for _ in 0..80 {
                advance(
                    &vehicle,
                    &mut flight,
                    &mut plan,
                    &still(0.0, 18.0),
                    Inertial::ZERO,
                );
                farthest = if flight.theta > farthest {
                    flight.theta
                } else {
                    farthest
                };
                thrust = if flight.thrust > thrust {
                    flight.thrust
                } else {
                    thrust
                };
            }
            (farthest - level, thrust / vehicle.weight())
        };
        let (free, _) = turned(vehicle());
        let (held, thrust) = turned(elevons(1.0));
        assert!(
            free > 1.2 && held < 0.8 && thrust > 1.9,
            "{free} {held} {thrust}"
        );
    }

    /// A turn far past stall at 45 m/s, in steps of flights and of predictions: the air's force grows to the greatest and is held
    /// there, where it would be more than 9 g, and the vehicle gets to the attitude once it is slow enough.
    #[test]
    fn the_air_gives_no_more_than_the_load_factor() {
        let vehicle = vehicle();
        let level = -core::f32::consts::FRAC_PI_2;
        let heaviest = |max_load_factor: f32, h: f32| {
            let p = GuidanceParameters {
                max_load_factor,
                ..GuidanceParameters::default()
            };
            let model = ReferenceModel::new(&p, &vehicle, &Tuning::default());
            let mut flight = PlanarModelState {
                velocity: Inertial::new(0.0, 45.0),
                theta: level + 0.05,
                ..PlanarModelState::default()
            };
            let mut plan = Plan {
                push: 0.0,
                target: level + 1.2,
                turn: 1,
            };
            let mut most = 0.0_f32;
            for _ in 0..(4.0 / h) as u32 {
                let wind = Inertial::ZERO;
                model.advance(
                    &vehicle,
                    &mut flight,
                    &mut plan,
                    &still(0.0, 0.0),
                    wind,
                    FREE,
                    h,
                );
                let attitude = Attitude::from_angle(flight.theta);
                let air = AirData::new(attitude.to_body(flight.velocity), vehicle.thrust_line());
                most = most.max(vehicle.aerodynamic_force(&air).norm() / vehicle.weight());
            }
            assert_eq!(plan.turn, 0, "it did not get there");
            most
        };
        // Beyond it by what it turns until the slew has stopped it, and by a step.
        for (h, most) in [(DT, 3.3), (0.05, 3.6)] {
            let (free, held) = (heaviest(1e3, h), heaviest(3.0, h));
            assert!(free > 9.0 && held > 2.0 && held < most, "{free} {held}");
        }
    }

    /// Too high by 50 m the vehicle sinks no faster than it may, and climbs as fast as before.
    #[test]
    fn it_sinks_no_faster_than_it_may() {
        let p = GuidanceParameters {
            max_sink: 1.5,
            ..GuidanceParameters::default()
        };
        let model = ReferenceModel::new(&p, &vehicle(), &Tuning::default());
        let wanted = |down| {
            model
                .desired_velocity(Inertial::new(down, 0.0), Inertial::ZERO, Inertial::ZERO)
                .down()
        };
        assert_eq!((wanted(-50.0), wanted(50.0)), (1.5, -p.max_velocity_down));
    }

    /// Too high and climbing at 20 m/s, a vehicle whose surfaces need the slipstream keeps the thrust that turns it by 15 rad/s², of 40 rad/s²
    /// in hover; one that turns without thrust is pushed down.
    #[test]
    fn an_acceleration_down_leaves_the_thrust_to_turn() {
        let down = |authority: f32, slipstream: f32| {
            let p = VehicleParameters {
                authority,
                authority_slipstream: slipstream / crate::authority::IN_SLIPSTREAM,
                ..VehicleParameters::PAPER
            };
            let airfoil = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
            let vehicle = Vehicle::new(p, airfoil).unwrap();
            let model =
                ReferenceModel::new(&GuidanceParameters::default(), &vehicle, &Tuning::default());
            let rising = Inertial::new(-20.0, 0.0);
            let gains = model.gains(DT);
            model
                .desired_acceleration(rising, Inertial::ZERO, 9.81, &gains)
                .down()
                / 9.81
        };
        let constant = VehicleParameters::PAPER.authority;
        assert_eq!(down(constant, 0.0), Tuning::default().max_vertical);
        assert!((down(0.0, 40.0) - (1.0 - 15.0 / 40.0)).abs() < 1e-5);
        assert!((down(5.0, 40.0) - (1.0 - 10.0 / 40.0)).abs() < 1e-5);
        // What never turns as fast keeps 0.6 of the weight.
        assert!((down(0.0, 10.0) - LEAST_DOWN).abs() < 1e-5);
    }

    /// The attitude of a prediction is turned step by step, also by an agile vehicle, whose rate would take it further than π/4 in a step.
    #[test]
    fn the_attitude_keeps_to_its_angle() {
        let p = GuidanceParameters {
            max_rate: 100.0,
            max_slew: 1e4,
            ..GuidanceParameters::default()
        };
        let vehicle = vehicle();
        let model = ReferenceModel::new(&p, &vehicle, &Tuning::default());
        for (target, h) in [(3.0, 0.045), (-3.0, 0.2), (0.5, 0.115)] {
            let mut flight = PlanarModelState {
                velocity: Inertial::new(0.0, 15.0),
                theta: -1.5,
                ..PlanarModelState::default()
            };
            let mut attitude = Attitude::from_angle(flight.theta);
            let mut plan = Plan {
                target,
                turn: 1,
                push: 0.0,
            };
            for _ in 0..27 {
                model.step::<_, true>(
                    &vehicle,
                    &mut flight,
                    &mut attitude,
                    &mut plan,
                    Inertial::ZERO,
                    Inertial::ZERO,
                    Inertial::ZERO,
                    FREE,
                    &model.gains(h),
                    false,
                );
                let exact = Attitude::from_angle(flight.theta);
                // 1e-5: 27 turns by up to π/4, each wrong by 2e-7.
                let off = (attitude.cos - exact.cos).abs() + (attitude.sin - exact.sin).abs();
                assert!(off < 1e-5, "{off}");
            }
            assert_eq!(plan.turn, 0);
        }
    }

    /// The attitude turns with the course: a pull-up at 20 m/s of 4 m/s² is followed closely.
    #[test]
    fn the_attitude_turns_with_the_course() {
        let vehicle = vehicle();
        let mut flight = PlanarModelState {
            velocity: Inertial::new(0.0, 20.0),
            theta: -1.5,
            ..PlanarModelState::default()
        };
        let (mut plan, mut worst) = (Plan::default(), 0f32);
        for n in 0..600 {
            let t = n as f32 * DT - 3.0;
            let pulling = (0.0..1.5).contains(&t);
            let reference = Reference {
                velocity: Inertial::new(-4.0 * math::clamp(t, 0.0, 1.5), 20.0),
                acceleration: Inertial::new(if pulling { -4.0 } else { 0.0 }, 0.0),
            };
            advance(&vehicle, &mut flight, &mut plan, &reference, Inertial::ZERO);
            if t > 0.5 && pulling {
                worst = f32::max(worst, (flight.velocity - reference.velocity).down().abs());
            }
        }
        // 0.09 m/s; 0.45 m/s where only the error turns the attitude.
        assert!(worst < 0.2, "{worst}");
    }

    /// A wing that is large for its weight stops a velocity across the air's in less than a step of a prediction: only with
    /// `STIFF` does that stay a stop. Where nothing is stiff it changes nothing.
    #[test]
    fn predictions_of_a_light_wing_stay_bounded() {
        let end_of = |vehicle: &Vehicle<Combined>, stiff: bool| {
            let model =
                ReferenceModel::new(&GuidanceParameters::default(), vehicle, &Tuning::default());
            let mut flight = PlanarModelState {
                velocity: Inertial::new(1.0, 20.0),
                theta: -1.57,
                ..PlanarModelState::default()
            };
            let mut attitude = Attitude::from_angle(flight.theta);
            let (mut plan, gains) = (Plan::default(), model.gains(0.1));
            let mut steepest = 0f32;
            for _ in 0..25 {
                let reference = Inertial::new(0.0, 20.0);
                let step = if stiff {
                    ReferenceModel::step::<Combined, true>
                } else {
                    ReferenceModel::step::<Combined, false>
                };
                let error = flight.velocity - reference;
                let desired = model.desired_acceleration(error, Inertial::ZERO, 9.81, &gains);
                step(
                    &model,
                    vehicle,
                    &mut flight,
                    &mut attitude,
                    &mut plan,
                    reference,
                    desired,
                    Inertial::ZERO,
                    FREE,
                    &gains,
                    false,
                );
                steepest = f32::max(steepest, flight.velocity.down().abs());
            }
            (flight, steepest)
        };
        // 0.5 kg with 0.3 m²: a change of lift stops a velocity in 1/40 s.
        let light = VehicleParameters {
            mass: 0.5,
            k_a: 0.5 * 1.225 * 0.3,
            thrust_max: 9.81,
            ..VehicleParameters::PAPER
        };
        let light = Vehicle::new(light, *vehicle().model()).unwrap();
        let (explicit, implicit) = (end_of(&light, false).1, end_of(&light, true).1);
        assert!(implicit < 1.5 && explicit > 4.0, "{implicit} {explicit}");
        assert_eq!(end_of(&vehicle(), true), end_of(&vehicle(), false));
    }

    /// From hover the servo finds the equilibria of slow forward flight, of flight sideways to the wind, and of a
    /// descent tail first, which is on the other branch.
    #[test]
    fn the_servo_settles_in_equilibria_of_both_branches() {
        let vehicle = vehicle();
        for (down, forward, wind) in [(0.0, 10.0, 0.0), (0.0, 0.0, -6.0), (12.0, 0.0, 0.0)] {
            let (mut flight, mut plan) = (PlanarModelState::default(), Plan::default());
            let wind = Inertial::new(0.0, wind);
            let mut acceleration = Inertial::ZERO;
            for n in 0..3000 {
                let part = math::min(n as f32 / 1000.0, 1.0);
                let reference = still(down * part, forward * part);
                acceleration = advance(&vehicle, &mut flight, &mut plan, &reference, wind);
            }
            let error = flight.velocity - Inertial::new(down, forward);
            // 1 cm/s, 1 cm/s², 0.1 N: what is left of slow decays.
            assert!(error.norm() < 0.01 && acceleration.norm() < 0.01);
            let v_a = flight.velocity - wind;
            let transverse_force = |theta| {
                let attitude = Attitude::from_angle(theta);
                ApparentForces::new(&vehicle, attitude, v_a, Inertial::ZERO)
                    .f
                    .j()
            };
            let left = transverse_force(flight.theta);
            assert!(left.abs() < 0.1, "{left}");
            let slope = transverse_force(flight.theta + 0.01);
            // ∂_θ F̄_2 = −F̄_p1: negative on θ̃ = 0.
            assert_eq!(slope > 0.0, down > 9.0);
        }
    }
}
