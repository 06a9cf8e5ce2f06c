//! The reference model in space: the planner's flight in its plane, and the turning of that plane.
//!
//! Starting, braking and descending happen in the plane of flight, turning around it. The plane contains the course and
//! apparent gravity, that is gravity less the acceleration to the side: in a turn of load factor n the planner flies the
//! vehicle at n times the gravity. A velocity is turned at flying speed, and slowed down or moved sideways below it.

use super::course::{Axes, Course};
use super::memory::memory;
use super::parameters::GuidanceParameters;
use super::planner::{Planner, PlannerState};
use super::planner_options::{PlannerOptions, most_theta};
use super::progress::Progress;
use super::reference_model::{PlanarModelState, limited};
use super::rollout::{MAX_LATERAL_JERK, PlanRequest};
use crate::aero::{Aerodynamics, Stall};
use crate::control::Guard;
use crate::frame::{Attitude, Inertial};
use crate::math;
use crate::ned::Ned;
use crate::reference;
use crate::spatial::Reference;
use crate::vehicle::Vehicle;

/// Part of the greatest load factor that a level turn takes: the rest pulls the vehicle out of a dive. Turns that took all of 3 g ended in
/// spiral dives, 5 of 1,000 of `campaign steep-turns`.
const LOAD_OF_TURN: f32 = 2.0 / 3.0;

/// Lateral acceleration per lateral velocity error [1/s].
const LATERAL_GAIN: f32 = 1.5;
/// Part of the lateral acceleration that is left while an attitude far away is turned to: the wing is nearly level then.
const CROSSING: f32 = 0.25;
/// Part of thrust and lift that a turn may take. The rest holds the altitude.
const SHARE: f32 = 0.9;
/// Speeds in multiples of that at which the wing carries the weight with a lift coefficient of 1: below the first, a velocity
/// is moved sideways, from twice that on it is turned.
const TURNING: f32 = 0.5;
/// Speed, in the same measure, from which on the air alone has a say in the course, and the heading none.
const TAKEOVER: f32 = 0.8;
/// Weight of the present course where no heading is asked for.
const STAY: f32 = 0.3;
/// Rate at which the course approaches its aim [1/s].
const COURSE_GAIN: f32 = 2.0;
/// Cosine of the angle between the vehicle's wing and the model's below which the course turns more slowly: it waits for the
/// vehicle.
const WAIT: f32 = 0.5;
/// Airspeed [m/s] below which a lateral acceleration turns the course less.
const SLOW: f32 = 3.0;
/// Part of the greatest angular rate that the course may turn with.
const SHARE_OF_RATE: f32 = 0.5;

/// Where the reference model is, in world axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct ReferenceModelState {
    /// Velocity [m/s].
    pub velocity: Ned,
    /// Position less reference position \[m\].
    pub position: Ned,
    /// Course of the plane of flight.
    pub course: Course,
    /// Acceleration to the right of that plane [m/s²].
    pub lateral_acceleration: f32,
    /// Attitude θ in the plane \[rad\].
    pub theta: f32,
    /// Its rate ω [rad/s].
    pub rate: f32,
    /// Thrust \[N\].
    pub thrust: f32,
}

memory!(ReferenceModelState {
    velocity: Ned,
    position: Ned,
    course: Course,
    lateral_acceleration: f32,
    theta: f32,
    rate: f32,
    thrust: f32,
});

/// Farther \[m\] than this a vehicle is not behind its reference model, and not by more speed [m/s]. In 2,500 flights of campaigns it was 26 m,
/// after a jump of the measured position, and 8 m/s.
const APART: f32 = 50.0;
const SLIPPING: f32 = 25.0;

impl ReferenceModelState {
    /// Whether it may be the reference model of a vehicle with this velocity [m/s] and position \[m\].
    #[inline(always)]
    pub fn is_near(&self, velocity: Ned, position: Ned) -> bool {
        (self.position - position).norm_squared() <= APART * APART
            && (self.velocity - velocity).norm_squared() <= SLIPPING * SLIPPING
    }

    /// Whether what grows in an absurd flight is inside its bounds. NaN is not.
    #[inline(always)]
    pub fn is_bounded(&self) -> bool {
        100.0 * self.velocity.norm_squared() + self.position.norm_squared() <= 1e10
    }

    /// Whether every number is one that a reference model can have left. NaN is not.
    pub fn is_sound(&self) -> bool {
        self.is_bounded()
            && self.course.is_sound()
            && self.lateral_acceleration.abs() + self.theta.abs() + self.rate.abs() <= 1e3
            && self.thrust.abs() <= 1e7
    }
}

/// How the plane of flight turns.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct LateralGuidance {
    /// Greatest acceleration to the side [m/s²]. Zero: the plane is not turned.
    max: f32,
    /// Velocity per position error across the plane [1/s].
    position_gain: f32,
    /// ([`SHARE`] T_max/(m g))²: what of the greatest thrust carries a turn, in multiples of the weight, squared.
    thrust_squared: f32,
    /// [`SHARE`] of the greatest lift coefficient short of stall.
    stall: f32,
    /// The lift with it, per weight and squared airspeed [s²/m²].
    lift: f32,
    /// Speed at which the wing carries the weight with a lift coefficient of 1 [m/s].
    speed: f32,
    /// How the air takes over from the heading, by airspeed, as in the law.
    air: Guard,
    /// Greatest rate of the course [rad/s].
    rate: f32,
}

/// What a step of the reference model goes by.
pub(super) struct LateralGuidanceInput<'a> {
    pub reference: &'a Reference,
    pub planner_options: &'a PlannerOptions,
    /// v_w [m/s].
    pub wind: Ned,
    /// The air's force over the believed one.
    pub air_force_scale: f32,
    /// Part \[N\] of the greatest thrust that is not there.
    pub missing_thrust: f32,
    /// Cosine of the angle between the vehicle's wing and the model's.
    pub wing_alignment: f32,
}

/// What a step of the reference model gives.
pub(super) struct ReferenceModelOutput {
    /// Velocity [m/s] and position \[m\] in the middle of the step, over which the command holds.
    pub velocity: Ned,
    pub position: Ned,
    /// Acceleration [m/s²].
    pub acceleration: Ned,
    /// Its derivative as far as turning makes it [m/s³].
    pub jerk: Ned,
    /// Acceleration in the plane of flight [m/s²].
    pub in_plane: Inertial,
    /// Attitude in the plane at the end of the step.
    pub attitude: Attitude,
    /// ω̇ about the plane's normal [rad/s²].
    pub rate_change: f32,
    /// The plane of flight.
    pub axes: Axes,
    /// How the plane turns [rad/s].
    pub spin: Ned,
    /// Greatest thrust that is there \[N\].
    pub thrust_max: f32,
    /// How far it has come.
    pub progress: Progress,
    /// Whether a plan is due.
    pub plan_due: bool,
}

/// How the air takes over from the heading that is asked of a vehicle, by airspeed.
pub(crate) fn takeover<A: Aerodynamics>(vehicle: &Vehicle<A>) -> Guard {
    // The absolute value of what is positive: the root then needs no call of the C library.
    let speed = math::sqrt((vehicle.weight() / vehicle.k_a()).abs());
    Guard::of_checked(math::clamp(TAKEOVER * speed, 1e-3, 1e3))
}

impl LateralGuidance {
    /// How `vehicle` turns with these parameters, which have been checked.
    pub fn new<A: Aerodynamics>(p: &GuidanceParameters, vehicle: &Vehicle<A>) -> Self {
        let (weight, k_a) = (vehicle.weight(), vehicle.k_a());
        let thrust = SHARE * vehicle.thrust_max() / weight;
        // The absolute value of what is positive: the root then needs no call of the C library.
        let speed = math::sqrt((weight / k_a).abs());
        let stall = SHARE * Stall::of(vehicle.model()).c_l;
        let load = LOAD_OF_TURN * p.max_load_factor;
        let loaded = math::sqrt(math::max(load * load - 1.0, 0.0).abs());
        Self {
            max: math::min(p.max_lateral_acceleration, loaded) * vehicle.gravity(),
            position_gain: p.position_gain_forward,
            thrust_squared: thrust * thrust,
            stall,
            lift: stall * k_a / weight,
            speed,
            air: takeover(vehicle),
            rate: SHARE_OF_RATE * p.max_rate,
        }
    }

    /// Lift coefficient short of stall that plans may count on.
    pub fn lift_coefficient(&self) -> f32 {
        self.stall
    }

    /// Speed below which a velocity is moved sideways and not turned [m/s]: the wing carries little yet.
    pub fn slow(&self) -> f32 {
        TURNING * self.speed
    }

    /// Speed from which on the air alone has a say in the course, and the heading none [m/s].
    pub fn takeover(&self) -> f32 {
        self.air.tau()
    }

    /// Greatest acceleration to the side [m/s²] that leaves enough of thrust, or of lift at this squared airspeed, to carry
    /// the weight.
    #[inline(always)]
    fn most(&self, gravity: f32, airspeed_squared: f32) -> f32 {
        let lift = self.lift * airspeed_squared;
        let lift_squared = lift * lift;
        let load_squared = if lift_squared > self.thrust_squared {
            lift_squared
        } else {
            self.thrust_squared
        };
        if load_squared > 1.0 {
            // The absolute value of what is positive: the compiler then knows that it has a root.
            math::min(gravity * math::sqrt((load_squared - 1.0).abs()), self.max)
        } else {
            0.0
        }
    }

    /// 0 for speeds at which a velocity is moved sideways, 1 for those at which it is turned.
    #[inline(always)]
    fn flying(&self, speed: f32) -> f32 {
        math::clamp(speed / self.slow() - 1.0, 0.0, 1.0)
    }

    /// Lets `flight` pass for `dt` \[s\] by the plan in force, and leaves the request for the next one.
    #[inline(always)]
    pub fn advance<A: Aerodynamics>(
        &self,
        planner: &Planner,
        vehicle: &Vehicle<A>,
        flight: &mut ReferenceModelState,
        state: &mut PlannerState,
        input: &LateralGuidanceInput,
        dt: f32,
    ) -> ReferenceModelOutput {
        let servo = &planner.reference_model;
        let reference = input.reference;
        let course = flight.course;
        let (velocity, across) = course.project(flight.velocity);
        let (position, aside) = course.project(flight.position);
        let (wind, wind_across) = course.project(input.wind);
        let (v_r, v_r_across) = course.project(reference.velocity);
        let (a_r, a_r_across) = course.project(reference.acceleration);

        // The horizontal air velocity wanted: it is that which is turned.
        let forward = servo.desired_velocity(position, v_r, wind).forward() - wind.forward();
        let right = v_r_across
            - limited(self.position_gain * aside, servo.max_velocity.forward())
            - wind_across;
        let wanted = math::sqrt(forward * forward + right * right);
        let ahead = velocity.forward() - wind.forward();
        let aslant = across - wind_across;
        let airspeed_squared = ahead * ahead + aslant * aslant;
        let turning = if self.max > 0.0 {
            self.flying(math::sqrt(airspeed_squared)) * self.flying(wanted)
        } else {
            0.0
        };

        // Behind, it is turned to at once, by the shorter way.
        let beside = if forward < 0.0 {
            let side = if right < 0.0 { -wanted } else { wanted };
            right + turning * (side - right)
        } else {
            right
        };
        let desired_lateral_acceleration = limited(
            a_r_across + LATERAL_GAIN * (beside - aslant),
            self.most(vehicle.gravity(), input.air_force_scale * airspeed_squared),
        );
        let share = if state.plan.turn == 1 { CROSSING } else { 1.0 };
        let lateral_acceleration = share * desired_lateral_acceleration;
        let step = MAX_LATERAL_JERK * vehicle.gravity() * dt;
        let lateral_acceleration = math::clamp(
            lateral_acceleration,
            flight.lateral_acceleration - step,
            flight.lateral_acceleration + step,
        );
        let lateral_jerk = (lateral_acceleration - flight.lateral_acceleration) / dt;
        let axes = Axes::new(&course, vehicle.gravity(), lateral_acceleration);
        let heavier = vehicle.as_flown(axes.gravity, input.air_force_scale, input.missing_thrust);

        // What is down leans with the plane: in it, down is shorter by the load factor.
        let load = axes.gravity / vehicle.gravity();
        let to_banked = |v: Inertial| Inertial::new(v.down() / load, v.forward());
        let to_level = |v: Inertial| Inertial::new(v.down() * load, v.forward());
        // The length of the velocity wanted is had in the plane, its direction by turning the plane.
        let faster = Inertial::new(0.0, turning * (wanted - forward));
        let asked = reference::Reference {
            velocity: to_banked(v_r) + faster,
            acceleration: to_banked(a_r),
        };
        let wind = to_banked(wind);
        let mut plane = PlanarModelState {
            velocity: to_banked(velocity),
            position: to_banked(position),
            theta: flight.theta,
            rate: flight.rate,
            thrust: flight.thrust,
        };
        let missed_lateral_acceleration = (1.0 - CROSSING) * desired_lateral_acceleration.abs();
        let (in_plane, attitude, error) = servo.advance(
            &heavier,
            &mut plane,
            &mut state.plan,
            &asked,
            wind,
            most_theta(input.planner_options.nose_below_vertical),
            dt,
        );
        let request = PlanRequest {
            flight: plane,
            wind,
            velocity: asked.velocity,
            acceleration: asked.acceleration,
            gravity: axes.gravity,
            air_force_scale: input.air_force_scale,
            missing_thrust: input.missing_thrust,
            missed_lateral_acceleration,
            altitude_band: planner.altitude_band(input.planner_options.altitude_band),
        };
        let plan_due = state.leave(request, planner.cost.velocity_band.forward(), dt);
        let progress = Progress::new(&heavier, planner, state, plane.thrust, error);

        // The plane turns with the air velocity, and towards the heading where there is little of it.
        let across = across + lateral_acceleration * dt;
        let (ahead, aslant) = (
            plane.velocity.forward() - wind.forward(),
            across - wind_across,
        );
        let square = ahead * ahead + aslant * aslant;
        let over = self.air.over_square(square);
        let heading = reference.heading.vector();
        let (facing, facing_right) = if heading.norm_squared() > 0.0 {
            let (along, right) = course.project(heading);
            (along.forward(), right)
        } else {
            let weight = wanted / (self.takeover() * self.takeover());
            (STAY + weight * forward, weight * right)
        };
        let (air, rest) = (math::sqrt(square) * over, 1.0 - square * over);
        let aim = math::atan2(
            rest * facing_right + air * aslant,
            rest * facing + air * ahead,
        );
        let turn_rate_per_acceleration = ahead / (square + SLOW * SLOW);
        let turn = if self.max > 0.0 {
            let waiting = math::clamp(input.wing_alignment / WAIT, 0.0, 1.0);
            waiting
                * limited(
                    COURSE_GAIN * aim + lateral_acceleration * turn_rate_per_acceleration,
                    self.rate,
                )
        } else {
            0.0
        };

        let moved = course.lift(to_level(plane.velocity), across);
        let roll = lateral_jerk * vehicle.gravity() / (axes.gravity * axes.gravity);
        // In a turn the wing turns about itself with the part of the course's rate that bank puts there.
        let turn_change = lateral_jerk * turn_rate_per_acceleration * axes.right.down
            + turn * roll * axes.down.down;
        let rate_change = (plane.rate - flight.rate) / dt + turn_change;
        let before = *flight;
        *flight = ReferenceModelState {
            velocity: moved,
            position: flight.position + (moved - reference.velocity) * dt,
            course: course.turned(turn * dt),
            lateral_acceleration,
            theta: plane.theta,
            rate: plane.rate,
            thrust: plane.thrust,
        };
        ReferenceModelOutput {
            velocity: (before.velocity + flight.velocity) * 0.5,
            position: (before.position + flight.position) * 0.5,
            acceleration: course.lift(to_level(in_plane), lateral_acceleration),
            jerk: course.lift(
                Inertial::new(0.0, -lateral_acceleration * turn),
                lateral_jerk + in_plane.forward() * turn,
            ),
            in_plane,
            attitude,
            rate_change,
            spin: Ned::new(0.0, 0.0, turn) + axes.forward * roll,
            axes,
            thrust_max: heavier.thrust_max(),
            progress,
            plan_due,
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{Combined, CombinedParameters};
    use crate::ned::{BodyAxes, Quaternion};
    use crate::spatial::{Heading, Orientation};
    use crate::vehicle::VehicleParameters;

    const DT: f32 = 0.01;
    const NO_OPTIONS: PlannerOptions = PlannerOptions {
        nose_below_vertical: false,
        hold_altitude_only: false,
        altitude_band: 0.0,
    };

    fn vehicle() -> Vehicle<Combined> {
        let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        Vehicle::new(VehicleParameters::PAPER, model).unwrap()
    }

    /// The course to the north.
    fn north() -> Course {
        let up = Quaternion {
            w: 1.0,
            x: 0.0,
            y: 0.0,
            z: 0.0,
        };
        Course::of(&Orientation::from_quaternion(&up, BodyAxes::NoseUp).unwrap())
    }

    fn flight(velocity: Ned, theta: f32) -> ReferenceModelState {
        ReferenceModelState {
            velocity,
            course: north(),
            theta,
            thrust: 10.0,
            ..ReferenceModelState::default()
        }
    }

    /// Still air, all of the thrust, the wing where the model's is.
    fn calm(reference: &Reference) -> LateralGuidanceInput<'_> {
        LateralGuidanceInput {
            reference,
            planner_options: &NO_OPTIONS,
            wind: Ned::ZERO,
            air_force_scale: 1.0,
            missing_thrust: 0.0,
            wing_alignment: 1.0,
        }
    }

    /// Flies to `reference` in still air with the wing where the model's is; gives what is seen at every step.
    fn fly(
        start: ReferenceModelState,
        reference: &Reference,
        seconds: f32,
        see: impl FnMut(&ReferenceModelState, &ReferenceModelOutput),
    ) -> ReferenceModelState {
        let p = GuidanceParameters::default();
        fly_with(&p, start, reference, 0.0, seconds, see)
    }

    /// The same with these parameters, without a part of the greatest thrust.
    fn fly_with(
        p: &GuidanceParameters,
        start: ReferenceModelState,
        reference: &Reference,
        missing_thrust: f32,
        seconds: f32,
        mut see: impl FnMut(&ReferenceModelState, &ReferenceModelOutput),
    ) -> ReferenceModelState {
        let vehicle = vehicle();
        let turning = LateralGuidance::new(p, &vehicle);
        let planner = Planner::new(
            p,
            &vehicle,
            turning.lift_coefficient(),
            &crate::guidance::Tuning::default(),
        );
        let (mut flight, mut state) = (start, PlannerState::default());
        for _ in 0..(seconds / DT) as usize {
            let input = LateralGuidanceInput {
                missing_thrust,
                ..calm(reference)
            };
            let output = turning.advance(&planner, &vehicle, &mut flight, &mut state, &input, DT);
            assert!(flight.is_sound());
            if output.plan_due {
                let mut search = state.search();
                while planner.look(&vehicle, &mut search).is_some() {}
                state.adopt(&search, flight.theta);
            }
            see(&flight, &output);
        }
        flight
    }

    fn cruise(north: f32, east: f32) -> Reference {
        Reference {
            velocity: Ned::new(north, east, 0.0),
            ..Reference::default()
        }
    }

    /// With everything in the plane to the north there is nothing to the side, to the bit.
    #[test]
    fn flight_in_the_plane_stays_there() {
        let start = flight(Ned::new(20.0, 0.0, 0.0), -1.5);
        let end = fly(start, &cruise(12.0, 0.0), 5.0, |f, moved| {
            assert_eq!(
                (f.velocity.east, f.position.east, f.lateral_acceleration),
                (0.0, 0.0, 0.0)
            );
            assert_eq!(f.course, north());
            assert_eq!((moved.acceleration.east, moved.jerk.east), (0.0, 0.0));
            assert_eq!(moved.axes.gravity, 9.81);
        });
        assert!((end.velocity.north - 12.0).abs() < 1.0);
    }

    /// 5 m to the right of a place and ahead of it in hover: who turns at 1.2 rad/s in place of 2.8 comes back as fast to the side, and more slowly
    /// in its plane of flight.
    #[test]
    fn who_leans_slowly_goes_aside_as_fast() {
        let left = |max_rate: f32| {
            let p = GuidanceParameters {
                max_rate,
                ..GuidanceParameters::default()
            };
            let start = ReferenceModelState {
                position: Ned::new(5.0, 5.0, 0.0),
                thrust: vehicle().weight(),
                ..flight(Ned::ZERO, 0.0)
            };
            let reference = Reference {
                heading: Heading::of_unit(Ned::new(1.0, 0.0, 0.0)),
                ..cruise(0.0, 0.0)
            };
            fly_with(&p, start, &reference, 0.0, 3.0, |_, _| {}).position
        };
        let (quick, slow) = (left(2.8), left(1.2));
        // In its plane 2 m are left of the 5.
        assert!((slow.east - quick.east).abs() < 0.3, "{quick:?} {slow:?}");
        assert!(slow.north > quick.north + 1.5, "{quick:?} {slow:?}");
    }

    /// A velocity reversed at speed is turned: it never gets slow. Forces, load factor and their change are those of the
    /// bank, and the altitude is held.
    #[test]
    fn a_velocity_reversed_at_speed_is_turned() {
        let start = flight(Ned::new(20.0, 0.0, 0.0), -1.5);
        let mut before = start;
        let end = fly(start, &cruise(-20.0, 0.1), 12.0, |f, moved| {
            let (north, east) = (f.velocity.north, f.velocity.east);
            assert!(north * north + east * east > 14.0 * 14.0);
            assert!(f.position.down.abs() < 2.0);
            let load = moved.axes.gravity / 9.81;
            let lateral_acceleration = f.lateral_acceleration / 9.81;
            // 1e-4: roundings of a root.
            assert!((load * load - 1.0 - lateral_acceleration * lateral_acceleration).abs() < 1e-4);
            assert!(load < 2.3, "2 g to the side at most");
            let mean = (f.velocity - before.velocity) * (1.0 / DT);
            // The plane is implicit in drag, which is some 0.1 m/s² here.
            assert!((mean - moved.acceleration).norm_squared() < 0.1);
            before = *f;
        });
        // It catches up with its reference at up to 6 m/s.
        assert!(
            (-26.5..-19.0).contains(&end.velocity.north),
            "{:?}",
            end.velocity
        );
        // And comes back from the half circle to its track.
        assert!(end.velocity.east.abs() < 0.3 * end.velocity.north.abs());
        let (along, _) = end.course.project(Ned::new(-1.0, 0.0, 0.0));
        assert!(along.forward() > 0.95);
    }

    /// Below the speed at which the wing carries, a velocity to the side is moved to, and the course stays where the heading
    /// is.
    #[test]
    fn at_hover_a_velocity_to_the_side_is_moved_to() {
        let start = ReferenceModelState {
            thrust: 98.1,
            ..flight(Ned::ZERO, 0.0)
        };
        let reference = Reference {
            heading: Heading::from_angle(0.0),
            ..cruise(0.0, 2.0)
        };
        let end = fly(start, &reference, 6.0, |_, _| {});
        assert!((end.velocity.east - 2.0).abs() < 0.1);
        let (along, _) = end.course.project(Ned::new(1.0, 0.0, 0.0));
        // 2 m/s of air have some say in the course, of 20 m/s.
        assert!(along.forward() > 0.95, "{}", along.forward());
    }

    /// A sink that full thrust has to stop: what is not there of it is not counted on.
    #[test]
    fn thrust_that_is_not_there_is_not_counted_on() {
        let start = flight(Ned::new(0.0, 0.0, 12.0), 0.0);
        for missing in [0.0, 9.81] {
            let mut most = 0f32;
            fly_with(
                &GuidanceParameters::default(),
                start,
                &cruise(0.0, 0.0),
                missing,
                1.0,
                |f, _| {
                    most = f32::max(most, f.thrust);
                },
            );
            // 1e-3 N: roundings of mass and thrust.
            assert!((most - (vehicle().thrust_max() - missing)).abs() < 1e-3);
        }
    }

    /// The course waits for a wing that is elsewhere.
    #[test]
    fn the_course_waits_for_the_wing() {
        let (p, vehicle) = (GuidanceParameters::default(), vehicle());
        let turning = LateralGuidance::new(&p, &vehicle);
        let planner = Planner::new(
            &p,
            &vehicle,
            turning.lift_coefficient(),
            &crate::guidance::Tuning::default(),
        );
        let turned = |wing_alignment: f32| {
            let mut flight = flight(Ned::new(0.0, 20.0, 0.0), -1.5);
            let reference = cruise(0.0, 20.0);
            let input = LateralGuidanceInput {
                wing_alignment,
                ..calm(&reference)
            };
            let mut state = PlannerState::default();
            turning.advance(&planner, &vehicle, &mut flight, &mut state, &input, DT);
            flight.course.project(Ned::new(0.0, 1.0, 0.0)).0.forward()
        };
        assert!(turned(1.0) > 0.01);
        assert_eq!(turned(0.5), turned(1.0));
        assert!((turned(0.25) / turned(1.0) - 0.5).abs() < 0.01);
        assert_eq!(turned(-0.3), 0.0);
    }

    /// Nine tenths of what thrust or lift carries: 19.62·0.9 N per kg give √(1.8² − 1) g.
    #[test]
    fn a_turn_leaves_what_carries_the_weight() {
        let turning = LateralGuidance::new(
            &GuidanceParameters {
                max_lateral_acceleration: 10.0,
                ..GuidanceParameters::default()
            },
            &vehicle(),
        );
        let thrust_alone = 9.81 * (1.8f32 * 1.8 - 1.0).sqrt();
        assert!((turning.most(9.81, 0.0) - thrust_alone).abs() < 1e-3);
        let (slow, fast) = (turning.most(9.81, 25.0 * 25.0), turning.most(9.81, 900.0));
        assert!(slow > thrust_alone && fast > slow);
    }

    /// 3 g leave a turn of 2 g: √(2² − 1) g to the side, of 10 g that are allowed. Without a bound it is those.
    #[test]
    fn a_turn_leaves_load_to_pull_out() {
        let most = |max_load_factor: f32| {
            let p = GuidanceParameters {
                max_lateral_acceleration: 10.0,
                max_load_factor,
                ..GuidanceParameters::default()
            };
            LateralGuidance::new(&p, &vehicle()).max / 9.81
        };
        assert!((most(3.0) - 3f32.sqrt()).abs() < 1e-4);
        assert_eq!(most(1e3), 10.0);
    }

    #[test]
    fn what_no_step_leaves_is_not_sound() {
        let good = flight(Ned::new(20.0, 1.0, 0.0), -1.5);
        assert!(good.is_sound());
        for bad in [
            ReferenceModelState {
                velocity: Ned::new(f32::NAN, 0.0, 0.0),
                ..good
            },
            ReferenceModelState {
                position: Ned::new(0.0, 0.0, 1e6),
                ..good
            },
            ReferenceModelState {
                lateral_acceleration: f32::INFINITY,
                ..good
            },
            ReferenceModelState {
                theta: f32::NAN,
                ..good
            },
            ReferenceModelState {
                thrust: -1e8,
                ..good
            },
            ReferenceModelState {
                course: Course::default(),
                ..good
            },
        ] {
            assert!(!bad.is_sound());
        }
    }
}
