//! The guidance in space, as a companion's pilot: the whole attitude, along a path, in a wind from anywhere.
//!
//! The path's north is north, and it begins where the vehicle is when the flight begins.

use alula::GuidanceInput;
use alula::ned::BodyAxes;
use alula::spatial::{Heading, Reference};
use alula_bridges::companion::{Command, End, Pilot, Settings, Told};
use nalgebra::{Quaternion, UnitQuaternion};

use alula_sim::controllers::{Answer, Controller, Input};
use alula_sim::experiment::{Experiment, Path, State, Target, V3, double, ned};
use alula_sim::simulate::{Record, Step};

/// Settings for flying `experiment`, of whose belief `hover_thrust` is the autopilot's thrust in hover.
pub fn settings(experiment: &Experiment, hover_thrust: Option<f64>) -> anyhow::Result<Settings> {
    let spec = experiment.spec()?;
    let weight = spec.belief().unwrap_or(&experiment.vehicle).weight();
    let most = experiment.thrust_limits(None, weight)[1];
    super::settings(weight, most, hover_thrust, experiment.duration_s)
}

/// The guidance on its path.
pub struct OnPath {
    controller: Box<dyn Controller>,
    /// None where what comes over the link is followed.
    path: Option<Path>,
    gravity: f64,
    /// When the path was asked last \[s\], and how fast it goes on since.
    last: (f64, f64),
    record: Record,
}

/// What is to be flown at one step.
struct Asked {
    target: Target,
    /// Whether at its position.
    placed: bool,
    /// Its age \[s\].
    age: f32,
}

impl OnPath {
    /// The guidance of `experiment` along its path, or, if it is led `from_link`, along what comes over the link.
    pub fn new(experiment: &Experiment, from_link: bool) -> anyhow::Result<Self> {
        Ok(Self {
            controller: experiment.controller()?,
            path: match from_link {
                true => None,
                false => Some(experiment.path.path()?),
            },
            gravity: experiment.vehicle.gravity_m_s2,
            last: (0.0, 1.0),
            record: Record::new(),
        })
    }

    /// What was told and answered. Of the truth nothing is known but what the autopilot says.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// What is to be flown now.
    fn asked(&mut self, told: &Told) -> Asked {
        let Some(path) = &mut self.path else {
            let Some((asked, age)) = &told.asked else {
                // Until something is asked for: stay.
                return Asked {
                    target: Target::default(),
                    placed: true,
                    age: 0.0,
                };
            };
            let target = Target {
                position: double(asked.position.unwrap_or(told.position)),
                velocity: double(asked.velocity),
                acceleration: double(asked.acceleration),
                heading: None,
            };
            return Asked {
                target,
                placed: asked.position.is_some(),
                age: *age,
            };
        };
        let (last, pace) = self.last;
        path.advance(last, (told.t - last).max(0.0), |_| pace);
        let mut pace = 1.0;
        let target = path.advance(told.t, 0.0, |target| {
            let error = double(told.position) - target.position;
            let controller = &self.controller;
            pace = controller.pace(ned(error), ned(target.velocity)).into();
            pace
        });
        self.last = (told.t, pace);
        Asked {
            target,
            placed: true,
            age: 0.0,
        }
    }

    fn keep(&mut self, told: &Told, target: Target, input: Input, answer: Answer) {
        let q = told.orientation.to_quaternion(BodyAxes::NoseUp);
        let [w, x, y, z] = [q.w, q.x, q.y, q.z].map(f64::from);
        let force = told
            .specific_force
            .map(|f| f64::from(f.norm_squared()).sqrt());
        let attitude = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        let truth = State {
            position: double(told.position),
            velocity: double(told.velocity),
            attitude,
            rates: V3::from(told.rates.map(f64::from)),
            thrust: answer.thrust.into(),
        };
        let step = Step {
            t: told.t,
            truth,
            theta: truth.theta(),
            readings: Vec::new(),
            wind: match told.air {
                alula::guidance::Air::Wind(wind) | alula::guidance::Air::Pitot { wind, .. } => {
                    double(wind)
                }
                _ => V3::zeros(),
            },
            load_factor: force.map_or(f64::NAN, |f| f / self.gravity),
            target,
            measured_attitude: attitude,
            input,
            answer,
            mission: None,
            virtual_theta: None,
        };
        if self.record.last().is_none_or(|last| step.t > last.t) {
            self.record.push(step);
        }
    }
}

impl Pilot for OnPath {
    fn begin(&mut self, _: f32) {}

    fn answer(&mut self, told: &Told, dt: f32) -> Result<Command, End> {
        let Asked {
            target,
            placed,
            age: reference_age,
        } = self.asked(told);
        let error = told.position - ned(target.position);
        let heading = target.heading.map_or(f32::NAN, |h| h as f32);
        let sample = GuidanceInput::default()
            .velocity(told.velocity)
            .orientation(told.orientation)
            .state_age(told.age)
            .air(told.air)
            .specific_force(told.specific_force.map(Into::into))
            .position_error(placed.then_some(error))
            .reference(Reference {
                velocity: ned(target.velocity),
                acceleration: ned(target.acceleration),
                heading: Heading::from_angle(heading),
            })
            .reference_age(reference_age);
        let input = Input {
            sample,
            feed_forward: None,
        };
        let answer = self.controller.answer(&input, dt).map_err(|_| End::Pilot)?;
        self.keep(told, target, input, answer);
        Ok(Command {
            thrust: answer.thrust,
            rates: BodyAxes::NoseUp.components(answer.rates),
        })
    }
}
