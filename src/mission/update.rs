//! A step of a mission: which item, what is done for it, and the reference of that.

use super::ability::Ability;
use super::edge_on::edge_on;
use super::follow::{FollowState, Followed, Seen};
use super::height::{Descent, HeightReference};
use super::item::{Item, Mission, MissionError, Pass, Until};
use super::output::{Activity, Gate, MissionOutput, MissionProgress, Remark};
use super::parameters::MissionParameters;
use super::response::{Response, Responses, Troubles};
use super::segment::{Pose, Segment, along, level, right_of};
use super::triangle::Triangle;
use super::turns;
use crate::aero::Aerodynamics;
use crate::error::ParameterError;
use crate::guidance::{
    Goal, GoalOutput, GoalState, Goals, MAX_STEP, MIN_STEP, PlannerOptions, Preferences,
};
use crate::math::{self, PI};
use crate::ned::Ned;
use crate::parameters::Parameters;
use crate::parameters::setters;
use crate::reference::MAX_SPEED;
use crate::spatial::{Heading, Orientation, Reference};
use crate::vehicle::Vehicle;

/// Time constant of the wind that paths are flown with \[s\].
const WIND_TIME: f32 = 2.0;
/// Time constant of the level position on a path \[s\], and how far off \[m\] it is taken at once.
const POSITION_TIME: f32 = 0.5;
const JUMP: f32 = 5.0;
/// Part of the braking that is planned with, as `Goals` does.
const BRAKING_SHARE: f32 = 0.7;
/// Positions farther than this \[m\] are taken for none.
const FARTHEST: f32 = 1e6;
/// How near a place in hover and a height are reached \[m\].
const NEAR: f32 = 2.0;
/// Off the path by this \[m\], across it or in height, for this long \[s\]: the vehicle does not follow.
const OFF_PATH: f32 = 20.0;
const OFF_PATH_TIME: f32 = 5.0;
/// Off the path by this \[m\] a new one is laid from the vehicle.
const ASTRAY: f32 = 30.0;
/// Climb that is asked for before it has lifted off [m/s]; it has when it has been at this height \[m\] for so long \[s\].
const LIFTING: f32 = 1.0;
const LIFTED: f32 = 0.25;
const LIFTED_TIME: f32 = 0.1;
/// Thrust up to which it is tried, in multiples of the weight, and for how much longer than `spool_time` \[s\].
const MOST_THRUST: f32 = 1.6;
const PATIENCE: f32 = 3.0;
/// It stands on the ground when it has sunk by less than this part of what it is asked to, and risen no faster, for so
/// long \[s\]. So it does within this of the ground's believed height \[m\]. Elsewhere its thrust is besides at most
/// this, in multiples of the weight, and it is over its reference by this \[m\].
const STANDING: f32 = 0.5;
const STANDING_TIME: f32 = 0.1;
const NEAR_GROUND: f32 = 1.0;
const CARRIED: f32 = 0.75;
const OVER_REFERENCE: f32 = 0.25;
/// Wind in which a vehicle that circles for too much of it hovers again, over the most: estimates waver.
const LULL: f32 = 0.9;
/// Time in which the thrust goes off \[s\].
const THRUST_OFF: f32 = 0.2;
/// How far from its place a vehicle may be to sink \[m\], and the height below which it sinks in any case \[m\].
const OVER_PLACE: f32 = 1.5;
const COMMITTED: f32 = 1.0;

/// Flies missions. Immutable and validated.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Missions {
    p: MissionParameters,
    responses: Responses,
    ability: Ability,
    tan_bank: f32,
}

/// What a step of a mission is told: from the default, which is at rest and not armed, by the method of each field.
///
/// ```
/// use alula::mission::MissionInput;
/// use alula::prelude::*;
///
/// let told = MissionInput::default().position(Ned::ZERO).armed(true);
/// assert_eq!(told.position, Some(Ned::ZERO));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct MissionInput {
    /// Position \[m\]; none where nothing is known of it. Then it is reckoned from the velocity.
    pub position: Option<Ned>,
    /// Velocity over ground [m/s].
    pub velocity: Ned,
    /// Wind as an autopilot estimates it, without gusts [m/s].
    pub wind: Ned,
    /// Attitude.
    pub orientation: Orientation,
    /// Thrust commanded last \[N\], for the energy.
    pub thrust: f32,
    /// Whether it may take off.
    pub armed: bool,
    /// What has failed, as far as the mission does not find it itself.
    pub troubles: Troubles,
}

setters! {
    MissionInput {
        position: impl Into<Option<Ned>>,
        velocity: Ned,
        wind: Ned,
        orientation: Orientation,
        thrust: f32,
        armed: bool,
        troubles: Troubles,
    }
}

/// What is to be done for an item.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
enum Task {
    /// Wait where it is.
    #[default]
    Wait,
    TakeOff,
    /// To the target.
    Pass,
    /// To the target, and so long there \[s\].
    Hover(f32),
    /// Round the target.
    Circle(Until),
    /// Over the target, and down to this position \[m\].
    Land(f32),
}

/// The items after the present one, as far as they have been looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct Ahead {
    next: u32,
    /// Where the last one leads to \[m\], and the speed after it [m/s].
    from: Ned,
    speed: f32,
    /// Way \[m\] and time \[s\] so far.
    sum: [f32; 2],
}

/// What is remembered between steps. The default is that of a flight that has not begun.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MissionState {
    /// Whether the flight has begun, and whether the item has.
    begun: bool,
    item_begun: bool,
    item: u16,
    activity: Activity,
    task: Task,
    /// Where the task leads to \[m\].
    target: Ned,
    /// Radius of its circle \[m\].
    radius: f32,
    /// Place of the item before \[m\].
    before: Ned,
    /// Where it took off, or the flight began \[m\].
    home: Ned,
    /// Speed of the items [m/s].
    speed: f32,
    /// Time in the item, in the activity, and at its target \[s\].
    time: f32,
    active: f32,
    there: f32,
    /// How long it has been off its path \[s\].
    off_path: f32,
    corner: bool,
    follow: FollowState,
    height: HeightReference,
    goal: GoalState,
    position: Ned,
    velocity: Ned,
    wind: Ned,
    energy: f32,
    /// Way \[m\] and time \[s\] of the items after this one.
    after: [f32; 2],
    ahead: Ahead,
    forced: Response,
    /// Wind that a vehicle on the wing waits for to hover [m/s]; 0 where it does not wait.
    lull: f32,
}

impl MissionState {
    /// What is done.
    pub fn activity(&self) -> Activity {
        self.activity
    }

    /// Item, counted from 0; the number of items when all are done.
    pub fn item(&self) -> usize {
        self.item.into()
    }

    /// Goes to an item, of the same mission or of another that takes its place in flight. A return or landing that was kept to is
    /// given up.
    pub fn go_to(&mut self, item: usize) {
        self.item = item.min(usize::from(u16::MAX)) as u16;
        self.item_begun = false;
        self.forced = Response::Continue;
    }

    fn is_airborne(&self) -> bool {
        use Activity::{Descending, Flying, Hovering, Rising};
        matches!(self.activity, Flying | Hovering | Rising | Descending)
    }

    fn enter(&mut self, activity: Activity) {
        self.activity = activity;
        self.active = 0.0;
        self.there = 0.0;
    }

    fn done(&mut self, before: Ned) {
        self.before = before;
        self.item = self.item.saturating_add(1);
        self.item_begun = false;
    }
}

/// Whether a vector is no longer than this. NaN is not.
fn is_within(v: Ned, most: f32) -> bool {
    v.norm_squared() <= most * most
}

impl Missions {
    /// Missions of `vehicle`.
    ///
    /// # Errors
    /// A parameter outside its range, or a `cruise_speed` that the wing does not carry or the thrust does not reach.
    pub fn new<A: Aerodynamics>(
        vehicle: &Vehicle<A>,
        p: &MissionParameters,
        responses: Responses,
    ) -> Result<Self, ParameterError> {
        p.check()?;
        let ability = Ability::new(vehicle);
        let (least, most) = (ability.least_speed(), ability.most_speed());
        if !(least..=most).contains(&p.cruise_speed) {
            let relation =
                "a speed of the wing, 1.15 times its stall speed and more, that the thrust reaches";
            return Err(ParameterError::contradiction("cruise_speed", relation));
        }
        Ok(Self {
            p: *p,
            responses,
            ability,
            tan_bank: p.tan_bank(),
        })
    }

    /// Least and greatest airspeed on the wing [m/s].
    pub fn speeds(&self) -> [f32; 2] {
        [self.ability.least_speed(), self.ability.most_speed()]
    }

    /// The mission of these items.
    ///
    /// # Errors
    /// The first item that cannot be flown, by its number and field.
    pub fn mission(&self, items: &[Item]) -> Result<Mission, MissionError> {
        Mission::new(items, &self.p, &self.ability)
    }

    /// One step, `dt` \[s\] after the last. Total: whatever comes in, what comes out is finite. What is not finite is not remembered.
    pub fn step(
        &self,
        state: &mut MissionState,
        mission: &Mission,
        input: &MissionInput,
        dt: f32,
    ) -> MissionOutput {
        let dt = if (MIN_STEP..=MAX_STEP).contains(&dt) {
            dt
        } else {
            0.0
        };
        let seen = self.see(state, input, dt);
        let mut out = MissionOutput {
            troubles: input.troubles
                | flag(Troubles::POSITION, input.position.is_none())
                | flag(Troubles::FOLLOW, state.off_path > OFF_PATH_TIME),
            ..MissionOutput::default()
        };
        self.respond(state, &seen, out.troubles);
        self.heed_wind(state, &seen);
        if !state.item_begun && state.forced == Response::Continue {
            self.begin(state, mission, &seen);
        }
        if state.item_begun {
            self.look_ahead(state, mission);
        }
        state.time += dt;
        state.active += dt;
        match state.activity {
            Activity::Grounded => self.grounded(state, input.armed, &mut out),
            Activity::Spooling => {
                self.spooling(
                    state,
                    &seen,
                    (input.armed, &input.orientation),
                    dt,
                    &mut out,
                );
            }
            Activity::Rising | Activity::Hovering => {
                self.hovering(state, &seen, &input.orientation, dt, &mut out);
            }
            Activity::Flying => self.flying(state, &seen, dt, &mut out),
            Activity::Descending => {
                self.descending(
                    state,
                    &seen,
                    (input.thrust, &input.orientation),
                    dt,
                    &mut out,
                );
            }
            Activity::Touched => self.touched(state, &mut out),
        }
        if out.remark.is_none() && (state.lull > 0.0 || self.is_too_windy(state)) {
            out.remark = Some(Remark::TooWindy);
        }
        if out.remark.is_none() && state.corner {
            out.remark = Some(Remark::TightCorner);
        }
        if out.troubles.contains(Troubles::FOLLOW) {
            out.remark = Some(Remark::NotFollowing);
        }
        out.activity = state.activity;
        out.response = state.forced;
        out.progress = MissionProgress {
            item: state.item,
            time: state.time,
            distance_after: state.after[0],
            time_after: state.after[1],
            energy: state.energy,
            ..out.progress
        };
        out
    }

    /// What is known of vehicle and air, without what is not finite; and the energy of the last step.
    fn see(&self, state: &mut MissionState, input: &MissionInput, dt: f32) -> Seen {
        if is_within(input.velocity, MAX_SPEED) {
            state.velocity = input.velocity;
        }
        state.position += state.velocity * dt;
        if let Some(position) = input.position
            && is_within(position, FARTHEST)
        {
            // On a path the reference goes along with the vehicle, and the noise of its position with it: the velocity tells the
            // way between.
            let off = position - state.position;
            let smooth = state.activity == Activity::Flying && is_within(off, JUMP);
            let part = if smooth {
                dt / (POSITION_TIME + dt)
            } else {
                1.0
            };
            state.position += Ned::new(part * off.north, part * off.east, off.down);
        }
        if is_within(input.wind, MAX_SPEED) {
            let level = Ned::new(input.wind.north, input.wind.east, 0.0);
            let part = if state.begun {
                dt / (WIND_TIME + dt)
            } else {
                1.0
            };
            state.wind += (level - state.wind) * part;
        }
        if !state.begun {
            state.begun = true;
            state.home = state.position;
            state.before = state.position;
            state.speed = self.p.cruise_speed;
        }
        let along_nose = -(state.velocity - state.wind).dot(input.orientation.i());
        let (u, thrust) = (0.5 * along_nose, math::max(input.thrust, 0.0));
        let downwash = self.p.hover_downwash;
        let induced =
            math::sqrt((u * u + thrust / self.ability.weight() * downwash * downwash).abs());
        let power = thrust * (u + induced);
        if power < 1e9 {
            state.energy += power * dt;
        }
        Seen {
            position: state.position,
            velocity: state.velocity,
            wind: state.wind,
        }
    }

    /// Does what the table says about `troubles`.
    fn respond(&self, state: &mut MissionState, seen: &Seen, troubles: Troubles) {
        if troubles.is_empty() && state.forced == Response::Continue {
            return;
        }
        let asked = self.responses.to(troubles);
        let kept = if state.forced > Response::Loiter {
            state.forced
        } else {
            Response::Continue
        };
        let forced = if asked > kept { asked } else { kept };
        if forced == state.forced {
            return;
        }
        state.forced = forced;
        state.lull = 0.0;
        if !state.is_airborne() {
            return;
        }
        match forced {
            Response::Continue => state.item_begun = false,
            Response::Loiter => {
                if state.activity == Activity::Descending {
                    let up = state.home.down - self.p.safe_height;
                    let down = math::min(seen.position.down, up);
                    state.task = Task::Wait;
                    let place = Ned {
                        down,
                        ..state.target
                    };
                    self.hover_at(state, seen, place);
                } else {
                    self.wait(state, seen);
                }
            }
            Response::Return => self.go_home(state, seen),
            Response::Land => {
                let place = self.stopping_place(state, seen);
                self.land_at(state, seen, place, state.home.down);
            }
        }
    }

    /// Begins an item.
    fn begin(&self, state: &mut MissionState, mission: &Mission, seen: &Seen) {
        state.item_begun = true;
        state.time = 0.0;
        state.there = 0.0;
        state.corner = false;
        state.lull = 0.0;
        let number = state.item();
        state.ahead = Ahead {
            next: u32::from(state.item) + 1,
            from: mission.next_place(number).unwrap_or(state.position),
            speed: state.speed,
            sum: [0.0; 2],
        };
        // Without a take-off the flight begins in the air.
        if state.activity == Activity::Grounded
            && !matches!(
                mission.items().get(number),
                Some(Item::TakeOff { .. }) | None
            )
        {
            state.goal = GoalState::default();
            state.target = seen.position;
            state.enter(Activity::Hovering);
        }
        let airborne = state.is_airborne();
        match mission.items().get(number).copied() {
            None if airborne => self.wait(state, seen),
            None => state.task = Task::Wait,
            Some(Item::TakeOff { .. }) if airborne => state.done(seen.position),
            Some(Item::TakeOff { height }) => {
                state.task = Task::TakeOff;
                state.home = seen.position;
                state.target = seen.position - Ned::new(0.0, 0.0, height);
                state.enter(Activity::Grounded);
            }
            Some(Item::Speed(speed)) => {
                state.speed = speed;
                let before = state.before;
                state.done(before);
            }
            Some(Item::Altitude { down }) => {
                state.task = Task::Hover(0.0);
                if state.activity == Activity::Flying {
                    self.spiral(state, seen, down, Until::Turns(0.0));
                } else {
                    let place = Ned {
                        down,
                        ..state.target
                    };
                    self.hover_at(state, seen, place);
                }
            }
            Some(Item::Waypoint { place, pass }) => {
                state.target = place;
                match pass {
                    Pass::Hover(time) => {
                        state.task = Task::Hover(time);
                        self.go_to_place(state, seen);
                    }
                    _ => {
                        state.task = Task::Pass;
                        self.go_past(state, seen, pass, mission.next_place(number + 1));
                    }
                }
            }
            Some(Item::Loiter {
                centre,
                radius,
                until,
            }) => {
                state.task = Task::Circle(until);
                self.circle(state, seen, centre, radius);
            }
            Some(Item::Land { place }) => match place {
                Some(place) => self.land_at(state, seen, place, place.down),
                None => {
                    let place = self.stopping_place(state, seen);
                    self.land_at(state, seen, place, state.home.down);
                }
            },
            Some(Item::Return) => self.go_home(state, seen),
        }
    }

    /// Takes one more of the items after the present one into the way and time that are left: one a step.
    fn look_ahead(&self, state: &mut MissionState, mission: &Mission) {
        let Ahead {
            next,
            from,
            speed,
            sum: [way, time],
        } = &mut state.ahead;
        let Some(item) = mission.items().get(*next as usize) else {
            state.after = [*way, *time];
            return;
        };
        *next += 1;
        let (to, extra) = match *item {
            Item::Speed(next) => {
                *speed = next;
                return;
            }
            Item::Waypoint { place, pass } => match pass {
                Pass::Hover(time) => (place, time),
                _ => (place, 0.0),
            },
            Item::Loiter {
                centre,
                radius,
                until,
            } => match until {
                Until::Turns(turns) => {
                    let round = 2.0 * PI * radius.abs() * turns;
                    *way += round;
                    (centre, round / *speed)
                }
                Until::Time(time) => (centre, time),
                Until::Forever => (centre, 0.0),
            },
            Item::Land { place } => (place.unwrap_or(*from), 0.0),
            Item::Return => (state.home, 0.0),
            _ => return,
        };
        let leg = to - *from;
        let length = level(leg);
        if length > 0.0 {
            let triangle = Triangle::new(*speed, state.wind, leg * (1.0 / length));
            *way += length;
            *time += length / triangle.map_or(1.0, |t| math::max(t.ground(1.0), 1.0));
        }
        *time += extra;
        *from = to;
    }

    /// Radius of turns at the speed asked for, in the present wind \[m\].
    fn turn_radius(&self, state: &MissionState) -> f32 {
        let speed = math::max(state.speed, self.ability.least_speed());
        let ground = speed + level(state.wind);
        ground * ground / self.ability.turn_of_paths(speed, self.tan_bank)
    }

    /// Way in which hover is reached from a speed [m/s].
    fn braking_way(&self, speed: f32) -> f32 {
        speed * speed / (2.0 * BRAKING_SHARE * self.p.braking)
    }

    /// Place and course from which a path goes on: at the end of the path flown, if little is left of it, or on it, if it is near; in hover towards
    /// the target, and there into the wind. And what is left of the path flown before that.
    fn departure(&self, state: &MissionState, seen: &Seen) -> (Pose, Option<Segment>) {
        let place = Ned::new(seen.position.north, seen.position.east, 0.0);
        let towards = |v: Ned| math::atan2(v.east, v.north);
        if state.activity != Activity::Flying {
            let way = state.target - place;
            let ahead = if self.is_on_wing(state, seen) {
                seen.velocity
            } else if level(way) > NEAR {
                way
            } else {
                -seen.wind
            };
            let course = towards(ahead);
            return (Pose { place, course }, None);
        }
        let nearest = { state.follow.path }.advance(seen.position);
        if nearest.right.abs() < ASTRAY {
            let rest = state.follow.rest(level(seen.velocity));
            let pose = rest.map_or_else(
                || Pose {
                    place: place - right_of(nearest.along) * nearest.right,
                    course: towards(nearest.along),
                },
                |rest| rest.end(),
            );
            (pose, rest)
        } else {
            let course = towards(seen.velocity);
            (Pose { place, course }, None)
        }
    }

    /// Flies the path that `lay` lays from a pose with a radius of turns.
    fn fly(
        &self,
        state: &mut MissionState,
        seen: &Seen,
        lay: impl FnOnce(Pose, f32) -> super::segment::Path,
    ) {
        let (pose, rest) = self.departure(state, seen);
        let path = lay(pose, self.turn_radius(state));
        let speed = math::max(state.speed, self.ability.least_speed());
        if state.activity == Activity::Flying {
            state
                .follow
                .turn_to(rest.map_or(path, |rest| path.behind(rest)));
        } else {
            state.follow = FollowState::begin(path, speed, seen);
            state.height = HeightReference::at(seen.position, seen.velocity);
            state.enter(Activity::Flying);
        }
        state.follow.banking = self.ability.banking(speed * speed * path.tightest());
    }

    /// Whether the wing carries it now.
    fn is_on_wing(&self, state: &MissionState, seen: &Seen) -> bool {
        state.activity == Activity::Flying
            || level(seen.velocity - seen.wind) >= self.ability.least_speed()
    }

    /// Whether a place at this distance \[m\] is flown to on the wing, and passed or else stopped at.
    fn is_far(&self, state: &MissionState, seen: &Seen, distance: f32, passed: bool) -> bool {
        let brake = if passed {
            0.0
        } else {
            self.braking_way(state.speed)
        };
        let start = if self.is_on_wing(state, seen) {
            0.0
        } else {
            state.speed * state.speed / (2.0 * self.p.acceleration)
        };
        state.speed >= self.ability.least_speed() && distance > brake + start
    }

    /// Whether there is more wind than the task is done in: to take off and to sink, or else to hover.
    fn is_too_windy(&self, state: &MissionState) -> bool {
        let most = match state.task {
            Task::TakeOff | Task::Land(_) => self.ability.landing_wind,
            Task::Hover(_) => self.ability.hover_wind,
            _ if state.activity == Activity::Hovering => self.ability.hover_wind,
            _ => return false,
        };
        level(state.wind) > most
    }

    /// Whether it sinks in this wind to land. Who must land does.
    fn sinks(&self, state: &MissionState) -> bool {
        state.forced == Response::Land || !self.is_too_windy(state)
    }

    /// Whether it is driven off in this wind, where it hovers. Who must land takes that.
    fn is_driven_off(&self, state: &MissionState) -> bool {
        state.forced != Response::Land && level(state.wind) > self.ability.hover_wind
    }

    /// Whether it stays on the wing until there is less wind.
    fn waits(&self, state: &mut MissionState) -> bool {
        let waits = self.is_driven_off(state);
        state.lull = if waits {
            LULL * self.ability.hover_wind
        } else {
            0.0
        };
        waits
    }

    /// Leaves a hover or a landing before it is driven off, down to the height of the flare; and goes back to it when there is less wind.
    fn heed_wind(&self, state: &mut MissionState, seen: &Seen) {
        if state.lull > 0.0 {
            if level(state.wind) <= state.lull {
                state.lull = 0.0;
                match state.forced {
                    Response::Continue => state.item_begun = false,
                    Response::Return => self.go_home(state, seen),
                    _ => {}
                }
            }
            return;
        }
        let leaves = match (state.activity, state.task) {
            (Activity::Hovering, _) => true,
            (Activity::Descending, Task::Land(ground)) => {
                ground - seen.position.down > self.p.flare_height
            }
            _ => false,
        };
        if leaves && self.is_driven_off(state) {
            if state.task == Task::Pass {
                state.item_begun = false;
            } else {
                self.hover_at(state, seen, state.target);
            }
        }
    }

    /// To a place in hover; in too much wind a circle that begins here.
    fn hover_at(&self, state: &mut MissionState, seen: &Seen, place: Ned) {
        if self.waits(state) {
            let until = match state.task {
                Task::Hover(time) => Until::Time(time),
                _ => Until::Forever,
            };
            let down = math::min(place.down, state.home.down - self.p.safe_height);
            self.spiral(state, seen, down, until);
            return;
        }
        if state.activity != Activity::Hovering {
            state.goal = GoalState::default();
        }
        state.target = place;
        state.enter(Activity::Hovering);
    }

    /// To the target, to be stopped at.
    fn go_to_place(&self, state: &mut MissionState, seen: &Seen) {
        let target = state.target;
        if self.is_far(state, seen, level(target - seen.position), false) {
            self.fly(state, seen, |pose, radius| {
                turns::to_place(pose, target, radius)
            });
        } else {
            self.hover_at(state, seen, target);
        }
    }

    /// Past the target, by or over it, with a place after it or none.
    fn go_past(&self, state: &mut MissionState, seen: &Seen, pass: Pass, next: Option<Ned>) {
        let place = state.target;
        let on_wing = state.speed >= self.ability.least_speed();
        let near = level(place - seen.position);
        let flies = self.is_on_wing(state, seen) || self.is_far(state, seen, near, true);
        let hovers = !(on_wing && flies);
        if hovers && !self.waits(state) {
            self.hover_at(state, seen, place);
            return;
        }
        let radius = self.turn_radius(state);
        let unit = |leg: Ned| {
            let length = level(leg);
            (length > 1.0).then(|| (Ned::new(leg.north, leg.east, 0.0) * (1.0 / length), length))
        };
        let into = unit(place - state.before);
        let out = next.and_then(|next| unit(next - place));
        let course = |v: Ned| math::atan2(v.east, v.north);
        let level_place = Ned::new(place.north, place.east, 0.0);
        let over = |along: Ned| Pose {
            place: level_place,
            course: course(along),
        };
        let to = match (into, out) {
            (Some((into, before)), Some((out, after))) => {
                let longer = over(if after > before { out } else { into });
                if pass == Pass::By {
                    let shorter = 0.5 * math::min(before, after);
                    let rounded = rounded(level_place, into, out, (radius, shorter));
                    state.corner = rounded.is_none();
                    rounded.unwrap_or(longer)
                } else {
                    longer
                }
            }
            (Some((along, _)), None) | (None, Some((along, _))) => over(along),
            (None, None) => Pose {
                place: level_place,
                course: self.departure(state, seen).0.course,
            },
        };
        self.fly(state, seen, |pose, radius| turns::to_pose(pose, to, radius));
    }

    fn circle(&self, state: &mut MissionState, seen: &Seen, centre: Ned, radius: f32) {
        state.target = centre;
        state.radius = radius;
        self.fly(state, seen, |pose, turning| {
            // No wider than the circle: else nothing inside it leads onto it.
            let turning = math::min(turning, radius.abs());
            turns::to_circle(pose, turning, centre, radius)
        });
    }

    /// Round to the right, beginning here, until the position is `down` \[m\].
    fn spiral(&self, state: &mut MissionState, seen: &Seen, down: f32, until: Until) {
        let (pose, _) = self.departure(state, seen);
        let radius = self.turn_radius(state);
        let centre = pose.place + right_of(along(pose.course)) * radius;
        state.task = Task::Circle(until);
        self.circle(state, seen, Ned { down, ..centre }, radius);
    }

    /// Waits where it is.
    fn wait(&self, state: &mut MissionState, seen: &Seen) {
        if state.activity == Activity::Flying {
            let down = state.height.down;
            self.spiral(state, seen, down, Until::Forever);
        } else {
            state.task = Task::Wait;
            let place = if state.activity == Activity::Hovering && state.active > 0.0 {
                state.target
            } else {
                seen.position
            };
            self.hover_at(state, seen, place);
        }
    }

    /// Where it can stop: ahead.
    fn stopping_place(&self, state: &MissionState, seen: &Seen) -> Ned {
        match state.activity {
            Activity::Flying => {
                let way = self.braking_way(level(seen.velocity));
                let course = along(self.departure(state, seen).0.course);
                seen.position + course * way
            }
            Activity::Hovering => state.target,
            _ => seen.position,
        }
    }

    fn go_home(&self, state: &mut MissionState, seen: &Seen) {
        let down = math::min(seen.position.down, state.home.down - self.p.safe_height);
        let place = Ned { down, ..state.home };
        self.land_at(state, seen, place, state.home.down);
    }

    /// Over `place` at its height, or at flare height, and down to `ground` \[m\].
    fn land_at(&self, state: &mut MissionState, seen: &Seen, place: Ned, ground: f32) {
        let down = math::min(
            math::min(place.down, seen.position.down),
            ground - self.p.flare_height,
        );
        state.target = Ned { down, ..place };
        state.task = Task::Land(ground);
        if state.activity != Activity::Descending {
            self.go_to_place(state, seen);
        }
    }

    fn grounded(&self, state: &mut MissionState, armed: bool, out: &mut MissionOutput) {
        if state.task != Task::TakeOff || state.forced != Response::Continue {
            return;
        }
        if !armed {
            out.remark = Some(Remark::NotArmed);
        } else if !self.is_too_windy(state) {
            state.enter(Activity::Spooling);
        }
    }

    fn spooling(
        &self,
        state: &mut MissionState,
        seen: &Seen,
        (armed, orientation): (bool, &Orientation),
        dt: f32,
        out: &mut MissionOutput,
    ) {
        let most = math::min(state.active / self.p.spool_time, MOST_THRUST);
        out.gate = Gate::AtMost(most * self.ability.weight());
        out.reference.velocity = Ned::new(0.0, 0.0, -LIFTING);
        out.reference.heading = edge_on(seen.wind, orientation, &self.ability);
        let lifted = state.home.down - seen.position.down > LIFTED;
        state.there = if lifted { state.there + dt } else { 0.0 };
        if state.there > LIFTED_TIME {
            state.goal = GoalState::default();
            state.enter(Activity::Rising);
        } else if !armed || state.forced != Response::Continue || self.is_too_windy(state) {
            state.enter(Activity::Grounded);
        } else if state.active > MOST_THRUST * self.p.spool_time + PATIENCE {
            out.remark = Some(Remark::NoLiftOff);
            state.task = Task::Wait;
            state.enter(Activity::Grounded);
        }
    }

    /// To the target and there, by its position.
    fn hovering(
        &self,
        state: &mut MissionState,
        seen: &Seen,
        orientation: &Orientation,
        dt: f32,
        out: &mut MissionOutput,
    ) {
        let offset = seen.position - state.target;
        let slow = if state.speed < self.ability.least_speed() {
            state.speed
        } else {
            self.p.hover_speed
        };
        let preferences = Preferences {
            speed: math::clamp(math::max(slow, level(seen.velocity)), 0.1, 300.0),
            climb: if offset.down > 0.0 {
                self.p.climb
            } else {
                self.p.sink
            },
            acceleration: self.p.braking,
            planner_options: PlannerOptions::default(),
        };
        let goal = Goal::Hover(state.target);
        if let Ok(goals) = Goals::new(preferences) {
            let GoalOutput {
                reference,
                position_error,
                planner_options,
            } = goals.step(&mut state.goal, &goal, seen.position, seen.velocity, dt);
            out.reference = reference;
            out.position_error = position_error;
            out.planner_options = planner_options;
        }
        out.gate = Gate::Open;
        out.progress.load_factor = 1.0;
        out.progress.steady_thrust = self.ability.weight();
        let distance = level(offset);
        let near = distance < NEAR && offset.down.abs() < NEAR;
        if near {
            state.there += dt;
        }
        out.reference.heading = edge_on(seen.wind, orientation, &self.ability);
        out.progress.distance_to_go = distance;
        out.progress.time_to_go = distance / slow;
        match state.task {
            Task::TakeOff if offset.down < NEAR => state.done(seen.position),
            Task::Pass if near => state.done(state.target),
            Task::Hover(time) => {
                out.progress.time_to_go += math::max(time - state.there, 0.0);
                if near && state.there >= time && state.goal.is_reached() {
                    state.done(state.target);
                }
            }
            Task::Land(_)
                if near
                    && state.goal.is_reached()
                    && distance < OVER_PLACE
                    && self.sinks(state) =>
            {
                state.height = HeightReference::at(seen.position, seen.velocity);
                state.enter(Activity::Descending);
            }
            _ => {}
        }
    }

    /// A path at an airspeed.
    fn flying(&self, state: &mut MissionState, seen: &Seen, dt: f32, out: &mut MissionOutput) {
        let speed = math::max(state.speed, self.ability.least_speed());
        let followed = state.follow.step(&self.p, &self.ability, seen, speed, dt);
        let airspeed = state.follow.airspeed;
        let ground = math::max(level(followed.velocity), 1.0);
        let left = state.follow.path.left();
        let [drag, slope] = self.ability.slopes(airspeed);
        let glide = self.p.glide_share * airspeed * drag;
        let climb = math::min(self.p.climb, airspeed * slope);
        let way = Descent {
            to: state.target.down,
            time: left / ground,
            most: [climb, glide],
        };
        let (acceleration, steep) = state.height.step(&way, seen.position.down, dt);
        out.gate = Gate::Open;
        out.reference = Reference {
            velocity: followed.velocity + Ned::new(0.0, 0.0, state.height.velocity),
            acceleration: followed.acceleration + Ned::new(0.0, 0.0, acceleration),
            heading: Heading::FREE,
        };
        let low = seen.position.down - state.height.down;
        out.position_error = followed.error + Ned::new(0.0, 0.0, low);
        // Along the path the reference goes along with the vehicle.
        out.planner_options.hold_altitude_only = true;
        out.remark = if followed.drifting {
            Some(Remark::Drifting)
        } else if steep {
            Some(Remark::Steep)
        } else {
            None
        };
        out.progress.distance_to_go = left;
        out.progress.time_to_go = left / ground;
        out.progress.right = followed.right;
        out.progress.airspeed = airspeed;
        let turn = followed.turn / self.ability.gravity();
        out.progress.load_factor = math::sqrt((1.0 + turn * turn).abs());
        out.progress.steady_thrust = self.ability.steady_thrust(
            airspeed,
            out.progress.load_factor,
            -state.height.velocity / airspeed,
        );
        out.progress.settled = state.follow.is_settled(speed);
        let off = followed.right.abs() > OFF_PATH || low.abs() > OFF_PATH;
        state.off_path = if off { state.off_path + dt } else { 0.0 };
        if followed.drifting {
            return;
        }
        if followed.right.abs() > ASTRAY && state.forced == Response::Continue {
            state.item_begun = false;
            return;
        }
        self.next_of_flight(state, seen, &followed, dt, out);
    }

    /// Whether the flight is at the end of its task.
    fn next_of_flight(
        &self,
        state: &mut MissionState,
        seen: &Seen,
        followed: &Followed,
        dt: f32,
        out: &mut MissionOutput,
    ) {
        let at_height = (state.target.down - seen.position.down).abs() < NEAR;
        match state.task {
            Task::Pass
                if out.progress.time_to_go < state.follow.lead()
                    && state.follow.path.is_final() =>
            {
                if at_height {
                    state.done(state.target);
                } else {
                    let down = state.target.down;
                    self.spiral(state, seen, down, Until::Turns(0.0));
                }
            }
            Task::Hover(_) | Task::Land(_) => {
                let speed = level(seen.velocity);
                if state.follow.path.left() < self.braking_way(speed) {
                    let target = state.target;
                    self.hover_at(state, seen, target);
                }
            }
            Task::Circle(until) if state.follow.path.is_last() => {
                state.there += dt;
                let turned = state.follow.path.turned();
                let left = match until {
                    Until::Turns(turns) => {
                        let round = 2.0 * PI * state.radius.abs();
                        let left = math::max(turns - turned, 0.0);
                        out.progress.distance_to_go = left * round;
                        left * round / math::max(level(followed.velocity), 1.0)
                    }
                    Until::Time(time) => math::max(time - state.there, 0.0),
                    Until::Forever => MAX_SPEED,
                };
                out.progress.time_to_go = left;
                if left <= 0.0 && at_height {
                    state.done(seen.position);
                }
            }
            _ => {}
        }
    }

    /// Straight down over the target.
    fn descending(
        &self,
        state: &mut MissionState,
        seen: &Seen,
        (thrust, orientation): (f32, &Orientation),
        dt: f32,
        out: &mut MissionOutput,
    ) {
        let Task::Land(ground) = state.task else {
            state.item_begun = false;
            return;
        };
        let height = ground - seen.position.down;
        let offset = seen.position - state.target;
        let over = level(offset) < OVER_PLACE || height < COMMITTED;
        let sinks = over && (self.sinks(state) || height < self.p.flare_height);
        let above = math::max(height - self.p.flare_height, 0.0);
        let sink = math::min(self.p.sink, self.p.landing_speed + 0.5 * above);
        let way = Descent {
            // Through the ground, until it is found.
            to: seen.position.down + 20.0,
            time: 0.0,
            most: [0.0, if sinks { sink } else { 0.0 }],
        };
        let (acceleration, _) = state.height.step(&way, seen.position.down, dt);
        out.gate = Gate::Open;
        out.progress.load_factor = 1.0;
        out.progress.steady_thrust = self.ability.weight();
        out.reference.velocity.down = state.height.velocity;
        out.reference.acceleration.down = acceleration;
        out.reference.heading = edge_on(seen.wind, orientation, &self.ability);
        let low = seen.position.down - state.height.down;
        out.position_error = Ned {
            down: low,
            ..offset
        };
        out.progress.distance_to_go = math::max(height, 0.0);
        out.progress.time_to_go = math::max(height, 0.0) / self.p.landing_speed;
        if !over {
            out.remark = Some(Remark::NotOverPlace);
        }
        let stopped = seen.velocity.down.abs() < STANDING * state.height.velocity;
        let carried = thrust < CARRIED * self.ability.weight() && low < -OVER_REFERENCE;
        let stands = stopped && (height < NEAR_GROUND || carried);
        state.there = if stands { state.there + dt } else { 0.0 };
        if state.there > STANDING_TIME {
            state.enter(Activity::Touched);
        }
    }

    /// The thrust goes off.
    fn touched(&self, state: &mut MissionState, out: &mut MissionOutput) {
        let left = 1.0 - state.active / THRUST_OFF;
        out.gate = Gate::AtMost(math::max(left, 0.0) * self.ability.weight());
        out.reference.velocity.down = self.p.landing_speed;
        if left <= 0.0 {
            state.enter(Activity::Grounded);
            state.task = Task::Wait;
            if state.forced == Response::Continue {
                state.done(state.position);
            } else {
                state.item_begun = true;
            }
        }
    }
}

/// `trouble` if `failed`.
fn flag(trouble: Troubles, failed: bool) -> Troubles {
    if failed { trouble } else { Troubles::empty() }
}

/// The middle of the arc that rounds a corner at `place`, if it takes no more than so much of its legs: (radius, most) \[m\].
fn rounded(place: Ned, into: Ned, out: Ned, (radius, most): (f32, f32)) -> Option<Pose> {
    let both = into + out;
    let length = level(both);
    // The cosine of half the angle that is turned by.
    let cos = 0.5 * length;
    if cos < 0.1 {
        return None;
    }
    let sin = math::sqrt((1.0 - math::min(cos * cos, 1.0)).abs());
    if radius * sin / cos > most {
        return None;
    }
    let inward = out - into;
    let inwards = math::max(level(inward), 1e-6);
    let cut = radius * (1.0 / cos - 1.0) / inwards;
    Some(Pose {
        place: place + inward * cut,
        course: math::atan2(both.east, both.north),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aero::{Combined, CombinedParameters};
    use crate::vehicle::VehicleParameters;

    const DT: f32 = 0.02;

    /// A point that does what it is asked, in a wind from the north.
    struct Point {
        missions: Missions,
        mission: Mission,
        state: MissionState,
        position: Ned,
        velocity: Ned,
    }

    impl Point {
        fn new(items: &[Item], responses: Responses) -> Self {
            let wing = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
            let vehicle = Vehicle::new(VehicleParameters::PAPER, wing).unwrap();
            let p = MissionParameters::cruising_at(22.0);
            let missions = Missions::new(&vehicle, &p, responses).unwrap();
            Self {
                missions,
                mission: missions.mission(items).unwrap(),
                state: MissionState::default(),
                position: Ned::ZERO,
                velocity: Ned::ZERO,
            }
        }

        /// Flies on in a `wind` [m/s] until `done`, for 300 s at most.
        fn until(
            &mut self,
            wind: f32,
            troubles: Troubles,
            done: impl Fn(&MissionOutput, Ned) -> bool,
        ) -> MissionOutput {
            let mut out = MissionOutput::default();
            for _ in 0..15_000 {
                let told = MissionInput::default()
                    .position(self.position)
                    .velocity(self.velocity)
                    .wind(Ned::new(-wind, 0.0, 0.0))
                    .armed(true)
                    .thrust(98.0)
                    .troubles(troubles);
                out = self
                    .missions
                    .step(&mut self.state, &self.mission, &told, DT);
                self.velocity = match out.gate {
                    Gate::Off => Ned::ZERO,
                    _ => out.reference.velocity - out.position_error * 0.5,
                };
                let moved = self.position + self.velocity * DT;
                // The ground.
                if moved.down > 0.0 {
                    self.velocity = Ned::ZERO;
                }
                self.position = Ned::new(moved.north, moved.east, math::min(moved.down, 0.0));
                if done(&out, self.position) {
                    return out;
                }
            }
            panic!("not done: {out:?} at {:?}", self.position);
        }
    }

    /// More than the paper's vehicle lands in, and than some hover in [m/s].
    const STRONG: f32 = 7.0;
    const GALE: f32 = 10.0;
    const OVER: Ned = Ned::new(15.0, 0.0, -10.0);

    fn says_so(out: &MissionOutput) -> bool {
        out.remark == Some(Remark::TooWindy)
    }

    /// The paper's vehicle is turned by the air as much as by a heading at 5.7 m/s, and what turns it is not bounded.
    #[test]
    fn it_knows_the_wind_that_it_lands_and_hovers_in() {
        let ability = Point::new(&[Item::Return], Responses::default())
            .missions
            .ability;
        assert!((ability.landing_wind - 5.69).abs() < 0.01, "{ability:?}");
        // Nearly that in which the wing carries it.
        assert!((13.0..ability.least_speed()).contains(&ability.hover_wind));
    }

    /// On the ground it waits, until there is less.
    #[test]
    fn it_does_not_take_off_in_too_much_wind() {
        let items = [Item::TakeOff { height: 10.0 }, Item::Return];
        let mut point = Point::new(&items, Responses::default());
        let out = point.until(STRONG, Troubles::empty(), |out, _| out.progress.time > 20.0);
        assert!(says_so(&out) && out.activity == Activity::Grounded);
        let out = point.until(4.0, Troubles::empty(), |out, _| {
            out.activity == Activity::Hovering
        });
        assert!(!says_so(&out));
    }

    /// In more wind than it lands in it stays over the place, in more than it hovers in it circles at a safe height. From the flare on it lands.
    #[test]
    fn a_landing_waits_for_less_wind() {
        let items = [Item::TakeOff { height: 30.0 }, Item::Return];
        let mut point = Point::new(&items, Responses::default());
        point.missions.ability.hover_wind = GALE - 1.0;
        let none = Troubles::empty();
        point.until(2.0, none, |out, at| {
            out.activity == Activity::Descending && at.down > -28.0
        });
        let out = point.until(STRONG, none, |out, _| out.progress.time > 60.0);
        assert!(says_so(&out) && out.activity == Activity::Descending);
        assert!(point.position.down < -15.0 && level(point.position) < 1.0);
        let out = point.until(GALE, none, |out, _| out.progress.time > 180.0);
        assert!(says_so(&out) && out.activity == Activity::Flying);
        assert!(point.position.down < -19.0 && level(point.position) < 400.0);
        let out = point.until(STRONG, none, |out, _| {
            out.activity == Activity::Hovering && out.progress.time > 60.0
        });
        assert!(says_so(&out) && point.position.down < -19.0);
        point.until(2.0, none, |out, at| {
            out.activity == Activity::Descending && at.down > -2.0
        });
        point.until(GALE, none, |out, _| {
            assert!(out.activity != Activity::Flying);
            out.activity == Activity::Grounded
        });
        assert!(level(point.position) < 1.0 && point.position.down == 0.0);
    }

    /// Who must land lands, and says so; who must return waits.
    #[test]
    fn a_landing_that_is_forced_is_done_in_any_wind() {
        let responses = Responses::default()
            .battery(Response::Land)
            .link(Response::Return);
        let mut point = Point::new(&[Item::TakeOff { height: 30.0 }], responses);
        point.missions.ability.hover_wind = GALE - 1.0;
        point.until(2.0, Troubles::empty(), |out, at| {
            out.activity == Activity::Hovering && at.down < -29.0
        });
        point.until(GALE, Troubles::LINK, |out, _| {
            says_so(out) && out.activity == Activity::Flying && out.progress.time > 60.0
        });
        let out = point.until(GALE, Troubles::BATTERY, |out, _| {
            out.activity == Activity::Descending
        });
        assert!(says_so(&out));
        point.until(GALE, Troubles::BATTERY, |out, _| {
            out.activity == Activity::Grounded
        });
    }

    /// What was to be hovered at is circled for as long, and the mission goes on.
    #[test]
    fn a_hover_in_too_much_wind_is_a_circle_for_its_time() {
        let hover = Item::Waypoint {
            place: OVER,
            pass: Pass::Hover(30.0),
        };
        let mut point = Point::new(
            &[Item::TakeOff { height: 10.0 }, hover],
            Responses::default(),
        );
        // More than this vehicle's wing flies at: it hovers in all that it does not fly in.
        point.missions.ability.hover_wind = 6.0;
        let none = Troubles::empty();
        point.until(2.0, none, |out, _| out.progress.item == 1);
        let out = point.until(STRONG, none, |out, _| out.activity == Activity::Flying);
        assert!(says_so(&out));
        let out = point.until(STRONG, none, |out, _| out.progress.item == 2);
        assert!(level(point.position - OVER) < 400.0 && out.activity == Activity::Flying);
        let again = point.until(STRONG, none, |_, _| true);
        assert!(again.progress.time < 1.0);
    }
}
