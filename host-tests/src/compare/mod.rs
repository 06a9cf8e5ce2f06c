//! Comparisons: policies flown in the same plant under the same conditions.
//!
//! A comparison is data ([`Comparison`]): a base mission, policies and conditions that each set some of its fields by name.
//! Every policy flies every condition ([`fly`]); the figures of a flight are [`Flight`].

mod flight;
mod markdown;
mod page;
mod results;
mod run;
mod spec;

pub use flight::{Flight, Outcome, Sample};
pub use markdown::markdown;
pub use page::page;
pub use results::{Cell, Results};
pub use run::fly;
pub use spec::{Comparison, Condition, Plan, Policy, Source};
