//! The guidance as a companion's pilot, along a path or what comes over the link.
//!
//! The path begins where the vehicle is when the flight begins, in the axes of its own north: [`Lead::Path`] says where that points. What is told
//! is turned into these axes, and the record is in them.

use alula::GuidanceInput;
use alula::ned::{BodyAxes, Ned};
use alula::spatial::{Heading, Orientation, Reference};
use alula_bridges::companion::{Command, End, Kind, Pilot, Setpoint, Settings, Told};
use anyhow::ensure;
use nalgebra::{Quaternion, UnitQuaternion};

use alula_sim::controllers::{Answer, Controller, Input};
use alula_sim::experiment::{Experiment, Path, State, Target, V3, angle, double, ned};
use alula_sim::reference::wrap;
use alula_sim::simulate::{Record, Step};

/// Settings for flying `experiment`, of whose belief `hover_thrust` is the autopilot's thrust in hover. If it is none, thrust is taken for
/// proportional up to the most.
pub fn settings(experiment: &Experiment, hover_thrust: Option<f64>) -> anyhow::Result<Settings> {
    let spec = experiment.spec()?;
    let weight = spec.belief().unwrap_or(&experiment.vehicle).weight();
    let most = experiment.thrust_limits(None, weight)[1];
    let hover_thrust = hover_thrust.unwrap_or(weight / most);
    ensure!(
        (0.05..=0.95).contains(&hover_thrust),
        "the thrust in hover is {hover_thrust}, must be from 0.05 to 0.95"
    );
    Ok(Settings {
        kind: Kind::Px4,
        weight: weight as f32,
        hover_thrust: hover_thrust as f32,
        engage: false,
        led: false,
        duration: experiment.duration_s,
        timeout: 0.5,
    })
}

/// By what a flight is led.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lead {
    /// The experiment's path, its north at this heading \[rad\]; the vehicle's at the start if none.
    Path(Option<f32>),
    /// What comes over the link, in its axes.
    Link,
}

/// The guidance on its path.
pub struct OnPath {
    controller: Box<dyn Controller>,
    /// None where what comes over the link is followed.
    path: Option<Path>,
    /// Heading of the path's north \[rad\], if it is known before the start.
    heading: Option<f32>,
    axes: Axes,
    gravity: f64,
    /// When the path was asked last \[s\], and how fast it goes on since.
    last: (f64, f64),
    /// The attitude θ \[rad\], counted on through full turns.
    theta: f64,
    record: Record,
}

/// The axes of a path: the world's, turned to a heading.
#[derive(Clone, Copy, Debug)]
struct Axes {
    cos: f32,
    sin: f32,
}

impl Axes {
    fn new(heading: f32) -> Self {
        let (sin, cos) = heading.sin_cos();
        Self { cos, sin }
    }

    /// A vector of the world in these axes.
    fn of(&self, v: Ned) -> Ned {
        let &Self { cos, sin } = self;
        Ned::new(
            cos * v.north + sin * v.east,
            cos * v.east - sin * v.north,
            v.down,
        )
    }

    /// What is told, in these axes.
    fn told(&self, told: &Told) -> Told {
        let axes: [Ned; 3] = told.orientation.into();
        let orientation = Orientation::try_from(axes.map(|axis| self.of(axis)));
        Told {
            position: self.of(told.position),
            velocity: self.of(told.velocity),
            orientation: orientation.unwrap_or(Orientation::UNKNOWN),
            air: told.air.map(|v| self.of(v)),
            asked: told.asked.map(|(asked, age)| {
                let turned = Setpoint {
                    velocity: self.of(asked.velocity),
                    acceleration: self.of(asked.acceleration),
                    position: asked.position.map(|x| self.of(x)),
                };
                (turned, age)
            }),
            ..*told
        }
    }
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
    /// The guidance of `experiment`, led by `lead`.
    pub fn new(experiment: &Experiment, lead: Lead) -> anyhow::Result<Self> {
        ensure!(
            experiment.controller.kind == "guidance",
            "controller.{}: flies in a plane and holds nothing across it; beside an autopilot flies the guidance",
            experiment.controller.kind
        );
        let (path, heading) = match lead {
            Lead::Path(heading) => (Some(experiment.path.path()?), heading),
            Lead::Link => (None, Some(0.0)),
        };
        if let Some(heading) = heading {
            angle("heading", heading.to_degrees().into())?;
        }
        // With a heading of its own at the start it is in no plane, and its guidance turns.
        let mut turned = experiment.clone();
        turned.initial.heading_deg = Some(0.0);
        Ok(Self {
            controller: turned.controller()?,
            path,
            heading,
            axes: Axes::new(heading.unwrap_or_default()),
            gravity: experiment.vehicle.gravity_m_s2,
            last: (0.0, 1.0),
            theta: 0.0,
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
        self.theta += wrap(truth.theta() - self.theta);
        let step = Step {
            t: told.t,
            truth,
            theta: self.theta,
            readings: Vec::new(),
            wind: told.air.wind(told.velocity).map_or_else(V3::zeros, double),
            load_factor: force.map_or(f64::NAN, |f| f / self.gravity),
            target,
            measured_attitude: attitude,
            input,
            answer,
            mission: None,
            model_theta: None,
        };
        if self.record.last().is_none_or(|last| step.t > last.t) {
            self.record.push(step);
        }
    }
}

impl Pilot for OnPath {
    fn begin(&mut self, heading: f32) {
        self.axes = Axes::new(self.heading.unwrap_or(heading));
    }

    fn answer(&mut self, told: &Told, dt: f32) -> Result<Command, End> {
        let told = &self.axes.told(told);
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
