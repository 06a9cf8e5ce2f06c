//! Vehicles by name or file, for analyses that need no flight.

use std::path::Path;

use alula::GainParameters;
use serde::Serialize;
use toml::Value;

use crate::controllers::Choice;
use crate::experiment::{
    AerodynamicsSpec, Document, FieldError, PlantSpec, Vehicle, VehicleSpec, thrust_limits,
};
use crate::margins::{Loop, LoopGains, Point};
use crate::polar::{self, Polar};
use crate::reference;

/// A vehicle with where it came from.
#[derive(Clone, Debug)]
pub struct Airframe {
    /// Built-in name, or the file's name without its extension.
    pub name: String,
    /// One line for reports.
    pub description: String,
    /// The vehicle.
    pub spec: VehicleSpec,
    /// Its actuators.
    pub plant: PlantSpec,
    /// Its controller.
    pub controller: Choice,
}

/// How much lag and delay the loop bears with one choice of gains.
#[derive(Clone, Debug, Serialize)]
pub struct LoopMargins {
    /// `paper` or `experiment`.
    pub gains: &'static str,
    /// The equilibria of level flight at each speed.
    pub points: Vec<Point>,
}

impl Airframe {
    /// The margins in level flight at `speeds` \[m/s\], or at 0 to 25 m/s if there are none, with the paper's gains and with those of its
    /// controller, which takes its belief for the vehicle if `belief`, and the vehicle itself else.
    ///
    /// # Errors
    /// `controller`: it has no gains. `speeds`: one is not from 0 to 1000 m/s.
    pub fn margins(&self, speeds: &[f64], belief: bool) -> anyhow::Result<[LoopMargins; 2]> {
        let vehicle = self.reference();
        let spec = self.controller.spec()?;
        let believed = spec.belief().unwrap_or(&self.spec);
        let Some(gains) = spec.gains(believed) else {
            let problem = format!("that of {} has no gains", self.name);
            return Err(FieldError::new("controller", problem).into());
        };
        let belief = match belief {
            true => believed.reference(),
            false => vehicle,
        };
        let speeds = match speeds {
            [] => (0..=25).map(f64::from).collect(),
            speeds => speeds.to_vec(),
        };
        if let Some(bad) = speeds.iter().find(|v| !(0.0..=1000.0).contains(*v)) {
            let problem = format!("{bad} is not from 0 to 1000 m/s");
            return Err(FieldError::new("speeds", problem).into());
        }
        let paper = LoopGains::of(&GainParameters::PAPER);
        Ok(
            [("paper", paper), ("experiment", gains)].map(|(name, gains)| {
                let of = Loop {
                    vehicle,
                    belief,
                    gains,
                    actuators: self.plant,
                };
                LoopMargins {
                    gains: name,
                    points: speeds.iter().flat_map(|&speed| of.at(speed)).collect(),
                }
            }),
        )
    }

    /// The vehicle that `argument` names: a built-in experiment, vehicle or polar, or else a file: an experiment's TOML (its true vehicle),
    /// or a polar's CSV. A polar is the section of the paper's vehicle.
    pub fn load(argument: &str) -> anyhow::Result<Self> {
        let is_csv = Path::new(argument)
            .extension()
            .is_some_and(|extension| extension == "csv");
        if is_csv || polar::BUILT_IN.iter().any(|(name, _)| *name == argument) {
            let stem = Path::new(argument).file_stem().unwrap_or_default();
            return Ok(Self::of_polar(
                &stem.to_string_lossy(),
                Polar::load(argument)?,
            ));
        }
        Self::of(&Document::load(argument)?)
    }

    /// The vehicle of a document, of which nothing else need be there.
    pub fn of(document: &Document) -> anyhow::Result<Self> {
        // A whole experiment is judged as one.
        if document.get("reference").is_some() {
            document.checked()?;
        }
        let read = || {
            let part = |key: &str| document.get(key).cloned();
            Ok(Self {
                name: document.name.clone(),
                description: match part("description") {
                    Some(Value::String(text)) => text,
                    _ => String::new(),
                },
                spec: document.vehicle()?,
                plant: match part("plant") {
                    Some(table) => crate::experiment::read(table)?,
                    None => PlantSpec::default(),
                },
                controller: match part("controller") {
                    Some(table) => crate::experiment::read(table)?,
                    None => Choice::default(),
                },
            })
        };
        read().map_err(|error| document.located(error))
    }

    /// The paper's vehicle with another section.
    pub fn of_polar(name: &str, polar: Polar) -> Self {
        let paper = Document::load("paper").and_then(|document| Self::of(&document));
        let paper = paper.expect("a built-in vehicle is valid");
        Self {
            name: name.to_owned(),
            description: format!("The paper's vehicle with the table {}", polar.name),
            spec: VehicleSpec {
                aerodynamics: AerodynamicsSpec::Table { polar },
                ..paper.spec
            },
            ..paper
        }
    }

    /// The vehicle as the core takes it.
    pub fn core(&self) -> Vehicle {
        self.spec.core().expect("validated when loaded")
    }

    /// Least and most thrust \[N\] that a guidance may command; of motors without limits none, and twice the weight.
    pub fn thrust_limits(&self) -> [f64; 2] {
        thrust_limits(self.plant.thrust_n, self.spec.weight())
    }

    /// The vehicle in double precision.
    pub fn reference(&self) -> reference::Vehicle {
        self.spec.reference()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::BUILT_IN;
    use crate::named::tests::{refusal, says};

    #[test]
    fn every_built_in_loads_and_the_paper_is_the_papers() {
        for (name, _) in BUILT_IN.iter().chain(polar::BUILT_IN) {
            assert_eq!(Airframe::load(name).unwrap().name, *name);
        }
        let paper = Airframe::load("paper").unwrap();
        assert_eq!(paper.spec, Airframe::load("hover-to-cruise").unwrap().spec);
        assert_eq!(paper.plant, PlantSpec::default());
    }

    #[test]
    fn errors_name_line_and_field() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.toml");
        let error =
            |text: &str| refusal(&path, text, |path| Airframe::load(path.to_str().unwrap()));
        let negative = error("[vehicle]\nmass_kg = -1\nk_a_kg_m = 1\n");
        assert!(
            negative.ends_with("x.toml:2: vehicle.mass_kg: mass must be positive"),
            "{negative}"
        );
        let missing = error("base = 'paper'\n[vehicle.aerodynamics.table]\npolar = 'nonesuch'\n");
        says(
            &missing,
            &["x.toml:3: vehicle.aerodynamics.table.polar: nonesuch: neither"],
        );
        let error = Airframe::load("nonesuch").unwrap_err().to_string();
        assert!(error.contains("paper") && !error.contains('\n'), "{error}");
    }
}
