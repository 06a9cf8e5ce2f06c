//! The guidance, the table model and the envelope through the ABI, against the core itself.
#![cfg(not(target_os = "none"))]

use std::ptr::{null, null_mut};

use alula::aero::Node;
use alula::guidance::{Air, Status};
use alula::ned::{BodyAxes, Frd, Quaternion};
use alula::planar::equilibrium::Equilibria;
use alula::planar::{Inertial, Reference};
use alula::spatial::{self, Heading, Ned, Orientation};
use alula::{
    Combined, CombinedParameters, Guidance, GuidanceInput, GuidanceParameters, GuidanceState,
    Vehicle, VehicleParameters,
};
use alula_capi::*;

/// Thrust of the safe command once the paper's vehicle has flown \[N\]: 0.95 of its weight.
const SINKING: f32 = 0.95 * (10.0 * 9.81);

const DT: f32 = 0.01;
const REFERENCE_HELD: u32 = Status::REFERENCE_HELD.bits() as u32;
const HALF: f32 = std::f32::consts::FRAC_1_SQRT_2;

/// The defaults, of the paper's vehicle with side force.
const PAPER: Parameters = Parameters {
    vehicle: VEHICLE,
    ..Parameters::DEFAULT
};
const VEHICLE: VehicleParameters = VehicleParameters::PAPER.c_y(0.5);

fn controller(parameters: &Parameters, table: *const Table) -> Controller {
    let mut controller = Controller::BLANK;
    let code = unsafe { alula_init(&mut controller, parameters, table) };
    assert_eq!(code, ALULA_OK);
    controller
}

fn report() -> Report {
    // SAFETY: Zero is a value of every field.
    let zero: Report = unsafe { std::mem::zeroed() };
    Report {
        header: Report::HEADER,
        ..zero
    }
}

fn guide(c: &mut Controller, input: &Input) -> (i32, Command, Report) {
    let (mut command, mut report) = (Command::SAFE, report());
    let code = unsafe { alula_guide(c, input, DT, &mut command, &mut report) };
    (code, command, report)
}

/// The core's guidance of the same vehicle, with its own defaults.
fn core() -> Guidance<Combined> {
    let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
    let vehicle = Vehicle::new(VEHICLE, model).unwrap();
    Guidance::new(vehicle, &GuidanceParameters::default()).unwrap()
}

fn ned([north, east, down]: [f32; 3]) -> Ned {
    Ned::new(north, east, down)
}

fn quaternion([w, x, y, z]: [f32; 4]) -> Quaternion {
    Quaternion { w, x, y, z }
}

/// Heading, then pitch of the fixed wing's axes, then bank about the nose \[rad\].
fn euler(heading: f32, pitch: f32, bank: f32) -> [f32; 4] {
    let ((sh, ch), (sp, cp), (sb, cb)) = (
        (0.5 * heading).sin_cos(),
        (0.5 * pitch).sin_cos(),
        (0.5 * bank).sin_cos(),
    );
    [
        ch * cp * cb + sh * sp * sb,
        ch * cp * sb - sh * sp * cb,
        ch * sp * cb + sh * cp * sb,
        sh * cp * cb - ch * sp * sb,
    ]
}

/// A flight through the ABI is the core's to the bit, in space, with air data of every kind, specific force, headings,
/// position errors, stale and damaged frames in it, in both body axes.
#[test]
fn a_guided_flight_is_the_cores_to_the_bit() {
    let mut c = controller(&PAPER, null());
    let (core, mut state) = (core(), GuidanceState::default());
    let (mut modes, mut statuses) = ([0; 3], 0);
    let (mut phases, mut uses) = (0, 0);
    for n in 0..5000u32 {
        let t = n as f32 * DT;
        let (axes, body_axes) = match n / 700 % 2 {
            0 => (BodyAxes::NoseForward, ALULA_BODY_NOSE_FORWARD),
            _ => (BodyAxes::NoseUp, ALULA_BODY_NOSE_UP),
        };
        let q = euler(
            0.2 * t,
            1.5 - 0.03 * t + 0.4 * (1.3 * t).sin(),
            0.5 * (0.8 * t).cos(),
        );
        let q = quaternion(q).in_axes(BodyAxes::NoseForward, axes);
        let bad = n % 400 > 385 || n % 97 == 0;
        let kind = [
            0,
            ALULA_AIR_VELOCITY,
            ALULA_AIR_UNKNOWN,
            ALULA_AIR_PITOT,
            ALULA_POSITION,
        ][n as usize / 150 % 5];
        let measured = if n / 500 % 2 == 1 {
            ALULA_SPECIFIC_FORCE
        } else {
            0
        };
        let input = Input {
            flags: kind | measured,
            body_axes,
            quaternion: [if bad { f32::NAN } else { q.w }, q.x, q.y, q.z],
            velocity: [
                0.5 * t + (0.9 * t).cos(),
                3.0 * (0.3 * t).sin(),
                (0.7 * t).sin(),
            ],
            air: [0.4 * t, 1.0, 0.2],
            airspeed: if n % 50 > 40 { f32::NAN } else { 0.3 * t },
            reference_velocity: [0.5 * t, 2.0 * (0.3 * t).sin(), 0.0],
            reference_acceleration: [0.5, 0.6 * (0.3 * t).cos(), 0.0],
            heading: if n / 300 % 2 == 0 { f32::NAN } else { 0.01 * t },
            position_error: [3.0 * (0.2 * t).sin(), 1.0, -0.5],
            specific_force: [9.0, 0.3 * t.sin(), -1.0],
            reference_age: if n % 1000 > 900 { 0.6 } else { 0.1 },
            ..Input::DEFAULT
        };
        let [x, y, z] = input.specific_force;
        // The tables of body axes in `Orientation`, written out.
        let along = match axes {
            BodyAxes::NoseUp => Frd::new(-z, y, x),
            BodyAxes::NoseForward => Frd::new(x, y, z),
        };
        let guided = core.update(
            &mut state,
            &GuidanceInput::default()
                .velocity(ned(input.velocity))
                .orientation(
                    Orientation::from_quaternion(&quaternion(input.quaternion), axes)
                        .unwrap_or(Orientation::UNKNOWN),
                )
                .state_age(0.0)
                .air(match kind {
                    ALULA_AIR_VELOCITY => Air::Velocity(ned(input.air)),
                    ALULA_AIR_UNKNOWN => Air::Unknown,
                    ALULA_AIR_PITOT => Air::Pitot {
                        airspeed: input.airspeed,
                        wind: ned(input.air),
                    },
                    _ => Air::Wind(ned(input.air)),
                })
                .specific_force((measured != 0).then_some(along))
                .position_error((kind == ALULA_POSITION).then_some(ned(input.position_error)))
                .reference(spatial::Reference {
                    velocity: ned(input.reference_velocity),
                    acceleration: ned(input.reference_acceleration),
                    heading: Heading::from_angle(input.heading),
                })
                .reference_age(input.reference_age),
            DT,
        );
        let (code, command, report) = guide(&mut c, &input);
        assert_eq!(code == ALULA_OK, guided.reject_reason.is_none(), "{n}");
        let rates = guided.command.rates;
        let rates = match axes {
            BodyAxes::NoseUp => [rates.yaw, rates.pitch, -rates.roll],
            BodyAxes::NoseForward => [rates.roll, rates.pitch, rates.yaw],
        };
        assert_eq!(
            (command.thrust, command.body_rate),
            (guided.command.thrust, rates),
            "{n}"
        );
        assert_eq!(command.status & 0xffff, u32::from(guided.status.bits()));
        assert_eq!(report.mode, guided.mode as u32);
        assert_eq!(
            [report.margin_force, report.margin_k, report.margin_fold],
            [guided.margin.force, guided.margin.k, guided.margin.fold]
        );
        let d = guided.command.diagnostics;
        assert_eq!([report.tilt, report.sideslip], [d.tilt(), d.sideslip()]);
        assert_eq!(report.phase, guided.progress.phase as u32);
        assert_eq!(ned(report.velocity), guided.reference.velocity);
        let length: f32 = command.quaternion.iter().map(|x| x * x).sum();
        assert!((length - 1.0).abs() < 1e-5);
        if bad {
            assert_eq!(code, ALULA_ERROR_ATTITUDE);
        }
        modes[report.mode as usize] += 1;
        statuses |= command.status;
        phases |= 1 << report.phase;
        uses |= 1 << report.air_use;
    }
    assert!(modes.iter().all(|count| *count > 10), "{modes:?}");
    let seen = ALULA_STATUS_HOLDING | ALULA_STATUS_SAFE | REFERENCE_HELD;
    assert_eq!(statuses & seen, seen);
    assert!(phases > 1 && uses > 0b10000, "{phases:b} {uses:b}");
}

#[test]
fn bad_frames_are_bridged_and_then_the_command_is_safe() {
    let mut c = controller(&PAPER, null());
    let hover = Input::DEFAULT;
    for _ in 0..20 {
        guide(&mut c, &hover);
    }
    let (code, hovering, _) = guide(&mut c, &hover);
    assert!(
        code == ALULA_OK
            && hovering.status & !ALULA_STATUS_PLAN_DUE == 0
            && (hovering.thrust - 98.1).abs() < 0.1
    );
    for heading in [f32::NAN, f32::INFINITY, 1e6] {
        // No heading is no fault: it is free.
        let (code, free, _) = guide(&mut c, &Input { heading, ..hover });
        assert_eq!((code, free.status & !ALULA_STATUS_PLAN_DUE), (ALULA_OK, 0));
    }
    let stale = Input {
        state_age: 1.0,
        ..hover
    };
    for _ in 0..20 {
        guide(&mut c, &stale);
    }
    let (code, safe, report) = guide(&mut c, &stale);
    assert_eq!(code, ALULA_ERROR_STATE_AGE);
    assert_eq!(
        (safe.status, safe.thrust, safe.body_rate),
        (ALULA_STATUS_SAFE, SINKING, [0.0; 3])
    );
    assert_eq!(report.mode, ALULA_MODE_SAFE);
    // A fault of the call itself is no step.
    let before = c.opaque;
    let (code, command, _) = guide(
        &mut c,
        &Input {
            body_axes: 7,
            ..hover
        },
    );
    assert_eq!((code, command), (ALULA_ERROR_SELECTOR, Command::SAFE));
    let mut wrong = report;
    wrong.header ^= 4;
    let mut command = hovering;
    let code = unsafe { alula_guide(&mut c, &hover, DT, &mut command, &mut wrong) };
    assert_eq!((code, command), (ALULA_ERROR_LAYOUT, Command::SAFE));
    assert_eq!(c.opaque, before);
    // Reset is power-on.
    assert_eq!(unsafe { alula_reset(&mut c) }, ALULA_OK);
    let mut new = controller(&PAPER, null());
    for _ in 0..20 {
        assert_eq!(guide(&mut c, &hover), guide(&mut new, &hover));
    }
    let mut command = Command::SAFE;
    let code = unsafe { alula_guide(&mut c, &hover, DT, &mut command, null_mut()) };
    assert_eq!(
        (code, command.status & !ALULA_STATUS_PLAN_DUE),
        (ALULA_OK, 0)
    );
}

/// A vehicle that flies already keeps its command until the first good frame, which is flown, and is never dropped: in either axes.
#[test]
fn a_vehicle_that_flies_is_taken_over() {
    let bad = Input {
        state_age: 9.0,
        ..Input::DEFAULT
    };
    let nose_up = Input {
        body_axes: ALULA_BODY_NOSE_UP,
        quaternion: [1.0, 0.0, 0.0, 0.0],
        ..bad
    };
    for input in [bad, nose_up] {
        let mut c = controller(&PAPER, null());
        let rates = [0.1, -0.2, 0.3];
        let take = |c: &mut Controller, thrust: f32| unsafe {
            alula_take_over(c, &input, thrust, rates.as_ptr())
        };
        assert_eq!(take(&mut c, 0.4), ALULA_OK);
        let (code, held, _) = guide(&mut c, &input);
        assert_eq!(
            (code, held.status),
            (ALULA_ERROR_STATE_AGE, ALULA_STATUS_HOLDING)
        );
        assert_eq!(held.body_rate, rates);
        assert!(same_attitude(held.quaternion, input.quaternion));
        assert!((held.thrust_normalised - 0.4).abs() < 1e-6);
        let good = Input {
            state_age: 0.0,
            ..input
        };
        let (code, flown, report) = guide(&mut c, &good);
        assert_eq!((code, report.mode), (ALULA_OK, ALULA_MODE_FLYING));
        assert!(flown.thrust > 0.2 * PAPER.vehicle.thrust_max);
        // No thrust is told: the safe one is held.
        assert_eq!(take(&mut c, f32::NAN), ALULA_OK);
        assert_eq!(guide(&mut c, &input).1.thrust, SINKING);
    }
    let mut c = controller(&PAPER, null());
    let none = Input {
        quaternion: [0.0; 4],
        ..bad
    };
    let still = [0.0; 3];
    let code = unsafe { alula_take_over(&mut c, &none, 0.5, still.as_ptr()) };
    assert_eq!(code, ALULA_ERROR_ATTITUDE);
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
    let hover = Input {
        heading: 0.2,
        // Nose up but for a lean, belly at 0.7 rad.
        quaternion: euler(0.7, 1.5, 0.1),
        velocity: [0.3, 0.4, 0.2],
        ..Input::DEFAULT
    };
    let mut last = Command::SAFE;
    for _ in 0..50 {
        last = guide(&mut c, &hover).1;
    }
    assert!(
        last.body_rate.iter().all(|rate| rate.abs() > 0.01),
        "{last:?}"
    );
    assert_eq!(last.status & 0x30000, 0);
    let nan = f32::NAN;
    let bad = [
        Input {
            quaternion: [nan; 4],
            ..hover
        },
        Input {
            quaternion: [0.0; 4],
            ..hover
        },
        Input {
            velocity: [nan; 3],
            ..hover
        },
        Input {
            state_age: 1.0,
            ..hover
        },
    ];
    for input in bad {
        let mut held_by = c;
        for _ in 0..5 {
            let (code, held, _) = guide(&mut held_by, &input);
            assert!(code != ALULA_OK);
            let wanted = Command {
                status: ALULA_STATUS_HOLDING,
                ..last
            };
            assert_eq!(held, wanted);
        }
        // In the other body axes it is the same attitude and the same turn.
        let other = Input {
            body_axes: ALULA_BODY_NOSE_UP,
            ..input
        };
        let (_, held, _) = guide(&mut held_by, &other);
        let [w, x, y, z] = last.quaternion;
        let turned = [
            HALF * (w + y),
            HALF * (x + z),
            HALF * (y - w),
            HALF * (z - x),
        ];
        assert!(
            same_attitude(held.quaternion, turned),
            "{:?}",
            held.quaternion
        );
        assert_eq!(
            held.body_rate,
            [last.body_rate[2], last.body_rate[1], -last.body_rate[0]]
        );
        assert_eq!(held.thrust, last.thrust);
        // A good frame is flown as if there had been no bad one.
        let mut undisturbed = c;
        let (code, next, _) = guide(&mut held_by, &hover);
        assert_eq!((code, next), (ALULA_OK, guide(&mut undisturbed, &hover).1));
        // After `hold` the command is the safe one, at the attitude that there is, or that was last known.
        for _ in 0..30 {
            guide(&mut held_by, &input);
        }
        let (_, safe, _) = guide(&mut held_by, &input);
        // The nose leans: sin 1.5 of the thrust carries. 1e-4 N: the quaternion's rounding.
        assert_eq!(safe.status, ALULA_STATUS_SAFE);
        assert!((safe.thrust - SINKING * 1.5_f32.sin()).abs() < 1e-4);
        assert_eq!(safe.body_rate, [0.0; 3]);
        let attitude_known = input.velocity[0].is_nan() || input.state_age > 0.0;
        let wanted = if attitude_known {
            hover.quaternion
        } else {
            next.quaternion
        };
        assert!(same_attitude(safe.quaternion, wanted));
    }
}

/// Nothing that is remembered depends on where the vehicle points: wind, held reference and integral are the world's.
#[test]
fn what_is_remembered_stays_where_it_is_when_the_vehicle_turns() {
    let mut c = controller(&PAPER, null());
    let blown = Input {
        velocity: [1.5, 0.5, 0.25],
        reference_velocity: [1.5, 0.5, 0.25],
        air: [-0.75, 1.0, 0.0],
        ..Input::DEFAULT
    };
    for _ in 0..500 {
        guide(&mut c, &blown);
    }
    // Turned to the east, without air data: flown as with the wind that was last known, to the bit.
    let east = Input {
        quaternion: euler(1.5, 1.4, 0.0),
        ..blown
    };
    let unknown = Input {
        flags: ALULA_AIR_UNKNOWN,
        air: [0.0; 3],
        ..east
    };
    let (mut told, mut remembered) = (c, c);
    let (_, wanted, _) = guide(&mut told, &east);
    let (_, got, report) = guide(&mut remembered, &unknown);
    assert_eq!(report.air_use, ALULA_AIR_USE_HELD_WIND);
    assert_eq!(got, wanted);
    // The reference is stale from now on: the last one is flown, north, east and down.
    let stale = Input {
        reference_age: 1.0,
        reference_velocity: [0.0; 3],
        ..blown
    };
    let mut velocity = [0.0; 3];
    for _ in 0..1000 {
        let (code, command, report) = guide(&mut c, &stale);
        assert!(code == ALULA_OK && command.status & REFERENCE_HELD != 0);
        velocity = report.velocity;
    }
    // Slow: the model's attitude is drawn to the real one from 0.45 rad on. 0.2 m/s: the integral and what the reference model, whose vehicle never leaves nose up, is off by.
    for (got, wanted) in velocity.iter().zip([1.5, 0.5, 0.25]) {
        assert!((got - wanted).abs() < 0.2, "{velocity:?}");
    }
}

/// A flight through the goals of the ABI: a place, a stop on the way to it, a velocity. The input is the core's, to the bit, for a
/// vehicle that lags behind; and the guidance flies it.
#[test]
fn goals_are_the_cores_to_the_bit() {
    use alula::guidance::{
        Goal as Core, GoalOutput, GoalState, Goals, PlannerOptions, Preferences,
    };
    let planner_options = PlannerOptions::default()
        .altitude_band(0.5)
        .nose_below_vertical(true);
    let mut goal = Goal {
        altitude_band: planner_options.altitude_band,
        nose_below_vertical: 1,
        ..Goal::DEFAULT
    };
    let goals = Goals::new(Preferences::default().planner_options(planner_options));
    let (goals, mut state) = (goals.unwrap(), GoalState::default());
    let mut c = controller(&PAPER, null());
    let (mut position, mut velocity) = ([0.0f32; 3], [0.0f32; 3]);
    let (place, fast) = ([120.0, -60.0, -15.0], [0.0, 18.0, 0.0]);
    let mut reached = Vec::new();
    for n in 0..6000 {
        let asked = match n {
            0..2500 => (ALULA_GOAL_HOVER, place, Core::Hover(ned(place))),
            2500..4000 => (ALULA_GOAL_VELOCITY, fast, Core::Velocity(ned(fast))),
            _ => (ALULA_GOAL_STOP, fast, Core::Stop),
        };
        (goal.kind, goal.target) = (asked.0, asked.1);
        let mut input = Input {
            velocity,
            flags: ALULA_SPECIFIC_FORCE,
            reference_age: 9.0,
            ..Input::DEFAULT
        };
        let code = unsafe { alula_goal_step(&mut goal, position.as_ptr(), DT, &mut input) };
        assert_eq!(code, ALULA_OK);
        let (x, v) = (ned(position), ned(velocity));
        let GoalOutput {
            reference,
            position_error: error,
            planner_options,
            ..
        } = goals.step(&mut state, &asked.2, x, v, DT);
        let three = |v: Ned| [v.north, v.east, v.down];
        let core = Input {
            velocity,
            flags: ALULA_SPECIFIC_FORCE
                | ALULA_POSITION
                | ALULA_NOSE_BELOW_VERTICAL
                | if planner_options.hold_altitude_only {
                    ALULA_HOLD_ALTITUDE_ONLY
                } else {
                    0
                },
            reference_velocity: three(reference.velocity),
            reference_acceleration: three(reference.acceleration),
            position_error: three(error),
            altitude_band: planner_options.altitude_band,
            ..Input::DEFAULT
        };
        // A free heading is NaN, which equals nothing.
        assert_eq!(format!("{input:?}"), format!("{core:?}"), "{n}");
        assert_eq!(goal.reached == 1, state.is_reached(), "{n}");
        if [2499, 3999, 5999].contains(&n) {
            reached.push(goal.reached);
        }
        assert_eq!(guide(&mut c, &input).0, ALULA_OK);
        for k in 0..3 {
            // It follows with a lag of half a second.
            velocity[k] += DT / 0.5 * (input.reference_velocity[k] - velocity[k]);
            position[k] += DT * velocity[k];
        }
    }
    assert_eq!(reached, [1, 1, 1]);
    assert!((position[2] + 15.0).abs() < 0.5, "{position:?}");
}

/// What is refused leaves goal and input as they were.
#[test]
fn a_goal_that_is_none_is_refused() {
    let refused = |goal: Goal, position: [f32; 3], velocity: [f32; 3], dt: f32| {
        let before = Input {
            velocity,
            ..Input::DEFAULT
        };
        let (mut after, mut input) = (goal, before);
        let code = unsafe { alula_goal_step(&mut after, position.as_ptr(), dt, &mut input) };
        let same = format!("{after:?} {input:?}") == format!("{goal:?} {before:?}");
        assert_eq!(same, code != ALULA_OK);
        code
    };
    let (good, zero) = (Goal::DEFAULT, [0.0; 3]);
    assert_eq!(refused(good, zero, zero, DT), ALULA_OK);
    let nan = [0.0, f32::NAN, 0.0];
    for bad in [
        Goal { kind: 0, ..good },
        Goal { kind: 4, ..good },
        Goal {
            target: nan,
            ..good
        },
        Goal { speed: 0.0, ..good },
        Goal {
            climb: f32::NAN,
            ..good
        },
        Goal {
            acceleration: 2e3,
            ..good
        },
    ] {
        assert_eq!(refused(bad, zero, zero, DT), ALULA_ERROR_GOAL, "{bad:?}");
    }
    assert_eq!(refused(good, nan, zero, DT), ALULA_ERROR_GOAL);
    assert_eq!(refused(good, zero, nan, DT), ALULA_ERROR_VELOCITY);
    assert_eq!(refused(good, zero, zero, 0.0), ALULA_ERROR_TIME_STEP);
    assert_eq!(refused(good, zero, zero, f32::NAN), ALULA_ERROR_TIME_STEP);
    let (mut goal, mut input) = (Goal { header: 0, ..good }, Input::DEFAULT);
    let step = |goal, position, input| unsafe { alula_goal_step(goal, position, DT, input) };
    assert_eq!(
        step(&mut goal, zero.as_ptr(), &mut input),
        ALULA_ERROR_LAYOUT
    );
    assert_eq!(unsafe { alula_goal_default(&mut goal) }, ALULA_ERROR_LAYOUT);
    goal = good;
    assert_eq!(step(&mut goal, null(), &mut input), ALULA_ERROR_NULL);
    assert_eq!(
        step(null_mut(), zero.as_ptr(), &mut input),
        ALULA_ERROR_NULL
    );
    assert_eq!(step(&mut goal, zero.as_ptr(), null_mut()), ALULA_ERROR_NULL);
}

/// The time scale of a path is the core's: slower behind, faster ahead, 1 where there is nothing to tell.
#[test]
fn a_path_waits_for_who_is_behind() {
    let (c, core) = (controller(&PAPER, null()), core());
    let mut scales = Vec::new();
    for along in [-40.0, -1.0, 0.0, 7.0, 100.0, f32::NAN] {
        let (error, velocity) = ([0.6 * along, 0.8 * along, 3.0], [12.0, 16.0, 0.0]);
        let mut scale = 9.0;
        let code =
            unsafe { alula_path_time_scale(&c, error.as_ptr(), velocity.as_ptr(), &mut scale) };
        assert_eq!(code, ALULA_OK);
        assert_eq!(scale, core.path_time_scale(ned(error), ned(velocity)));
        scales.push(scale);
    }
    assert!(scales[0] < scales[1] && scales[1] < 1.0 && scales[3] > 1.0);
    assert_eq!((scales[2], scales[5]), (1.0, 1.0));
}

/// In hover the heading asked for turns the vehicle about its tail; a free one does not.
#[test]
fn a_heading_turns_the_vehicle_and_a_free_one_does_not() {
    let about_the_tail = |heading| {
        let mut c = controller(&PAPER, null());
        let mut command = Command::SAFE;
        for _ in 0..50 {
            let input = Input {
                heading,
                body_axes: ALULA_BODY_NOSE_UP,
                quaternion: [1.0, 0.0, 0.0, 0.0],
                ..Input::DEFAULT
            };
            command = guide(&mut c, &input).1;
        }
        command.body_rate[2]
    };
    assert!(about_the_tail(0.5) > 0.5);
    assert!(about_the_tail(-0.5) < -0.5);
    assert_eq!(about_the_tail(f32::NAN), 0.0);
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
    let vehicle = Vehicle::new(VEHICLE, alula::Table::new(&polar)).unwrap();
    let guidance = Guidance::new(vehicle, &GuidanceParameters::default()).unwrap();
    for n in 0..2000 {
        let x = n as f32;
        let input = Input {
            velocity: [11.0, 2.0, 3.0],
            quaternion: euler(0.3 * x, 0.37 * x, 0.1 * x),
            heading: 0.4,
            ..Input::DEFAULT
        };
        let state = spatial::State {
            velocity: ned(input.velocity),
            orientation: Orientation::from_quaternion(
                &quaternion(input.quaternion),
                BodyAxes::NoseForward,
            )
            .unwrap(),
            ..spatial::State::default()
        };
        let reference = spatial::Reference {
            heading: Heading::from_angle(0.4),
            ..spatial::Reference::default()
        };
        let wanted = guidance.control().robust(&state, &reference, None).unwrap();
        let mut command = Command::SAFE;
        let code = unsafe { alula_step(&c, &input, DT, &mut command, null_mut()) };
        assert_eq!(code, ALULA_OK);
        let r = wanted.rates;
        assert_eq!(
            (command.thrust, command.body_rate),
            (wanted.thrust, [r.roll, r.pitch, r.yaw])
        );
    }
}

/// The set is the core's in level flight; in any turn the law asks for no rotation but the turn's at each attitude, and
/// for the thrust that is given.
#[test]
fn equilibria_are_the_cores_and_a_step_holds_them() {
    let c = controller(&PAPER, null());
    let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
    let vehicle = Vehicle::new(VEHICLE, model).unwrap();
    // SAFETY: Zero is a value of every field.
    let mut set: EquilibriumSet = unsafe { std::mem::zeroed() };
    set.header = EquilibriumSet::HEADER;
    let (mut most, mut in_turns) = (0, 0);
    for n in 0..120 {
        let speed = 0.5 * (n % 60) as f32;
        let turn = if n < 60 { 0.0 } else { 7.0 };
        let (sin, cos) = 0.4f32.sin_cos();
        let body_axes = n % 2;
        let mut input = Input {
            body_axes,
            reference_velocity: [speed * cos, speed * sin, 0.0],
            reference_acceleration: [-turn * sin, turn * cos, 0.0],
            ..Input::DEFAULT
        };
        let code = unsafe { alula_equilibria_at(&c, &input, &mut set) };
        assert!(code == ALULA_OK && set.count > 0);
        if n < 60 {
            let reference = Reference {
                velocity: Inertial::new(0.0, speed),
                acceleration: Inertial::ZERO,
            };
            let wanted = Equilibria::find(&vehicle, &reference, Inertial::ZERO).unwrap();
            assert_eq!(set.count, wanted.as_slice().len() as u32);
            for (got, wanted) in set.items.iter().zip(wanted.as_slice()) {
                assert!((got.alpha - wanted.alpha).abs() < 1e-4 && got.isolated == 1);
            }
        } else {
            in_turns += set.count;
        }
        most = most.max(set.count);
        for got in set.items.iter().take(set.count as usize) {
            input.quaternion = got.quaternion;
            input.velocity = input.reference_velocity;
            let (mut command, mut report) = (Command::SAFE, report());
            let code = unsafe { alula_step(&c, &input, DT, &mut command, &mut report) };
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
            // Lateral forces balance, and there is no sideslip.
            assert!(
                report.tilt.abs() < 1e-3 && report.sideslip.abs() < 1e-5,
                "{report:?}"
            );
            assert!((report.alpha - got.alpha).abs() < 1e-5 || speed == 0.0);
        }
    }
    assert!(most >= 4 && in_turns > 100, "{most} {in_turns}");
}

/// A level turn of load factor n has its fold at √n times the airspeed of level flight.
#[test]
fn the_fold_is_the_cores_and_moves_with_the_load_factor() {
    let c = controller(&PAPER, null());
    let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
    let mut map = Box::new(Map {
        header: Map::HEADER,
        reserved: 0,
        opaque: [0; 384],
    });
    let mut margin = FoldMargin::EMPTY;
    // Flight at α = 8°, on its equilibrium: a_ν = cot α / (c_D + c_L cot α); the fold is at 11.155°, a = 1.30333.
    let alpha = 8f32.to_radians();
    let c_8 = alula::Aerodynamics::coefficients(&model, alula::AngleOfAttack::from_radians(alpha));
    let a_8 = 1.0 / (alpha.tan() * c_8.c_d + c_8.c_l);
    for load in [1.0f32, 2.0] {
        let speed = (a_8 * load * 98.1 / 0.646).sqrt();
        let bank = (1.0 / load).acos();
        // The nose is up by α about the banked wing.
        let (sin, cos) = (0.5 * bank).sin_cos();
        let (sp, cp) = (0.5 * alpha).sin_cos();
        let input = Input {
            quaternion: [cos * cp, sin * cp, cos * sp, sin * sp],
            velocity: [speed, 0.0, 0.0],
            reference_velocity: [speed, 0.0, 0.0],
            reference_acceleration: [0.0, 9.81 * (load * load - 1.0).sqrt(), 0.0],
            ..Input::DEFAULT
        };
        if load == 1.0 {
            let code = unsafe { alula_fold_margin_at(&*map, &c, &input, &mut margin) };
            assert_eq!(code, ALULA_ERROR_NOT_INITIALISED);
            assert_eq!(unsafe { alula_fold_map_init(&mut *map, &c) }, ALULA_OK);
        }
        let code = unsafe { alula_fold_margin_at(&*map, &c, &input, &mut margin) };
        assert_eq!(code, ALULA_OK);
        // The map's nodes are 1° apart, and linear between: 0.1° and 1 %.
        assert!(
            (margin.alpha.to_degrees() - 3.155).abs() < 0.1,
            "{margin:?}"
        );
        assert!((margin.a * a_8 / 1.30333 - 1.0).abs() < 0.01, "{margin:?}");
    }
    let hover = Input::DEFAULT;
    let code = unsafe { alula_fold_margin_at(&*map, &c, &hover, &mut margin) };
    assert_eq!(
        (code, margin.alpha, margin.a),
        (ALULA_ERROR_NO_FOLD, 0.0, 0.0)
    );
}

/// The rules through the ABI are the core's; a refusal names the parameter, and changes nothing.
#[test]
fn the_parameters_by_rule_are_the_cores() {
    use alula::Parameters as _;
    let response = alula::ResponseParameters::DEFAULT
        .rate_lag(0.3)
        .thrust_lag(0.3)
        .control_rate(50.0)
        .cruise_speed(12.0);
    let ruled = |parameters: &mut Parameters, rate_lag| unsafe {
        alula_parameters_for_vehicle(parameters, rate_lag, 0.3, 50.0, 12.0)
    };
    let mut parameters = PAPER;
    assert_eq!(ruled(&mut parameters, 0.3), ALULA_OK);
    let expected = GuidanceParameters::for_vehicle(&VEHICLE, &response).unwrap();
    assert_eq!(parameters.guidance, expected);
    assert_ne!(expected, GuidanceParameters::default());
    assert_eq!(parameters.vehicle, VEHICLE);

    let named = |code: i32| {
        let text = unsafe { std::ffi::CStr::from_ptr(alula_strerror(code)) };
        text.to_str().unwrap()
    };
    let before = parameters;
    assert_eq!(
        named(ruled(&mut parameters, f32::NAN)),
        "guidance.rate_lag must be from 0 to 1 s"
    );
    // Two numbers that are in no structure.
    let asked = |parameters: &mut Parameters, rate, cruise| unsafe {
        alula_parameters_for_vehicle(parameters, 0.3, 0.3, rate, cruise)
    };
    assert_eq!(
        [
            asked(&mut parameters, 1e9, 12.0),
            asked(&mut parameters, 50.0, -1.0)
        ],
        [ALULA_ERROR_CONTROL_RATE, ALULA_ERROR_CRUISE_SPEED]
    );
    parameters.vehicle.thrust_max = 90.0;
    let code = ruled(&mut parameters, 0.3);
    assert_eq!(
        named(code),
        "vehicle.thrust_max must be above thrust_min, and above the weight, mass times gravity"
    );
    assert_eq!(parameters.guidance, before.guidance);
}
