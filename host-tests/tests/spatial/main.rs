//! The laws in space: identities, accuracy, flights.
#[path = "../common/mod.rs"]
mod common;

mod accuracy;
mod course;
mod flown;
mod identity;
mod lyapunov;
mod paths;
mod starts;
mod support;
mod wander;
mod weather;
