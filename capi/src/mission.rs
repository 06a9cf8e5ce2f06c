//! Missions: items that are flown from take-off to landing by `alula_guide`'s guidance.

use alula::guidance::Mode;
use alula::mission::{
    Activity, CAPACITY, Gate, Item, ItemProblem, Mission as CoreMission, MissionError,
    MissionInput, MissionOutput, MissionParameters, MissionState, Missions, Pass, Remark, Response,
    Responses, Troubles, Until,
};
use alula::ned::{BodyAxes, Ned, Quaternion};
use alula::spatial::{self, Orientation};
use alula::{GuidanceOutput, ParameterError, Parameters as _};

use crate::boundary::{self, Layout};
use crate::code;
use crate::command::Command;
use crate::controller::{Controller, Initialised, initialised as controller, initialised_mut};
use crate::guide::of_guidance;
use crate::input::{Input, ned};
use crate::parameters::MISSION_FIRST;
use crate::report::Report;

/// Most items of a mission.
pub const ALULA_MISSION_ITEMS: u32 = 128;
const _: () = assert!(ALULA_MISSION_ITEMS as usize == CAPACITY);

/// Item: straight up from where it stands, to the height `value` \[m\] over that. The first item, or the one after a landing.
pub const ALULA_ITEM_TAKE_OFF: u32 = 1;
/// Item: past `place` by it: an arc rounds the corner.
pub const ALULA_ITEM_BY: u32 = 2;
/// Item: over `place`, on the course of the longer of its two legs.
pub const ALULA_ITEM_OVER: u32 = 3;
/// Item: to a stop at `place`, for the time `value` \[s\].
pub const ALULA_ITEM_HOVER: u32 = 4;
/// Item: round `place` with `radius`, for ever.
pub const ALULA_ITEM_LOITER: u32 = 5;
/// Item: round `place` with `radius`, `value` turns.
pub const ALULA_ITEM_LOITER_TURNS: u32 = 6;
/// Item: round `place` with `radius`, for the time `value` \[s\].
pub const ALULA_ITEM_LOITER_TIME: u32 = 7;
/// Item: the airspeed `value` [m/s] from here on. Below the least of the wing it is a speed over ground, in hover.
pub const ALULA_ITEM_SPEED: u32 = 8;
/// Item: to the position down of `place`, where the vehicle is.
pub const ALULA_ITEM_ALTITUDE: u32 = 9;
/// Item: a landing where the vehicle is.
pub const ALULA_ITEM_LAND: u32 = 10;
/// Item: a landing at `place`, whose position down is the ground's.
pub const ALULA_ITEM_LAND_AT: u32 = 11;
/// Item: back to where it took off, and a landing there.
pub const ALULA_ITEM_RETURN: u32 = 12;

/// Response: the mission goes on.
pub const ALULA_RESPONSE_CONTINUE: u32 = 0;
/// Response: a circle on the wing, a stop in hover, for as long as it lasts.
pub const ALULA_RESPONSE_LOITER: u32 = 1;
/// Response: back to where it took off, and a landing there. It is kept to.
pub const ALULA_RESPONSE_RETURN: u32 = 2;
/// Response: a landing where the vehicle is. It is kept to.
pub const ALULA_RESPONSE_LAND: u32 = 3;

/// Flag of a mission: the link to whoever flies is lost.
pub const ALULA_TROUBLE_LINK: u32 = 1;
/// Flag of a mission: nothing is known of the air.
pub const ALULA_TROUBLE_AIR: u32 = 1 << 1;
/// Flag of a mission: nothing is known of the position, and `position` is not read.
pub const ALULA_TROUBLE_POSITION: u32 = 1 << 2;
/// Flag of a mission: the battery is low.
pub const ALULA_TROUBLE_BATTERY: u32 = 1 << 3;
/// In `troubles`: the vehicle has been far from the path for 5 s.
pub const ALULA_TROUBLE_FOLLOW: u32 = 1 << 4;
/// Flag of a mission: stop. On the ground no take-off, in a landing a go-around, else a loiter, until it is taken back.
pub const ALULA_TROUBLE_ABORT: u32 = 1 << 5;
/// Flag of a mission: the vehicle may take off.
pub const ALULA_ARMED: u32 = 1 << 8;

/// Activity: on the ground, without thrust.
pub const ALULA_ACTIVITY_GROUNDED: u32 = 0;
/// Activity: the thrust grows until it lifts off.
pub const ALULA_ACTIVITY_SPOOLING: u32 = 1;
/// Activity: straight up.
pub const ALULA_ACTIVITY_RISING: u32 = 2;
/// Activity: a path at an airspeed.
pub const ALULA_ACTIVITY_FLYING: u32 = 3;
/// Activity: to a place and there, by its position.
pub const ALULA_ACTIVITY_HOVERING: u32 = 4;
/// Activity: straight down, until it touches the ground.
pub const ALULA_ACTIVITY_DESCENDING: u32 = 5;
/// Activity: it has touched the ground: the thrust goes off.
pub const ALULA_ACTIVITY_TOUCHED: u32 = 6;

/// Remark: none.
pub const ALULA_REMARK_NONE: u32 = 0;
/// Remark: the wind is stronger than the airspeed: the nose is held into it, and it drifts.
pub const ALULA_REMARK_DRIFTING: u32 = 1;
/// Remark: the way is steeper than the wing climbs or glides: what is left is flown in a spiral at its end.
pub const ALULA_REMARK_STEEP: u32 = 2;
/// Remark: the turn does not fit between the neighbours: the waypoint is passed over.
pub const ALULA_REMARK_TIGHT_CORNER: u32 = 3;
/// Remark: it has not lifted off with the most thrust of a take-off, or does not stand on its tail.
pub const ALULA_REMARK_NO_LIFT_OFF: u32 = 4;
/// Remark: the vehicle does not follow.
pub const ALULA_REMARK_NOT_FOLLOWING: u32 = 5;
/// Remark: it is not armed.
pub const ALULA_REMARK_NOT_ARMED: u32 = 6;
/// Remark: the landing waits until the vehicle is over its place.
pub const ALULA_REMARK_NOT_OVER_PLACE: u32 = 7;
/// Remark: there is more wind than the vehicle hovers, lands or takes off in: it waits, or circles on the wing.
pub const ALULA_REMARK_TOO_WINDY: u32 = 8;

// The core's numbers are these.
const _: () = {
    assert!(Response::Continue as u32 == ALULA_RESPONSE_CONTINUE);
    assert!(Response::Loiter as u32 == ALULA_RESPONSE_LOITER);
    assert!(Response::Return as u32 == ALULA_RESPONSE_RETURN);
    assert!(Response::Land as u32 == ALULA_RESPONSE_LAND);
    assert!(Troubles::LINK.bits() as u32 == ALULA_TROUBLE_LINK);
    assert!(Troubles::AIR.bits() as u32 == ALULA_TROUBLE_AIR);
    assert!(Troubles::POSITION.bits() as u32 == ALULA_TROUBLE_POSITION);
    assert!(Troubles::BATTERY.bits() as u32 == ALULA_TROUBLE_BATTERY);
    assert!(Troubles::FOLLOW.bits() as u32 == ALULA_TROUBLE_FOLLOW);
    assert!(Troubles::ABORT.bits() as u32 == ALULA_TROUBLE_ABORT);
    assert!((Troubles::all().bits() as u32) < ALULA_ARMED);
    assert!(1 + Remark::Drifting as u32 == ALULA_REMARK_DRIFTING);
    assert!(1 + Remark::Steep as u32 == ALULA_REMARK_STEEP);
    assert!(1 + Remark::TightCorner as u32 == ALULA_REMARK_TIGHT_CORNER);
    assert!(1 + Remark::NoLiftOff as u32 == ALULA_REMARK_NO_LIFT_OFF);
    assert!(1 + Remark::NotFollowing as u32 == ALULA_REMARK_NOT_FOLLOWING);
    assert!(1 + Remark::NotArmed as u32 == ALULA_REMARK_NOT_ARMED);
    assert!(1 + Remark::NotOverPlace as u32 == ALULA_REMARK_NOT_OVER_PLACE);
    assert!(1 + Remark::TooWindy as u32 == ALULA_REMARK_TOO_WINDY);
    assert!(Activity::Grounded as u32 == ALULA_ACTIVITY_GROUNDED);
    assert!(Activity::Spooling as u32 == ALULA_ACTIVITY_SPOOLING);
    assert!(Activity::Rising as u32 == ALULA_ACTIVITY_RISING);
    assert!(Activity::Flying as u32 == ALULA_ACTIVITY_FLYING);
    assert!(Activity::Hovering as u32 == ALULA_ACTIVITY_HOVERING);
    assert!(Activity::Descending as u32 == ALULA_ACTIVITY_DESCENDING);
    assert!(Activity::Touched as u32 == ALULA_ACTIVITY_TOUCHED);
};

/// One item of a mission. What an item does not use is not read.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct MissionItem {
    /// `ALULA_ITEM_…`.
    pub kind: u32,
    /// Position \[m\]: north, east, down, in the world of the mission's `position`.
    pub place: [f32; 3],
    /// Radius of a loiter \[m\], to the right; negative to the left.
    pub radius: f32,
    /// Height of a take-off \[m\], time of a hover or loiter \[s\], turns of a loiter, speed [m/s].
    pub value: f32,
}

impl MissionItem {
    /// The core's item.
    fn core(&self) -> Result<Item, i32> {
        let &Self { radius, value, .. } = self;
        let place = ned(self.place);
        let waypoint = |pass| Item::Waypoint { place, pass };
        let loiter = |until| Item::Loiter {
            centre: place,
            radius,
            until,
        };
        Ok(match self.kind {
            ALULA_ITEM_TAKE_OFF => Item::TakeOff { height: value },
            ALULA_ITEM_BY => waypoint(Pass::By),
            ALULA_ITEM_OVER => waypoint(Pass::Over),
            ALULA_ITEM_HOVER => waypoint(Pass::Hover(value)),
            ALULA_ITEM_LOITER => loiter(Until::Forever),
            ALULA_ITEM_LOITER_TURNS => loiter(Until::Turns(value)),
            ALULA_ITEM_LOITER_TIME => loiter(Until::Time(value)),
            ALULA_ITEM_SPEED => Item::Speed(value),
            ALULA_ITEM_ALTITUDE => Item::Altitude { down: place.down },
            ALULA_ITEM_LAND => Item::Land { place: None },
            ALULA_ITEM_LAND_AT => Item::Land { place: Some(place) },
            ALULA_ITEM_RETURN => Item::Return,
            _ => return Err(code::ALULA_ERROR_ITEM_KIND),
        })
    }
}

/// How missions are flown, and what is done when something fails. `alula_mission_default` fills in the defaults.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct MissionSetup {
    /// `ALULA_HEADER(alula_mission_setup)`.
    pub header: u32,
    /// `cruise_speed` has no default and must be set.
    pub parameters: MissionParameters,
    /// `ALULA_RESPONSE_…` to a lost link. Of several troubles the gravest response is done.
    pub link: u32,
    /// To unknown air.
    pub air: u32,
    /// To an unknown position: it is reckoned from the velocity.
    pub position: u32,
    /// To a low battery.
    pub battery: u32,
    /// To a vehicle that does not follow.
    pub follow: u32,
}

impl MissionSetup {
    /// The defaults; NaN where there is none. Whatever fails, the mission goes on.
    pub const DEFAULT: Self = Self {
        header: Self::HEADER,
        parameters: MissionParameters::DEFAULT,
        link: ALULA_RESPONSE_CONTINUE,
        air: ALULA_RESPONSE_CONTINUE,
        position: ALULA_RESPONSE_CONTINUE,
        battery: ALULA_RESPONSE_CONTINUE,
        follow: ALULA_RESPONSE_CONTINUE,
    };

    /// The responses, and the parameters, each of which is in its range.
    fn checked(&self) -> Result<(MissionParameters, Responses), i32> {
        self.parameters.check().map_err(refused)?;
        let response = |number| match number {
            ALULA_RESPONSE_CONTINUE => Ok(Response::Continue),
            ALULA_RESPONSE_LOITER => Ok(Response::Loiter),
            ALULA_RESPONSE_RETURN => Ok(Response::Return),
            ALULA_RESPONSE_LAND => Ok(Response::Land),
            _ => Err(code::ALULA_ERROR_SELECTOR),
        };
        let responses = Responses::default()
            .link(response(self.link)?)
            .air(response(self.air)?)
            .position(response(self.position)?)
            .battery(response(self.battery)?)
            .follow(response(self.follow)?);
        Ok((self.parameters, responses))
    }
}

// SAFETY: `repr(C)`, its first word is the header, and it holds nothing but u32 and f32.
unsafe impl Layout for MissionSetup {}

/// A mission in flight: what it is told, what it says, and opaque memory. Set `header`, then call `alula_mission_init`.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct Mission {
    /// `ALULA_HEADER(alula_mission)` before `alula_mission_init`.
    pub header: u32,
    /// Told: sum of `ALULA_ARMED` and `ALULA_TROUBLE_…`.
    pub flags: u32,
    /// Told: position \[m\]: north, east, down.
    pub position: [f32; 3],
    /// Result: item, counted from 0; the number of items when all are done.
    pub item: u32,
    /// Result: `ALULA_ACTIVITY_…`.
    pub activity: u32,
    /// Result: `ALULA_REMARK_…`, what cannot be done as asked.
    pub remark: u32,
    /// Result: `ALULA_TROUBLE_…`, of what is told and of what it finds itself.
    pub troubles: u32,
    /// Result: `ALULA_RESPONSE_…` that is done.
    pub response: u32,
    /// Result: time since the item began \[s\].
    pub time: f32,
    /// Result: way to the end of the item \[m\].
    pub distance_to_go: f32,
    /// Result: time to the end of the item \[s\].
    pub time_to_go: f32,
    /// Result: way of the items after it, legs alone \[m\].
    pub distance_after: f32,
    /// Result: time of the items after it \[s\].
    pub time_after: f32,
    /// Result: energy that the propellers have given the air, by momentum theory \[J\].
    pub energy: f32,
    /// Result: how far the vehicle is to the right of its path \[m\].
    pub right: f32,
    /// Result: airspeed asked for [m/s]; 0 in hover.
    pub airspeed: f32,
    /// Result: thrust of steady flight at this airspeed, turn and climb \[N\]; the weight in hover, 0 on the ground.
    pub steady_thrust: f32,
    /// Private.
    pub reserved: u32,
    /// Private.
    pub opaque: [u64; 560],
}

// SAFETY: `repr(C)`, its first word is the header, and it holds nothing but numbers.
unsafe impl Layout for Mission {}

/// The header word of a mission that is initialised.
const INITIALISED: u32 = Mission::HEADER | 1 << 31;

/// What is private in a [`Mission`] after `alula_mission_init`.
struct Memory {
    missions: Missions,
    items: CoreMission,
    state: MissionState,
    /// Thrust commanded last \[N\].
    thrust: f32,
}

const PRIVATE: usize = core::mem::offset_of!(Mission, opaque);
const _: () = assert!(size_of::<Memory>() <= size_of::<Mission>() - PRIVATE);
const _: () = assert!(align_of::<Memory>() <= align_of::<u64>() && PRIVATE.is_multiple_of(8));

impl Mission {
    /// Memory that is ready for `alula_mission_init`.
    pub const BLANK: Self = Self {
        header: Self::HEADER,
        flags: 0,
        position: [0.0; 3],
        item: 0,
        activity: ALULA_ACTIVITY_GROUNDED,
        remark: ALULA_REMARK_NONE,
        troubles: 0,
        response: ALULA_RESPONSE_CONTINUE,
        time: 0.0,
        distance_to_go: 0.0,
        time_to_go: 0.0,
        distance_after: 0.0,
        time_after: 0.0,
        energy: 0.0,
        right: 0.0,
        airspeed: 0.0,
        steady_thrust: 0.0,
        reserved: 0,
        opaque: [0; 560],
    };

    /// What a step has said.
    fn say(&mut self, out: &MissionOutput) {
        self.item = out.progress.item.into();
        self.activity = out.activity as u32;
        let remark = out.remark.map(|remark| 1 + remark as u32);
        self.remark = remark.unwrap_or(ALULA_REMARK_NONE);
        self.troubles = out.troubles.bits().into();
        self.response = out.response as u32;
        let progress = &out.progress;
        self.time = progress.time;
        self.distance_to_go = progress.distance_to_go;
        self.time_to_go = progress.time_to_go;
        self.distance_after = progress.distance_after;
        self.time_after = progress.time_after;
        self.energy = progress.energy;
        self.right = progress.right;
        self.airspeed = progress.airspeed;
        self.steady_thrust = progress.steady_thrust;
    }

    /// What the mission is told with `input`.
    fn told(
        &self,
        input: &Input,
        orientation: Orientation,
        thrust: f32,
    ) -> Result<MissionInput, i32> {
        let troubles = u8::try_from(self.flags & !ALULA_ARMED).ok();
        let troubles = troubles.and_then(Troubles::from_bits);
        let troubles = troubles.ok_or(code::ALULA_ERROR_SELECTOR)?;
        let velocity = ned(input.velocity);
        // What is not finite is not remembered: the last wind goes on.
        const UNKNOWN: Ned = Ned::new(f32::NAN, f32::NAN, f32::NAN);
        Ok(MissionInput::default()
            .position((!troubles.contains(Troubles::POSITION)).then(|| ned(self.position)))
            .velocity(velocity)
            .wind(input.air().wind(velocity).unwrap_or(UNKNOWN))
            .airspeed(input.air().airspeed())
            .orientation(orientation)
            .thrust(thrust)
            .armed(self.flags & ALULA_ARMED != 0)
            .troubles(troubles))
    }
}

impl Initialised<'_> {
    /// The command on the ground: the safe one, with the attitude there is as its set-point.
    fn off(&self, input: &Input, axes: BodyAxes) -> Command {
        let present = Orientation::from_quaternion(&input.quaternion(), axes);
        let present = present.unwrap_or_default().to_quaternion(axes);
        self.command(
            axes,
            &spatial::Command::default(),
            &present,
            code::ALULA_STATUS_SAFE,
        )
    }

    /// What `gate` lets through of the guidance's command `value`.
    fn passed(
        &self,
        input: &Input,
        axes: BodyAxes,
        gate: Gate,
        guided: &GuidanceOutput,
        value: Command,
    ) -> Command {
        if gate == Gate::Open {
            return value;
        }
        let mut bounded = guided.command;
        (bounded.thrust, bounded.rates) = gate.pass(bounded.thrust, bounded.rates);
        match guided.mode {
            Mode::Flying => self.of_law(input, axes, &bounded, value.status),
            _ => {
                let [w, x, y, z] = value.quaternion;
                self.command(axes, &bounded, &Quaternion { w, x, y, z }, value.status)
            }
        }
    }
}

/// The code of a refused parameter of missions.
fn refused(error: ParameterError) -> i32 {
    let mut names = MissionParameters::RANGES.iter().map(|range| range.name);
    let row = names.position(|name| name == error.parameter);
    code::of_parameter(MISSION_FIRST + row.unwrap_or_default(), error.problem)
}

/// The code of a refused item.
fn of_item(error: &MissionError) -> i32 {
    match (error.problem, error.field) {
        (ItemProblem::TooMany, _) => code::ALULA_ERROR_ITEM_TOO_MANY,
        (ItemProblem::Far { .. }, _) | (ItemProblem::Range { .. }, "down") => {
            code::ALULA_ERROR_ITEM_PLACE
        }
        (ItemProblem::Range { .. }, "radius") => code::ALULA_ERROR_ITEM_RADIUS,
        (ItemProblem::Range { .. }, _) => code::ALULA_ERROR_ITEM_VALUE,
        (ItemProblem::Narrow { .. }, _) => code::ALULA_ERROR_ITEM_NARROW,
        (ItemProblem::Slow { .. }, _) => code::ALULA_ERROR_ITEM_SLOW,
        (ItemProblem::NotFirst, _) => code::ALULA_ERROR_ITEM_NOT_FIRST,
        (ItemProblem::AfterLanding, _) => code::ALULA_ERROR_ITEM_AFTER_LANDING,
        // What the header has no code of its own for.
        _ => code::ALULA_ERROR_ITEM_VALUE,
    }
}

/// Whether the mission that C points to is one, and initialised.
///
/// # Safety
/// `pointer` is null, unaligned, or points to a header word.
unsafe fn check(pointer: *const Mission) -> Result<(), i32> {
    boundary::check_pointer(pointer)?;
    // SAFETY: The pointer is neither null nor unaligned, so it points to a header word.
    match unsafe { pointer.cast::<u32>().read() } {
        INITIALISED => Ok(()),
        Mission::HEADER => Err(code::ALULA_ERROR_NOT_INITIALISED),
        _ => Err(code::ALULA_ERROR_LAYOUT),
    }
}

/// What is public and what is private of the mission that C points to.
///
/// # Safety
/// `pointer` is null, unaligned, or points to a mission that nothing else reads or changes for `'a`.
unsafe fn initialised<'a>(pointer: *mut Mission) -> Result<(&'a mut Mission, *mut Memory), i32> {
    // SAFETY: `check` finds INITIALISED, which is written by `alula_mission_init` alone, and only together with a `Memory` in
    // `opaque`, which is large enough and aligned by the assertions above.
    unsafe {
        check(pointer)?;
        let memory = (&raw mut (*pointer).opaque).cast::<Memory>();
        Ok((&mut *pointer, memory))
    }
}

/// Fills in the default of every parameter of missions; whatever fails, the mission goes on. `cruise_speed` has none, becomes NaN
/// and must be set.
///
/// # Safety
/// As `alula_input_default`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_mission_default(setup: *mut MissionSetup) -> i32 {
    // SAFETY: `setup` is as `write` asks for, by the condition above.
    unsafe { boundary::write(setup, MissionSetup::DEFAULT) }
}

/// Makes `mission` one without items, before its flight, for the vehicle of `of`, which is initialised. Returns `ALULA_OK`, or the
/// code that names the parameter refused; the mission is then not initialised.
///
/// # Safety
/// Each pointer is null or points to memory of the caller's that holds at least the header word; the whole structure
/// if that is right. No other call uses the mission meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_mission_init(
    mission: *mut Mission,
    setup: *const MissionSetup,
    of: *const Controller,
) -> i32 {
    // SAFETY: A pointer that passes its check points to the structure that its header word says, by the condition above.
    unsafe {
        match check(mission) {
            Ok(()) | Err(code::ALULA_ERROR_NOT_INITIALISED) => {}
            Err(code) => return code,
        }
        mission.write(Mission::BLANK);
        let made = boundary::read(setup).and_then(|setup| {
            let (parameters, responses) = setup.checked()?;
            let vehicle = controller(of)?.guidance.guidance().vehicle();
            Missions::new(vehicle, &parameters, responses).map_err(refused)
        });
        match made {
            Ok(missions) => {
                (&raw mut (*mission).opaque).cast::<Memory>().write(Memory {
                    missions,
                    items: CoreMission::default(),
                    state: MissionState::default(),
                    thrust: 0.0,
                });
                mission.cast::<u32>().write(INITIALISED);
                code::ALULA_OK
            }
            Err(code) => code,
        }
    }
}

/// Gives `mission` these `count` items in place of its own, and goes to the one of number `from`, counted from 0: before the flight to 0,
/// in flight to any. The items are not needed afterwards. If `refused` is not null, it is set to the item that is refused, counted from
/// 0; then the mission is as before.
///
/// # Safety
/// `mission` as in `alula_mission_init`. `items` is null or points to `count` items, `refused` is null or points to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_mission_items(
    mission: *mut Mission,
    items: *const MissionItem,
    count: u32,
    from: u32,
    refused: *mut u32,
) -> i32 {
    // SAFETY: A pointer that passes its check points to what it is to point to, by the condition above.
    unsafe {
        let memory = match initialised(mission) {
            Ok((_, memory)) => &mut *memory,
            Err(code) => return code,
        };
        if let Err(code) = boundary::check_pointer(items) {
            return code;
        }
        if !refused.is_null() && !refused.is_aligned() {
            return code::ALULA_ERROR_UNALIGNED;
        }
        let taken = count.min(ALULA_MISSION_ITEMS) as usize;
        let mut list = [Item::Return; CAPACITY];
        let given = core::slice::from_raw_parts(items, taken);
        let converted = list.iter_mut().zip(given).enumerate();
        let mut made = match count > ALULA_MISSION_ITEMS {
            true => Err((CAPACITY, code::ALULA_ERROR_ITEM_TOO_MANY)),
            false => Ok(()),
        };
        for (number, (place, item)) in converted {
            match item.core() {
                Ok(item) => *place = item,
                Err(code) => made = made.and(Err((number, code))),
            }
        }
        let list = list.get(..taken).unwrap_or(&[]);
        let made = made.and_then(|()| {
            let made = memory.missions.mission(list);
            made.map_err(|error| (error.item, of_item(&error)))
        });
        match made {
            Ok(made) => {
                memory.items = made;
                memory.state.go_to(from as usize);
                code::ALULA_OK
            }
            Err((number, code)) => {
                if !refused.is_null() {
                    refused.write(number as u32);
                }
                code
            }
        }
    }
}

/// One step of a mission and of the guidance, `dt` \[s\] after the last: in place of `alula_guide`, with the attitude, velocity and air
/// that are in `input`, and with `flags` and `position` in `mission`. References in `input` are not read. On the ground the command is
/// the safe one, and the controller is as at power-on; during spool-up the thrust is bounded. What the mission says is in its results.
/// Codes and commands are those of `alula_guide`; if the mission or its flags are at fault, there was no step, and the command is that
/// of `alula_command_default`. `report` may be null.
///
/// # Safety
/// As `alula_guide`, and no other call uses the mission meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_mission_fly(
    mission: *mut Mission,
    controller: *mut Controller,
    input: *const Input,
    dt: f32,
    command: *mut Command,
    report: *mut Report,
) -> i32 {
    // SAFETY: Every pointer that passes its check points to the structure that its header word says, by the condition above; mission,
    // controller, command and report are not the same memory.
    unsafe {
        if let Err(code) = boundary::check(command) {
            return code;
        }
        let arguments = boundary::check_optional(report).and_then(|()| {
            let (mission, memory) = initialised(mission)?;
            let controller = initialised_mut(controller)?;
            let input = boundary::read(input)?;
            let axes = input.axes()?;
            let orientation = Orientation::from_quaternion(&input.quaternion(), axes);
            let orientation = orientation.unwrap_or(Orientation::UNKNOWN);
            let told = mission.told(input, orientation, (*memory).thrust)?;
            Ok((mission, &mut *memory, controller, input, axes, told))
        });
        let (mission, memory, controller, input, axes, told) = match arguments {
            Ok(arguments) => arguments,
            Err(code) => {
                command.write(Command::SAFE);
                return code;
            }
        };
        let asked = memory
            .missions
            .step(&mut memory.state, &memory.items, &told, dt);
        mission.say(asked);
        let (code, value) = match asked.gate {
            Gate::Off => {
                controller.memory = Default::default();
                (code::ALULA_OK, controller.off(input, axes))
            }
            gate => {
                let told = asked.asked_of(input.guidance_input(axes));
                let guided = controller.update(&told, dt);
                let value = controller.guided_command(input, axes, &guided);
                if !report.is_null() {
                    report.write(Report::of_guidance(&guided));
                }
                let value = controller.passed(input, axes, gate, &guided, value);
                (of_guidance(&guided), value)
            }
        };
        memory.thrust = value.thrust;
        command.write(value);
        code
    }
}
