//! The laws in space: identities, accuracy, flights.
#[path = "../common/mod.rs"]
mod common;

mod accuracy;
mod identity;
mod lyapunov;
mod support;
