//! The guidance, the table model and the envelope through the ABI, against the core itself.
#![cfg(not(target_os = "none"))]

use std::ptr::{null, null_mut};

use alula::aero::Node;
use alula::guidance::{Air, Status};
use alula::{
    Attitude, Combined, CombinedParameters, Equilibria, Guidance, GuidanceInput,
    GuidanceParameters, GuidanceState, Inertial, Reference, Vehicle, VehicleParameters,
    VelocityControl,
};
use alula_capi::*;

const DT: f32 = 0.01;
const REFERENCE_HELD: u32 = Status::REFERENCE_HELD.bits() as u32;

/// The defaults, of the paper's vehicle.
const PAPER: Parameters = Parameters {
    vehicle: VehicleParameters::PAPER,
    ..Parameters::DEFAULT
};

fn controller(parameters: &Parameters, table: *const Table) -> Controller {
    let mut controller = Controller {
        header: Controller::HEADER,
        reserved: 0,
        opaque: [0; 95],
    };
    let code = unsafe { alula_init(&mut controller, parameters, table) };
    assert_eq!(code, ALULA_OK);
    controller
}

fn report() -> NedReport {
    // SAFETY: Zero is a value of every field.
    let zero: NedReport = unsafe { std::mem::zeroed() };
    NedReport {
        header: NedReport::HEADER,
        ..zero
    }
}

fn guide(c: &mut Controller, input: &NedInput) -> (i32, NedCommand, NedReport) {
    let (mut command, mut report) = (NedCommand::SAFE, report());
    let code = unsafe { alula_guide(c, input, DT, &mut command, &mut report) };
    (code, command, report)
}

/// The core's guidance of the same vehicle, with its own defaults.
fn core() -> Guidance<Combined> {
    let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
    let vehicle = Vehicle::new(VehicleParameters::PAPER, model).unwrap();
    Guidance::new(vehicle, &GuidanceParameters::default()).unwrap()
}

/// Heading north, by pitch: nothing is rounded between the axes, and a flight through the ABI is the core's to the bit,
/// with air data of every kind, position errors, stale and damaged frames in it.
#[test]
fn a_guided_flight_is_the_cores_to_the_bit() {
    let mut c = controller(&PAPER, null());
    let (core, mut state) = (core(), GuidanceState::default());
    let (mut modes, mut statuses) = ([0; 3], 0);
    for n in 0..5000u32 {
        let t = n as f32 * DT;
        let pitch = -0.03 * t + 0.4 * (1.3 * t).sin();
        let (down, forward) = ((0.7 * t).sin(), 0.5 * t + (0.9 * t).cos());
        let bad = n % 400 > 385 || n % 97 == 0;
        let input = NedInput {
            flags: [0, ALULA_AIR_VELOCITY, ALULA_AIR_UNKNOWN, ALULA_POSITION][n as usize / 150 % 4],
            body_axes: ALULA_BODY_NOSE_UP,
            attitude: ALULA_ATTITUDE_PITCH,
            pitch: if bad { f32::NAN } else { pitch },
            velocity: [forward, 0.0, down],
            air: [0.8 * forward, 0.0, 0.2],
            reference_velocity: [0.5 * t, 0.0, 0.0],
            reference_acceleration: [0.5, 0.0, 0.0],
            position_error: [3.0 * (0.2 * t).sin(), 0.0, 1.0],
            reference_age: if n % 1000 > 900 { 0.6 } else { 0.1 },
            ..NedInput::DEFAULT
        };
        let air = Inertial::new(0.2, 0.8 * forward);
        let guided = core.update(
            &mut state,
            &GuidanceInput {
                velocity: Inertial::new(down, forward),
                attitude: Attitude::from_angle(input.pitch),
                state_age: 0.0,
                air: match input.flags {
                    ALULA_AIR_VELOCITY => Air::Velocity(air),
                    ALULA_AIR_UNKNOWN => Air::Unknown,
                    _ => Air::Wind(air),
                },
                position_error: (input.flags == ALULA_POSITION)
                    .then_some(Inertial::new(1.0, input.position_error[0])),
                reference: Reference {
                    velocity: Inertial::new(0.0, 0.5 * t),
                    acceleration: Inertial::new(0.0, 0.5),
                },
                reference_age: input.reference_age,
            },
            DT,
        );
        let (code, command, report) = guide(&mut c, &input);
        assert_eq!(code == ALULA_OK, guided.refusal.is_none(), "{n}");
        assert_eq!(
            (command.thrust, command.pitch_rate),
            (guided.command.thrust, guided.command.rate),
            "{n}"
        );
        assert_eq!(command.status & 0xffff, u32::from(guided.status.bits()));
        assert_eq!(report.mode, guided.mode as u32);
        assert_eq!(report.velocity[0], guided.reference.velocity.forward());
        assert_eq!(
            [report.margin_force, report.margin_k, report.margin_fold],
            [guided.margin.force, guided.margin.k, guided.margin.fold]
        );
        if bad {
            assert_eq!(code, ALULA_ERROR_ATTITUDE);
        }
        modes[report.mode as usize] += 1;
        statuses |= command.status;
    }
    assert!(modes.iter().all(|count| *count > 10), "{modes:?}");
    let seen = ALULA_STATUS_HOLDING | ALULA_STATUS_SAFE | REFERENCE_HELD;
    assert_eq!(statuses & seen, seen);
}

#[test]
fn bad_frames_are_bridged_and_then_the_command_is_safe() {
    let mut c = controller(&PAPER, null());
    let hover = NedInput::DEFAULT;
    for _ in 0..20 {
        guide(&mut c, &hover);
    }
    let (code, flown, _) = guide(&mut c, &hover);
    assert!(code == ALULA_OK && flown.status == 0 && (flown.thrust - 98.1).abs() < 0.1);
    for (heading, wanted) in [(f32::NAN, ALULA_ERROR_HEADING), (1e6, ALULA_ERROR_HEADING)] {
        let (code, held, report) = guide(&mut c, &NedInput { heading, ..hover });
        assert_eq!(
            (code, held.status, held.thrust),
            (wanted, ALULA_STATUS_HOLDING, flown.thrust)
        );
        // Whatever was bad, nothing that is given back is.
        let numbers = held.quaternion.iter().chain(&held.body_rate);
        assert!(
            numbers
                .chain([&held.pitch, &report.lateral_velocity])
                .all(|v| v.is_finite())
        );
    }
    let stale = NedInput {
        state_age: 1.0,
        ..hover
    };
    for _ in 0..20 {
        guide(&mut c, &stale);
    }
    let (code, safe, report) = guide(&mut c, &stale);
    assert_eq!(code, ALULA_ERROR_STATE_AGE);
    assert_eq!(
        (safe.status, safe.thrust, safe.pitch_rate),
        (ALULA_STATUS_SAFE, 0.0, 0.0)
    );
    assert_eq!(report.mode, ALULA_MODE_SAFE);
    // A fault of the call itself is no step.
    let before = c.opaque;
    let (code, command, _) = guide(
        &mut c,
        &NedInput {
            heading: 2.0,
            body_axes: 7,
            ..hover
        },
    );
    assert_eq!((code, command), (ALULA_ERROR_SELECTOR, NedCommand::SAFE));
    let mut wrong = report;
    wrong.header ^= 4;
    let mut command = flown;
    let code = unsafe { alula_guide(&mut c, &hover, DT, &mut command, &mut wrong) };
    assert_eq!((code, command), (ALULA_ERROR_LAYOUT, NedCommand::SAFE));
    assert_eq!(c.opaque, before);
    // Reset is power-on.
    assert_eq!(unsafe { alula_reset(&mut c) }, ALULA_OK);
    let mut new = controller(&PAPER, null());
    for _ in 0..20 {
        assert_eq!(guide(&mut c, &hover), guide(&mut new, &hover));
    }
    let mut command = NedCommand::SAFE;
    let code = unsafe { alula_guide(&mut c, &hover, DT, &mut command, null_mut()) };
    assert_eq!((code, command.status), (ALULA_OK, 0));
}

/// Both attitudes are of the same body axes; quaternions of either sign.
fn same_attitude(a: [f32; 4], b: [f32; 4]) -> bool {
    let dot: f32 = a.iter().zip(b).map(|(a, b)| a * b).sum();
    dot.abs() > 1.0 - 1e-6
}

/// While frames are bad the last command is repeated as a whole: rates, thrust, and the attitude set-point. When they are
/// good again, the flight goes on from what was remembered.
#[test]
fn a_held_command_is_the_last_one_as_a_whole() {
    let mut c = controller(&PAPER, null());
    let hover = NedInput {
        heading: 0.7,
        quaternion: {
            // Nose up, heading 0.7 rad, in fixed-wing axes: pitch 90°.
            let (s, c) = 0.35f32.sin_cos();
            let h = std::f32::consts::FRAC_1_SQRT_2;
            [h * c, -h * s, h * c, h * s]
        },
        velocity: [0.3, 0.4, 0.2],
        ..NedInput::DEFAULT
    };
    let mut flown = NedCommand::SAFE;
    for _ in 0..50 {
        flown = guide(&mut c, &hover).1;
    }
    assert!(flown.pitch_rate.abs() > 0.01 && flown.pitch > 1.5 && flown.status & 0x30000 == 0);
    let nan = f32::NAN;
    let bad = [
        NedInput {
            quaternion: [nan; 4],
            ..hover
        },
        NedInput {
            quaternion: [0.0; 4],
            ..hover
        },
        NedInput {
            heading: nan,
            ..hover
        },
        NedInput {
            velocity: [nan; 3],
            ..hover
        },
        NedInput {
            attitude: ALULA_ATTITUDE_PITCH,
            pitch: nan,
            ..hover
        },
        NedInput {
            state_age: 1.0,
            ..hover
        },
    ];
    for input in bad {
        let mut held_by = c;
        for _ in 0..5 {
            let (code, held, _) = guide(&mut held_by, &input);
            assert!(code != ALULA_OK);
            let wanted = NedCommand {
                status: ALULA_STATUS_HOLDING,
                ..flown
            };
            assert_eq!(held, wanted);
        }
        // In the other body axes it is the same attitude and the same turn.
        let other = NedInput {
            body_axes: ALULA_BODY_NOSE_UP,
            ..input
        };
        let (_, held, _) = guide(&mut held_by, &other);
        let [w, x, y, z] = flown.quaternion;
        let h = std::f32::consts::FRAC_1_SQRT_2;
        let turned = [h * (w + y), h * (x + z), h * (y - w), h * (z - x)];
        assert!(
            same_attitude(held.quaternion, turned),
            "{:?}",
            held.quaternion
        );
        // 1e-6: a quarter turn is rounded to 1e-7.
        assert!((held.pitch - (flown.pitch - std::f32::consts::FRAC_PI_2)).abs() < 1e-6);
        assert_eq!(
            held.body_rate,
            [flown.body_rate[2], flown.body_rate[1], -flown.body_rate[0]]
        );
        assert_eq!(
            (held.thrust, held.pitch_rate),
            (flown.thrust, flown.pitch_rate)
        );
        // A good frame is flown as if there had been no bad one.
        let mut undisturbed = c;
        let (code, next, _) = guide(&mut held_by, &hover);
        assert_eq!((code, next), (ALULA_OK, guide(&mut undisturbed, &hover).1));
        // After `hold` the command is the safe one, at the attitude that there is, or that was last known.
        for _ in 0..30 {
            guide(&mut held_by, &input);
        }
        let (_, safe, _) = guide(&mut held_by, &input);
        assert_eq!((safe.status, safe.thrust), (ALULA_STATUS_SAFE, 0.0));
        assert_eq!((safe.pitch_rate, safe.body_rate), (0.0, [0.0; 3]));
        let attitude_known = input.velocity[0].is_nan() || input.state_age > 0.0;
        let wanted = if attitude_known {
            std::f32::consts::FRAC_PI_2
        } else {
            next.pitch
        };
        assert!(
            (safe.pitch - wanted).abs() < 1e-6,
            "{} {wanted}",
            safe.pitch
        );
    }
}

/// Wind, velocities and the integral are the world's. They do not turn with the heading.
#[test]
fn what_is_remembered_stays_where_it_is_when_the_heading_turns() {
    use std::f32::consts::{FRAC_PI_2, PI};
    let mut still = PAPER;
    still.guidance = GuidanceParameters {
        integral_gain_down: 0.0,
        integral_gain_forward: 0.0,
        position_gain_down: 0.0,
        position_gain_forward: 0.0,
        ..still.guidance
    };
    let mut c = controller(&still, null());
    let north = NedInput {
        attitude: ALULA_ATTITUDE_PITCH,
        velocity: [6.0, 2.0, 0.5],
        reference_velocity: [6.0, 2.0, 0.5],
        air: [-3.0, 4.0, 0.0],
        ..NedInput::DEFAULT
    };
    for _ in 0..500 {
        guide(&mut c, &north);
    }
    // The wind: without air data an eastern plane is flown as with the wind that was last known.
    let east = NedInput {
        heading: FRAC_PI_2,
        ..north
    };
    let unknown = NedInput {
        flags: ALULA_AIR_UNKNOWN,
        air: [0.0; 3],
        ..east
    };
    let (mut told, mut remembered) = (c, c);
    let (_, wanted, _) = guide(&mut told, &east);
    // A heading that is refused on the way leaves no trace.
    guide(
        &mut remembered,
        &NedInput {
            heading: f32::NAN,
            ..north
        },
    );
    let (_, got, report) = guide(&mut remembered, &unknown);
    assert_eq!(report.air_use, ALULA_AIR_USE_HELD_WIND);
    // 1e-2 N of thousands: the wind is turned and back by roundings of 1e-6 m/s.
    assert!(
        (got.thrust - wanted.thrust).abs() < 1e-2,
        "{} {}",
        got.thrust,
        wanted.thrust
    );
    assert!((got.pitch_rate - wanted.pitch_rate).abs() < 1e-3);
    // The reference: it is stale from now on, and its eastern part is flown in the eastern plane.
    let stale = NedInput {
        reference_age: 1.0,
        reference_velocity: [0.0; 3],
        // Flown as it is asked for, so that nothing has to be made good.
        velocity: [0.0, 2.0, 0.5],
        ..east
    };
    let mut velocity = [0.0; 3];
    for _ in 0..1000 {
        let (code, command, report) = guide(&mut c, &stale);
        assert!(code == ALULA_OK && command.status & REFERENCE_HELD != 0);
        velocity = report.velocity;
    }
    for (got, wanted) in velocity.iter().zip([0.0, 2.0, 0.5]) {
        // The velocity followed settles within 1e-3 m/s.
        assert!((got - wanted).abs() < 2e-3, "{velocity:?}");
    }

    // The integral: facing back, it still acts the same way in the world.
    let mut c = controller(&PAPER, null());
    let pulled = NedInput {
        flags: ALULA_POSITION,
        attitude: ALULA_ATTITUDE_PITCH,
        position_error: [2.0, 0.0, 0.0],
        ..NedInput::DEFAULT
    };
    let mut before = guide(&mut c, &pulled).2;
    for _ in 0..300 {
        before = guide(&mut c, &pulled).2;
    }
    let (_, _, after) = guide(
        &mut c,
        &NedInput {
            heading: PI,
            ..pulled
        },
    );
    // The position asks for 0.5 · 2 m/s and the integral has 0.1 · 1.0 · 3 m/s; 0.1: what the virtual flight is off by.
    assert!(
        (before.velocity[0] + 1.3).abs() < 0.1,
        "{:?}",
        before.velocity
    );
    // In another plane the virtual flight begins anew where the vehicle is. What is left is the integral, to the south as before.
    assert!(
        (-0.35..-0.05).contains(&after.velocity[0]),
        "{:?}",
        after.velocity
    );
}

/// A flat plate's table, symmetric.
fn rows() -> Vec<TableRow> {
    (0..=36)
        .map(|n| {
            let alpha = n as f32 * (std::f32::consts::PI / 36.0);
            let on_axis = n == 0 || n == 36;
            TableRow {
                alpha,
                c_l: if on_axis { 0.0 } else { (2.0 * alpha).sin() },
                c_d: 0.02 + 2.0 * alpha.sin().powi(2),
            }
        })
        .collect()
}

fn empty_table() -> Box<Table> {
    Box::new(Table {
        header: Table::HEADER,
        reserved: 0,
        opaque: [0; 671],
    })
}

#[test]
fn a_table_flies_as_the_cores_does_and_says_which_row_is_bad() {
    let mut table = empty_table();
    let init = |table: &mut Table, rows: &[TableRow], row: &mut u32| unsafe {
        alula_table_init(table, rows.as_ptr(), rows.len() as u32, row)
    };
    let mut with_table = PAPER;
    with_table.controller.model = ALULA_MODEL_TABLE as f32;
    let mut row = 99;
    type Spoil = fn(&mut Vec<TableRow>);
    let cases: [(i32, u32, Spoil); 6] = [
        (ALULA_ERROR_TABLE_NOT_FINITE, 3, |r| r[3].c_l = f32::NAN),
        (ALULA_ERROR_TABLE_DRAG, 5, |r| r[5].c_d = 0.0),
        (ALULA_ERROR_TABLE_NOT_INCREASING, 8, |r| {
            r[8].alpha = r[7].alpha
        }),
        (ALULA_ERROR_TABLE_START, 0, |r| r[0].alpha = 0.02),
        (ALULA_ERROR_TABLE_TOO_FEW, 4, |r| r.truncate(4)),
        (ALULA_ERROR_TABLE_TOO_MANY, ALULA_TABLE_ROWS, |r| {
            *r = vec![r[1]; ALULA_TABLE_ROWS as usize + 1]
        }),
    ];
    for (code, at, spoil) in cases {
        let mut rows = rows();
        spoil(&mut rows);
        assert_eq!((init(&mut table, &rows, &mut row), row), (code, at));
        let mut c = controller(&PAPER, null());
        assert_eq!(
            unsafe { alula_init(&mut c, &with_table, &*table) },
            ALULA_ERROR_NOT_INITIALISED
        );
    }
    assert_eq!(init(&mut table, &rows(), &mut row), ALULA_OK);
    let c = controller(&with_table, &*table);

    let nodes: Vec<_> = rows()
        .iter()
        .map(|r| Node {
            alpha: r.alpha,
            c_l: r.c_l,
            c_d: r.c_d,
        })
        .collect();
    let polar = alula::aero::Polar::<95>::new(&nodes).unwrap();
    let vehicle = Vehicle::new(VehicleParameters::PAPER, alula::Table::new(&polar)).unwrap();
    let guidance = Guidance::new(vehicle, &GuidanceParameters::default()).unwrap();
    let core: &VelocityControl<_, _> = guidance.control();
    for n in 0..2000 {
        let theta = 0.37 * n as f32;
        let input = Input {
            velocity: [3.0, 11.0],
            attitude: [theta.cos(), theta.sin()],
            ..Input::DEFAULT
        };
        let wanted = core.robust(
            &alula::State {
                velocity: Inertial::new(3.0, 11.0),
                attitude: Attitude {
                    cos: theta.cos(),
                    sin: theta.sin(),
                },
                wind: Inertial::ZERO,
            },
            &Reference::default(),
            None,
        );
        let mut command = Command::SAFE;
        assert_eq!(
            unsafe { alula_step(&c, &input, DT, &mut command) },
            ALULA_OK
        );
        let wanted = wanted.unwrap();
        assert_eq!((command.thrust, command.rate), (wanted.thrust, wanted.rate));
    }
}

#[test]
fn equilibria_and_the_fold_are_the_cores_and_a_step_holds_them() {
    let c = controller(&PAPER, null());
    let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
    let vehicle = Vehicle::new(VehicleParameters::PAPER, model).unwrap();
    // SAFETY: Zero is a value of every field.
    let mut set: EquilibriumSet = unsafe { std::mem::zeroed() };
    set.header = EquilibriumSet::HEADER;
    let mut most = 0;
    for n in 0..60 {
        let speed = 0.5 * n as f32;
        let mut input = NedInput {
            heading: 0.4,
            attitude: ALULA_ATTITUDE_PITCH,
            pitch: 0.0,
            reference_velocity: [speed * 0.4f32.cos(), speed * 0.4f32.sin(), 0.0],
            ..NedInput::DEFAULT
        };
        let code = unsafe { alula_equilibria_at(&c, &input, &mut set) };
        let reference = Reference {
            velocity: Inertial::new(0.0, speed),
            acceleration: Inertial::ZERO,
        };
        let wanted = Equilibria::find(&vehicle, &reference, Inertial::ZERO).unwrap();
        assert_eq!(
            (code, set.count),
            (ALULA_OK, wanted.as_slice().len() as u32)
        );
        most = most.max(set.count);
        for (got, wanted) in set.items.iter().zip(wanted.as_slice()) {
            assert!((got.alpha - wanted.alpha).abs() < 1e-4 && got.isolated == 1);
            // At the pitch that is given, the law asks for no rotation and for the thrust that is given.
            input.pitch = got.pitch;
            input.velocity = input.reference_velocity;
            let (mut command, mut report) = (NedCommand::SAFE, report());
            let code = unsafe { alula_step_ned(&c, &input, DT, &mut command, &mut report) };
            assert_eq!(code, ALULA_OK);
            // 1e-4 rad of an attitude that is known to 1e-6 rad, under forces 20 times the weight.
            let off = report.theta_tilde.abs();
            let off = if got.aligned == 1 {
                off
            } else {
                std::f32::consts::PI - off
            };
            assert!(off < 1e-4, "{speed}: {off}");
            assert!((command.thrust - got.thrust).abs() < 0.05);
        }
    }
    assert!(most >= 4, "{most}");

    let mut map = Box::new(Map {
        header: Map::HEADER,
        reserved: 0,
        opaque: [0; 384],
    });
    let mut margin = FoldMargin {
        header: FoldMargin::HEADER,
        alpha: 0.0,
        a: 0.0,
    };
    // Level flight at α = 8°, on its equilibrium: a_ν = cot α / (c_D + c_L cot α); the fold is at 11.155°, a = 1.30333.
    let alpha = 8f32.to_radians();
    let c_8 = alula::Aerodynamics::coefficients(&model, alula::AngleOfAttack::from_radians(alpha));
    let a_8 = 1.0 / (alpha.tan() * c_8.c_d + c_8.c_l);
    let speed = (a_8 * 98.1 / 0.646).sqrt();
    let input = NedInput {
        attitude: ALULA_ATTITUDE_PITCH,
        pitch: alpha,
        velocity: [speed, 0.0, 0.0],
        reference_velocity: [speed, 0.0, 0.0],
        ..NedInput::DEFAULT
    };
    unsafe {
        assert_eq!(
            alula_fold_margin_at(&*map, &c, &input, &mut margin),
            ALULA_ERROR_NOT_INITIALISED
        );
        assert_eq!(alula_fold_map_init(&mut *map, &c), ALULA_OK);
        assert_eq!(
            alula_fold_margin_at(&*map, &c, &input, &mut margin),
            ALULA_OK
        );
    }
    // The map's nodes are 1° apart, and linear between: 0.1° and 1 %.
    assert!(
        (margin.alpha.to_degrees() - 3.155).abs() < 0.1,
        "{margin:?}"
    );
    assert!((margin.a * a_8 / 1.30333 - 1.0).abs() < 0.01, "{margin:?}");
    let hover = NedInput::DEFAULT;
    let code = unsafe { alula_fold_margin_at(&*map, &c, &hover, &mut margin) };
    assert_eq!(
        (code, margin.alpha, margin.a),
        (ALULA_ERROR_NO_FOLD, 0.0, 0.0)
    );
}
