//! Random starts: attitudes uniform over the rotations, rates of ±2 rad/s on each axis, velocities within 5 m/s of the
//! reference.

use super::course::{self, Course};
use super::scenario::{Setup, Target, Task, rms, with};

/// Share that converges, and the most altitude lost \[m\], of `n` starts about hover or a level 20 m/s to the north.
/// Converged: within 0.1 m/s rms after 23 s, nose up or belly down to 8°.
fn starts(n: usize, speed: f64) -> (f64, f64) {
    let setup = &Setup::new();
    let fly = |seeds: std::ops::Range<usize>| {
        let (mut converged, mut lost) = (0, 0.0_f64);
        for seed in seeds {
            let start = with(
                vec![format!("initial.velocity_m_s=[{speed:?}, 0.0, 0.0]")],
                [
                    &*format!("seed={seed}"),
                    "initial.scatter={ velocity_m_s = 5.0, rate_rad_s = 2.0 }",
                ],
            );
            // In cruise along a track: how far along is not held, for a clean aircraft can only brake by its drag.
            let mut hold = |_: f64| Target::default();
            let mut track = Course::new(course::north, 20.0);
            let task: &mut dyn Task = if speed == 0.0 { &mut hold } else { &mut track };
            let samples = setup.fly(task, 25.0, &start);
            let last = samples[samples.len() - 1];
            let lowest = samples.iter().map(|s| s.altitude).fold(0.0, f64::min);
            let upright = if speed == 0.0 {
                last.nose_up
            } else {
                last.belly_down
            };
            let settled = rms(&samples, 23.0, |s| s.velocity_error) < 0.1;
            converged += usize::from(settled && upright > 0.99);
            lost = lost.max(-lowest);
        }
        (converged, lost)
    };
    let (a, b) = std::thread::scope(|scope| {
        let first = scope.spawn(|| fly(0..n / 2));
        let second = fly(n / 2..n);
        (first.join().unwrap(), second)
    });
    ((a.0 + b.0) as f64 / n as f64, a.1.max(b.1))
}

#[test]
#[ignore = "slow: cargo test-slow"]
fn slow_a_thousand_random_starts_converge() {
    for (name, speed) in [("hover", 0.0), ("20 m/s", 20.0)] {
        let (share, lost) = starts(1000, speed);
        println!(
            "random starts to {name}: {:.1} % converge, at most {lost:.1} m lost",
            100.0 * share
        );
        assert!(share >= 0.995 && lost <= 30.0);
    }
}
