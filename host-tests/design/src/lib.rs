//! A vehicle of one's own: from what a person knows of it to its file, a flight, a campaign, and what it can do.
//! Of a vehicle alone: its [`envelope`], a [`sweep`](mod@sweep) of its equilibria along a reference, the [`fit`](mod@fit) of a model to a table.
//! On a target without an operating system the package is empty.
#![cfg_attr(target_os = "none", no_std)]
#![cfg(not(target_os = "none"))]

mod authority;
mod code;
pub mod curves;
mod document;
mod drag;
pub mod envelope;
mod files;
mod first_flight;
pub mod fit;
mod flown;
mod forces;
mod goals;
mod identified;
pub mod identify;
mod known;
mod lag;
mod limits;
mod performance;
mod rate_lag;
mod reconstruct;
pub mod regression;
mod remedies;
mod round_trip;
mod rust_code;
mod side;
pub mod sweep;
mod thrust_lag;
mod trip;
mod turning;
mod velocity_lag;
mod verdict;
mod waves;
mod wind;
mod wing;

use alula::{GuidanceParameters, Parameters, ResponseParameters};

pub use code::{Coded, c_code};
pub use document::{check_name, vehicle_text};
pub use first_flight::{Findings, FirstFlight};
pub use known::{Actuators, Facts, Known};
pub use limits::Limits;
pub use performance::{ON_WING, Performance, Stall};
pub use round_trip::RoundTrip;
pub use rust_code::rust_code;
pub use trip::Trip;
pub use verdict::{Outcome, Verdict};
pub use wing::{ROWS, Wing};

use alula_sim::experiment::{FieldError, VehicleSpec, refused};

/// Part of the weight that a wing must carry in cruise: of a vehicle that is more on its thrust than on its wing, a number was meant otherwise. A cruise
/// below the speed of transition by up to 30 % is doubted, and flown.
const LEAST_CARRIED: f64 = 0.5;

/// A vehicle worked out from what is known.
#[derive(Clone, Debug)]
pub struct Design {
    /// What is known.
    pub facts: Facts,
    /// Its wing.
    pub wing: Wing,
    /// The parameters of its guidance.
    pub parameters: GuidanceParameters,
    /// The round trip that it is to fly.
    pub trip: Trip,
}

impl Design {
    /// The vehicle of `facts`, with a round trip that brakes level: nothing is flown.
    pub fn new(facts: Facts) -> anyhow::Result<Self> {
        let wing = Wing::new(&facts)?;
        // A model that is refused is told before the parameters.
        let spec = spec(&facts, &wing);
        spec.limited(facts.thrust())?;
        let vehicle = spec.parameters(facts.thrust());
        let response = ResponseParameters::DEFAULT
            .rate_lag(facts.rate_lag_s as f32)
            .thrust_lag(facts.thrust_lag_s as f32)
            .control_rate(facts.control_rate_hz as f32)
            .cruise_speed(facts.cruise_m_s as f32);
        let parameters = GuidanceParameters::for_vehicle(&vehicle, &response);
        let design = Self {
            parameters: parameters.map_err(refused::<ResponseParameters>)?,
            facts,
            wing,
            trip: Trip::LEVEL,
        };
        let carried = design.performance().carried;
        if carried < LEAST_CARRIED {
            return Err(design.facts.not_carried(carried).into());
        }
        Ok(design)
    }

    /// What it can do, before it has flown.
    pub fn performance(&self) -> Performance {
        let facts = &self.facts;
        Performance::of(
            &self.vehicle(),
            self.wing.stall_deg(),
            facts.thrust(),
            facts.cruise_m_s,
            self.parameters.max_lateral_acceleration.into(),
        )
    }

    /// The vehicle.
    pub fn vehicle(&self) -> VehicleSpec {
        spec(&self.facts, &self.wing)
    }

    /// The vehicle `name` as C and as Rust.
    pub fn code(&self, name: &str) -> [String; 2] {
        let coded = Coded {
            vehicle: &self.vehicle(),
            thrust: self.facts.thrust(),
            parameters: &self.parameters,
        };
        [c_code(name, &coded), rust_code(name, &coded)]
    }

    /// What it can do by what turns it.
    pub fn limits(&self) -> Result<Limits, FieldError> {
        let sink = self.parameters.max_sink.into();
        let facts = &self.facts;
        Limits::of(&self.vehicle(), facts.thrust(), facts.cruise_m_s, sink)
    }
}

impl Facts {
    /// Least and greatest thrust \[N\].
    pub fn thrust(&self) -> [f64; 2] {
        [self.idle_to_weight, self.thrust_to_weight].map(|part| part * self.weight())
    }
}

fn spec(facts: &Facts, wing: &Wing) -> VehicleSpec {
    VehicleSpec {
        mass_kg: facts.mass_kg,
        k_a_kg_m: facts.k_a(),
        delta_deg: facts.delta_deg,
        c_y: facts.c_y,
        gravity_m_s2: 9.81,
        aerodynamics: wing.aerodynamics,
        authority: facts.turning().0,
    }
}

#[cfg(test)]
#[path = "../../tests/common/refusals.rs"]
pub mod refusals;
