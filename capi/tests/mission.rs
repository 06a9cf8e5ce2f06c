//! Missions through the ABI, against the core itself.
#![cfg(not(target_os = "none"))]

use std::ptr::{null, null_mut};

use alula::guidance::Air;
use alula::mission::{
    Gate, Item, MissionInput, MissionParameters, MissionState, Missions, Pass, Response, Responses,
    Troubles, Until,
};
use alula::ned::{BodyAxes, Frd, Quaternion};
use alula::spatial::{Ned, Orientation};
use alula::{
    Combined, CombinedParameters, Guidance, GuidanceInput, GuidanceParameters, GuidanceState,
    Vehicle, VehicleParameters,
};
use alula_capi::*;

const DT: f32 = 0.02;
const PAPER: Parameters = Parameters {
    vehicle: VehicleParameters::PAPER,
    ..Parameters::DEFAULT
};
const SETUP: MissionSetup = MissionSetup {
    parameters: MissionParameters::cruising_at(20.0),
    link: ALULA_RESPONSE_RETURN,
    ..MissionSetup::DEFAULT
};

fn controller() -> Controller {
    let mut controller = Controller::BLANK;
    // SAFETY: Both are there, and no table is read.
    let code = unsafe { alula_init(&mut controller, &PAPER, null()) };
    assert_eq!(code, ALULA_OK);
    controller
}

fn init(setup: &MissionSetup) -> Result<Box<Mission>, i32> {
    let mut mission = Box::new(Mission::BLANK);
    // SAFETY: All are there.
    match unsafe { alula_mission_init(&mut *mission, setup, &controller()) } {
        ALULA_OK => Ok(mission),
        code => Err(code),
    }
}

/// Gives it the items; else the item refused, and its code.
fn items(mission: &mut Mission, items: &[MissionItem], from: u32) -> Result<(), (u32, i32)> {
    let mut refused = 99;
    let count = items.len() as u32;
    // SAFETY: The items are so many.
    match unsafe { alula_mission_items(mission, items.as_ptr(), count, from, &mut refused) } {
        ALULA_OK => Ok(()),
        code => Err((refused, code)),
    }
}

const fn item(kind: u32, place: [f32; 3], radius: f32, value: f32) -> MissionItem {
    MissionItem {
        kind,
        place,
        radius,
        value,
    }
}

const MISSION: [MissionItem; 9] = [
    item(ALULA_ITEM_TAKE_OFF, [0.0; 3], 0.0, 10.0),
    item(ALULA_ITEM_BY, [300.0, 0.0, -30.0], 0.0, 0.0),
    item(ALULA_ITEM_OVER, [300.0, 300.0, -30.0], 0.0, 0.0),
    item(ALULA_ITEM_LOITER_TURNS, [0.0, 300.0, -40.0], 120.0, 0.25),
    item(ALULA_ITEM_LOITER_TIME, [0.0, 300.0, -40.0], -120.0, 4.0),
    item(ALULA_ITEM_SPEED, [0.0; 3], 0.0, 18.0),
    item(ALULA_ITEM_ALTITUDE, [0.0, 0.0, -35.0], 0.0, 0.0),
    item(ALULA_ITEM_HOVER, [0.0, 20.0, -30.0], 0.0, 2.0),
    item(ALULA_ITEM_LAND_AT, [0.0, 10.0, 0.0], 0.0, 0.0),
];

fn core_items() -> [Item; 9] {
    let place = |north, east, down| Ned::new(north, east, down);
    let waypoint = |place, pass| Item::Waypoint { place, pass };
    let loiter = |radius, until| Item::Loiter {
        centre: place(0.0, 300.0, -40.0),
        radius,
        until,
    };
    [
        Item::TakeOff { height: 10.0 },
        waypoint(place(300.0, 0.0, -30.0), Pass::By),
        waypoint(place(300.0, 300.0, -30.0), Pass::Over),
        loiter(120.0, Until::Turns(0.25)),
        loiter(-120.0, Until::Time(4.0)),
        Item::Speed(18.0),
        Item::Altitude { down: -35.0 },
        waypoint(place(0.0, 20.0, -30.0), Pass::Hover(2.0)),
        Item::Land {
            place: Some(place(0.0, 10.0, 0.0)),
        },
    ]
}

/// A point that does what the reference says, upright and with a ground, from take-off to landing; every command is the core's to the bit,
/// and what the mission says is the core's. A lost link and a lost position are in it, in both body axes.
#[test]
fn a_mission_is_the_cores_to_the_bit() {
    let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
    let vehicle = Vehicle::new(VehicleParameters::PAPER, model).unwrap();
    let guidance = Guidance::new(vehicle, &GuidanceParameters::default()).unwrap();
    let responses = Responses::default().link(Response::Return);
    let missions = Missions::new(&vehicle, &SETUP.parameters, responses).unwrap();
    let of_core = missions.mission(&core_items()).unwrap();
    let (mut flight, mut state) = (MissionState::default(), GuidanceState::default());
    let mut last = 0.0;

    let mut c = controller();
    let mut mission = init(&SETUP).unwrap();
    items(&mut mission, &MISSION, 0).unwrap();
    let (mut x, mut v) = (Ned::ZERO, Ned::ZERO);
    let wind = Ned::new(-2.0, 1.0, 0.0);
    // Less than it climbs with.
    let airspeed = 2.0;
    let (mut command, mut seen, mut off) = (Command::SAFE, 0_u32, 0);
    for n in 0..20_000 {
        let up = n % 2 == 0;
        let axes = match up {
            true => BodyAxes::NoseUp,
            false => BodyAxes::NoseForward,
        };
        let q = Orientation::NOSE_UP.to_quaternion(axes);
        let Quaternion {
            w: qw,
            x: qx,
            y: qy,
            z: qz,
        } = q;
        let mut troubles = Troubles::empty();
        troubles.set(Troubles::POSITION, (2000..2050).contains(&n));
        troubles.set(Troubles::ABORT, (2500..2550).contains(&n));
        mission.flags = ALULA_ARMED | u32::from(troubles.bits());
        mission.position = [x.north, x.east, x.down];
        let specific = Frd::new(9.81, 0.0, 0.0);
        let input = Input {
            flags: ALULA_SPECIFIC_FORCE | ALULA_AIR_PITOT,
            body_axes: match up {
                true => ALULA_BODY_NOSE_UP,
                false => ALULA_BODY_NOSE_FORWARD,
            },
            quaternion: [qw, qx, qy, qz],
            velocity: [v.north, v.east, v.down],
            air: [wind.north, wind.east, wind.down],
            airspeed,
            specific_force: axes.components(specific),
            ..Input::DEFAULT
        };
        // SAFETY: All are there.
        let code = unsafe {
            alula_mission_fly(&mut *mission, &mut c, &input, DT, &mut command, null_mut())
        };
        assert_eq!(code, ALULA_OK);

        let orientation = Orientation::from_quaternion(&q, axes).unwrap();
        let told = MissionInput::default()
            .position((!troubles.contains(Troubles::POSITION)).then_some(x))
            .velocity(v)
            .wind(wind)
            .airspeed(airspeed)
            .orientation(orientation)
            .thrust(last)
            .armed(true)
            .troubles(troubles);
        let asked = missions.step(&mut flight, &of_core, &told, DT);
        let told = asked.asked_of(
            GuidanceInput::default()
                .velocity(v)
                .orientation(orientation)
                .air(Air::Pitot { airspeed, wind })
                .specific_force(Some(specific)),
        );
        let (thrust, rates) = match asked.gate {
            Gate::Off => {
                off += 1;
                state = GuidanceState::default();
                asked.gate.pass(0.0, Default::default())
            }
            gate => {
                let expected = guidance.update(&mut state, &told, DT).command;
                gate.pass(expected.thrust, expected.rates)
            }
        };
        last = thrust;
        let what = format!("{n}: {:?} {asked:?}", command);
        assert_eq!(command.thrust.to_bits(), thrust.to_bits(), "{what}");
        let bits = |rates: [f32; 3]| rates.map(|rate| (rate + 0.0).to_bits());
        let expected = axes.components(rates);
        assert_eq!(bits(command.body_rate), bits(expected), "{what}");
        assert!(command.quaternion.iter().all(|x| x.is_finite()));
        let p = asked.progress;
        assert_eq!(
            (
                mission.item,
                mission.activity,
                mission.troubles,
                mission.response
            ),
            (
                p.item.into(),
                asked.activity as u32,
                asked.troubles.bits().into(),
                asked.response as u32
            )
        );
        assert_eq!(
            [
                mission.time,
                mission.distance_to_go,
                mission.time_to_go,
                mission.distance_after,
                mission.time_after,
                mission.energy,
                mission.right,
                mission.airspeed,
                mission.steady_thrust,
            ],
            [
                p.time,
                p.distance_to_go,
                p.time_to_go,
                p.distance_after,
                p.time_after,
                p.energy,
                p.right,
                p.airspeed,
                p.steady_thrust,
            ]
        );
        assert_eq!(mission.remark != ALULA_REMARK_NONE, asked.remark.is_some());
        seen |= 1 << mission.activity;
        if mission.item == 9 {
            break;
        }
        // It goes where it is asked to: at the thrust of its weight it lifts off, and the ground holds it.
        v = match thrust > 100.0 || x.down < 0.0 {
            true => asked.reference.velocity,
            false => Ned::ZERO,
        };
        x += v * DT - asked.position_error * 0.02;
        if x.down > 0.0 {
            (x.down, v) = (0.0, Ned::ZERO);
        }
    }
    assert_eq!((mission.item, seen), (9, 0b111_1111));
    assert!(off >= 1 && command.thrust == 0.0);
}

/// Each way to be wrong has a code and the number of the item, and leaves the mission as it was.
#[test]
fn what_cannot_be_flown_is_refused_by_item() {
    let mut mission = init(&SETUP).unwrap();
    items(&mut mission, &MISSION, 0).unwrap();
    let before = *mission;
    let up = MISSION[0];
    let far = item(ALULA_ITEM_BY, [1e6, 0.0, 0.0], 0.0, 0.0);
    for (wrong, code) in [
        (item(0, [0.0; 3], 0.0, 0.0), ALULA_ERROR_ITEM_KIND),
        (item(13, [0.0; 3], 0.0, 0.0), ALULA_ERROR_ITEM_KIND),
        (far, ALULA_ERROR_ITEM_PLACE),
        (
            item(ALULA_ITEM_LAND_AT, [0.0, f32::NAN, 0.0], 0.0, 0.0),
            ALULA_ERROR_ITEM_PLACE,
        ),
        (
            item(ALULA_ITEM_ALTITUDE, [0.0, 0.0, f32::INFINITY], 0.0, 0.0),
            ALULA_ERROR_ITEM_PLACE,
        ),
        (
            item(ALULA_ITEM_LOITER, [0.0; 3], f32::NAN, 0.0),
            ALULA_ERROR_ITEM_RADIUS,
        ),
        (
            item(ALULA_ITEM_LOITER, [0.0; 3], 10.0, 0.0),
            ALULA_ERROR_ITEM_NARROW,
        ),
        (
            item(ALULA_ITEM_LOITER_TURNS, [0.0; 3], 200.0, -1.0),
            ALULA_ERROR_ITEM_VALUE,
        ),
        (
            item(ALULA_ITEM_HOVER, [0.0; 3], 0.0, f32::NAN),
            ALULA_ERROR_ITEM_VALUE,
        ),
        (
            item(ALULA_ITEM_SPEED, [0.0; 3], 0.0, 300.0),
            ALULA_ERROR_ITEM_VALUE,
        ),
        (up, ALULA_ERROR_ITEM_NOT_FIRST),
    ] {
        let refused = items(&mut mission, &[up, wrong], 0);
        assert_eq!(refused, Err((1, code)), "{wrong:?}");
    }
    let slow = item(ALULA_ITEM_SPEED, [0.0; 3], 0.0, 2.0);
    let circle = item(ALULA_ITEM_LOITER, [0.0; 3], 200.0, 0.0);
    let refused = items(&mut mission, &[up, slow, circle], 0);
    assert_eq!(refused, Err((2, ALULA_ERROR_ITEM_SLOW)));
    let home = item(ALULA_ITEM_RETURN, [0.0; 3], 0.0, 0.0);
    let refused = items(&mut mission, &[up, home, circle], 0);
    assert_eq!(refused, Err((2, ALULA_ERROR_ITEM_AFTER_LANDING)));
    let many = [up; 129];
    let refused = items(&mut mission, &many, 0);
    assert_eq!(refused, Err((128, ALULA_ERROR_ITEM_TOO_MANY)));
    assert_eq!(before.opaque, mission.opaque);
    // As many as there is room for, and none.
    items(
        &mut mission,
        &[[up].as_slice(), &[far_enough(); 127]].concat(),
        3,
    )
    .unwrap();
    items(&mut mission, &[], 0).unwrap();
}

const fn far_enough() -> MissionItem {
    item(ALULA_ITEM_BY, [9e4, 0.0, -50.0], 0.0, 0.0)
}

#[test]
fn setups_and_pointers_are_checked() {
    let text = |code| {
        // SAFETY: `alula_strerror` gives a text for every code.
        let text = unsafe { std::ffi::CStr::from_ptr(alula_strerror(code)) };
        text.to_str().unwrap()
    };
    let refused = |change: fn(&mut MissionSetup)| {
        let mut setup = SETUP;
        change(&mut setup);
        init(&setup).err().unwrap()
    };
    let code = refused(|s| s.parameters.cruise_speed = f32::NAN);
    assert_eq!(text(code), "mission.cruise_speed must be from 1 to 340 m/s");
    let code = refused(|s| s.parameters.cruise_speed = 3.0);
    assert!(
        text(code).starts_with("mission.cruise_speed must be a speed of the wing"),
        "{}",
        text(code)
    );
    let code = refused(|s| s.parameters.hover_downwash = 0.0);
    assert!(text(code).starts_with("mission.hover_downwash must be"));
    assert_eq!(refused(|s| s.battery = 4), ALULA_ERROR_SELECTOR);
    assert_eq!(refused(|s| s.header += 1), ALULA_ERROR_LAYOUT);
    let mut setup = MissionSetup { link: 9, ..SETUP };
    let (mut blank, mut c) = (Box::new(Mission::BLANK), controller());
    let mut command = Command::SAFE;
    // SAFETY: What is not null is there.
    unsafe {
        assert_eq!(alula_mission_default(&mut setup), ALULA_OK);
        assert!(setup.link == 0 && setup.parameters.cruise_speed.is_nan());
        assert_eq!(alula_mission_default(null_mut()), ALULA_ERROR_NULL);
        let none = ALULA_ERROR_NULL;
        assert_eq!(alula_mission_init(null_mut(), &SETUP, &c), none);
        assert_eq!(alula_mission_init(&mut *blank, null(), &c), none);
        assert_eq!(alula_mission_init(&mut *blank, &SETUP, null()), none);
        let cold = Controller::BLANK;
        let code = alula_mission_init(&mut *blank, &SETUP, &cold);
        assert_eq!(code, ALULA_ERROR_NOT_INITIALISED);
        let code = alula_mission_items(&mut *blank, &MISSION[0], 1, 0, null_mut());
        assert_eq!(code, ALULA_ERROR_NOT_INITIALISED);
        let mut fly = |mission: *mut Mission, input: *const Input| {
            command.thrust = 1.0;
            let code = alula_mission_fly(mission, &mut c, input, DT, &mut command, null_mut());
            assert_eq!(command, Command::SAFE);
            code
        };
        assert_eq!(
            fly(&mut *blank, &Input::DEFAULT),
            ALULA_ERROR_NOT_INITIALISED
        );
        assert_eq!(fly(null_mut(), &Input::DEFAULT), none);
        let mut mission = init(&SETUP).unwrap();
        assert_eq!(fly(&mut *mission, null()), none);
        mission.flags = 1 << 6;
        assert_eq!(fly(&mut *mission, &Input::DEFAULT), ALULA_ERROR_SELECTOR);
        mission.flags = 1 << 9;
        assert_eq!(fly(&mut *mission, &Input::DEFAULT), ALULA_ERROR_SELECTOR);
        let code = alula_mission_items(&mut *mission, null(), 1, 0, null_mut());
        assert_eq!(code, none);
    }
}
