//! Studies: an experiment flown many times, varied.
//!
//! A [`Campaign`] draws its variations at random and judges them against limits; a [`Comparison`] names them: variants under conditions.
//! Both are data, both start from a `base` and `[set]` its fields, and both are flown by [`each`] on all cores: flights share nothing, so
//! that threads, shards and interruptions change no result. A campaign's results are [`Frame`]s, which a [`Summary`] reads. With the feature
//! `store` they are kept in a folder of Parquet files, the `Store`, where an interrupted campaign goes on.
//! On a target without an operating system the package is empty.
#![cfg_attr(target_os = "none", no_std)]
#![cfg(not(target_os = "none"))]

mod campaign;
mod chunk;
mod comparison;
mod distribution;
mod draw;
mod evolution;
pub mod files;
mod flight_result;
mod frame;
#[cfg(feature = "store")]
mod frame_file;
mod load;
mod map;
#[cfg(feature = "store")]
mod merge;
pub mod oracle;
#[cfg(feature = "store")]
mod part;
mod random_reference;
mod results;
mod run;
pub mod starts;
#[cfg(feature = "store")]
mod store;
mod summary;
pub mod tune;

pub use campaign::{Campaign, Dispersion, Expected, FaultDraw, Limit};
pub use chunk::CHUNK;
pub use comparison::{COMPARISONS, Comparison, Condition, Plan, Source, Variant};
pub use distribution::Distribution;
pub use draw::{Drawn, DrawnFault};
pub use flight_result::{CampaignFlight, FlightResult, SAMPLED, Sample};
pub use frame::{Column, Frame};
pub use load::{BUILT_IN, CampaignSource};
pub use map::{Axis, Map, MapResult};
pub use random_reference::{DrawnReference, RandomReference};
pub use results::{ASTRAY, COLUMNS, Cell, FAR, Flight, OSCILLATION, Outcome, Results, header};
pub use run::{Shard, Threads, each, fly};
#[cfg(feature = "store")]
pub use store::{Store, run};
pub use summary::{Fan, LimitResult, PERCENTILES, Summary, Worst};

#[cfg(test)]
#[path = "../../tests/common/refusals.rs"]
pub mod refusals;
