//! Campaigns: one experiment flown many times with its fields dispersed, judged against stated limits.
//!
//! Flight `n` of a campaign is a function of the campaign's text and `n`.

use std::collections::BTreeMap;
use std::fmt;

use serde::Deserialize;

use super::{Distribution, Map, RandomReference};
use alula_sim::experiment::FaultKind;

/// A campaign. The format is described in this package's README.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Campaign {
    /// One line for reports.
    #[serde(default)]
    pub description: String,
    /// The experiment that the flights depart from: a built-in, or a TOML file beside this one.
    pub base: String,
    /// Number of flights.
    pub flights: u64,
    /// Seed of everything that is drawn.
    #[serde(default)]
    pub seed: u64,
    /// Fields of the experiment, by dotted path, that are changed in all flights.
    #[serde(default)]
    pub set: toml::Table,
    /// Fields of the experiment that are drawn for each flight.
    #[serde(default)]
    pub disperse: Vec<Dispersion>,
    /// How the references are drawn, in place of the base's.
    pub reference: Option<RandomReference>,
    /// Faults, one of which is drawn for each flight.
    #[serde(default)]
    pub faults: Vec<FaultDraw>,
    /// What is asked of the flights.
    #[serde(default)]
    pub limits: Vec<Limit>,
    /// Maps of where flights strain.
    #[serde(default)]
    pub maps: Vec<Map>,
}

/// A field of the experiment that is drawn for each flight: scaled by, added to or replaced by a random number, or one of several names.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Dispersion {
    /// Its dotted path, as in `plant.thrust_n[1]`.
    pub field: String,
    /// Factor.
    pub scale: Option<Distribution>,
    /// Summand.
    pub add: Option<Distribution>,
    /// Value.
    pub to: Option<Distribution>,
    /// Texts, one of which is drawn with equal chances: the vehicle of a plant is an example. Its place in this list is what is recorded.
    pub names: Option<Vec<String>>,
    /// Other fields, each with an exponent: the number drawn is multiplied by the powers of their drawn values. An area that grows with
    /// mass^(2/3) is an example.
    #[serde(default)]
    pub powers: BTreeMap<String, f64>,
    /// Another field, whose drawn value is added at the end: the number drawn is the error of a belief about that field.
    pub plus: Option<String>,
    /// Other fields, each with a factor: the value is at most factor times drawn value of each. This excludes beliefs with which the
    /// vehicle could not hover.
    #[serde(default)]
    pub at_most: BTreeMap<String, f64>,
}

/// A fault that may be drawn.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FaultDraw {
    /// What fails.
    pub kind: FaultKind,
    /// From when \[s\].
    pub from_s: Distribution,
    /// How long \[s\].
    pub lasts_s: Distribution,
    /// How much, of the kinds that have a size.
    pub size: Option<Distribution>,
    /// Farthest that the flight may sink below its reference \[m\]; any depth if left out.
    pub sinks_m: Option<f64>,
    /// The guidance's state at the fault's last control step.
    pub during: Expected,
    /// The guidance's state at the end of the flight.
    pub after: Expected,
}

/// A state of the guidance, by the names in a trace; what is left out may be anything.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Expected {
    /// `safe`, `holding` or `flying`.
    pub mode: Option<String>,
    /// `velocity`, `wind`, `held-wind` or `none`.
    pub air: Option<String>,
    /// Flags that must be set.
    pub status: Vec<String>,
    /// Flags that must not be set.
    pub not_status: Vec<String>,
}

impl fmt::Display for Expected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let air = self.air.iter().map(|air| format!("air {air}"));
        let not = self.not_status.iter().map(|flag| format!("not {flag}"));
        let parts = self.mode.iter().cloned().chain(air);
        let parts: Vec<String> = parts.chain(self.status.clone()).chain(not).collect();
        f.write_str(&parts.join(", "))
    }
}

/// Bounds of a figure that every flight, or a share of them, has to keep.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limit {
    /// One of those of the place that is flown in.
    pub figure: String,
    /// Least value that is inside.
    pub least: Option<f64>,
    /// Greatest value that is inside.
    pub most: Option<f64>,
    /// Share of the flights that must be inside.
    #[serde(default = "all")]
    pub share: f64,
    /// Whether a flight outside has departed.
    #[serde(default)]
    pub departure: bool,
}

fn all() -> f64 {
    1.0
}

impl Limit {
    /// How far `value` is outside; negative inside, by the distance to the nearer bound. NaN is infinitely far outside.
    pub fn excess(&self, value: f64) -> f64 {
        if value.is_nan() {
            return f64::INFINITY;
        }
        let below = self.least.map_or(f64::NEG_INFINITY, |least| least - value);
        let above = self.most.map_or(f64::NEG_INFINITY, |most| value - most);
        below.max(above)
    }
}
