//! A controller run open loop over logged inputs: of a trace ([`trace`]), or of an autopilot's log ([`log`]).

pub mod log;
mod rejected;
mod source;
mod states;
mod steps;
pub mod trace;
mod unknown;

pub use source::Source;

use std::io::Write;

use alula::ned::BodyAxes;
use nalgebra::UnitQuaternion;

use crate::columns::{declared, write_columns};
use crate::controllers::{Controller, Input};
use crate::experiment::{Experiment, State, Target, V3, double};
use crate::simulate::{Record, Step};

/// What is written, as far as it applies to the controller.
const OUTPUTS: [&str; 14] = [
    "t_s",
    "thrust_n",
    "command_roll_rad_s",
    "command_pitch_rad_s",
    "command_yaw_rad_s",
    "law_alpha_rad",
    "fp_n",
    "margin_k",
    "margin_fold_rad",
    "mode",
    "phase",
    "unreachable",
    "air",
    "status",
];

/// The controller of an experiment, open loop.
struct OpenLoop<'a> {
    experiment: &'a Experiment,
    controller: Box<dyn Controller>,
    record: Record,
}

/// What a log says of the vehicle besides the controller's input; NaN where it says nothing.
struct Logged {
    position: V3,
    wind: V3,
    load_factor: f64,
    target: Target,
}

impl<'a> OpenLoop<'a> {
    fn new(experiment: &'a Experiment) -> anyhow::Result<Self> {
        Ok(Self {
            experiment,
            controller: experiment.controller()?,
            record: Record::new(),
        })
    }

    /// One row of the log: what it says stands for the truth.
    fn row(&mut self, t: f64, input: Input, logged: Logged) -> anyhow::Result<()> {
        let period = 1.0 / self.experiment.control_rate_hz;
        let dt = self.record.last().map_or(period, |last| t - last.t);
        let answer = self.controller.answer(&input, dt as f32)?;
        let q = input.sample.orientation.to_quaternion(BodyAxes::NoseUp);
        let [w, x, y, z] = [q.w, q.x, q.y, q.z].map(f64::from);
        let attitude = UnitQuaternion::new_normalize(nalgebra::Quaternion::new(w, x, y, z));
        let truth = State {
            position: logged.position,
            velocity: double(input.sample.velocity),
            attitude,
            rates: V3::repeat(f64::NAN),
            thrust: f64::NAN,
        };
        self.record.push(Step {
            t,
            truth,
            theta: truth.theta(),
            wind: logged.wind,
            load_factor: logged.load_factor,
            readings: Vec::new(),
            target: logged.target,
            asked_speed: logged.target.velocity.norm(),
            measured_attitude: attitude,
            input,
            answer,
            mission: None,
            model_theta: self.controller.model_theta(),
            candidates: self.controller.candidates().to_vec(),
        });
        Ok(())
    }
}

/// Writes the commands of a replay as CSV.
pub fn write(experiment: &Experiment, record: &[Step], to: impl Write) -> std::io::Result<()> {
    write_columns(&OUTPUTS.map(declared), experiment, record, to)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_column_written_is_declared() {
        for name in OUTPUTS {
            declared(name);
        }
    }
}
