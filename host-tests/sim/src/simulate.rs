//! The loop of an experiment: the plant in double precision, its controller at a fixed rate.

use std::collections::VecDeque;
use std::fmt;
use std::ops::Deref;

use alula::guidance::{Candidate, PlannerOptions};
use alula::mission::{Gate, MissionOutput};
use alula::ned::Ned;
use alula::spatial::FeedForward;
use alula::{BodyRates, GuidanceOutput};
use nalgebra::UnitQuaternion;
use rand_chacha::ChaCha8Rng;

use crate::controllers::{Answer, Controller, Input};
use crate::experiment::{
    Estimates, Experiment, Faults, Measured, Path, State, Target, V3, Weather, from_frd, ned,
    stream,
};
use crate::flown_mission::{FlownMission, asked_of, passed, target};
use crate::plant::{Command, Plant};
use crate::reference::wrap;
use crate::sensor_hold::SensorHold;

/// One control step of a flight.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Time \[s\].
    pub t: f64,
    /// The plant's state when the controller was asked.
    pub truth: State,
    /// θ of that state \[rad\], counted on through full turns.
    pub theta: f64,
    /// The wind there \[m/s\].
    pub wind: V3,
    /// Specific force over g.
    pub load_factor: f64,
    /// What the plant says in columns of its own.
    pub readings: Vec<f64>,
    /// What is to be flown.
    pub target: Target,
    /// The speed asked for \[m/s\]: along the path before it waits for the vehicle; of what goes along with the wind, through the air.
    pub asked_speed: f64,
    /// The attitude measured: from (belly, right wing, tail) to north-east-down.
    pub measured_attitude: UnitQuaternion<f64>,
    /// What the controller was told.
    pub input: Input,
    /// What it answered.
    pub answer: Answer,
    /// What the mission asks for, if one is flown.
    pub mission: Option<MissionOutput>,
    /// The attitude θ \[rad\] of its reference model after that, if it has one that is known.
    pub model_theta: Option<f32>,
    /// The plans that it looked at in this step, if it made one.
    pub candidates: Vec<Candidate>,
}

impl Step {
    /// v − v_r \[m/s\].
    pub fn velocity_error(&self) -> V3 {
        self.truth.velocity - self.target.velocity
    }

    /// x − x_r \[m\].
    pub fn position_error(&self) -> V3 {
        self.truth.position - self.target.position
    }

    /// Whether the vehicle is in the vertical plane to the north, upright or not.
    pub fn in_plane(&self) -> bool {
        /// What rounding leaves \[m, m/s, 1\].
        const ROUNDING: f64 = 1e-6;
        let State {
            position, velocity, ..
        } = self.truth;
        let [_, _, right] = self.truth.axes();
        let out = [position.y, velocity.y, right.y - 1.0];
        out.iter().all(|x| x.abs() < ROUNDING)
    }

    /// Altitude over the path \[m\].
    pub fn altitude(&self) -> f64 {
        -self.position_error().z
    }

    /// Whether it stands on the ground, and its mission has the motors off: nothing is flown.
    pub fn stands(&self) -> bool {
        /// Speed of what stands \[m/s\].
        const REST: f64 = 0.1;
        let off = self.mission.is_some_and(|asked| asked.gate == Gate::Off);
        off && self.truth.velocity.norm() < REST
    }
}

/// What is shown of a record: all of it, but of the time on the ground after a landing no more than 5 s.
pub fn shown(record: &[Step]) -> &[Step] {
    /// \[s\].
    const STANDING: f64 = 5.0;
    let standing = record.iter().rev().take_while(|step| step.stands()).count();
    // One that never left the ground is shown whole.
    let Some(landed) = (record.len() - standing).checked_sub(1) else {
        return record;
    };
    let end = record[landed].t + STANDING;
    &record[..record.partition_point(|step| step.t <= end)]
}

/// A flight that came to no number: at this time \[s\] the plant's state was not finite, or its speed beyond that of any aircraft.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diverged {
    /// Time \[s\].
    pub t: f64,
}

impl Diverged {
    /// What is said of a step that has diverged.
    pub fn at(step: &Step) -> Result<(), Self> {
        match step.truth.is_sound() {
            true => Ok(()),
            false => Err(Self { t: step.t }),
        }
    }
}

impl fmt::Display for Diverged {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(
            f,
            "diverged at {:.2} s: no aircraft flies like this, or the plant's steps are too long for it",
            self.t
        )
    }
}

impl std::error::Error for Diverged {}

/// How a simulation ended.
#[must_use = "a flight that diverged has no figures"]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// At the end of the flight.
    Flown,
    /// `visit` ended it.
    Left,
    /// It came to no number.
    Diverged(Diverged),
}

impl End {
    /// The error is a flight that diverged.
    pub fn sound(self) -> Result<(), Diverged> {
        match self {
            Self::Flown | Self::Left => Ok(()),
            Self::Diverged(diverged) => Err(diverged),
        }
    }
}

/// A flight: one row per control step, the last at its end.
pub type Record = Vec<Step>;

/// Flies `experiment` under its own controller. The error is one of [`fly_by`].
pub fn fly(experiment: &Experiment) -> anyhow::Result<Record> {
    fly_by(experiment, experiment.controller()?.as_mut())
}

/// Flies `experiment` under `controller`. The error is a controller that cannot be reached, or [`Diverged`].
pub fn fly_by(experiment: &Experiment, controller: &mut dyn Controller) -> anyhow::Result<Record> {
    let mut record = Record::with_capacity(experiment.steps() + 1);
    simulate(experiment, controller, |step| {
        record.push(step.clone());
        true
    })?
    .sound()?;
    Ok(record)
}

/// Flies `experiment` under `controller`: `visit` is given every control step, the last at the end of the flight, and says whether to go
/// on. A step at which the plant has diverged is the last one. The error is a controller that cannot be reached.
pub fn simulate(
    experiment: &Experiment,
    controller: &mut dyn Controller,
    mut visit: impl FnMut(&Step) -> bool,
) -> anyhow::Result<End> {
    let mut flight = Flight::new(experiment)?;
    for _ in 0..=experiment.steps() {
        let step = flight.ask(controller)?;
        let go_on = visit(&step);
        if let Err(diverged) = Diverged::at(&step) {
            return Ok(End::Diverged(diverged));
        }
        if !go_on {
            return Ok(End::Left);
        }
        flight.advance(&step.answer);
    }
    Ok(End::Flown)
}

/// A flight that goes on step by step: [`ask`](Self::ask) the controller, then [`advance`](Self::advance) with its answer.
///
/// `E` leads to its experiment: a reference, or what shares it. `C` is what the plant is asked for.
pub struct Flight<E, C = Command> {
    experiment: E,
    in_plane: bool,
    /// Whether the controller is told the measured air acceleration.
    feed_forward: bool,
    /// Random numbers of sensors and weather.
    noise: ChaCha8Rng,
    gusts: ChaCha8Rng,
    weather: Weather,
    faults: Faults,
    estimates: Estimates,
    hold: SensorHold,
    path: Path,
    mission: Option<FlownMission>,
    /// Where the path begins, and how far the wind has carried it \[m\].
    drift: V3,
    plant: Box<dyn Plant<C>>,
    measured: Option<Measured>,
    last_answer: Option<Answer>,
    /// Commands on their way: the number of the plant's step from which each acts.
    pending: VecDeque<(usize, C)>,
    command: C,
    /// Steps of the controller and of the plant so far.
    step: usize,
    plant_step: usize,
    theta: f64,
}

/// What a step is asked for.
struct Asked {
    target: Target,
    /// \[m/s\].
    speed: f64,
    planner_options: PlannerOptions,
    /// Of the mission, if one is flown.
    mission: Option<MissionOutput>,
}

impl<E: Deref<Target = Experiment> + Clone> Flight<E> {
    /// The flight of `experiment` at its beginning.
    pub fn new(experiment: E) -> anyhow::Result<Self> {
        let mut random = stream(experiment.seed, 2);
        let target = experiment.path.path()?.start();
        let start = experiment.initial.state(&target, &mut random);
        let theta = experiment.initial.theta_deg.to_radians();
        let command = Command {
            thrust: start.thrust,
            rates: V3::zeros(),
        };
        let plant = experiment.plant(start);
        let flight = Self::of(experiment, plant, command)?;
        Ok(Self { theta, ..flight })
    }

    /// Goes on by a control step, with `answer` given to the plant.
    pub fn advance(&mut self, answer: &Answer) {
        self.apply(answer.into());
    }
}

impl<E: Deref<Target = Experiment> + Clone, C: Clone> Flight<E, C> {
    /// The flight of `experiment` with another `plant`, which is under `command` until the first one acts.
    pub fn of(experiment: E, plant: Box<dyn Plant<C>>, command: C) -> anyhow::Result<Self> {
        let in_plane = experiment.in_plane();
        let [noise, mut gusts] = [0, 1].map(|n| stream(experiment.seed, n));
        let faults = experiment.sensors.faults.clone();
        Ok(Self {
            in_plane,
            feed_forward: experiment.spec()?.feed_forward(),
            noise,
            weather: Weather::new(experiment.weather, in_plane, &mut gusts),
            gusts,
            faults: Faults::new(faults, experiment.seed, in_plane),
            estimates: Estimates::new(experiment.seed),
            hold: SensorHold::default(),
            path: experiment.path.path()?,
            mission: experiment.flown_mission()?,
            drift: V3::zeros(),
            theta: plant.state().theta(),
            plant,
            measured: None,
            last_answer: None,
            pending: VecDeque::new(),
            command,
            step: 0,
            plant_step: 0,
            experiment,
        })
    }

    /// Puts the clock to 0, and the beginning of the path to where the vehicle is.
    pub fn begin(&mut self) {
        self.step = 0;
        self.path.restart();
        self.drift = self.plant.state().position;
        self.theta = wrap(self.theta);
        self.hold = SensorHold::default();
    }

    /// What is flown.
    pub fn plant(&self) -> &dyn Plant<C> {
        self.plant.as_ref()
    }

    /// What was measured at the last step; none before the first.
    pub fn measured(&self) -> Option<&Measured> {
        self.measured.as_ref()
    }

    /// Specific force \[m/s²\] in components along (i, j, w).
    pub fn specific_force(&self) -> V3 {
        self.plant.specific_force(self.weather.wind(self.time()))
    }

    /// Time of a control step \[s\].
    fn period(&self) -> f64 {
        1.0 / self.experiment.control_rate_hz
    }

    /// Asks `controller` along the experiment's path.
    pub fn ask(&mut self, controller: &mut dyn Controller) -> anyhow::Result<Step> {
        self.asked(controller, Self::along_path)
    }

    /// Asks `controller` for what `wanted` makes of what is measured, in place of the path.
    pub fn ask_for(
        &mut self,
        controller: &mut dyn Controller,
        wanted: impl FnOnce(&Measured) -> (Target, PlannerOptions),
    ) -> anyhow::Result<Step> {
        self.asked(controller, |_, _, measured| {
            let (target, planner_options) = wanted(measured);
            Asked {
                speed: target.velocity.norm(),
                target,
                planner_options,
                mission: None,
            }
        })
    }

    /// What the mission asks for, or the target on the path.
    fn along_path(&mut self, controller: &dyn Controller, measured: &Measured) -> Asked {
        let (t, period) = (self.time(), self.period());
        if let Some(mission) = &mut self.mission {
            let wind = self.estimates.last_wind();
            let asked = mission.step(t, period, measured, ned(wind), self.last_answer.as_ref());
            let target = target(&asked, measured);
            return Asked {
                speed: (target.velocity - wind).norm(),
                target,
                planner_options: PlannerOptions::default(),
                mission: Some(asked),
            };
        }
        let drift = self.drift;
        let mut own_speed = None;
        let mut target = self.path.advance(t, period, |target| {
            own_speed = Some(target.velocity.norm());
            let error = measured.position - drift - target.position;
            controller
                .time_scale(ned(error), ned(target.velocity))
                .into()
        });
        let speed = own_speed.unwrap_or(target.velocity.norm());
        if self.experiment.path_in_air {
            let along = target.velocity.normalize();
            let ahead = (measured.position - self.drift - target.position).dot(&along);
            self.drift += ahead * along;
            target.position += self.drift;
            target.velocity += self.estimates.last_wind();
            self.drift += self.estimates.last_wind() * period;
        } else {
            target.position += self.drift;
        }
        Asked {
            target,
            speed,
            planner_options: PlannerOptions::default(),
            mission: None,
        }
    }

    /// Time \[s\] of the next step.
    pub fn time(&self) -> f64 {
        self.step as f64 / self.experiment.control_rate_hz
    }

    fn asked(
        &mut self,
        controller: &mut dyn Controller,
        wanted: impl FnOnce(&mut Self, &dyn Controller, &Measured) -> Asked,
    ) -> anyhow::Result<Step> {
        let experiment = self.experiment.clone();
        let sensors = &experiment.sensors;
        let gravity = experiment.vehicle.gravity_m_s2;
        let (t, period) = (self.time(), self.period());
        let truth = *self.plant.state();
        self.theta += wrap(truth.theta() - self.theta);
        let wind = self.weather.wind(t);
        let force = self.plant.specific_force(wind);
        let measured = sensors.measure(
            &truth,
            force,
            wind,
            experiment.weather.steady(),
            self.in_plane,
            (&mut self.noise, &mut self.estimates),
            period,
        );
        let measured = self.hold.state(&mut self.faults, t, measured);
        self.measured = Some(measured);
        let Asked {
            target,
            speed,
            planner_options,
            mission,
        } = wanted(self, controller, &measured);
        let mut sample = self.hold.input(sensors, &self.faults, t, &target);
        sample.planner_options = planner_options;
        let mut input = Input {
            sample,
            feed_forward: self.feed_forward.then(|| {
                let [i, j, w] = truth.axes();
                let acceleration = force.x * i + force.y * j + force.z * w + gravity * V3::z();
                FeedForward {
                    // As an accelerometer gives it; the air's own acceleration is not known to it.
                    air_acceleration: ned(acceleration),
                    // The reference is piecewise linear.
                    jerk: Ned::default(),
                }
            }),
        };
        if let Some(mission) = &mission {
            asked_of(mission, &mut input);
        }
        let gate = mission.as_ref().map_or(Gate::Open, |mission| mission.gate);
        let clock = self.faults.clock(t, period);
        if let Some(bit) = clock.flips {
            controller.flip(bit);
        }
        for dt in clock.steps.into_iter().flatten() {
            // On the ground nobody is asked: the state stays that of power-on.
            self.last_answer = Some(match gate {
                Gate::Off => passed(gate, GuidanceOutput::default().into()),
                _ => passed(gate, controller.answer(&input, dt as f32)?),
            });
        }
        let answer = self
            .last_answer
            .expect("asked at the first step at the latest");
        Ok(Step {
            t,
            truth,
            theta: self.theta,
            wind,
            load_factor: force.norm() / gravity,
            readings: self.plant.readings(),
            target,
            asked_speed: speed,
            measured_attitude: measured.attitude,
            input,
            answer,
            mission,
            model_theta: controller.model_theta(),
            candidates: controller.candidates().to_vec(),
        })
    }

    /// Goes on by a control step, with `command` given to the plant.
    pub fn apply(&mut self, command: C) {
        let period = self.period();
        let dt = period / f64::from(self.experiment.substeps);
        let wind = self.weather.wind(self.time());
        let delay = (self.experiment.plant.delay_s / dt).round() as usize;
        let begin = self.plant_step + delay;
        self.pending.push_back((begin, command));
        for _ in 0..self.experiment.substeps {
            let due = |next: &mut (usize, C)| next.0 <= self.plant_step;
            while let Some((_, next)) = self.pending.pop_front_if(due) {
                self.command = next;
            }
            self.plant.step(&self.command, wind, dt);
            self.plant_step += 1;
        }
        let airspeed = (self.plant.state().velocity - wind).norm();
        self.weather.advance(airspeed, period, &mut self.gusts);
        self.step += 1;
    }
}

impl From<&Answer> for Command {
    fn from(answer: &Answer) -> Self {
        let BodyRates { roll, pitch, yaw } = answer.rates;
        Self {
            thrust: answer.thrust.into(),
            rates: from_frd([roll, pitch, yaw].map(f64::from)),
        }
    }
}
