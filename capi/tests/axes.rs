//! World and body axes through the ABI, against nalgebra's quaternions in double precision and the law in the plane.
#![cfg(not(target_os = "none"))]

use std::f64::consts::{FRAC_PI_2, PI};

use alula::planar::{Attitude, Inertial, Reference, State, VelocityControl};
use alula::{
    BandwidthGains, Combined, CombinedParameters, GuidanceParameters, Vehicle, VehicleParameters,
};
use alula_capi::*;
use nalgebra::{UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

type V3 = Vector3<f64>;

/// The default of `attitude_gain` [1/s].
const ATTITUDE_GAIN: f64 = 6.5;

/// A vehicle with side force.
fn controller() -> Controller {
    let parameters = Parameters {
        vehicle: VehicleParameters::PAPER.c_y(0.5),
        ..Parameters::DEFAULT
    };
    let mut controller = Controller::BLANK;
    let code = unsafe { alula_init(&mut controller, &parameters, std::ptr::null()) };
    assert_eq!(code, ALULA_OK);
    controller
}

fn step(controller: &Controller, input: &Input) -> (Command, Report) {
    let mut command = Command::SAFE;
    // SAFETY: Zero is a value of every field.
    let mut report: Report = unsafe { std::mem::zeroed() };
    report.header = Report::HEADER;
    let code = unsafe { alula_step(controller, input, 0.01, &mut command, &mut report) };
    assert_eq!(code, ALULA_OK);
    (command, report)
}

fn words(q: &UnitQuaternion<f64>) -> [f32; 4] {
    [q.w, q.i, q.j, q.k].map(|v| v as f32)
}

fn attitude([w, x, y, z]: [f32; 4]) -> UnitQuaternion<f64> {
    let [w, x, y, z] = [w, x, y, z].map(f64::from);
    UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z))
}

/// Multicopter axes from fixed-wing axes.
fn nose_up(forward: &UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    forward * UnitQuaternion::from_scaled_axis(-FRAC_PI_2 * V3::y())
}

fn vector(v: [f32; 3]) -> V3 {
    V3::from(v.map(f64::from))
}

/// An attitude anywhere; every fourth with Euler angles of which the pitch is locked at ±90°.
fn anywhere(rng: &mut ChaCha8Rng, n: usize) -> UnitQuaternion<f64> {
    let mut angle = |limit: f64| rng.random_range(-limit..limit);
    if n.is_multiple_of(4) {
        let pitch = FRAC_PI_2 * if n.is_multiple_of(8) { 1.0 } else { -1.0 };
        UnitQuaternion::from_euler_angles(angle(PI), pitch, angle(PI))
    } else {
        let v: [f64; 4] = std::array::from_fn(|_| angle(1.0));
        UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(v[0], v[1], v[2], v[3]))
    }
}

/// The same state in both body conventions, and in a world that is turned about the vertical: the same thrust, the same
/// rates in the world, and a set-point that leads the attitude by them.
#[test]
fn commands_are_the_same_turn_in_both_body_conventions_and_any_world() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let controller = controller();
    let (mut worst_lead, mut worst_turn) = (0f64, 0f64);
    for n in 0..100_000 {
        let q = anywhere(&mut rng, n);
        let mut number = |limit: f32| rng.random_range(-limit..limit);
        let mut triple = |limit: f32| [number(limit), number(limit), number(limit)];
        let forward = Input {
            quaternion: words(&q),
            // Far from where the wing stalls forces change gently with rounding: slow.
            velocity: triple(4.0),
            air: triple(1.0),
            reference_velocity: triple(4.0),
            reference_acceleration: triple(1.0),
            heading: number(3.0),
            ..Input::DEFAULT
        };
        let up = Input {
            body_axes: ALULA_BODY_NOSE_UP,
            quaternion: words(&nose_up(&q)),
            ..forward
        };
        let psi = number(3.0);
        let turn = UnitQuaternion::from_scaled_axis(f64::from(psi) * V3::z());
        let turned = |v: [f32; 3]| (turn * vector(v)).map(|x| x as f32).into();
        let elsewhere = Input {
            quaternion: words(&(turn * q)),
            velocity: turned(forward.velocity),
            air: turned(forward.air),
            reference_velocity: turned(forward.reference_velocity),
            reference_acceleration: turned(forward.reference_acceleration),
            heading: forward.heading + psi,
            ..forward
        };
        let (wanted, report) = step(&controller, &forward);
        let rates = attitude(forward.quaternion) * vector(wanted.body_rate);
        for (input, back) in [
            (forward, UnitQuaternion::identity()),
            (up, UnitQuaternion::identity()),
            (elsewhere, turn.inverse()),
        ] {
            let (command, told) = step(&controller, &input);
            let present = attitude(input.quaternion);
            let rate = vector(command.body_rate);
            let lead = rate / ATTITUDE_GAIN;
            let limited = lead.norm() > FRAC_PI_2;
            assert_eq!(limited, command.status & ALULA_STATUS_LEAD_LIMITED != 0);
            let lead = if limited {
                lead.normalize() * FRAC_PI_2
            } else {
                lead
            };
            let set_point = present * UnitQuaternion::from_scaled_axis(lead);
            worst_lead = worst_lead.max(attitude(command.quaternion).angle_to(&set_point));
            // Rates have gains up to 13 1/s and forces of the air 60 N for each m/s; with F_p near zero, or the lateral force,
            // they grow as its inverse.
            let scale = (1.0 + rates.norm()) * (1.0 + 100.0 / f64::from(report.f_p_norm));
            worst_turn = worst_turn.max((back * (present * rate) - rates).norm() / scale);
            assert!((command.thrust - wanted.thrust).abs() < 2e-3, "{n}");
            assert!(
                (told.tilt - report.tilt).abs() < 1e-2
                    && (told.sideslip - report.sideslip).abs() < 1e-2
            );
        }
    }
    // Roundings of four components, doubled.
    assert!(worst_lead < 1e-6, "{worst_lead:e}");
    assert!(worst_turn < 1e-4, "{worst_turn:e}");
}

/// In a vertical plane the command is the planar law's, in every plane and from every attitude, and there is no other rate.
#[test]
fn commands_in_a_vertical_plane_are_the_planar_laws() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let controller = controller();
    let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
    let vehicle = Vehicle::new(VehicleParameters::PAPER, model).unwrap();
    let gains = BandwidthGains::new(&GuidanceParameters::default(), &vehicle).unwrap();
    let planar = VelocityControl::new(vehicle, gains);
    let (mut worst, mut tilt) = (0f32, 0f32);
    for n in 0..100_000_usize {
        let mut number = |limit: f64| f64::from(rng.random_range(-limit..limit) as f32);
        let (heading, pitch) = (number(PI), number(PI));
        let theta = pitch - FRAC_PI_2;
        let forward = V3::new(heading.cos(), heading.sin(), 0.0);
        let vector =
            |[down, ahead]: [f64; 2]| (forward * ahead + V3::z() * down).map(|v| v as f32).into();
        let mut pair = || [number(20.0), number(20.0)];
        let (velocity, wind, reference) = (pair(), pair(), pair());
        let acceleration = pair().map(|v| v / 8.0);
        let inertial = |[down, ahead]: [f64; 2]| Inertial::new(down as f32, ahead as f32);
        let state = State {
            velocity: inertial(velocity),
            attitude: Attitude {
                cos: theta.cos() as f32,
                sin: theta.sin() as f32,
            },
            wind: inertial(wind),
        };
        let wanted = planar.robust(
            &state,
            &Reference {
                velocity: inertial(reference),
                acceleration: inertial(acceleration),
            },
            None,
        );
        let wanted = wanted.unwrap();
        let q = UnitQuaternion::from_scaled_axis(heading * V3::z())
            * UnitQuaternion::from_scaled_axis(pitch * V3::y());
        let nose_up_axes = n.is_multiple_of(2);
        let input = Input {
            body_axes: if nose_up_axes {
                ALULA_BODY_NOSE_UP
            } else {
                ALULA_BODY_NOSE_FORWARD
            },
            quaternion: words(&if nose_up_axes { nose_up(&q) } else { q }),
            velocity: vector(velocity),
            air: vector(wind),
            reference_velocity: vector(reference),
            reference_acceleration: vector(acceleration),
            ..Input::DEFAULT
        };
        let (command, report) = step(&controller, &input);
        // Air velocities up to 57 m/s, known to 1e-5 m/s and 5e-7 rad, make forces of 4000 N that change by as much
        // within 0.1 rad where the wing stalls: 0.1 N.
        assert!((command.thrust - wanted.thrust).abs() < 0.1, "{n}");
        let [x, pitch_rate, z] = command.body_rate;
        assert!(
            (pitch_rate - wanted.rate).abs() < 0.05 + 1e-4 * wanted.rate.abs(),
            "{n}"
        );
        worst = worst.max(x.abs().max(z.abs()));
        tilt = tilt.max(report.tilt.abs());
        assert!(report.sideslip.abs() < 1e-5);
    }
    // Roundings of the quaternion, as a share of a force that may vanish. Measured 4.0e-5 rad/s and 3.6e-5 rad.
    assert!(worst < 1e-4 && tilt < 1e-4, "{worst:e} {tilt:e}");
}
