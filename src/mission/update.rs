//! A step of a mission: which item, what is done for it, and the reference of that.

use super::ability::Ability;
use super::edge_on::edge_on;
use super::follow::{FollowState, Seen};
use super::height::{Descent, HeightReference};
use super::item::{Item, Mission, MissionError, Pass, Until};
use super::output::{Activity, Gate, MissionOutput, Remark};
use super::parameters::MissionParameters;
use super::response::{Response, Responses, Rules, Troubles};
use super::segment::{Pose, Segment, along, level, right_of};
use super::triangle::Triangle;
use super::turns::{Destination, Search};
use crate::aero::Aerodynamics;
use crate::error::ParameterError;
use crate::guidance::{
    Goal, GoalOutput, Goals, MAX_STEP, MIN_STEP, PlannerOptions, Preferences, SetPointState,
    deceleration,
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
/// Greatest gust that an airspeed is believed, over the airspeed that wind and velocity tell: a tube that tells nothing may tell 0.
const MOST_GUST: f32 = 0.5;
/// Time constant of the level position on a path \[s\], and how far off \[m\] it is taken at once.
const POSITION_TIME: f32 = 0.5;
const JUMP: f32 = 5.0;
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
/// Least sine of the elevation of its nose at which it stands on its tail: lying it would slide, and not lift off.
const UPRIGHT: f32 = 0.7;
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
/// Greatest speed to a place of hover [m/s].
const FASTEST: f32 = 300.0;
/// Ways that are compared in a step in which a path is laid.
const COMPARED: u8 = 2;
/// Most steps from the end of an item to the path of the next: it begins, departs, its ways are compared, the shortest is laid, what has no length
/// is passed.
const LAYING: f32 = (4 + Search::MOST / COMPARED) as f32;
/// Most steps in a row in which nothing new is asked for: who decides otherwise all the time is not heeded.
const MOST_HELD: u8 = 16;
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
    rules: Rules,
    ability: Ability,
    tan_bank: f32,
    /// Squared speed that the propellers give the air in hover, per thrust [m²/s² N].
    induced: f32,
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
    /// Airspeed along the nose, as a pitot tube tells it [m/s]; none, or NaN, where it tells nothing.
    pub airspeed: Option<f32>,
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
        airspeed: impl Into<Option<f32>>,
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

/// What is being prepared, a part in a step. In such a step what was asked for last is asked for again.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
enum Preparing {
    #[default]
    Nothing,
    /// The items after the present one are looked at, in every second step.
    After,
    /// A hover at the target.
    Hover,
    /// Where a path departs; without a destination to a circle to the right that begins there.
    Departure(Option<Destination>),
    /// The ways are compared, and the shortest is laid behind what is left of the path that is flown.
    Ways(Search, Option<Segment>),
}

/// What is remembered between steps. The default is that of a flight that has not begun.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MissionState {
    flight: Flight,
    /// What was asked for last.
    asked: MissionOutput,
}

/// How far a flight has come.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct Flight {
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
    set_point: SetPointState,
    preparing: Preparing,
    /// How long what was asked for last has been held \[s\], and for how many steps.
    held: f32,
    steps_held: u8,
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
        self.flight.activity
    }

    /// Item, counted from 0; the number of items when all are done.
    pub fn item(&self) -> usize {
        self.flight.item.into()
    }

    /// Goes to an item, of the same mission or of another that takes its place in flight. A return or landing that was kept to is
    /// given up.
    pub fn go_to(&mut self, item: usize) {
        self.flight.item = item.min(usize::from(u16::MAX)) as u16;
        self.flight.item_begun = false;
        self.flight.forced = Response::Continue;
    }
}

impl Flight {
    /// Prepares a path to a destination.
    fn lay(&mut self, to: Destination) {
        self.preparing = Preparing::Departure(Some(to));
    }

    /// Whether it leaves what it does for a path.
    fn is_laying(&self) -> bool {
        matches!(
            self.preparing,
            Preparing::Departure(_) | Preparing::Ways(..)
        )
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

    /// The present item is done, once.
    fn done(&mut self, before: Ned) {
        if self.item_begun {
            self.before = before;
            self.item = self.item.saturating_add(1);
            self.item_begun = false;
        }
    }
}

/// Wind from behind [m/s] that a tube tells and the `known` airspeed along the nose has not, on a path: in hover a tube tells nothing.
fn gust_from_behind(activity: Activity, told: Option<f32>, known: f32) -> f32 {
    match told {
        Some(told) if activity == Activity::Flying && (known - told).abs() <= MOST_GUST * known => {
            known - told
        }
        _ => 0.0,
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
        // Who brakes level needs no climb for it.
        let braking_climb = if ability.brakes_level() {
            0.0
        } else {
            p.braking_climb
        };
        Ok(Self {
            p: p.braking_climb(braking_climb),
            rules: Rules::new(&responses),
            ability,
            tan_bank: p.tan_bank(),
            induced: p.hover_downwash * p.hover_downwash / ability.weight(),
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
    pub fn step<'s>(
        &self,
        state: &'s mut MissionState,
        mission: &Mission,
        input: &MissionInput,
        dt: f32,
    ) -> &'s MissionOutput {
        let MissionState { flight, asked: out } = state;
        let dt = if (MIN_STEP..=MAX_STEP).contains(&dt) {
            dt
        } else {
            0.0
        };
        let seen = self.see(flight, input, dt);
        let troubles = input.troubles
            | flag(Troubles::POSITION, input.position.is_none())
            | flag(Troubles::FOLLOW, flight.off_path > OFF_PATH_TIME);
        flight.time += dt;
        flight.active += dt;
        let prepares = flight.steps_held < MOST_HELD
            && (self.respond(flight, &seen, troubles)
                || self.heed_wind(flight, &seen)
                || self.prepare(flight, mission, &seen, dt, out));
        if prepares {
            flight.held += dt;
            flight.steps_held += 1;
            out.go_on(seen.velocity, dt);
        } else {
            let dt = math::min(dt + flight.held, MAX_STEP);
            (flight.held, flight.steps_held) = (0.0, 0);
            self.ask(flight, &seen, input, dt, out);
        }
        if troubles.contains(Troubles::FOLLOW) {
            out.remark = Some(Remark::NotFollowing);
        } else if out.remark.is_none() {
            if flight.lull > 0.0 || self.is_too_windy(flight) {
                out.remark = Some(Remark::TooWindy);
            } else if flight.corner {
                out.remark = Some(Remark::TightCorner);
            }
        }
        out.troubles = troubles;
        out.activity = flight.activity;
        out.response = flight.forced;
        out.progress.item = flight.item;
        out.progress.time = flight.time;
        [out.progress.distance_after, out.progress.time_after] = flight.after;
        out.progress.energy = flight.energy;
        out
    }

    /// What is asked for in this step.
    #[inline(always)]
    fn ask(
        &self,
        state: &mut Flight,
        seen: &Seen,
        input: &MissionInput,
        dt: f32,
        out: &mut MissionOutput,
    ) {
        let MissionInput {
            armed,
            thrust,
            ref orientation,
            ..
        } = *input;
        if state.activity == Activity::Flying {
            return self.flying(state, seen, dt, out);
        }
        out.clear();
        match state.activity {
            Activity::Grounded => self.grounded(state, (armed, orientation), out),
            Activity::Spooling => self.spooling(state, seen, (armed, orientation), dt, out),
            Activity::Rising | Activity::Hovering => {
                self.hovering(state, seen, orientation, dt, out);
            }
            Activity::Flying => {}
            Activity::Descending => {
                self.descending(state, seen, (thrust, orientation), dt, out);
            }
            Activity::Touched => self.touched(state, out),
        }
    }

    /// A part of what is being prepared; whether there is one in this step.
    fn prepare(
        &self,
        state: &mut Flight,
        mission: &Mission,
        seen: &Seen,
        dt: f32,
        out: &mut MissionOutput,
    ) -> bool {
        let asked = state.steps_held == 0;
        match &mut state.preparing {
            _ if !state.item_begun && state.forced == Response::Continue && asked => {
                self.begin(state, mission, seen, out);
            }
            _ if state.activity == Activity::Flying && state.follow.path.is_passed() => {
                state.follow.path.pass();
            }
            Preparing::After if asked => self.look_ahead(state, mission),
            Preparing::Nothing | Preparing::After => return false,
            Preparing::Hover => self.hover_at(state, state.target),
            Preparing::Departure(to) => {
                let to = *to;
                self.depart(state, seen, to, dt);
            }
            Preparing::Ways(search, rest) => {
                if search.is_complete() {
                    search.lay(*rest, &mut state.follow.path);
                    self.fly(state, seen);
                } else {
                    (0..COMPARED).for_each(|_| search.compare());
                }
            }
        }
        true
    }

    /// What is known of vehicle and air, without what is not finite; and the energy of the last step.
    fn see(&self, state: &mut Flight, input: &MissionInput, dt: f32) -> Seen {
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
        let tail = input.orientation.i();
        // Airspeed along the nose, of the estimated wind.
        let known = (input.wind - input.velocity).dot(tail);
        let gust = gust_from_behind(state.activity, input.airspeed, known);
        if is_within(input.wind, MAX_SPEED) {
            let part = if state.begun {
                dt / (WIND_TIME + dt)
            } else {
                1.0
            };
            let Ned { north, east, .. } = input.wind;
            state.wind.north += (north - tail.north * gust - state.wind.north) * part;
            state.wind.east += (east - tail.east * gust - state.wind.east) * part;
        }
        if !state.begun {
            state.begun = true;
            state.home = state.position;
            state.before = state.position;
            state.speed = self.p.cruise_speed;
        }
        let (u, thrust) = (0.5 * (known - gust), math::max(input.thrust, 0.0));
        let induced = math::sqrt((u * u + thrust * self.induced).abs());
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

    /// Does what the table says about `troubles`; whether that is something else than before.
    fn respond(&self, state: &mut Flight, seen: &Seen, troubles: Troubles) -> bool {
        if troubles.is_empty() && state.forced == Response::Continue {
            return false;
        }
        let asked = self.rules.to(troubles);
        let kept = if state.forced > Response::Loiter {
            state.forced
        } else {
            Response::Continue
        };
        let forced = if asked > kept { asked } else { kept };
        if forced == state.forced {
            return false;
        }
        state.forced = forced;
        state.lull = 0.0;
        if !state.is_airborne() {
            return true;
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
                    self.hover_at(state, place);
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
        true
    }

    /// Begins an item.
    fn begin(&self, state: &mut Flight, mission: &Mission, seen: &Seen, out: &mut MissionOutput) {
        state.item_begun = true;
        state.time = 0.0;
        state.there = 0.0;
        state.corner = false;
        state.lull = 0.0;
        state.preparing = Preparing::After;
        let number = usize::from(state.item);
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
            state.set_point = SetPointState::default();
            state.target = seen.position;
            state.enter(Activity::Hovering);
            out.gate = Gate::Open;
            out.reference.velocity = seen.velocity;
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
                    self.spiral(state, down, Until::Turns(0.0));
                } else {
                    let place = Ned {
                        down,
                        ..state.target
                    };
                    self.hover_at(state, place);
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
                (state.target, state.radius) = (centre, radius);
                state.lay(Destination::Circle(centre, radius));
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
    fn look_ahead(&self, state: &mut Flight, mission: &Mission) {
        let Ahead {
            next,
            from,
            speed,
            sum: [way, time],
        } = &mut state.ahead;
        let Some(item) = mission.items().get(*next as usize) else {
            state.after = [*way, *time];
            state.preparing = Preparing::Nothing;
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
    fn turn_radius(&self, state: &Flight) -> f32 {
        let speed = math::max(state.speed, self.ability.least_speed());
        let ground = speed + level(state.wind);
        ground * ground / self.ability.turn_of_paths(speed, self.tan_bank)
    }

    /// Way in which hover is reached from a speed [m/s].
    fn braking_way(&self, speed: f32) -> f32 {
        let square = speed * speed;
        square / (2.0 * deceleration(square, self.p.braking, self.p.braking_climb))
    }

    /// Place and course from which a path goes on: at the end of the path flown, if less than `most` \[s\] of it is left, or on it, if it is near; in
    /// hover towards the target, and there into the wind. And what is left of the path flown before that.
    fn departure(&self, state: &Flight, seen: &Seen, most: f32) -> (Pose, Option<Segment>) {
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
        let nearest = state.follow.path.nearest(seen.position);
        if nearest.right.abs() < ASTRAY {
            let here = Pose {
                place: place - right_of(nearest.along) * nearest.right,
                course: towards(nearest.along),
            };
            let most = most * level(seen.velocity);
            let rest = state.follow.path.rest(here, nearest.way, most);
            (rest.map_or(here, |_| state.follow.path.end()), rest)
        } else {
            let course = towards(seen.velocity);
            (Pose { place, course }, None)
        }
    }

    /// Begins a path to a destination, with the radius of turns; without one to a circle of that radius.
    fn depart(&self, state: &mut Flight, seen: &Seen, to: Option<Destination>, dt: f32) {
        // More than what is left when the next path is looked for.
        let most = 1.5 * (state.follow.lead() + LAYING * dt);
        let (pose, rest) = self.departure(state, seen, most);
        let radius = self.turn_radius(state);
        let to = to.unwrap_or_else(|| {
            let centre = pose.place + right_of(along(pose.course)) * radius;
            let down = state.target.down;
            (state.target, state.radius) = (Ned { down, ..centre }, radius);
            Destination::Circle(centre, radius)
        });
        let radius = match to {
            // No wider than the circle: else nothing inside it leads onto it.
            Destination::Circle(_, circle) => math::min(radius, circle.abs()),
            _ => radius,
        };
        state.preparing = Preparing::Ways(Search::new(pose, to, radius), rest);
    }

    /// Flies the path that has been laid.
    fn fly(&self, state: &mut Flight, seen: &Seen) {
        let speed = math::max(state.speed, self.ability.least_speed());
        if state.activity != Activity::Flying {
            state.follow.begin(speed, seen);
            state.height = HeightReference::at(seen.position, seen.velocity);
            state.enter(Activity::Flying);
        }
        let tightest = state.follow.path.tightest();
        state.follow.banking = self.ability.banking(speed, speed * speed * tightest);
        state.preparing = Preparing::After;
    }

    /// Whether the wing carries it now.
    fn is_on_wing(&self, state: &Flight, seen: &Seen) -> bool {
        state.activity == Activity::Flying
            || level(seen.velocity - seen.wind) >= self.ability.least_speed()
    }

    /// Whether a place at this distance \[m\] is flown to on the wing, and passed or else stopped at.
    fn is_far(&self, state: &Flight, seen: &Seen, distance: f32, passed: bool) -> bool {
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
    fn is_too_windy(&self, state: &Flight) -> bool {
        let most = match state.task {
            Task::TakeOff | Task::Land(_) => self.ability.landing_wind,
            Task::Hover(_) => self.ability.hover_wind,
            _ if state.activity == Activity::Hovering => self.ability.hover_wind,
            _ => return false,
        };
        blows(state, most)
    }

    /// Whether it sinks in this wind to land. Who must land does.
    fn sinks(&self, state: &Flight) -> bool {
        state.forced == Response::Land || !self.is_too_windy(state)
    }

    /// Whether it is driven off in this wind, where it hovers. Who must land takes that.
    fn is_driven_off(&self, state: &Flight) -> bool {
        state.forced != Response::Land && blows(state, self.ability.hover_wind)
    }

    /// Whether it stays on the wing until there is less wind.
    fn waits(&self, state: &mut Flight) -> bool {
        let waits = self.is_driven_off(state);
        state.lull = if waits {
            LULL * self.ability.hover_wind
        } else {
            0.0
        };
        waits
    }

    /// Leaves a hover or a landing before it is driven off, down to the height of the flare; and goes back to it when there is less wind.
    /// Whether it does either.
    fn heed_wind(&self, state: &mut Flight, seen: &Seen) -> bool {
        if state.lull > 0.0 {
            if blows(state, state.lull) {
                return false;
            }
            state.lull = 0.0;
            match state.forced {
                Response::Continue => state.item_begun = false,
                Response::Return => self.go_home(state, seen),
                _ => {}
            }
            return true;
        }
        let leaves = match (state.activity, state.task) {
            _ if state.is_laying() => false,
            (Activity::Hovering, _) => true,
            (Activity::Descending, Task::Land(ground)) => {
                ground - seen.position.down > self.p.flare_height
            }
            _ => false,
        };
        if !leaves || !self.is_driven_off(state) {
            return false;
        }
        if state.task == Task::Pass {
            state.item_begun = false;
        } else {
            self.hover_at(state, state.target);
        }
        true
    }

    /// To a place in hover; in too much wind a circle that begins here.
    fn hover_at(&self, state: &mut Flight, place: Ned) {
        if self.waits(state) {
            let until = match state.task {
                Task::Hover(time) => Until::Time(time),
                _ => Until::Forever,
            };
            let down = math::min(place.down, state.home.down - self.p.safe_height);
            self.spiral(state, down, until);
            return;
        }
        if state.activity != Activity::Hovering {
            state.set_point = SetPointState::default();
        }
        state.target = place;
        state.preparing = Preparing::After;
        state.enter(Activity::Hovering);
    }

    /// To the target, to be stopped at.
    fn go_to_place(&self, state: &mut Flight, seen: &Seen) {
        let target = state.target;
        if self.is_far(state, seen, level(target - seen.position), false) {
            state.lay(Destination::Place(target));
        } else {
            self.hover_at(state, target);
        }
    }

    /// Past the target, by or over it, with a place after it or none.
    fn go_past(&self, state: &mut Flight, seen: &Seen, pass: Pass, next: Option<Ned>) {
        let place = state.target;
        let on_wing = state.speed >= self.ability.least_speed();
        let near = level(place - seen.position);
        let flies = self.is_on_wing(state, seen) || self.is_far(state, seen, near, true);
        let hovers = !(on_wing && flies);
        if hovers && !self.waits(state) {
            self.hover_at(state, place);
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
                    Destination::Pose(rounded.unwrap_or(longer))
                } else {
                    Destination::Pose(longer)
                }
            }
            (Some((along, _)), None) | (None, Some((along, _))) => Destination::Pose(over(along)),
            (None, None) => Destination::Place(place),
        };
        state.lay(to);
    }

    /// Round to the right, beginning here, until the position is `down` \[m\].
    fn spiral(&self, state: &mut Flight, down: f32, until: Until) {
        state.task = Task::Circle(until);
        state.target.down = down;
        state.preparing = Preparing::Departure(None);
    }

    /// Waits where it is.
    fn wait(&self, state: &mut Flight, seen: &Seen) {
        if state.activity == Activity::Flying {
            let down = state.height.down;
            self.spiral(state, down, Until::Forever);
        } else {
            state.task = Task::Wait;
            let place = if state.activity == Activity::Hovering && state.active > 0.0 {
                state.target
            } else {
                seen.position
            };
            self.hover_at(state, place);
        }
    }

    /// Where it can stop: ahead.
    fn stopping_place(&self, state: &Flight, seen: &Seen) -> Ned {
        match state.activity {
            Activity::Flying => {
                let speed = level(seen.velocity);
                let time = self.braking_way(speed) / math::max(speed, 1.0);
                let Ned { north, east, .. } = seen.velocity * time;
                seen.position + Ned::new(north, east, 0.0)
            }
            Activity::Hovering => state.target,
            _ => seen.position,
        }
    }

    fn go_home(&self, state: &mut Flight, seen: &Seen) {
        let down = math::min(seen.position.down, state.home.down - self.p.safe_height);
        let place = Ned { down, ..state.home };
        self.land_at(state, seen, place, state.home.down);
    }

    /// Over `place` at its height, or at flare height, and down to `ground` \[m\].
    fn land_at(&self, state: &mut Flight, seen: &Seen, place: Ned, ground: f32) {
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

    fn grounded(
        &self,
        state: &mut Flight,
        (armed, orientation): (bool, &Orientation),
        out: &mut MissionOutput,
    ) {
        if state.task != Task::TakeOff || state.forced != Response::Continue {
            return;
        }
        if !armed {
            out.remark = Some(Remark::NotArmed);
        } else if !is_upright(orientation) {
            out.remark = Some(Remark::NoLiftOff);
        } else if !self.is_too_windy(state) {
            state.enter(Activity::Spooling);
        }
    }

    /// Until it is off the ground, whatever the wind comes to: without thrust it falls over where the wing has begun to lean.
    fn spooling(
        &self,
        state: &mut Flight,
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
            state.set_point = SetPointState::default();
            state.enter(Activity::Rising);
        } else if !armed || state.forced != Response::Continue {
            state.enter(Activity::Grounded);
        } else if state.active > MOST_THRUST * self.p.spool_time + PATIENCE
            || !is_upright(orientation)
        {
            out.remark = Some(Remark::NoLiftOff);
            state.task = Task::Wait;
            state.enter(Activity::Grounded);
        }
    }

    /// To the target and there, by its position.
    fn hovering(
        &self,
        state: &mut Flight,
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
        // From place to place in hover it brakes level.
        let climbs = self.p.braking_climb > 0.0
            && (state.set_point.is_climbing() || self.is_on_wing(state, seen));
        let preferences = Preferences {
            speed: if climbs {
                FASTEST
            } else {
                math::max(slow, level(seen.velocity))
            },
            climb: if offset.down > 0.0 {
                self.p.climb
            } else {
                self.p.sink
            },
            acceleration: self.p.braking,
            braking_climb: if climbs { self.p.braking_climb } else { 0.0 },
            planner_options: PlannerOptions::default(),
        };
        let goal = Goal::Hover(state.target);
        // Within their bounds: so are the parameters.
        let goals = Goals::of(preferences);
        let GoalOutput {
            reference,
            position_error,
            ..
        } = goals.advance(
            &mut state.set_point,
            &goal,
            seen.position,
            seen.velocity,
            dt,
        );
        out.reference = reference;
        out.position_error = position_error;
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
                if near && state.there >= time && state.set_point.is_reached() {
                    state.done(state.target);
                }
            }
            Task::Land(_)
                if near
                    && state.set_point.is_reached()
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
    fn flying(&self, state: &mut Flight, seen: &Seen, dt: f32, out: &mut MissionOutput) {
        let speed = math::max(state.speed, self.ability.least_speed());
        let [drag, slope] = self.ability.slopes(state.follow.airspeed);
        let slowing = self.ability.gravity() * drag;
        let followed = state.follow.step(&self.p, slowing, seen, speed, dt);
        let airspeed = state.follow.airspeed;
        let ground = math::max(followed.ground, 1.0);
        let left = state.follow.path.left();
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
        self.next_of_flight(state, seen, ground, dt, out);
    }

    /// Whether the flight is at the end of its task.
    fn next_of_flight(
        &self,
        state: &mut Flight,
        seen: &Seen,
        ground: f32,
        dt: f32,
        out: &mut MissionOutput,
    ) {
        let at_height = (state.target.down - seen.position.down).abs() < NEAR;
        match state.task {
            Task::Pass
                if out.progress.time_to_go < state.follow.lead() + LAYING * dt
                    && state.follow.path.is_final() =>
            {
                if at_height {
                    state.done(state.target);
                } else {
                    let down = state.target.down;
                    self.spiral(state, down, Until::Turns(0.0));
                }
            }
            Task::Hover(_) | Task::Land(_) => {
                let Ned { north, east, .. } = seen.velocity;
                let square = north * north + east * east;
                let braking = deceleration(square, self.p.braking, self.p.braking_climb);
                if 2.0 * braking * out.progress.distance_to_go < square {
                    state.preparing = Preparing::Hover;
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
                        left * round / ground
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
        state: &mut Flight,
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
    fn touched(&self, state: &mut Flight, out: &mut MissionOutput) {
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

/// Whether there is more wind than this [m/s]: by squares, in which a step asks three times.
fn blows(state: &Flight, most: f32) -> bool {
    let Ned { north, east, .. } = state.wind;
    north * north + east * east > most * most
}

/// Whether the nose is up.
fn is_upright(orientation: &Orientation) -> bool {
    orientation.i().down > UPRIGHT
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
                out = *self
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

    /// Wind that grows with the thrust does not cut it: nearly weightless and leaning it would fall over.
    #[test]
    fn a_take_off_that_has_begun_goes_on() {
        let items = [Item::TakeOff { height: 10.0 }, Item::Return];
        let mut point = Point::new(&items, Responses::default());
        let most = point.missions.ability.landing_wind;
        point.until(most - 0.05, Troubles::empty(), |out, _| {
            out.activity == Activity::Spooling
        });
        let out = point.until(GALE, Troubles::empty(), |out, _| {
            out.activity != Activity::Spooling
        });
        assert!(out.activity == Activity::Rising && says_so(&out), "{out:?}");
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

    /// To hover from 22 m/s, for a vehicle that does not hold its wing across the air: in a climb of 41 m, and down to the place; and level where a metre less is
    /// allowed than that takes, and for one that does.
    #[test]
    fn who_cannot_brake_level_brakes_in_a_climb() {
        let hover = Item::Waypoint {
            place: Ned::new(400.0, 0.0, -40.0),
            pass: Pass::Hover(1.0),
        };
        let most_over = |braking_climb: f32| {
            let items = [Item::TakeOff { height: 40.0 }, hover, Item::Return];
            let mut point = Point::new(&items, Responses::default());
            assert_eq!(point.missions.p.braking_climb, 0.0);
            point.missions.p.braking_climb = braking_climb;
            let highest = core::cell::Cell::new(0.0f32);
            let out = point.until(0.0, Troubles::empty(), |out, at| {
                highest.set(highest.get().max(-at.down));
                out.progress.item == 2
            });
            assert!((point.position.down + 40.0).abs() < 2.0, "{out:?}");
            highest.get() - 40.0
        };
        assert!((most_over(100.0) - 0.085 * 22.0 * 22.0).abs() < 2.0);
        assert!(most_over(40.0) < 1.0 && most_over(0.0) < 1.0);
        let wing = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        let turned = VehicleParameters::PAPER.wing_moment(0.85).authority(26.0);
        let p = MissionParameters::cruising_at(22.0);
        let climb = |vehicle: VehicleParameters, p: &MissionParameters| {
            let vehicle = Vehicle::new(vehicle, wing).unwrap();
            let missions = Missions::new(&vehicle, p, Responses::default());
            missions.unwrap().p.braking_climb
        };
        assert_eq!(climb(turned, &p), p.braking_climb);
        assert_eq!(climb(turned, &p.braking_climb(0.0)), 0.0);
        assert_eq!(climb(turned.authority(260.0), &p), 0.0);
    }

    /// While a path is laid what was asked for goes on, for no more steps than the lead of the next path counts on: no step in velocity, and in the
    /// air thrust from the first step on.
    #[test]
    fn a_path_is_laid_while_it_flies_on() {
        let by = |north, east| Item::Waypoint {
            place: Ned::new(north, east, 0.0),
            pass: Pass::By,
        };
        let items = [by(300.0, 0.0), by(500.0, 300.0), by(300.0, 500.0)];
        let mut point = Point::new(&items, Responses::default());
        // 22 m/s against the wind.
        point.velocity = Ned::new(19.0, 0.0, 0.0);
        let (mut last, mut held, mut laid) = (point.velocity, 0, 0);
        for _ in 0..4000 {
            let out = point.until(3.0, Troubles::empty(), |_, _| true);
            assert_eq!(out.gate, Gate::Open);
            // 5 m/s² for the steps that it is held, half as much again.
            let change = out.reference.velocity - last;
            let most = 1.5 * 5.0 * DT * (1.0 + LAYING);
            assert!(is_within(change, most), "{change:?} {out:?}");
            last = out.reference.velocity;
            held = point.state.flight.steps_held;
            laid = laid.max(held);
        }
        assert_eq!((f32::from(laid), held), (LAYING, 0));
    }

    /// An airspeed that a gust from behind has taken is asked for again, on a path. A tube that tells nothing changes nothing, and none does in hover.
    #[test]
    fn an_airspeed_that_is_lost_is_asked_for_again() {
        let north = |airspeed: Option<f32>, speed: f32| {
            let place = Ned::new(900.0, 0.0, 0.0);
            let pass = Pass::By;
            let items = [Item::Speed(speed), Item::Waypoint { place, pass }];
            let mut point = Point::new(&items, Responses::default());
            let (nose, belly) = (Ned::new(1.0, 0.0, 0.0), Ned::new(0.0, 0.0, 1.0));
            let mut told = MissionInput::default()
                .position(Ned::ZERO)
                .velocity(Ned::new(speed, 0.0, 0.0))
                .wind(Ned::new(-3.0, 0.0, 0.0))
                .airspeed(airspeed)
                .orientation(Orientation::from_directions(nose, belly).unwrap());
            let mut out = MissionOutput::default();
            for n in 1..1000 {
                out = *(point.missions).step(&mut point.state, &point.mission, &told, DT);
                told.position = Some(Ned::new(DT * speed * n as f32, 0.0, 0.0));
            }
            out.reference.velocity.north
        };
        // 22 m/s over ground in 3 m/s from ahead are 25 m/s; 22 are asked for.
        for nothing in [None, Some(f32::NAN), Some(0.0), Some(25.0)] {
            assert!((north(nothing, 22.0) - 19.5).abs() < 0.1, "{nothing:?}");
        }
        assert!((north(Some(18.0), 22.0) - 26.0).abs() < 0.1);
        assert_eq!(north(Some(5.0), 4.0), north(None, 4.0));
    }

    /// What fails and is good again in every step does not keep it from asking.
    #[test]
    fn who_decides_otherwise_all_the_time_is_not_heeded() {
        let responses = Responses::default().link(Response::Loiter);
        let place = Ned::new(900.0, 0.0, 0.0);
        let items = [Item::Waypoint {
            place,
            pass: Pass::By,
        }];
        let mut point = Point::new(&items, responses);
        point.velocity = Ned::new(22.0, 0.0, 0.0);
        let mut asked = 0;
        for n in 0..200 {
            let trouble = [Troubles::LINK, Troubles::empty()][n % 2];
            point.until(0.0, trouble, |_, _| true);
            asked += usize::from(point.state.flight.steps_held == 0);
        }
        assert!(asked >= 200 / (usize::from(MOST_HELD) + 1), "{asked}");
    }

    /// Who begins in the air, in more wind than it hovers in, is on its way as soon as its path is laid.
    #[test]
    fn a_flight_that_begins_in_wind_is_on_its_way() {
        let place = Ned::new(900.0, 0.0, 0.0);
        let items = [Item::Waypoint {
            place,
            pass: Pass::By,
        }];
        let mut point = Point::new(&items, Responses::default());
        point.missions.ability.hover_wind = STRONG - 1.0;
        point.velocity = Ned::new(22.0 - STRONG, 0.0, 0.0);
        let out = point.until(STRONG, Troubles::empty(), |out, _| {
            out.progress.time > DT * (LAYING + 1.0)
        });
        assert_eq!(out.activity, Activity::Flying);
    }

    /// Who lies on the ground gives no thrust, whether it has lain there before or falls over while its thrust grows.
    #[test]
    fn who_has_fallen_over_does_not_take_off() {
        let items = [Item::TakeOff { height: 10.0 }];
        let mut point = Point::new(&items, Responses::default());
        let up = Ned::new(0.0, 0.0, -1.0);
        let lying = Orientation::from_directions(Ned::new(1.0, 0.0, 0.0), up).unwrap();
        let mut told = MissionInput::default().position(Ned::ZERO).armed(true);
        let mut step = |told: &MissionInput| {
            let Point {
                missions,
                mission,
                state,
                ..
            } = &mut point;
            *missions.step(state, mission, told, DT)
        };
        for _ in 0..10 {
            step(&told);
        }
        assert!(matches!(step(&told).gate, Gate::AtMost(most) if most > 0.0));
        told.orientation = lying;
        step(&told);
        for _ in 0..100 {
            let out = step(&told);
            assert_eq!((out.gate, out.activity), (Gate::Off, Activity::Grounded));
        }
    }
}
