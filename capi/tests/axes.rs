//! North-east-down and both body axes, through the ABI, against nalgebra's quaternions in double precision.
#![cfg(not(target_os = "none"))]

use std::f64::consts::{FRAC_PI_2, PI};

use alula_capi::*;
use nalgebra::{UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const CASES: usize = 100_000;

fn controller() -> Controller {
    let parameters = Parameters {
        vehicle: alula::VehicleParameters::PAPER,
        ..Parameters::DEFAULT
    };
    let mut controller = Controller {
        header: Controller::HEADER,
        reserved: 0,
        opaque: [0; 95],
    };
    let code = unsafe { alula_init(&mut controller, &parameters, std::ptr::null()) };
    assert_eq!(code, ALULA_OK);
    controller
}

fn step(controller: &Controller, input: &NedInput) -> Result<(NedCommand, NedReport), i32> {
    let mut command = NedCommand::SAFE;
    // SAFETY: Zero is a value of every field.
    let mut report: NedReport = unsafe { std::mem::zeroed() };
    report.header = NedReport::HEADER;
    match unsafe { alula_step_ned(controller, input, 0.01, &mut command, &mut report) } {
        ALULA_OK => Ok((command, report)),
        code => Err(code),
    }
}

fn about(axis: Vector3<f64>, angle: f64) -> UnitQuaternion<f64> {
    UnitQuaternion::from_scaled_axis(axis * angle)
}

fn words(q: &UnitQuaternion<f64>) -> [f32; 4] {
    [q.w, q.i, q.j, q.k].map(|v| v as f32)
}

/// Heading, then pitch, tilt and bank about the axes as they have turned.
fn compose(heading: f64, pitch: f64, tilt: f64, bank: f64) -> UnitQuaternion<f64> {
    about(Vector3::z(), heading)
        * about(Vector3::y(), pitch)
        * about(Vector3::z(), tilt)
        * about(Vector3::x(), bank)
}

/// Multicopter axes from fixed-wing axes.
fn nose_up(forward: &UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    forward * about(Vector3::y(), -FRAC_PI_2)
}

/// An attitude anywhere; every fourth with Euler angles of which the pitch is locked at ±90°.
fn attitude(rng: &mut ChaCha8Rng, n: usize) -> UnitQuaternion<f64> {
    let mut angle = |limit: f64| rng.random_range(-limit..limit);
    if n.is_multiple_of(4) {
        let pitch = if n.is_multiple_of(8) {
            FRAC_PI_2
        } else {
            -FRAC_PI_2
        };
        UnitQuaternion::from_euler_angles(angle(PI), pitch, angle(PI))
    } else {
        let v: [f64; 4] = std::array::from_fn(|_| angle(1.0));
        UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(v[0], v[1], v[2], v[3]))
    }
}

/// Every attitude comes back from pitch, tilt and bank, in both body conventions; the commanded rate turns it in its plane;
/// the lateral components are those along the plane's normal.
#[test]
fn random_attitudes_return_in_both_body_conventions() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let controller = controller();
    let (mut worst, mut refused) = (0f64, 0);
    for n in 0..CASES {
        let q = attitude(&mut rng, n);
        let heading = f64::from(rng.random_range(-PI..PI) as f32);
        let right = Vector3::new(-heading.sin(), heading.cos(), 0.0);
        let across = (q * Vector3::x()).dot(&right);
        let velocity: [f32; 3] = std::array::from_fn(|_| rng.random_range(-20.0..20.0));
        for (axes, body) in [
            (ALULA_BODY_NOSE_FORWARD, q),
            (ALULA_BODY_NOSE_UP, nose_up(&q)),
        ] {
            let input = NedInput {
                body_axes: axes,
                heading: heading as f32,
                quaternion: words(&body),
                velocity,
                ..NedInput::DEFAULT
            };
            let (command, report) = match step(&controller, &input) {
                Ok(both) => both,
                Err(code) => {
                    // Refused only with the nose across the plane, to 1e-3.
                    assert_eq!(code, ALULA_ERROR_ATTITUDE);
                    assert!(across.abs() > 0.999_999);
                    refused += 1;
                    continue;
                }
            };
            let lead = (f64::from(command.pitch_rate) / 6.5).clamp(-FRAC_PI_2, FRAC_PI_2);
            let offset = if axes == ALULA_BODY_NOSE_UP {
                FRAC_PI_2
            } else {
                0.0
            };
            let pitch = f64::from(command.pitch) - lead + offset;
            let back = compose(
                heading,
                pitch,
                f64::from(report.tilt),
                f64::from(report.bank),
            );
            // With the nose nearly across the plane pitch and bank are the more uncertain, and make up for each other.
            worst = worst.max(back.angle_to(&q) * (1.0 - across * across).sqrt());
            // The rate, in world axes, is about the plane's normal.
            let rate = body * Vector3::from(command.body_rate.map(f64::from));
            let wanted = right * f64::from(command.pitch_rate);
            assert!((rate - wanted).norm() <= 1e-6 * (1.0 + wanted.norm()));
            // The set-point is the plane's heading, its pitch, and no more.
            let set = nalgebra::Quaternion::from(nalgebra::Vector4::new(
                f64::from(command.quaternion[1]),
                f64::from(command.quaternion[2]),
                f64::from(command.quaternion[3]),
                f64::from(command.quaternion[0]),
            ));
            let wanted = compose(heading, f64::from(command.pitch), 0.0, 0.0);
            let set = UnitQuaternion::from_quaternion(set);
            assert!(set.angle_to(&wanted) < 1e-6, "{}", set.angle_to(&wanted));
            let lateral = Vector3::from(velocity.map(f64::from)).dot(&right);
            // 1e-5: roundings of 35 m/s.
            assert!((f64::from(report.lateral_velocity) - lateral).abs() < 1e-5);
        }
    }
    // The quaternion's own rounding, the lead's, and a few more: measured 4.9e-7.
    assert!(worst < 1e-6, "{worst:e}");
    assert!(refused < CASES / 1000);
}

/// The command in NED is that of the plane, in every plane, from every attitude, by quaternion and by pitch.
#[test]
fn commands_are_those_of_the_plane() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let controller = controller();
    for n in 0..CASES {
        let mut number = |limit: f64| f64::from(rng.random_range(-limit..limit) as f32);
        let (heading, pitch) = (number(PI), number(PI));
        let theta = pitch - FRAC_PI_2;
        let forward = Vector3::new(heading.cos(), heading.sin(), 0.0);
        let vector = |v: [f64; 2]| {
            (forward * v[1] + Vector3::z() * v[0])
                .map(|v| v as f32)
                .into()
        };
        let mut pair = || [number(20.0), number(20.0)];
        let (velocity, wind, reference) = (pair(), pair(), pair());
        let acceleration = pair().map(|v| v / 8.0);
        let flat = Input {
            velocity: velocity.map(|v| v as f32),
            attitude: [theta.cos() as f32, theta.sin() as f32],
            wind: wind.map(|v| v as f32),
            reference_velocity: reference.map(|v| v as f32),
            reference_acceleration: acceleration.map(|v| v as f32),
            ..Input::DEFAULT
        };
        let mut command = Command::SAFE;
        let code = unsafe { alula_step(&controller, &flat, 0.01, &mut command) };
        assert_eq!(code, ALULA_OK);
        let nose_up_axes = n.is_multiple_of(2);
        let q = compose(heading, pitch, 0.0, 0.0);
        let input = NedInput {
            body_axes: if nose_up_axes {
                ALULA_BODY_NOSE_UP
            } else {
                ALULA_BODY_NOSE_FORWARD
            },
            heading: heading as f32,
            pitch: (if nose_up_axes { theta } else { pitch }) as f32,
            quaternion: words(&if nose_up_axes { nose_up(&q) } else { q }),
            velocity: vector(velocity),
            air: vector(wind),
            reference_velocity: vector(reference),
            reference_acceleration: vector(acceleration),
            ..NedInput::DEFAULT
        };
        for attitude in [ALULA_ATTITUDE_QUATERNION, ALULA_ATTITUDE_PITCH] {
            let (ned, report) = step(&controller, &NedInput { attitude, ..input }).unwrap();
            // Air velocities up to 57 m/s, known to 1e-5 m/s and 5e-7 rad, make forces of 4000 N that change by as much
            // within 0.1 rad where the wing stalls: 0.1 N.
            assert!((ned.thrust - command.thrust).abs() < 0.1, "{n}");
            assert!(
                (ned.pitch_rate - command.rate).abs() < 0.05 + 1e-4 * command.rate.abs(),
                "{n}"
            );
            assert!(report.tilt.abs() < 1e-6 && report.bank.abs() < 1e-6);
        }
    }
}
