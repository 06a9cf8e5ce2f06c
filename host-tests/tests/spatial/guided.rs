//! The guidance in space on the six-degree-of-freedom plant, with the wrong belief of [`flown`](crate::flown).

use alula::guidance::{Air, Mode};
use alula::spatial::{Body, Heading, Reference};
use alula::{
    Combined, CombinedParameters, Guidance, GuidanceInput, GuidanceParameters, GuidanceState,
    Vehicle, VehicleParameters,
};
use alula_sil::spatial_plant::{SpatialPlant, SpatialState};

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
            if std::env::var_os("TRACE").is_some() && n % 10 == 0 {
                let v = memory.virtual_flight();
                let vv = V3::new(v.0.north.into(), v.0.east.into(), v.0.down.into());
                println!(
                    "{t:.1} {:?} law {:.2} lean {:.1} tilt {:.2} virt-target {:.2} real-virt {:.2} down {:.2} {:.2} x {:.2?} rates {:.2?}",
                    guided.progress.phase,
                    guided.progress.distance,
                    guided.progress.time,
                    guided.command.diagnostics.tilt(),
                    (vv - target.velocity).norm(),
                    (state.velocity - vv).norm(),
                    vv.z,
                    state.velocity.z,
                    (state.position - target.position).as_slice(),
                    guided.command.rates
                );
            }
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
}
