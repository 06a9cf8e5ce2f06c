//! A controller run open loop over logged inputs: of a trace ([`trace`]), or of an autopilot's log ([`log`],
//! [`space`]).

pub mod log;
mod source;
pub mod space;
mod states;
mod steps;
pub mod trace;
mod unknown;

pub use source::Source;

use std::io::Write;

use crate::columns::{Column, column};
use crate::controllers::{Controller, Input};
use crate::experiment::{Experiment, State};
use crate::reference::Vector;
use crate::simulate::Step;

/// What is written after the time. The last two for controllers with modes alone.
const OUTPUTS: [&str; 7] = [
    "thrust_n",
    "rate_rad_s",
    "alpha_rad",
    "fp_n",
    "status",
    "mode",
    "air",
];

/// The controller of an experiment, and the CSV that its commands are written as.
pub struct Commands<'a, W: Write> {
    experiment: &'a Experiment,
    controller: Box<dyn Controller>,
    outputs: Vec<&'static Column>,
    writer: csv::Writer<W>,
    last_time: Option<f64>,
    cell: Vec<u8>,
}

impl<'a, W: Write> Commands<'a, W> {
    /// The controller of `experiment` at power-on; the header is written `to`.
    pub fn new(experiment: &'a Experiment, to: W) -> anyhow::Result<Self> {
        let has_mode = experiment.controller.name() != "law";
        let outputs = OUTPUTS.iter().take(if has_mode { 7 } else { 5 });
        let outputs: Vec<&Column> = outputs.filter_map(|name| column(name)).collect();
        let mut writer = csv::Writer::from_writer(to);
        let names = outputs.iter().map(|column| column.name);
        writer.write_record(std::iter::once("t_s").chain(names))?;
        Ok(Self {
            experiment,
            controller: experiment.controller()?,
            outputs,
            writer,
            last_time: None,
            cell: Vec::new(),
        })
    }

    /// Asks the controller at `t` \[s\], which is written as `time`. Of the truth nothing is known.
    pub fn row(&mut self, time: &str, t: f64, input: Input) -> anyhow::Result<Step> {
        let period = 1.0 / self.experiment.control_rate_hz;
        let dt = self.last_time.map_or(period, |last| t - last);
        self.last_time = Some(t);
        let answer = self.controller.answer(&input, dt as f32)?;
        let nowhere = Vector::from_element(f64::NAN);
        let step = Step {
            t,
            truth: State {
                velocity: nowhere,
                position: nowhere,
                theta: f64::NAN,
                rate: f64::NAN,
                thrust: f64::NAN,
            },
            wind: nowhere,
            reference_velocity: nowhere,
            reference_acceleration: nowhere,
            reference_position: nowhere,
            input,
            answer,
        };
        self.writer.write_field(time)?;
        for column in &self.outputs {
            self.cell.clear();
            if let Some(value) = (column.read)(self.experiment, &step) {
                value.push(&mut self.cell);
            }
            self.writer.write_field(&self.cell)?;
        }
        self.writer.write_record(None::<&[u8]>)?;
        Ok(step)
    }

    /// Writes what is left.
    pub fn end(mut self) -> anyhow::Result<()> {
        Ok(self.writer.flush()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_column_written_is_declared() {
        for name in OUTPUTS {
            assert!(column(name).is_some(), "{name} is no column");
        }
    }
}
