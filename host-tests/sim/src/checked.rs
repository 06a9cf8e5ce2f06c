//! Experiments with all that their documents must fit: the controller's table, and the names of figures.

use toml::{Table, Value};

use crate::experiment::{
    ControllerSpec, Document, Experiment, FieldError, TailSitterPlant, TailSitterSpec, read,
    require,
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

/// What is said of a vehicle where a flight is wanted.
const VEHICLE_ALONE: &str = "a vehicle alone, where an experiment is wanted: `margins` and `equilibria` take it, and an experiment names it, `base = \"…\"`";

impl Document {
    /// The experiment that the document describes, validated but for its controller.
    pub fn data(&self) -> Result<Experiment, FieldError> {
        let believed = self.believed()?;
        let mut experiment: Experiment = believed.document.read().map_err(|error| {
            match error.problem.starts_with("missing field `duration_s`") && !self.is_flight() {
                true => FieldError::new("", VEHICLE_ALONE),
                false => error,
            }
        })?;
        let problem = "missing field `path`, or `mission`";
        require(self.is_flight(), "", problem)?;
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
        let spec = &tail_sitter.measured();
        let belief = Belief::of(spec);
        document.set("vehicle", belief.vehicle(spec.mass_kg))?;
        document.set("plant", belief.plant(tail_sitter.delay_s))?;
        if document.controller() == "guidance" {
            let path = "controller.guidance.for_vehicle";
            if document.get(path).is_none() {
                document.set(path, belief.response(spec, &document))?;
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
        experiment.flown_mission()?;
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

    /// The experiment; an error names file and line, and the changes if the texts are sound without them.
    pub fn checked(&self) -> anyhow::Result<Experiment> {
        self.experiment().map_err(|error| {
            let sound = |texts: Self| texts.experiment().is_ok();
            match self.unchanged().is_some_and(sound) {
                true => self.located_by_changes(error),
                false => self.located(error),
            }
        })
    }

    /// Writes down what the controller believes about the vehicle, where that is left out or named: the vehicle as it stands here, or the
    /// one of this name. What is changed of the vehicle from then on is not known to the controller.
    pub fn pin_belief(&mut self) -> Result<(), FieldError> {
        self.data()?;
        self.write_belief()
    }

    /// As [`Self::pin_belief`], of a document that need not be whole.
    pub(crate) fn write_belief(&mut self) -> Result<(), FieldError> {
        self.write_named_belief()?;
        let spec = ControllerSpec {
            kind: self.controller(),
            ..ControllerSpec::default()
        };
        let path = format!("{}.vehicle", spec.path());
        match self.believed()?.document.get("vehicle").cloned() {
            Some(vehicle) if spec.believes() && self.get(&path).is_none() => {
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
            ("authority", self.authority.table()),
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

    /// `[controller.guidance.for_vehicle]`, where it is left out.
    fn response(&self, spec: &TailSitterSpec, document: &Document) -> Value {
        let control_rate = document.number("control_rate_hz").unwrap_or(100.0);
        table([
            ("rate_lag_s", self.rate_lag_s.into()),
            ("thrust_lag_s", self.thrust_lag_s.into()),
            ("control_rate_hz", control_rate.into()),
            ("cruise_speed_m_s", spec.cruise_speed_m_s.into()),
        ])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::tail_sitter::VEHICLES;

    /// A file of the plant's vehicle is named by its own line, and a field that is set by the assignment.
    #[test]
    fn errors_of_a_vehicle_name_its_file_line_and_field() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let document = "base = 'tail-sitter-hover'\nplant.vehicle = 'mine.toml'\n";
        std::fs::write(at("flight.toml"), document).unwrap();
        let mapping = VEHICLES
            .iter()
            .find(|(name, _)| *name == "mapping")
            .unwrap()
            .1;
        let error = |needle: &str, with: &str| {
            let swap = |line| {
                if str::starts_with(line, needle) {
                    with
                } else {
                    line
                }
            };
            let lines: Vec<&str> = mapping.lines().map(swap).collect();
            std::fs::write(at("mine.toml"), lines.join("\n")).unwrap();
            let loaded = Document::load(at("flight.toml").to_str().unwrap());
            let error = loaded.unwrap().checked().unwrap_err().to_string();
            let line = 1 + mapping.lines().position(|l| l.starts_with(needle)).unwrap();
            let (place, problem) = error.split_once(": ").unwrap();
            assert!(place.ends_with(&format!("mine.toml:{line}")), "{error}");
            problem.to_owned()
        };
        assert_eq!(
            error("mass_kg", "mass_kg = -1"),
            "plant.vehicle.mass_kg: must be from 0.01 to 1000"
        );
        assert_eq!(
            error("rate_hz", "rate_hz = 50"),
            "plant.vehicle.rate_loop.rate_hz: must be from 200 to 2000"
        );
        assert_eq!(
            error("travel_deg", "travel_deg = 90"),
            "plant.vehicle.servo.travel_deg: must be from 0 to 70"
        );
    }

    #[test]
    fn the_plant_is_changed_by_path_and_described_once() {
        let load = || Document::load("tail-sitter-hover").unwrap();
        let mut heavier = load();
        heavier.assign("plant.vehicle.mass_kg=2.6").unwrap();
        let experiment = heavier.checked().unwrap();
        let plant = experiment.tail_sitter.unwrap();
        assert_eq!(
            (plant.vehicle.mass_kg, experiment.vehicle.mass_kg),
            (2.6, 2.6)
        );
        let mut other = load();
        other.assign("plant.vehicle='biplane'").unwrap();
        assert_eq!(other.checked().unwrap().vehicle.mass_kg, 1.6);
        let refused = |assignment: &str| {
            let mut document = load();
            let done = document.assign(assignment);
            done.and_then(|()| document.checked().map(|_| ()))
                .unwrap_err()
                .to_string()
        };
        assert!(refused("vehicle.mass_kg=3").contains("vehicle: stands in plant.vehicle"));
        assert!(refused("plant.kind='glider'").contains("plant.kind: must be"));
        assert!(refused("plant.vehicle='maping'").contains("did you mean mapping?"));
        assert!(refused("plant.thrust_lag_s=0.1").contains("plant.thrust_lag_s: unknown field"));
    }

    /// A field of a belief that is left out, or a name, is that of the belief as it stands: all else of it stays.
    #[test]
    fn a_field_of_the_belief_is_changed_alone() {
        for name in ["circle-40", "round-trip", "tail-sitter-circle"] {
            let belief = |document: &Document| {
                let experiment = document.checked().unwrap();
                let spec = experiment.spec().unwrap();
                spec.belief().unwrap_or(&experiment.vehicle).clone()
            };
            let mut document = Document::load(name).unwrap();
            let before = belief(&document);
            document
                .assign("controller.guidance.vehicle.mass_kg=2.5")
                .unwrap();
            let expected = crate::experiment::VehicleSpec {
                mass_kg: 2.5,
                ..before
            };
            assert_eq!(belief(&document), expected, "{name}");
            assert_ne!(document.checked().unwrap().vehicle.mass_kg, 2.5);
        }
    }

    /// Static thrust by C_T, a lag within those of real rate loops, the wing's area, and a greatest lift of a wing.
    #[test]
    fn the_belief_is_what_a_person_measures() {
        for (name, text) in VEHICLES {
            let spec: TailSitterSpec = toml::from_str(text).unwrap();
            spec.validate().unwrap();
            let belief = Belief::of(&spec);
            let thrust = |p: &crate::experiment::tail_sitter::Propeller| {
                p.c_t[0] * 1.225 * p.speed_max_rev_s.powi(2) * p.diameter_m.powi(4)
            };
            let full = (1.0 - spec.motors.sag).powi(2);
            let thrust: f64 = full * spec.propellers.iter().map(thrust).sum::<f64>();
            assert!((belief.thrust_max_n / thrust - 1.0).abs() < 1e-12, "{name}");
            assert!(
                (0.02..0.6).contains(&belief.rate_lag_s),
                "{name}: {}",
                belief.rate_lag_s
            );
            let a = &belief.authority;
            let hover = a.slipstream_rad_s2 + a.difference_rad_s2;
            assert!((5.0..200.0).contains(&hover), "{name}: {hover}");
            assert!((0.05..5.0).contains(&a.wing_moment_rad_m2), "{name}");
            // Thrust is left at the cruise that the vehicle is made for; 0 is one that never falls.
            let falls = a.zero_thrust_speed_m_s;
            assert!(
                falls == 0.0 || falls > 1.1 * spec.cruise_speed_m_s,
                "{name}"
            );
            let most = belief.polar.iter().map(|row| row[1]).fold(0.0, f64::max);
            assert!((0.7..1.6).contains(&most), "{name}: {most}");
            assert!(belief.polar.iter().all(|row| row[2] > 0.0), "{name}");
        }
    }
}
