//! A velocity reference through the reference limit, on its own: no position is held.

use alula::spatial::{Ned, ReferenceLimit, ReferenceLimitParameters, ReferenceLimitState};

use crate::flown::{PERIOD, Setup, Target, V3, calm, cruise, report};
use crate::support::triple;

/// 20 m/s to the north, to the south from 5 s on: a coordinated turn with at most 6 m/s² across.
#[test]
fn a_reversal_of_velocity_at_speed_is_a_coordinated_turn() {
    let limit = ReferenceLimit::new(ReferenceLimitParameters {
        rate: 0.8,
        acceleration: 3.0,
        turn: 6.0,
        brake: 0.6,
        speed: 10.0,
    })
    .unwrap();
    let mut state = ReferenceLimitState {
        velocity: Ned::new(20.0, 0.0, 0.0),
    };
    let (mut position, mut slowest) = (V3::zeros(), f64::INFINITY);
    let mut task = |t: f64| {
        let asked = Ned::new(if t < 5.0 { 20.0 } else { -20.0 }, 0.0, 0.0);
        let velocity = V3::from(triple(state.velocity));
        let ff = limit.update(&mut state, asked, PERIOD as f32);
        let target = Target {
            position,
            velocity,
            acceleration: V3::from(triple(ff.air_acceleration)),
            jerk: V3::from(triple(ff.jerk)),
            heading: None,
        };
        position += velocity * PERIOD;
        slowest = slowest.min(velocity.norm());
        target
    };
    let samples = Setup::new().fly(&mut task, cruise(20.0), 30.0, &mut calm());
    let [velocity, position, sideslip] = report("reversal of 20 m/s", &samples, 5.0);
    assert!(velocity < 0.5 && position < 0.5 && sideslip < 1.0);
    let lowest = samples.iter().map(|s| s.altitude).fold(0.0, f64::min);
    assert!(slowest > 19.0 && lowest > -1.0, "{slowest} {lowest}");
    // Flying south, belly down.
    let last = samples[samples.len() - 1];
    assert!(last.belly_down > 0.99 && last.velocity_error < 0.1);
}
