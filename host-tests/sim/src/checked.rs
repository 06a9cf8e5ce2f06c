//! Experiments with all that their documents must fit: the controller's table, and the names of figures.

use crate::experiment::{Document, Experiment, FieldError, require};
use crate::figures;

impl Document {
    /// The experiment that the document describes, validated.
    pub fn experiment(&self) -> Result<Experiment, FieldError> {
        let experiment = self.data()?;
        experiment.controller()?;
        for name in experiment.bounds.keys() {
            let field = format!("bounds.{name}");
            require(
                figures::index(name).is_some(),
                field,
                figures::unknown(name),
            )?;
        }
        Ok(experiment)
    }

    /// The experiment; an error names file and line.
    pub fn checked(&self) -> anyhow::Result<Experiment> {
        self.experiment().map_err(|error| self.located(error))
    }

    /// Writes down what the controller believes about the vehicle, where that is left out: the vehicle as it stands here. What is
    /// changed of the vehicle from then on is not known to the controller.
    pub fn pin_belief(&mut self) -> Result<(), FieldError> {
        let controller = self.data()?.controller;
        let path = format!("{}.vehicle", controller.path());
        match self.get("vehicle").cloned() {
            Some(vehicle) if controller.believes() && self.get(&path).is_none() => {
                self.set(&path, vehicle)
            }
            _ => Ok(()),
        }
    }
}
