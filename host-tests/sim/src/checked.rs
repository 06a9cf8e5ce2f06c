//! Experiments with all that their documents must fit: the controller's table, and the names of figures.

use toml::{Table, Value};

use crate::experiment::{
    Document, Experiment, FieldError, TailSitterPlant, TailSitterSpec, read, require,
};
use crate::figures;
use crate::plant::tail_sitter::Belief;

/// A document of the ideal plant, and the plant that it is the belief about, if that is another.
pub struct Believed {
    /// The document.
    pub document: Document,
    /// The plant of kind `tail-sitter`.
    pub tail_sitter: Option<TailSitterPlant>,
}

impl Document {
    /// The experiment that the document describes, validated but for its controller.
    pub fn data(&self) -> Result<Experiment, FieldError> {
        let believed = self.believed()?;
        let mut experiment: Experiment = believed.document.read()?;
        experiment.tail_sitter = believed.tail_sitter;
        experiment
            .validate()
            .map_err(|error| self.as_written(error))?;
        Ok(experiment)
    }

    /// The document with what is believed of a plant of another kind than the ideal one in `[vehicle]`, `[plant]` and the guidance's table.
    pub fn believed(&self) -> Result<Believed, FieldError> {
        let mut document = self.clone();
        let plant = self.get("plant").and_then(Value::as_table);
        let mut plant = plant.cloned().unwrap_or_default();
        let kind = plant.remove("kind");
        match kind.as_ref().map(|kind| kind.as_str()) {
            None | Some(Some("ideal")) => {
                if kind.is_some() {
                    document.set("plant", Value::Table(plant))?;
                }
                return Ok(Believed {
                    document,
                    tail_sitter: None,
                });
            }
            Some(Some("tail-sitter")) => {}
            Some(_) => {
                let problem = "must be \"ideal\" or \"tail-sitter\"";
                return Err(FieldError::new("plant.kind", problem));
            }
        }
        let problem =
            "stands in plant.vehicle; what a controller believes, in controller.guidance.vehicle";
        require(self.get("vehicle").is_none(), "vehicle", problem)?;
        let inside = |e: FieldError| e.inside("plant");
        let tail_sitter: TailSitterPlant = read(Value::Table(plant)).map_err(inside)?;
        tail_sitter.validate().map_err(inside)?;
        let spec = &tail_sitter.vehicle;
        let belief = Belief::of(spec);
        document.set("vehicle", belief.vehicle(spec.mass_kg))?;
        document.set("plant", belief.plant(tail_sitter.delay_s))?;
        if document.controller() == "guidance" {
            for (name, value) in belief.guidance(spec, &document) {
                let path = format!("controller.guidance.{name}");
                if document.get(&path).is_none() {
                    document.set(&path, value)?;
                }
            }
        }
        Ok(Believed {
            document,
            tail_sitter: Some(tail_sitter),
        })
    }

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
        match self.believed()?.document.get("vehicle").cloned() {
            Some(vehicle) if controller.believes() && self.get(&path).is_none() => {
                self.set(&path, vehicle)
            }
            _ => Ok(()),
        }
    }
}

/// A table of numbers.
fn table(entries: impl IntoIterator<Item = (&'static str, Value)>) -> Value {
    let entries = entries.into_iter();
    Value::Table(
        entries
            .map(|(key, value)| (key.to_owned(), value))
            .collect::<Table>(),
    )
}

impl Belief {
    /// `[vehicle]`.
    fn vehicle(&self, mass: f64) -> Value {
        let row = |row: &[f64; 3]| row.map(Value::from).to_vec().into();
        let rows: Vec<Value> = self.polar.iter().map(row).collect();
        table([
            ("mass_kg", mass.into()),
            ("k_a_kg_m", self.k_a_kg_m.into()),
            ("c_y", self.c_y.into()),
            (
                "aerodynamics",
                table([("table", table([("polar", rows.into())]))]),
            ),
        ])
    }

    /// `[plant]`, with its actuators as lags.
    fn plant(&self, delay: f64) -> Value {
        let lag = table([("time_constant_s", self.rate_lag_s.into())]);
        table([
            ("rate_loop", table([("lag", lag)])),
            ("thrust_lag_s", self.thrust_lag_s.into()),
            ("delay_s", delay.into()),
            ("thrust_n", vec![0.0, self.thrust_max_n].into()),
        ])
    }

    /// What `[controller.guidance]` says where it says nothing else.
    fn guidance(&self, spec: &TailSitterSpec, document: &Document) -> [(&'static str, Value); 3] {
        let control_rate = document.number("control_rate_hz").unwrap_or(100.0);
        let for_vehicle = table([
            ("rate_lag_s", self.rate_lag_s.into()),
            ("thrust_lag_s", self.thrust_lag_s.into()),
            ("control_rate_hz", control_rate.into()),
            ("cruise_speed_m_s", spec.cruise_speed_m_s.into()),
        ]);
        [
            ("for_vehicle", for_vehicle),
            ("max_rate_rad_s", spec.rate_loop.rate_max_rad_s.into()),
            ("max_slew_rad_s2", self.slew_rad_s2.into()),
        ]
    }
}
