//! The guidance in closed loop.
#[path = "../common/mod.rs"]
mod common;

mod guidance;
mod lost_flights;
mod missions;
mod space;
mod tail_sitters;
