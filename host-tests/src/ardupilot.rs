//! The vehicle of an experiment behind ArduPilot's physics interface: a flight step by step, with the outputs in the place of a controller.
//!
//! The vehicle stands nose up on the ground, its belly to the north, until the thrust exceeds the weight. The record is along the
//! experiment's path from the start of the clock: the mark, or else the lift-off.

use std::sync::Arc;

use alula::BodyRates;
use alula::guidance::Air;
use alula_bridges::sitl::{Packet, Physics, Sample};

use alula_sim::controllers::{Answer, Controller, Input, Report};
use alula_sim::experiment::{Experiment, State, V3, attitude_to_frd, double, to_frd};
use alula_sim::simulate::{Flight, Record, Step};

/// Longest time step \[s\]: ArduPilot takes one of 0.1 s for a break.
const LONGEST_STEP: f64 = 0.02;
/// Pulse width \[µs\] over which the mark is set.
const MARK: u16 = 1700;
/// Height from which on the vehicle has lifted off \[m\].
const LIFTED: f64 = 1e-3;

/// The vehicle.
pub struct Vehicle {
    /// What is flown, one control step for each packet.
    experiment: Arc<Experiment>,
    flight: Flight<Arc<Experiment>, Packet>,
    /// Thrust of full throttle \[N\].
    most: f64,
    /// Packets for each step of the record.
    every: u64,
    /// Packets since the last restart.
    steps: u64,
    marked: bool,
    /// When the clock was started.
    start: Option<u64>,
    airborne: bool,
    record: Record,
    /// How each landing was: speed [m/s], and angle from upright \[rad\].
    landings: Vec<(f64, f64)>,
}

/// Nobody: the outputs are what ArduPilot makes of the samples.
struct Outside;

impl Controller for Outside {
    fn answer(&mut self, _: &Input, _: f32) -> anyhow::Result<Answer> {
        Ok(Answer {
            thrust: 0.0,
            rates: BodyRates::default(),
            report: Report::Outside,
        })
    }
}

/// The flight of `experiment`, on the ground.
fn flight(experiment: &Arc<Experiment>) -> anyhow::Result<Flight<Arc<Experiment>, Packet>> {
    let state = State::upright(V3::zeros(), 0.0);
    let plant = experiment.plant_under_outputs(state);
    Flight::of(Arc::clone(experiment), plant, Packet::new(0, 0, &[]))
}

impl Vehicle {
    /// The vehicle of `experiment` on the ground. The error is a time step that ArduPilot would not take, or what is not flown here.
    pub fn new(experiment: &Experiment) -> anyhow::Result<Self> {
        let rate = experiment.control_rate_hz * f64::from(experiment.substeps);
        let dt = 1.0 / rate;
        if dt > LONGEST_STEP {
            anyhow::bail!(
                "control_rate_hz and substeps give a time step of {dt} s, must be at most {LONGEST_STEP} s"
            );
        }
        if !experiment.sensors.faults.is_empty() {
            anyhow::bail!(
                "sensors.faults must be empty: they are of estimates, which ArduPilot makes itself; its sensors fail by its own SIM_* parameters"
            );
        }
        let every = experiment.substeps.into();
        let experiment = Arc::new(Experiment {
            control_rate_hz: rate,
            substeps: 1,
            // ArduPilot flies its own.
            mission: None,
            ..experiment.clone()
        });
        Ok(Self {
            flight: flight(&experiment)?,
            most: experiment.thrust_limits(None, experiment.weight())[1],
            experiment,
            every,
            steps: 0,
            marked: false,
            start: None,
            airborne: false,
            record: Record::new(),
            landings: Vec::new(),
        })
    }

    /// The flight so far, since the clock was started last.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// Each landing: speed [m/s], and angle from upright \[rad\].
    pub fn landings(&self) -> &[(f64, f64)] {
        &self.landings
    }

    fn start_clock(&mut self) {
        self.start = Some(self.steps);
        self.flight.begin();
        self.record.clear();
    }

    /// Goes on by a packet, and sees whether the vehicle has lifted off or landed.
    fn advance(&mut self, outputs: &Packet) {
        let before = *self.flight.plant().state();
        self.flight.apply(*outputs);
        let plant = self.flight.plant();
        let grounded = plant.is_grounded();
        let lifted = plant.state().position.z < -LIFTED && !grounded;
        if self.airborne && grounded {
            let [tail, ..] = before.axes();
            self.landings.push((before.velocity.norm(), tail.z.acos()));
            self.airborne = false;
        } else if !self.airborne && lifted {
            self.airborne = true;
            if self.start.is_none() && self.experiment.ardupilot.mark_channel.is_none() {
                self.start_clock();
            }
        }
        if self.start.is_none() {
            self.flight.begin();
        }
    }

    /// A step of the record, of which the outputs are the answer: ArduPilot does not tell the rates that it asks for.
    fn kept(&self, step: Step, outputs: &Packet) -> Step {
        let asked = self.experiment.ardupilot.thrust(outputs, self.most);
        let [roll, pitch, yaw] = to_frd(step.truth.rates).map(|x| x as f32);
        Step {
            answer: Answer {
                thrust: asked.iter().sum::<f64>() as f32,
                rates: BodyRates { roll, pitch, yaw },
                report: Report::Outside,
            },
            ..step
        }
    }
}

impl Physics for Vehicle {
    fn step(&mut self, packet: &Packet) -> Sample {
        let channel = self.experiment.ardupilot.mark_channel;
        let mark = channel.is_some_and(|n| packet.channel(n) > MARK);
        if mark && !self.marked {
            self.start_clock();
        }
        self.marked = mark;
        self.advance(packet);
        self.steps += 1;
        let step = self.flight.ask(&mut Outside);
        let step = step.expect("nobody is always reached");
        let measured = *self.flight.measured().expect("asked");
        let force = self.flight.specific_force();
        let (truth, wind) = (step.truth, step.wind);
        let lasts = self.start.is_some() && step.t <= self.experiment.duration_s;
        if lasts && self.steps.is_multiple_of(self.every) {
            let kept = self.kept(step, packet);
            self.record.push(kept);
        }
        let attitude = attitude_to_frd(&measured.attitude);
        let airspeed = match measured.air {
            Air::Velocity(air) => Some(to_frd(truth.attitude.inverse() * double(air))[0]),
            Air::Pitot { airspeed, .. } if airspeed.is_finite() => Some(airspeed.into()),
            _ => None,
        };
        Sample {
            timestamp: self.steps as f64 / self.experiment.control_rate_hz,
            gyro: to_frd(truth.rates),
            accel_body: to_frd(V3::new(force.y, force.z, force.x)),
            position: measured.position.into(),
            velocity: measured.velocity.into(),
            quaternion: [attitude.w, attitude.i, attitude.j, attitude.k],
            airspeed,
            velocity_wind: Some(wind.into()),
        }
    }

    fn restart(&mut self) {
        // The same outputs make the same flight again.
        self.flight = flight(&self.experiment).expect("made before");
        (self.steps, self.start) = (0, None);
        (self.marked, self.airborne) = (false, false);
        self.landings.clear();
    }
}
