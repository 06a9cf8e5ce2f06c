//! What a caller can do wrong, and the code it gets; and what a caller gets that does everything right.
//! `misuse.c` does the first from C, under sanitizers.
#![cfg(not(target_os = "none"))]

use std::ffi::CStr;
use std::mem::offset_of;
use std::ptr::{null, null_mut};

use alula::planar::GainLaw;
use alula::{Combined, Guidance, Vehicle, VehicleParameters};
use alula_capi::*;

/// The defaults, of the paper's vehicle.
const PAPER: Parameters = Parameters {
    vehicle: VehicleParameters::PAPER,
    ..Parameters::DEFAULT
};

fn controller(parameters: &Parameters) -> Result<Controller, i32> {
    let mut controller = Controller::BLANK;
    match unsafe { alula_init(&mut controller, parameters, null()) } {
        ALULA_OK => Ok(controller),
        code => Err(code),
    }
}

fn good() -> Controller {
    controller(&PAPER).unwrap()
}

/// `value` with the word at `offset` replaced.
fn poke<T: Copy>(mut value: T, offset: usize, word: u32) -> T {
    assert!(offset + 4 <= size_of::<T>());
    unsafe { (&raw mut value).byte_add(offset).cast::<u32>().write(word) };
    value
}

/// Numbers that are none, or absurd.
const BAD: [f32; 5] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -3e38];
const DENORMAL: u32 = 1;

#[test]
fn null_unaligned_and_foreign_structures_are_told_apart() {
    let mut c = good();
    let mut out = Command::SAFE;
    unsafe {
        assert_eq!(
            alula_step(null(), &Input::DEFAULT, 0.01, &mut out, null_mut()),
            ALULA_ERROR_NULL
        );
        assert_eq!(
            alula_step(&c, null(), 0.01, &mut out, null_mut()),
            ALULA_ERROR_NULL
        );
        assert_eq!(
            alula_step(&c, &Input::DEFAULT, 0.01, null_mut(), null_mut()),
            ALULA_ERROR_NULL
        );
        assert_eq!(
            alula_guide(null_mut(), &Input::DEFAULT, 0.01, &mut out, null_mut()),
            ALULA_ERROR_NULL
        );
        assert_eq!(alula_init(null_mut(), &PAPER, null()), ALULA_ERROR_NULL);
        assert_eq!(alula_init(&mut c, null(), null()), ALULA_ERROR_NULL);
        // The failed initialisation has left none behind, and a new one brings it back.
        assert_eq!(
            alula_step(&c, &Input::DEFAULT, 0.01, &mut out, null_mut()),
            ALULA_ERROR_NOT_INITIALISED
        );
        assert_eq!(alula_init(&mut c, &PAPER, null()), ALULA_OK);
        assert_eq!(
            alula_step(&c, &Input::DEFAULT, 0.01, &mut out, null_mut()),
            ALULA_OK
        );

        let mut room = [0u64; 64];
        let odd = room.as_mut_ptr().byte_add(2);
        assert_eq!(
            alula_step(&c, odd.cast(), 0.01, &mut out, null_mut()),
            ALULA_ERROR_UNALIGNED
        );
        assert_eq!(
            alula_step(&c, &Input::DEFAULT, 0.01, odd.cast(), null_mut()),
            ALULA_ERROR_UNALIGNED
        );
        assert_eq!(
            alula_step(&c, &Input::DEFAULT, 0.01, &mut out, odd.cast()),
            ALULA_ERROR_UNALIGNED
        );
        assert_eq!(alula_reset(odd.cast()), ALULA_ERROR_UNALIGNED);
        let still = [0.0f32; 3];
        for (input, rates, code) in [
            (&Input::DEFAULT as *const Input, null(), ALULA_ERROR_NULL),
            (
                &Input::DEFAULT as *const Input,
                odd.cast_const().cast(),
                ALULA_ERROR_UNALIGNED,
            ),
            (null::<Input>(), still.as_ptr(), ALULA_ERROR_NULL),
        ] {
            assert_eq!(alula_take_over(&mut c, input, 0.5, rates), code);
        }

        let (vector, mut scale) = ([1.0f32, 2.0, 3.0], 9.0);
        let v = vector.as_ptr();
        for (error, velocity) in [(null(), v), (v, null()), (odd.cast_const().cast(), v)] {
            let code = alula_path_time_scale(&c, error, velocity, &mut scale);
            assert!(code == ALULA_ERROR_NULL || code == ALULA_ERROR_UNALIGNED);
            assert_eq!(scale, 1.0);
        }
        assert_eq!(
            alula_path_time_scale(&c, v, v, null_mut()),
            ALULA_ERROR_NULL
        );

        for bit in 0..32 {
            let header = 1 << bit;
            let wrong = poke(Input::DEFAULT, 0, Input::HEADER ^ header);
            out.thrust = 1.0;
            assert_eq!(
                alula_step(&c, &wrong, 0.01, &mut out, null_mut()),
                ALULA_ERROR_LAYOUT
            );
            assert_eq!(out, Command::SAFE);
            let mut wrong = poke(Command::SAFE, 0, Command::HEADER ^ header);
            assert_eq!(
                alula_step(&c, &Input::DEFAULT, 0.01, &mut wrong, null_mut()),
                ALULA_ERROR_LAYOUT
            );
            // Nowhere to put a command: nothing was touched.
            assert_eq!(wrong, poke(Command::SAFE, 0, Command::HEADER ^ header));
            let wrong = poke(PAPER, 0, Parameters::HEADER ^ header);
            assert_eq!(
                alula_init(&mut { Controller::BLANK }, &wrong, null()),
                ALULA_ERROR_LAYOUT
            );
        }
        assert_eq!(alula_abi_version(), ALULA_ABI_VERSION);
    }
}

/// The code of a value just below the least one.
fn below(min: f32, base: i32) -> i32 {
    if min > 0.0 && min.next_down() <= 0.0 {
        base - 1
    } else {
        base - 2
    }
}

/// Parameters that are refused only together with others: the text names the others, as the core does.
#[test]
fn both_parties_of_a_contradiction_are_named() {
    let core = |p: &Parameters| -> Result<(), alula::ParameterError> {
        let vehicle = Vehicle::new(p.vehicle, Combined::new(p.coefficients)?)?;
        Guidance::new(vehicle, &p.guidance).map(|_| ())
    };
    let changes: [fn(&mut Parameters); 8] = [
        |p| p.vehicle.thrust_min = 99.0,
        |p| p.vehicle.thrust_max = 97.0,
        |p| (p.vehicle.thrust_min, p.vehicle.thrust_max) = (99.0, 98.0),
        |p| p.guidance.safe_thrust = 100.0,
        |p| p.guidance.max_integral_down = 2.0 * p.guidance.max_velocity_down,
        |p| p.guidance.max_integral_forward = 2.0 * p.guidance.max_velocity_forward,
        |p| p.coefficients.k_l = 9000.0,
        |p| p.coefficients.k_d = 9000.0,
    ];
    for change in changes {
        let mut p = PAPER;
        change(&mut p);
        let error = core(&p).unwrap_err();
        let alula::Requirement::Relation(relation) = error.requirement else {
            panic!("{error}");
        };
        let code = controller(&p).err().unwrap();
        let text = unsafe { CStr::from_ptr(alula_strerror(code)) };
        let text = text.to_str().unwrap();
        assert!(
            text.contains(&format!(".{} must be ", error.parameter)),
            "{text}"
        );
        assert!(text.contains(relation), "{text}: {error}");
    }
}

#[test]
fn every_refused_parameter_is_named() {
    let rows = SECTIONS
        .iter()
        .flat_map(|section| section.rows.iter().map(|row| (section.field, row)));
    for (n, (field, p)) in rows.enumerate() {
        let offset = 4 * (n + 1);
        let code = |value: f32| controller(&poke(PAPER, offset, value.to_bits())).err();
        let base = ALULA_ERROR_PARAMETER - 4 * n as i32;
        for bad in [f32::NAN, f32::INFINITY] {
            assert_eq!(code(bad), Some(base), "{}", p.name);
        }
        assert_eq!(
            code(p.min.next_down()),
            Some(below(p.min, base)),
            "{}",
            p.name
        );
        assert_eq!(code(p.max.next_up()), Some(base - 2), "{}", p.name);
        if n < CHOICES {
            assert_eq!(code(0.5), Some(base - 2));
        }
        // Of a number that is not finite, not positive or out of range it is said what it must be: to six digits.
        for problem in 0..3 {
            let text = unsafe { CStr::from_ptr(alula_strerror(base - problem)) };
            let must_be = format!("{field}.{} must be from ", p.name);
            let text = text.to_str().unwrap().strip_prefix(&must_be).unwrap();
            let (least, rest) = text.split_once(" to ").unwrap();
            let (most, unit) = rest.split_once(' ').unwrap_or((rest, ""));
            let is = |text: &str, b: f32| {
                let a: f32 = text.parse().unwrap();
                (a - b).abs() <= 5e-6 * b.abs()
            };
            assert!(is(least, p.min) && is(most, p.max), "{text}");
            assert_eq!(unit, p.unit);
        }
    }
    // What has no default must be set.
    let text = |code| unsafe { CStr::from_ptr(alula_strerror(code)) };
    assert_eq!(
        text(controller(&Parameters::DEFAULT).err().unwrap()),
        c"vehicle.mass must be from 0.001 to 1000000 kg"
    );
    let mut table = PAPER;
    table.controller.model = ALULA_MODEL_TABLE as f32;
    assert_eq!(controller(&table).err(), Some(ALULA_ERROR_NULL));
    // A parameter that has no relation to others.
    assert_eq!(
        text(ALULA_ERROR_PARAMETER - 3),
        c"controller.gains must be in agreement with the others"
    );
    for code in [1, -99, -1000, i32::MIN, i32::MAX] {
        assert_eq!(text(code), c"unknown code");
    }
}

/// Every number of an input, and the code that a bad one gets from the pure law.
const FIELDS: &[(usize, usize, i32)] = &[
    (offset_of!(Input, quaternion), 4, ALULA_ERROR_ATTITUDE),
    (offset_of!(Input, velocity), 3, ALULA_ERROR_VELOCITY),
    (offset_of!(Input, air), 3, ALULA_ERROR_WIND),
    (
        offset_of!(Input, reference_velocity),
        3,
        ALULA_ERROR_REFERENCE_VELOCITY,
    ),
    (
        offset_of!(Input, reference_acceleration),
        3,
        ALULA_ERROR_REFERENCE_ACCELERATION,
    ),
    (
        offset_of!(Input, air_acceleration),
        3,
        ALULA_ERROR_AIR_ACCELERATION,
    ),
    (offset_of!(Input, reference_jerk), 3, ALULA_ERROR_JERK),
];

#[test]
fn every_bad_number_is_named_and_gives_the_safe_command() {
    let c = good();
    let all = Input {
        flags: ALULA_FEED_FORWARD,
        quaternion: [0.5; 4],
        ..Input::DEFAULT
    };
    for &(offset, count, code) in FIELDS {
        for n in 0..count {
            for bad in BAD {
                let input = poke(all, offset + 4 * n, bad.to_bits());
                let mut out = Command::SAFE;
                out.thrust = 1.0;
                let got = unsafe { alula_step(&c, &input, 0.01, &mut out, null_mut()) };
                assert_eq!((got, out), (code, Command::SAFE), "{offset} {n} {bad}");
            }
            let input = poke(Input::DEFAULT, offset + 4 * n, DENORMAL);
            let mut out = Command::SAFE;
            let got = unsafe { alula_step(&c, &input, 0.01, &mut out, null_mut()) };
            let part_of_an_attitude = offset == offset_of!(Input, quaternion) && n % 2 == 0;
            assert_eq!(got == ALULA_OK, !part_of_an_attitude);
            assert!(out.thrust.is_finite());
        }
    }
    let step = |input: Input, dt| {
        let mut out = Command::SAFE;
        unsafe { alula_step(&c, &input, dt, &mut out, null_mut()) }
    };
    for dt in [0.0, -0.01, f32::NAN, f32::INFINITY, 0.3] {
        assert_eq!(step(all, dt), ALULA_ERROR_TIME_STEP);
    }
    let selectors = [
        Input { flags: 256, ..all },
        Input {
            flags: ALULA_AIR_PITOT | ALULA_AIR_UNKNOWN,
            ..all
        },
        Input {
            flags: ALULA_AIR_VELOCITY | ALULA_AIR_UNKNOWN,
            ..all
        },
        Input {
            body_axes: 2,
            ..all
        },
    ];
    for input in selectors {
        assert_eq!(step(input, 0.01), ALULA_ERROR_SELECTOR);
    }
    // A heading that is none is free.
    for heading in BAD {
        assert_eq!(step(Input { heading, ..all }, 0.01), ALULA_OK);
    }
    assert_eq!(
        step(
            Input {
                flags: ALULA_AIR_UNKNOWN,
                ..all
            },
            0.01
        ),
        ALULA_ERROR_WIND
    );
}

/// With either kind of gains, with feed-forward and without, commands are the core's to the bit.
#[test]
fn commands_are_the_cores() {
    use alula::guidance::BandwidthGains;
    use alula::ned::{BodyAxes, BodyRates, Quaternion};
    use alula::planar::{GainParameters, Gains};
    use alula::spatial::{FeedForward, Heading, Ned, Orientation, Reference, State};
    use alula::{Combined, CombinedParameters, GainChoice, Guidance, GuidanceParameters, Vehicle};
    let vehicle = VehicleParameters::PAPER.c_y(0.4);
    let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
    let believed = Vehicle::new(vehicle, model).unwrap();
    let gains = Gains::new(GainParameters::PAPER).unwrap();
    let parameters = GuidanceParameters::default();
    let bandwidth = BandwidthGains::new(&parameters, &believed).unwrap();
    for (gains, choice) in [
        (GainChoice::Constant(gains), ALULA_GAINS_CONSTANT),
        (GainChoice::Bandwidth(bandwidth), ALULA_GAINS_BANDWIDTH),
    ] {
        // 0.91 m g is 89.3 N.
        assert!((75.0..95.0).contains(&gains.guard().tau()));
        let core = Guidance::with_gains(believed, gains, &parameters).unwrap();
        let mut p = PAPER;
        p.vehicle = vehicle;
        p.controller.gains = choice as f32;
        let c = controller(&p).unwrap();
        for n in 0..20_000 {
            let x = n as f32;
            let (s, t) = ((0.37 * x).sin_cos(), (0.21 * x).sin_cos());
            let q = [s.0 * t.0, s.0 * t.1, s.1 * t.0, s.1 * t.1];
            let input = alula_capi::Input {
                flags: (n % 2) | if n % 3 == 0 { ALULA_AIR_VELOCITY } else { 0 },
                body_axes: n / 2 % 2,
                velocity: [15.0 * (0.13 * x).cos(), 3.0, 8.0 * (0.11 * x).sin()],
                quaternion: q,
                air: [10.0, -2.0, 0.5],
                reference_velocity: [10.0, 1.0, 0.0],
                reference_acceleration: [0.5, 2.0, 0.0],
                heading: 0.3,
                air_acceleration: [-0.5, 0.2, 1.0],
                reference_jerk: [0.1, -0.3, 0.0],
                ..alula_capi::Input::DEFAULT
            };
            let ned = |v: [f32; 3]| Ned::new(v[0], v[1], v[2]);
            let axes = [BodyAxes::NoseForward, BodyAxes::NoseUp][n as usize / 2 % 2];
            let [w, x, y, z] = q;
            let velocity = ned(input.velocity);
            let state = State {
                velocity,
                orientation: Orientation::from_quaternion(&Quaternion { w, x, y, z }, axes)
                    .unwrap(),
                wind: if n % 3 == 0 {
                    velocity - ned(input.air)
                } else {
                    ned(input.air)
                },
                ..State::default()
            };
            let reference = Reference {
                velocity: ned(input.reference_velocity),
                acceleration: ned(input.reference_acceleration),
                heading: Heading::from_angle(0.3),
            };
            let ff = FeedForward {
                air_acceleration: ned(input.air_acceleration),
                jerk: ned(input.reference_jerk),
            };
            let ff = (n % 2 == 1).then_some(&ff);
            let wanted = core.control().robust(&state, &reference, ff).unwrap();
            let mut out = alula_capi::Command::SAFE;
            // SAFETY: Zero is a value of every field.
            let mut report: Report = unsafe { std::mem::zeroed() };
            report.header = Report::HEADER;
            let code = unsafe { alula_step(&c, &input, 0.01, &mut out, &mut report) };
            assert_eq!(code, ALULA_OK);
            let BodyRates { roll, pitch, yaw } = wanted.rates;
            let rates = match axes {
                BodyAxes::NoseForward => [roll, pitch, yaw],
                BodyAxes::NoseUp => [yaw, pitch, -roll],
            };
            assert_eq!((out.thrust, out.body_rate), (wanted.thrust, rates));
            let d = wanted.diagnostics;
            assert_eq!(
                [report.alpha, report.f_p_norm, report.t_p, report.tilt],
                [d.plane.alpha, d.plane.f_p_norm, d.plane.t_p, d.tilt()]
            );
            assert_eq!(report.velocity, input.reference_velocity);
        }
    }
}
