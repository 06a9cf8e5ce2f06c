//! In a vertical plane the law in space is the planar law.

use alula::CombinedParameters;
use alula::ned::{BodyAxes, Quaternion};
use alula::planar::{Attitude, GainParameters, Inertial};
use alula::spatial::{
    Correction, FeedForward, Heading, Ned, Orientation, Reference, State, WingedControl,
};
use alula_sim::reference::{full, robust};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::support::{C_Y, lateral};
use crate::common::{Point, combined, control, gains, theta, vehicles};
use crate::yardstick::{SpatialInputs, winged_full, winged_robust};

const SET: CombinedParameters = CombinedParameters::NACA_0021_RE_160E3;

/// Bit for bit in the plane of north and down: T, ω_w of the robust law, and of the full law with feed-forward;
/// ω_i and ω_j are zero.
#[test]
fn in_the_north_plane_the_core_gives_the_planar_laws_bits() {
    let mut rng = ChaCha8Rng::seed_from_u64(21);
    let (core_gains, _) = gains(GainParameters::PAPER);
    let lift = |v: Inertial| Ned::new(v.forward(), 0.0, v.down());
    for n in 0..100_000 {
        let delta = if n % 2 == 0 {
            0.0
        } else {
            rng.random_range(-1.5..1.5)
        };
        let (vehicle, _) = vehicles(delta, combined(SET));
        let planar = control(vehicle, core_gains);
        let spatial = WingedControl::new(vehicle, core_gains, lateral().0);
        let mut point = Point::random(&mut rng);
        let (sin, cos) = (0.5 * theta(point.state.attitude)).sin_cos();
        let q = Quaternion {
            w: cos as f32,
            x: 0.0,
            y: sin as f32,
            z: 0.0,
        };
        let orientation = Orientation::from_quaternion(&q, BodyAxes::NoseUp).unwrap();
        point.state.attitude = Attitude {
            cos: -orientation.forward().down,
            sin: -orientation.forward().north,
        };
        let state = State {
            velocity: lift(point.state.velocity),
            orientation,
            wind: lift(point.state.wind),
            correction: Correction::default(),
        };
        let heading = [Heading::FREE, Heading::from_angle(0.0)][n % 2];
        let reference = Reference {
            velocity: lift(point.reference.velocity),
            acceleration: lift(point.reference.acceleration),
            heading,
        };
        let ff = FeedForward {
            air_acceleration: lift(point.feed_forward.air_acceleration),
            jerk: lift(point.feed_forward.jerk),
        };
        let pairs = [
            (
                spatial.robust(&state, &reference, None),
                planar.robust(&point.state, &point.reference, None),
            ),
            (
                spatial.full(&state, &reference, Some(&ff)),
                planar.full(&point.state, &point.reference, Some(&point.feed_forward)),
            ),
        ];
        for (got, want) in pairs {
            match (got, want) {
                (Ok(got), Ok(want)) => {
                    assert_eq!(got.thrust.to_bits(), want.thrust.to_bits(), "{point:?}");
                    assert_eq!(got.rates.pitch.to_bits(), want.rate.to_bits(), "{point:?}");
                    assert_eq!((got.rates.roll, got.rates.yaw), (0.0, 0.0), "{point:?}");
                    assert_eq!(got.diagnostics.plane, want.diagnostics);
                    assert_eq!(got.diagnostics.sideslip(), 0.0);
                }
                (got, want) => assert_eq!(got.map(|_| ()), want.map(|_| ())),
            }
        }
    }
}

/// In any vertical plane, its right side to the right or to the left: in double precision to the rounding of the
/// quaternion, 1e-13 of N; and the core to 1e-6 of N, see `accuracy`.
#[test]
fn in_any_vertical_plane_the_law_is_the_planar_law() {
    let mut rng = ChaCha8Rng::seed_from_u64(22);
    let (core_gains, g) = gains(GainParameters::PAPER);
    let (core_lateral, l) = lateral();
    let (core, vehicle) = vehicles(0.2, combined(SET));
    let core = WingedControl::new(core, core_gains, core_lateral);
    let (mut worst, mut worst_core) = (0.0_f64, 0.0_f64);
    for n in 0..50_000 {
        let point = Point::random(&mut rng);
        let heading: f64 = rng.random_range(-3.1..3.1);
        let (sin, cos) = heading.sin_cos();
        let (sin_half, cos_half) = (0.5 * heading).sin_cos();
        let (s, c) = (0.5 * theta(point.state.attitude)).sin_cos();
        let lift = |v: alula_sim::reference::Vector| [v.y * cos, v.y * sin, v.x];
        for fed in [false, true] {
            let planar_inputs = point.inputs(fed);
            let mut inputs = SpatialInputs {
                velocity: lift(planar_inputs.velocity),
                // Pitch about the right side of the plane, then heading about down.
                quaternion: [cos_half * c, -sin_half * s, cos_half * s, sin_half * c],
                wind: lift(planar_inputs.wind),
                reference_velocity: lift(planar_inputs.reference_velocity),
                reference_acceleration: lift(planar_inputs.reference_acceleration),
                heading: [[0.0; 3], [cos, sin, 0.0]][n % 2],
                feed_forward: planar_inputs.feed_forward.map(|(a, j)| (lift(a), lift(j))),
                ..Default::default()
            };
            let (want, got) = if fed {
                let want = full(&vehicle, &g, &planar_inputs);
                (want, winged_full(&vehicle, C_Y.into(), &g, &l, &inputs))
            } else {
                let want = robust(&vehicle, &g, &planar_inputs);
                (want, winged_robust(&vehicle, C_Y.into(), &g, &l, &inputs))
            };
            if fed
                && (want.k_inverse.abs() < 1e-3
                    || want.theta_tilde(planar_inputs.theta).abs() > 3.0)
            {
                continue;
            }
            let mut note = |difference: f64, size: f64| {
                worst = worst.max(difference.abs() / size);
            };
            note(got.thrust.value - want.thrust, got.thrust.size);
            note(got.rates[2].value - want.rate, got.rates[2].size);
            note(got.rates[0].value, got.rates[0].size);
            note(got.rates[1].value, got.rates[1].size);

            // The core, given what is left of all this in single precision.
            if fed {
                continue;
            }
            let round = |v: [f64; 3]| v.map(|x| f64::from(x as f32));
            inputs.quaternion = inputs.quaternion.map(|x| f64::from(x as f32));
            inputs.velocity = round(inputs.velocity);
            inputs.wind = round(inputs.wind);
            let ned = super::support::ned;
            let [w, x, y, z] = inputs.quaternion.map(|x| x as f32);
            let q = Quaternion { w, x, y, z };
            let state = State {
                velocity: ned(inputs.velocity),
                orientation: Orientation::from_quaternion(&q, BodyAxes::NoseUp).unwrap(),
                wind: ned(inputs.wind),
                correction: Correction::default(),
            };
            let reference = Reference {
                velocity: ned(inputs.reference_velocity),
                acceleration: ned(inputs.reference_acceleration),
                heading: Heading::FREE,
            };
            let command = core.robust(&state, &reference, None).unwrap();
            // The inputs' own rounding counts as one more of each.
            let mut note = |difference: f64, size: f64| {
                worst_core = worst_core.max(difference.abs() / size);
            };
            note(f64::from(command.thrust) - want.thrust, got.thrust.size);
            note(
                f64::from(command.rates.pitch) - want.rate,
                got.rates[2].size,
            );
            note(command.rates.roll.into(), got.rates[0].size);
            note(command.rates.yaw.into(), got.rates[1].size);
        }
    }
    println!("worst: reference {worst:.1e} of N, core {worst_core:.1e} of N");
    assert!(worst < 1e-13, "{worst:e}");
    assert!(worst_core < 1e-6, "{worst_core:e}");
}
