//! What a caller can do wrong, and the code it gets; and what a caller gets that does everything right.
//! `misuse.c` does the first from C, under sanitizers.
#![cfg(not(target_os = "none"))]

use std::ffi::CStr;
use std::mem::offset_of;
use std::ptr::{null, null_mut};

use alula::VehicleParameters;
use alula::control::GainLaw;
use alula_capi::*;

/// The defaults, of the paper's vehicle.
const PAPER: Parameters = Parameters {
    vehicle: VehicleParameters::PAPER,
    ..Parameters::DEFAULT
};

fn blank() -> Controller {
    Controller {
        header: Controller::HEADER,
        reserved: 0,
        opaque: [0; 95],
    }
}

fn controller(parameters: &Parameters) -> Result<Controller, i32> {
    let mut controller = blank();
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
    let mut out = NedCommand::SAFE;
    unsafe {
        let mut plane = Command::SAFE;
        assert_eq!(
            alula_step(null(), &Input::DEFAULT, 0.01, &mut plane),
            ALULA_ERROR_NULL
        );
        assert_eq!(alula_step(&c, null(), 0.01, &mut plane), ALULA_ERROR_NULL);
        assert_eq!(
            alula_step(&c, &Input::DEFAULT, 0.01, null_mut()),
            ALULA_ERROR_NULL
        );
        assert_eq!(
            alula_guide(null_mut(), &NedInput::DEFAULT, 0.01, &mut out, null_mut()),
            ALULA_ERROR_NULL
        );
        assert_eq!(alula_init(null_mut(), &PAPER, null()), ALULA_ERROR_NULL);
        assert_eq!(alula_init(&mut c, null(), null()), ALULA_ERROR_NULL);
        // The failed initialisation has left none behind, and a new one brings it back.
        assert_eq!(
            alula_step_ned(&c, &NedInput::DEFAULT, 0.01, &mut out, null_mut()),
            ALULA_ERROR_NOT_INITIALISED
        );
        assert_eq!(alula_init(&mut c, &PAPER, null()), ALULA_OK);
        assert_eq!(
            alula_step_ned(&c, &NedInput::DEFAULT, 0.01, &mut out, null_mut()),
            ALULA_OK
        );

        let mut room = [0u64; 64];
        let odd = room.as_mut_ptr().byte_add(2);
        assert_eq!(
            alula_step_ned(&c, odd.cast(), 0.01, &mut out, null_mut()),
            ALULA_ERROR_UNALIGNED
        );
        assert_eq!(
            alula_step_ned(&c, &NedInput::DEFAULT, 0.01, odd.cast(), null_mut()),
            ALULA_ERROR_UNALIGNED
        );
        assert_eq!(
            alula_step(&c, odd.cast(), 0.01, &mut plane),
            ALULA_ERROR_UNALIGNED
        );
        assert_eq!(alula_reset(odd.cast()), ALULA_ERROR_UNALIGNED);

        for bit in 0..32 {
            let header = 1 << bit;
            let wrong = poke(NedInput::DEFAULT, 0, NedInput::HEADER ^ header);
            out.thrust = 1.0;
            assert_eq!(
                alula_step_ned(&c, &wrong, 0.01, &mut out, null_mut()),
                ALULA_ERROR_LAYOUT
            );
            assert_eq!(out, NedCommand::SAFE);
            let mut wrong = poke(NedCommand::SAFE, 0, NedCommand::HEADER ^ header);
            assert_eq!(
                alula_step_ned(&c, &NedInput::DEFAULT, 0.01, &mut wrong, null_mut()),
                ALULA_ERROR_LAYOUT
            );
            // Nowhere to put a command: nothing was touched.
            assert_eq!(
                wrong,
                poke(NedCommand::SAFE, 0, NedCommand::HEADER ^ header)
            );
            let wrong = poke(PAPER, 0, Parameters::HEADER ^ header);
            assert_eq!(alula_init(&mut blank(), &wrong, null()), ALULA_ERROR_LAYOUT);
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
        if n < CHOICES.len() {
            assert_eq!(code(0.5), Some(base - 2));
        }
        for (problem, what) in [
            "must be a finite number",
            "must be positive",
            "is out of range",
            "contradicts another parameter",
        ]
        .iter()
        .enumerate()
        {
            let text = unsafe { CStr::from_ptr(alula_strerror(base - problem as i32)) };
            let wanted = format!("{field}.{} {what}", p.name);
            assert_eq!(text.to_str(), Ok(wanted.as_str()));
        }
    }
    // What has no default must be set.
    let text = |code| unsafe { CStr::from_ptr(alula_strerror(code)) };
    assert_eq!(
        text(controller(&Parameters::DEFAULT).err().unwrap()),
        c"vehicle.mass must be a finite number"
    );
    // Refused only together with others.
    let mut crossed = PAPER;
    crossed.vehicle.thrust_min = 99.0;
    assert_eq!(
        text(controller(&crossed).err().unwrap()),
        c"vehicle.thrust_min contradicts another parameter"
    );
    let mut sharp = PAPER;
    sharp.coefficients.k_d = 9000.0;
    assert_eq!(
        text(controller(&sharp).err().unwrap()),
        c"coefficients.k_d is out of range"
    );
    let mut table = PAPER;
    table.controller.model = ALULA_MODEL_TABLE as f32;
    assert_eq!(controller(&table).err(), Some(ALULA_ERROR_NULL));
    for code in [1, -7, -1000, i32::MIN, i32::MAX] {
        assert_eq!(text(code), c"unknown code");
    }
}

/// Every number of an input, and the code that a bad one gets from the pure law.
const FIELDS: &[(usize, usize, i32)] = &[
    (offset_of!(NedInput, heading), 1, ALULA_ERROR_HEADING),
    (offset_of!(NedInput, quaternion), 4, ALULA_ERROR_ATTITUDE),
    (offset_of!(NedInput, velocity), 3, ALULA_ERROR_VELOCITY),
    (offset_of!(NedInput, air), 3, ALULA_ERROR_WIND),
    (
        offset_of!(NedInput, reference_velocity),
        3,
        ALULA_ERROR_REFERENCE_VELOCITY,
    ),
    (
        offset_of!(NedInput, reference_acceleration),
        3,
        ALULA_ERROR_REFERENCE_ACCELERATION,
    ),
    (
        offset_of!(NedInput, air_acceleration),
        3,
        ALULA_ERROR_AIR_ACCELERATION,
    ),
    (offset_of!(NedInput, reference_jerk), 3, ALULA_ERROR_JERK),
];

#[test]
fn every_bad_number_is_named_and_gives_the_safe_command() {
    let c = good();
    let all = NedInput {
        flags: ALULA_FEED_FORWARD,
        heading: 0.5,
        quaternion: [0.5; 4],
        ..NedInput::DEFAULT
    };
    for &(offset, count, code) in FIELDS {
        for n in 0..count {
            for bad in BAD {
                let input = poke(all, offset + 4 * n, bad.to_bits());
                let mut out = NedCommand::SAFE;
                out.thrust = 1.0;
                let got = unsafe { alula_step_ned(&c, &input, 0.01, &mut out, null_mut()) };
                assert_eq!((got, out), (code, NedCommand::SAFE), "{offset} {n} {bad}");
            }
            let input = poke(NedInput::DEFAULT, offset + 4 * n, DENORMAL);
            let mut out = NedCommand::SAFE;
            let got = unsafe { alula_step_ned(&c, &input, 0.01, &mut out, null_mut()) };
            let part_of_an_attitude = offset == offset_of!(NedInput, quaternion) && n % 2 == 0;
            assert_eq!(got == ALULA_OK, !part_of_an_attitude);
            assert!(out.thrust.is_finite());
        }
    }
    let step = |input: NedInput, dt| {
        let mut out = NedCommand::SAFE;
        unsafe { alula_step_ned(&c, &input, dt, &mut out, null_mut()) }
    };
    for dt in [0.0, -0.01, f32::NAN, f32::INFINITY, 0.3] {
        assert_eq!(step(all, dt), ALULA_ERROR_TIME_STEP);
        let mut out = Command::SAFE;
        let code = unsafe { alula_step(&c, &Input::DEFAULT, dt, &mut out) };
        assert_eq!((code, out), (ALULA_ERROR_TIME_STEP, Command::SAFE));
    }
    let selectors = [
        NedInput { flags: 16, ..all },
        NedInput {
            flags: ALULA_AIR_VELOCITY | ALULA_AIR_UNKNOWN,
            ..all
        },
        NedInput {
            body_axes: 2,
            ..all
        },
        NedInput { attitude: 2, ..all },
    ];
    for input in selectors {
        assert_eq!(step(input, 0.01), ALULA_ERROR_SELECTOR);
    }
    for pitch in BAD {
        let input = NedInput {
            attitude: ALULA_ATTITUDE_PITCH,
            pitch,
            ..all
        };
        assert_eq!(step(input, 0.01), ALULA_ERROR_ATTITUDE);
    }
    assert_eq!(
        step(
            NedInput {
                flags: ALULA_AIR_UNKNOWN,
                ..all
            },
            0.01
        ),
        ALULA_ERROR_WIND
    );
}

#[test]
fn every_bad_number_of_the_plane_is_named_and_gives_the_safe_command() {
    let c = good();
    let codes = [
        ALULA_ERROR_VELOCITY,
        ALULA_ERROR_ATTITUDE,
        ALULA_ERROR_WIND,
        ALULA_ERROR_REFERENCE_VELOCITY,
        ALULA_ERROR_REFERENCE_ACCELERATION,
        ALULA_ERROR_AIR_ACCELERATION,
        ALULA_ERROR_JERK,
    ];
    let all = Input {
        flags: ALULA_FEED_FORWARD,
        ..Input::DEFAULT
    };
    for (n, code) in codes.into_iter().enumerate() {
        for k in 0..2 {
            for bad in BAD {
                let offset = offset_of!(Input, velocity) + 8 * n + 4 * k;
                let mut out = Command::SAFE;
                let got =
                    unsafe { alula_step(&c, &poke(all, offset, bad.to_bits()), 0.01, &mut out) };
                assert_eq!((got, out), (code, Command::SAFE), "{n} {k} {bad}");
            }
        }
    }
}

/// Both ways of the plane's step, and both laws, give the core's command to the bit.
#[test]
fn commands_are_the_cores() {
    use alula::*;
    let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
    let vehicle = Vehicle::new(VehicleParameters::PAPER, model).unwrap();
    let gains = Gains::new(GainParameters::PAPER).unwrap();
    let bandwidth = BandwidthGains::new(&GuidanceParameters::default(), &vehicle).unwrap();
    for (gains, choice) in [
        (GainChoice::Constant(gains), ALULA_GAINS_CONSTANT),
        (GainChoice::Bandwidth(bandwidth), ALULA_GAINS_BANDWIDTH),
    ] {
        // 0.91 m g is 89.3 N.
        assert!((75.0..95.0).contains(&gains.guard().tau()));
        let core = VelocityControl::new(vehicle, gains);
        let mut undefined = 0;
        for n in 0..20_000 {
            let x = n as f32;
            let theta = 0.37 * x;
            let input = alula_capi::Input {
                flags: n % 2,
                velocity: [8.0 * (0.11 * x).sin(), 15.0 * (0.13 * x).cos()],
                attitude: [theta.cos(), theta.sin()],
                reference_velocity: [0.0, 10.0],
                air_acceleration: [1.0, -0.5],
                ..alula_capi::Input::DEFAULT
            };
            let state = State {
                velocity: Inertial::new(input.velocity[0], input.velocity[1]),
                attitude: Attitude {
                    cos: input.attitude[0],
                    sin: input.attitude[1],
                },
                wind: Inertial::ZERO,
            };
            let reference = Reference {
                velocity: Inertial::new(0.0, 10.0),
                acceleration: Inertial::ZERO,
            };
            let ff = FeedForward {
                air_acceleration: Inertial::new(1.0, -0.5),
                jerk: Inertial::ZERO,
            };
            let ff = (n % 2 == 1).then_some(&ff);
            for law in [ALULA_LAW_ROBUST, ALULA_LAW_FULL] {
                let mut p = PAPER;
                p.controller.law = law as f32;
                p.controller.gains = choice as f32;
                let c = controller(&p).unwrap();
                let wanted = if law == ALULA_LAW_ROBUST {
                    core.robust(&state, &reference, ff)
                } else {
                    core.full(&state, &reference, ff)
                };
                let mut out = alula_capi::Command::SAFE;
                let code = unsafe { alula_step(&c, &input, 0.01, &mut out) };
                let Ok(wanted) = wanted else {
                    assert_eq!(
                        (code, out),
                        (ALULA_ERROR_UNDEFINED, alula_capi::Command::SAFE)
                    );
                    undefined += 1;
                    continue;
                };
                assert_eq!(code, ALULA_OK);
                assert_eq!((out.thrust, out.rate), (wanted.thrust, wanted.rate));
                let d = wanted.diagnostics;
                assert_eq!(
                    [out.alpha, out.f_p_norm, out.t_p, out.k],
                    [d.alpha, d.f_p_norm, d.t_p, d.k]
                );
            }
        }
        // The full law's rate grows as the inverse cube of π − θ̃, and is refused above 1e9 rad/s: within 4e-3 of π, which is
        // where one state in 800 is.
        assert!((10..60).contains(&undefined), "{undefined}");
    }
}
