//! The guidance in space on the six-degree-of-freedom plant, with the wrong belief of [`flown`](crate::flown).

use alula::guidance::{Air, Mode};
use alula::spatial::{Body, Heading, Reference};
use alula::{
    Combined, CombinedParameters, Guidance, GuidanceInput, GuidanceParameters, GuidanceState,
    Vehicle, VehicleParameters,
};
use alula_sil::space::{SpatialPlant, SpatialState};

use crate::flown::{PERIOD, Sample, Setup, Task, V3, orientation};
use crate::support::ned;

/// What is flown with.
pub struct Flown {
    pub plant: SpatialPlant,
    pub guidance: Guidance<Combined>,
    /// What the guidance is told of the wind: all of it, or this.
    pub wind_told: Option<V3>,
}

/// With the wrong belief, and the limits that the requirement states.
pub fn parameters() -> GuidanceParameters {
    GuidanceParameters {
        max_rate: 3.5,
        max_turn: 3.0,
        ..GuidanceParameters::default()
    }
}

impl Flown {
    pub fn new(p: &GuidanceParameters) -> Self {
        let exact = std::env::var_os("EXACT").is_some();
        let belief = if exact {
            VehicleParameters {
                c_y: 0.5,
                ..VehicleParameters::PAPER
            }
        } else {
            VehicleParameters {
                c_y: 0.35,
                ..VehicleParameters::PAPER_BELIEF
            }
        };
        let model = Combined::new(if exact {
            CombinedParameters::NACA_0021_RE_160E3
        } else {
            CombinedParameters::PAPER_BELIEF
        })
        .unwrap();
        Self {
            plant: Setup::new().plant,
            guidance: Guidance::new(Vehicle::new(belief, model).unwrap(), p).unwrap(),
            wind_told: None,
        }
    }

    /// Flies `task` from `start` for `duration` \[s\] in `wind`. The motors are off for the first 50 ms, in which frames
    /// become good.
    pub fn fly(
        &self,
        task: &mut dyn Task,
        start: SpatialState,
        duration: f64,
        wind: &mut dyn FnMut(f64, f64) -> V3,
    ) -> Vec<Sample> {
        let mut state = start;
        let mut memory = GuidanceState::default();
        let mut samples = Vec::new();
        for n in 0..(duration / PERIOD).round() as usize {
            let t = n as f64 * PERIOD;
            let air = wind(t, state.velocity.norm());
            let target = task.target(t, state.position);
            let told = self.wind_told.unwrap_or(air);
            let heading = target.heading.map_or(f32::NAN, |h| h as f32);
            let input = GuidanceInput {
                velocity: ned(state.velocity.into()),
                orientation: orientation(&state),
                state_age: 0.0,
                air: Air::Wind(ned(told.into())),
                specific_force: (std::env::var_os("NOACC").is_none()).then(|| {
                    let [i, j, w] = self.plant.specific_force(&state, air);
                    Body::new(i as f32, j as f32, w as f32)
                }),
                position_error: Some(ned((state.position - target.position).into())),
                reference: Reference {
                    velocity: ned(target.velocity.into()),
                    acceleration: ned(target.acceleration.into()),
                    heading: Heading::from_angle(heading),
                },
                reference_age: 0.0,
            };
            let guided = self.guidance.update(&mut memory, &input, PERIOD as f32);
            assert!(guided.mode == Mode::Flying || t < 0.1);
            samples.push(Sample::new(t, &state, &target, air, &start));
            let Body { i, j, w } = guided.command.rates;
            let rates = V3::new(j.into(), w.into(), i.into());
            let thrust = guided.command.thrust.into();
            state = self.plant.step(&state, thrust, rates, air, PERIOD);
        }
        samples
    }
}

mod paths {
    use super::*;
    use crate::course::{self, Course, Curve};
    use crate::flown::{calm, cruise, hover, report};

    fn course(name: &str, curve: Curve, speed: f64) -> [f64; 3] {
        let samples = Flown::new(&parameters()).fly(
            &mut Course::new(curve, speed),
            cruise(speed),
            50.0,
            &mut calm(),
        );
        report(name, &samples, 20.0)
    }

    #[test]
    fn courses() {
        let only = std::env::var("ONLY").unwrap_or_default();
        for (name, curve, speed) in [
            ("north", course::north as Curve, 20.0),
            ("circle 40 m, 15 m/s", course::circle_40, 15.0),
            ("circle 40 m, 20 m/s", course::circle_40, 20.0),
            ("circle 33 m, 30 m/s", course::circle_33, 30.0),
            ("eight", course::eight, 22.0),
            ("climbing turn", course::climbing_turn, 20.4),
        ] {
            if name.contains(&only) {
                course(name, curve, speed);
            }
        }
        let samples = Flown::new(&parameters()).fly(
            &mut Course::new(course::north, 20.0),
            cruise(20.0),
            50.0,
            &mut |_, _| V3::new(0.0, 8.0, 0.0),
        );
        report("cross wind", &samples, 20.0);
        let _ = hover;
    }

    use crate::flown::{Target, rms};
    use crate::support::{ball, rotation, triple};
    use alula_sil::space::{Gust, Turbulence};
    use nalgebra::{Quaternion, UnitQuaternion};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn stay(heading: impl Fn(f64) -> f64) -> impl FnMut(f64) -> Target {
        move |t| Target {
            heading: Some(heading(t)),
            ..Target::default()
        }
    }

    #[test]
    fn weather() {
        let mut f = Flown::new(&parameters());
        let gust = |start, duration, east| Gust {
            start,
            duration,
            peak: V3::new(0.0, east, 0.0),
        };
        let known = gust(10.0, 4.0, 8.0);
        report(
            "known side gust",
            &f.fly(
                &mut Course::new(course::north, 20.0),
                cruise(20.0),
                30.0,
                &mut |t, _| known.at(t),
            ),
            10.0,
        );
        f.wind_told = Some(V3::zeros());
        let step = gust(10.0, f64::INFINITY, 6.0);
        report(
            "unknown side wind",
            &f.fly(
                &mut Course::new(course::north, 20.0),
                cruise(20.0),
                30.0,
                &mut |t, _| step.at(t),
            ),
            10.0,
        );
        f.wind_told = None;
        report(
            "hover, 8 m/s cross wind",
            &f.fly(&mut stay(|_| 0.0), hover(0.0), 40.0, &mut |_, _| {
                V3::new(0.0, 8.0, 0.0)
            }),
            15.0,
        );
        report(
            "hover, 8 m/s tail wind",
            &f.fly(&mut stay(|_| 0.0), hover(0.0), 40.0, &mut |_, _| {
                V3::new(8.0, 0.0, 0.0)
            }),
            15.0,
        );
        for step in [90.0_f64, 180.0] {
            let h = step.to_radians();
            report(
                &format!("heading step {step}"),
                &f.fly(
                    &mut stay(|t| if t < 5.0 { 0.0 } else { h }),
                    hover(0.0),
                    15.0,
                    &mut calm(),
                ),
                5.0,
            );
        }
        for (off, held) in [
            (0.0, false),
            (90.0, false),
            (179.0, true),
            (179.0, false),
            (180.0, true),
        ] {
            let heading = f64::to_radians(off);
            let mut task = |t: f64| {
                let ramp = t.min(10.0);
                let along = |x: f64| V3::new(x, 0.0, 0.0);
                Target {
                    position: along(ramp * ramp + 20.0 * (t - ramp)),
                    velocity: along(2.0 * ramp),
                    acceleration: along(if t < 10.0 { 2.0 } else { 0.0 }),
                    heading: held.then_some(heading),
                    ..Target::default()
                }
            };
            report(
                &format!("transition {off} {held}"),
                &f.fly(&mut task, hover(heading), 25.0, &mut calm()),
                0.0,
            );
        }
        // Reversal.
        let mut p = V3::zeros();
        let mut task = |t: f64| {
            let v = V3::new(if t < 5.0 { 20.0 } else { -20.0 }, 0.0, 0.0);
            p += v * PERIOD;
            Target {
                position: p,
                velocity: v,
                ..Target::default()
            }
        };
        report(
            "reversal",
            &f.fly(&mut task, cruise(20.0), 40.0, &mut calm()),
            25.0,
        );
    }

    fn mission(t: f64) -> Target {
        // hover, 2 m/s2 to 20 m/s northward, circle of 40 m to the right, out of the circle brake at 2 m/s2 to hover.
        let (r, v) = (40.0, 20.0);
        let turn = 2.0 * std::f64::consts::PI * r / v * 1.25;
        let north = |s: f64, v: f64, a: f64| Target {
            position: V3::new(s, 0.0, 0.0),
            velocity: V3::new(v, 0.0, 0.0),
            acceleration: V3::new(a, 0.0, 0.0),
            ..Target::default()
        };
        if t < 5.0 {
            return north(0.0, 0.0, 0.0);
        }
        let t = t - 5.0;
        if t < 10.0 {
            return north(t * t, 2.0 * t, 2.0);
        }
        let t = t - 10.0;
        if t < 5.0 {
            return north(100.0 + v * t, v, 0.0);
        }
        let t = t - 5.0;
        let at = |phi: f64| {
            (
                V3::new(200.0 + r * phi.sin(), r * (1.0 - phi.cos()), 0.0),
                V3::new(phi.cos(), phi.sin(), 0.0),
                V3::new(-phi.sin(), phi.cos(), 0.0),
            )
        };
        if t < turn {
            let (p, d, n) = at(t * v / r);
            return Target {
                position: p,
                velocity: d * v,
                acceleration: n * (v * v / r),
                ..Target::default()
            };
        }
        let (p, d, _) = at(turn * v / r);
        let t = t - turn;
        let s = t.min(10.0);
        Target {
            position: p + d * (v * s - s * s),
            velocity: d * (v - 2.0 * s),
            acceleration: d * if t < 10.0 { -2.0 } else { 0.0 },
            ..Target::default()
        }
    }

    #[test]
    fn missions() {
        let f = Flown::new(&parameters());
        report(
            "mission",
            &f.fly(&mut mission, hover(0.0), 75.0, &mut calm()),
            0.0,
        );
        for seed in 0..8 {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let mut air = Turbulence::new(15.4, 50.0, 0.5 * std::f64::consts::PI, &mut random);
            let mut blow = |_: f64, speed: f64| {
                air.advance(speed, PERIOD, &mut random);
                V3::new(0.0, 5.0, 0.0) + air.velocity()
            };
            let s = f.fly(&mut mission, hover(0.0), 75.0, &mut blow);
            report(&format!("mission in turbulence {seed}"), &s, 0.0);
        }
    }

    #[test]
    fn starts() {
        let f = Flown::new(&parameters());
        for speed in [0.0, 20.0] {
            let (mut bad, mut lost, mut heights) = (0, 0.0_f64, Vec::new());
            let n = std::env::var("N").map_or(200, |n| n.parse().unwrap());
            for seed in 0..n {
                let mut rng = ChaCha8Rng::seed_from_u64(seed);
                let q = rotation(&mut rng);
                let q = Quaternion::new(q.w, q.x, q.y, q.z).cast::<f64>();
                let velocity = V3::new(speed, 0.0, 0.0);
                let mut rate = || rng.random_range(-2.0..2.0);
                let rates = V3::new(rate(), rate(), rate());
                let start = SpatialState {
                    position: V3::zeros(),
                    velocity: velocity + V3::from(triple(ball(&mut rng, 5.0))),
                    attitude: UnitQuaternion::from_quaternion(q),
                    rates,
                    thrust: 0.0,
                };
                let mut hold = |_: f64| Target::default();
                let mut track = Course::new(course::north, 20.0);
                let task: &mut dyn Task = if speed == 0.0 { &mut hold } else { &mut track };
                let samples = f.fly(task, start, 25.0, &mut calm());
                let last = samples[samples.len() - 1];
                let lowest = samples.iter().map(|s| s.altitude).fold(0.0, f64::min);
                let upright = if speed == 0.0 {
                    last.nose_up
                } else {
                    last.belly_down
                };
                let settled = rms(&samples, 23.0, |s| s.velocity_error) < 0.1;
                if !settled || upright < 0.99 {
                    bad += 1;
                    println!(
                        "| seed {seed} speed {speed}: rms {:.2} upright {upright:.2} lowest {lowest:.1}",
                        rms(&samples, 23.0, |s| s.velocity_error)
                    );
                }
                lost = lost.max(-lowest);
                heights.push(-lowest);
            }
            heights.sort_by(f64::total_cmp);
            println!(
                "| starts {speed}: bad {bad} lost {lost:.1} median {:.1} 95 % {:.1}",
                heights[heights.len() / 2],
                heights[heights.len() * 95 / 100]
            );
        }
    }
}
