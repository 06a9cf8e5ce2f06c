//! Vehicles by name or file, for analyses that need no scenario.

use std::path::Path;

use serde::Deserialize;
use toml::de::DeTable;

use crate::named::Named;
use crate::polar::{self, Polar};
use crate::scenario::{self, AerodynamicsSpec, Source, VehicleSpec, from_toml};

/// Name and TOML text of every built-in vehicle.
pub const BUILT_IN: &[(&str, &str)] = &[
    ("paper", include_str!("../vehicles/paper.toml")),
    (
        "paper-re-5e6",
        include_str!("../vehicles/paper-re-5e6.toml"),
    ),
];

/// A vehicle with where it came from.
#[derive(Clone, Debug)]
pub struct Airframe {
    /// Built-in name, or the file's name without its extension.
    pub name: String,
    /// One line for reports.
    pub description: String,
    /// The vehicle.
    pub spec: VehicleSpec,
}

/// A vehicle file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    /// One line for reports.
    #[serde(default)]
    description: String,
    /// The vehicle.
    vehicle: VehicleSpec,
}

impl Airframe {
    /// The vehicle that `argument` names: a built-in vehicle, polar or scenario, or else a file: a vehicle's or a
    /// scenario's TOML (its true vehicle), or a polar's CSV. A polar is the section of the paper's vehicle.
    pub fn load(argument: &str) -> anyhow::Result<Self> {
        if polar::BUILT_IN.iter().any(|(name, _)| *name == argument) {
            return Ok(Self::of_polar(argument, Polar::load(argument)?));
        }
        let built_in = [BUILT_IN, polar::BUILT_IN, scenario::BUILT_IN].concat();
        let Named {
            name, origin, text, ..
        } = Named::find("vehicle", &built_in, argument)?;
        let path = Path::new(argument);
        if path.extension().is_some_and(|extension| extension == "csv") {
            return Ok(Self::of_polar(&name, Polar::from_text(&origin, &text)?));
        }
        let is_scenario = DeTable::parse(&text)
            .is_ok_and(|document| document.get_ref().get("controller").is_some());
        if is_scenario {
            return Ok(Self::of_scenario(Source::from_text(&name, &origin, &text)?));
        }
        Self::from_text(&name, &origin, &text)
    }

    fn from_text(name: &str, origin: &str, text: &str) -> anyhow::Result<Self> {
        let validate = |file: &File| file.vehicle.control_vehicle("vehicle").map(drop);
        let file = from_toml(origin, text, validate)?;
        Ok(Self {
            name: name.to_owned(),
            description: file.description,
            spec: file.vehicle,
        })
    }

    fn of_scenario(source: Source) -> Self {
        Self {
            name: source.name,
            description: source.scenario.description,
            spec: source.scenario.vehicle,
        }
    }

    /// The paper's vehicle with another section.
    pub fn of_polar(name: &str, polar: Polar) -> Self {
        let (_, paper) = BUILT_IN[0];
        let paper = Self::from_text("paper", "paper", paper).expect("a built-in vehicle is valid");
        Self {
            name: name.to_owned(),
            description: format!("The paper's vehicle with the table {}", polar.name),
            spec: VehicleSpec {
                aerodynamics: AerodynamicsSpec::Table { polar },
                ..paper.spec
            },
        }
    }

    /// The vehicle as the core takes it.
    pub fn core(&self) -> alula::Vehicle<alula::Model> {
        self.spec
            .control_vehicle("vehicle")
            .expect("validated when loaded")
    }

    /// The vehicle in double precision.
    pub fn reference(&self) -> crate::reference::Vehicle {
        self.spec.plant_vehicle()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_loads_and_the_paper_is_the_papers() {
        for (name, _) in BUILT_IN
            .iter()
            .chain(polar::BUILT_IN)
            .chain(scenario::BUILT_IN)
        {
            assert_eq!(Airframe::load(name).unwrap().name, *name);
        }
        let paper = Airframe::load("paper").unwrap();
        assert_eq!(paper.spec, Airframe::load("hover-to-cruise").unwrap().spec);
    }

    #[test]
    fn errors_name_line_and_field() {
        let good = BUILT_IN[0].1;
        let error = |from: &str, to: &str| {
            let text = good.replace(from, to);
            format!(
                "{:#}",
                Airframe::from_text("x", "x.toml", &text).unwrap_err()
            )
        };
        let line = |needle: &str| 1 + good.lines().position(|l| l.contains(needle)).unwrap();
        assert_eq!(
            error("mass_kg = 10.0", "mass_kg = -10.0"),
            format!(
                "x.toml:{}: vehicle.mass_kg: mass must be positive",
                line("mass_kg")
            )
        );
        assert!(
            error(
                "[vehicle.aerodynamics.combined]",
                "[vehicle.aerodynamics.table]\npolar = 'nonesuch'\n[x]"
            )
            .contains("nonesuch: neither a file nor a built-in polar")
        );
        let error = Airframe::load("nonesuch").unwrap_err().to_string();
        assert!(error.contains("paper") && !error.contains('\n'), "{error}");
    }
}
