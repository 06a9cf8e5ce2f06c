//! Studies: an experiment flown many times, varied.
//!
//! A [`Campaign`] draws its variations at random and judges them against limits; a [`Comparison`] names them: variants under conditions.
//! Both are data, both start from a `base` and `[set]` its fields, and both are flown by [`each`] on all cores: flights share nothing, so
//! that threads, shards and interruptions change no result. A campaign's results go to a [`Store`] of [`Frame`]s, which a [`Summary`] reads.
//! On a target without an operating system the package is empty.
#![cfg_attr(target_os = "none", no_std)]
#![cfg(not(target_os = "none"))]

mod campaign;
mod comparison;
mod distribution;
mod draw;
pub mod files;
mod flight_result;
mod frame;
mod load;
mod map;
mod merge;
mod part;
mod random_reference;
mod results;
mod run;
pub mod starts;
mod store;
mod summary;

pub use campaign::{Campaign, Dispersion, Expected, FaultDraw, Limit};
pub use comparison::{Comparison, Condition, Plan, Source, Variant};
pub use distribution::Distribution;
pub use draw::{Drawn, DrawnFault};
pub use flight_result::{CampaignFlight, FlightResult, SAMPLED, Sample};
pub use frame::{Column, Frame};
pub use load::{BUILT_IN, CampaignSource};
pub use map::{Axis, Map, MapResult};
pub use random_reference::{DrawnReference, RandomReference};
pub use results::{ASTRAY, COLUMNS, Cell, FAR, Flight, OSCILLATION, Outcome, Results, header};
pub use run::{Shard, Threads, each, run};
pub use store::{CHUNK, Store};
pub use summary::{Fan, LimitResult, PERCENTILES, Summary, Worst};

#[cfg(test)]
#[path = "../../tests/common/refusals.rs"]
pub mod refusals;
