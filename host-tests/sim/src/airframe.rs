//! Vehicles by name or file, for analyses that need no flight.

use alula::planar::GainParameters;
use serde::Serialize;
use toml::Value;

use crate::experiment::{
    AerodynamicsSpec, ControllerSpec, Document, FieldError, PlantSpec, Vehicle, VehicleSpec,
};
use crate::kind::{self, Kind};
use crate::margins::{Loop, LoopGains, Point};
use crate::named::Named;
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
    pub controller: ControllerSpec,
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
    /// The margins in level flight at `speeds` \[m/s\], or at 0 to 25 m/s if there are none: with the paper's gains, and with those of its
    /// controller. If `belief`, the controller takes its belief for the vehicle, and the vehicle itself else.
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
            [("experiment", gains), ("paper", paper)].map(|(name, gains)| {
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
    /// or a polar, of whatever name: what it holds decides. A polar is the section of the paper's vehicle.
    pub fn load(argument: &str) -> anyhow::Result<Self> {
        let built_in = [crate::experiment::BUILT_IN, polar::BUILT_IN].concat();
        let file = Named::find("experiment, vehicle or polar", &built_in, argument)?;
        let wanted = [Kind::Experiment, Kind::Polar];
        let words = "an experiment, a vehicle or a polar";
        kind::expect(&wanted, words, &file.origin, file.text.as_bytes())?;
        if polar::is_document(&file.text) {
            return Self::of(&Document::new(&file)?);
        }
        let name = file.name.clone();
        Ok(Self::of_polar(&name, Polar::named(argument, file)?))
    }

    /// The vehicle of a document, of which nothing else need be there.
    pub fn of(document: &Document) -> anyhow::Result<Self> {
        // A whole experiment is judged as one.
        if document.is_flight() {
            document.checked()?;
        }
        let read = || {
            let document = &document.believed()?.document;
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
                    None => ControllerSpec::default(),
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
        self.plant.thrust_limits(None, self.spec.weight())
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
    use crate::refusals::{refusal, says};

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
            negative.ends_with(
                "x.toml:2: vehicle.mass_kg: mass must be positive, from 0.001 to 1000000 kg"
            ),
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

    /// The same polar under any name, and a document under that of a polar: what a file holds decides.
    #[test]
    fn what_a_file_is_is_told_by_what_it_holds() {
        let folder = tempfile::tempdir().unwrap();
        let rows: String = (-8..=16)
            .map(f64::from)
            .map(|a: f64| format!("{a} {} 0.02\n", (0.15 * a).sin()))
            .collect();
        let polar = format!("  XFOIL Version 6.99\n\n alpha CL CD\n ----- ---- ----\n{rows}");
        let load = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::write(&path, text).unwrap();
            Airframe::load(path.to_str().unwrap())
        };
        for name in ["x.csv", "x.txt", "x.pol", "x.polar", "x", "x.toml"] {
            let airframe = load(name, &polar).unwrap();
            assert_eq!(airframe.name, "x");
            assert!(matches!(
                airframe.spec.aerodynamics,
                AerodynamicsSpec::Table { .. }
            ));
            let vehicle = "[vehicle]\nmass_kg = 3\nk_a_kg_m = 1\n[vehicle.aerodynamics.large-angle]\nc0 = 0.02\nc1 = 1.0\n";
            assert_eq!(load(name, vehicle).unwrap().spec.mass_kg, 3.0, "{name}");
            // Damaged, each has the error of its kind.
            let error = |text: &str| format!("{:#}", load(name, text).unwrap_err());
            let damaged = error(&polar.replace("\n0 0 ", "\n0 zero "));
            says(&damaged, &["\"zero\" is not a number"]);
            let damaged = error("[vehicle]\nmass_kg = \n");
            says(&damaged, &[":2: "]);
            // And the other way round.
            let path = folder.path().join(name);
            std::fs::write(&path, vehicle).unwrap();
            let error = Polar::load(path.to_str().unwrap()).unwrap_err();
            says(&error.to_string(), &["where a polar is wanted"]);
        }
    }
}
