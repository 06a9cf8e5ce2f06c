//! The guidance, the table model and the envelope through the ABI, against the core itself.
#![cfg(not(target_os = "none"))]

use std::ptr::{null, null_mut};

use alula::aero::Node;
use alula::control::{
    Air, BranchParameters, BranchSwitch, LimitParameters, Limits, OuterLoop, OuterLoopParameters,
    ReferenceLimit, ReferenceLimitParameters, SupervisionParameters, Supervisor,
};
use alula::{
    Attitude, BandwidthGains, BandwidthParameters, Combined, CombinedParameters, Equilibria,
    GainParameters, Gains, Guidance, GuidanceInput, GuidanceState, Inertial, Reference, Vehicle,
    VehicleParameters, VelocityControl,
};
use alula_capi::*;

const DT: f32 = 0.01;

fn controller(parameters: &Parameters, table: *const Table) -> Controller {
    let mut controller = Controller {
        header: Controller::HEADER,
        reserved: 0,
        opaque: [0; 63],
    };
    let code = unsafe { alula_init(&mut controller, parameters, table) };
    assert_eq!(code, ALULA_OK);
    controller
}

fn report() -> GuidanceReport {
    // SAFETY: numbers only.
    let zero: GuidanceReport = unsafe { std::mem::zeroed() };
    GuidanceReport {
        header: GuidanceReport::HEADER,
        ..zero
    }
}

fn guide(c: &mut Controller, input: &NedInput) -> (i32, NedCommand, GuidanceReport) {
    let (mut command, mut report) = (NedCommand::SAFE, report());
    let code = unsafe { alula_guide(c, input, DT, &mut command, &mut report) };
    (code, command, report)
}

/// The defaults as the core's guidance, with gains by bandwidth.
fn core() -> Guidance<Combined, BandwidthGains> {
    let p = Parameters::DEFAULT;
    let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
    let vehicle = Vehicle::new(VehicleParameters::PAPER, model).unwrap();
    let gains = BandwidthGains::new(BandwidthParameters::PAPER_VEHICLE, &vehicle).unwrap();
    Guidance {
        control: VelocityControl::new(vehicle, gains),
        reference_limit: ReferenceLimit::new(ReferenceLimitParameters {
            acceleration: p.reference_acceleration_max,
            rate: p.reference_rate,
        })
        .unwrap(),
        outer_loop: OuterLoop::new(OuterLoopParameters {
            position_gain: Inertial::new(p.position_gain_down, p.position_gain_forward),
            pull: Inertial::new(p.pull_down, p.pull_forward),
            integral_gain: Inertial::new(p.integral_gain_down, p.integral_gain_forward),
            integral: Inertial::new(p.integral_down, p.integral_forward),
            forward_error: p.forward_error,
        })
        .unwrap(),
        branch: BranchSwitch::new(BranchParameters {
            switch: true,
            hysteresis: p.branch_hysteresis,
            fade: p.branch_fade,
        })
        .unwrap(),
        limits: Limits::new(LimitParameters {
            thrust_min: p.thrust_min,
            thrust_max: p.thrust_max,
            rate: p.rate_max,
            slew: p.slew_max,
        })
        .unwrap(),
        supervisor: Supervisor::new(SupervisionParameters {
            hold: p.hold,
            recovery: p.recovery,
            state_age: p.state_age,
            reference_age: p.reference_age,
            air_hold: p.air_hold,
            safe_thrust: p.safe_thrust,
        })
        .unwrap(),
    }
}

/// Heading north, by pitch: nothing is rounded between the axes, and a flight through the ABI is the core's to the bit,
/// with air data of every kind, position errors, stale and damaged frames in it.
#[test]
fn a_guided_flight_is_the_cores_to_the_bit() {
    let mut c = controller(
        &Parameters {
            gains: ALULA_GAINS_BANDWIDTH,
            ..Parameters::DEFAULT
        },
        null(),
    );
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
    let seen = ALULA_STATUS_HOLDING | ALULA_STATUS_SAFE | ALULA_STATUS_REFERENCE_HELD;
    assert_eq!(statuses & seen, seen);
}

#[test]
fn what_is_no_frame_is_bridged_and_then_safe() {
    let mut c = controller(&Parameters::DEFAULT, null());
    let hover = NedInput::DEFAULT;
    for _ in 0..20 {
        guide(&mut c, &hover);
    }
    let (code, flown, _) = guide(&mut c, &hover);
    assert!(code == ALULA_OK && flown.status == 0 && (flown.thrust - 98.1).abs() < 0.1);
    for (heading, wanted) in [(f32::NAN, ALULA_ERROR_HEADING), (1e6, ALULA_ERROR_HEADING)] {
        let (code, held, _) = guide(&mut c, &NedInput { heading, ..hover });
        assert_eq!(
            (code, held.status, held.thrust),
            (wanted, ALULA_STATUS_HOLDING, flown.thrust)
        );
        // Whatever was bad, nothing that is given back is.
        let numbers = held.quaternion.iter().chain(&held.body_rate);
        assert!(
            numbers
                .chain([&held.pitch, &held.lateral_velocity])
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
    let mut new = controller(&Parameters::DEFAULT, null());
    for _ in 0..20 {
        assert_eq!(guide(&mut c, &hover), guide(&mut new, &hover));
    }
    let mut command = NedCommand::SAFE;
    let code = unsafe { alula_guide(&mut c, &hover, DT, &mut command, null_mut()) };
    assert_eq!((code, command.status), (ALULA_OK, 0));
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
    let with_table = Parameters {
        model: ALULA_MODEL_TABLE,
        ..Parameters::DEFAULT
    };
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
        let mut c = controller(&Parameters::DEFAULT, null());
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
    let polar = Box::leak(Box::new(alula::aero::Polar::<95>::new(&nodes).unwrap()));
    let vehicle = Vehicle::new(VehicleParameters::PAPER, alula::Table::new(polar)).unwrap();
    let core = VelocityControl::new(vehicle, Gains::new(GainParameters::PAPER).unwrap());
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
    let c = controller(&Parameters::DEFAULT, null());
    let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
    let vehicle = Vehicle::new(VehicleParameters::PAPER, model).unwrap();
    // SAFETY: numbers only.
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
            let mut command = NedCommand::SAFE;
            let code = unsafe { alula_step_ned(&c, &input, DT, &mut command) };
            assert_eq!(code, ALULA_OK);
            // 1e-4 rad of an attitude that is known to 1e-6 rad, under forces 20 times the weight.
            let off = command.theta_tilde.abs();
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
