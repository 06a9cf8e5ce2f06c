//! The command line, and what it leaves.
#[path = "../common/mod.rs"]
mod common;

mod analysis;
mod ardupilot;
mod campaigns;
mod comparison;
mod identify;
mod logs;
mod new;
mod usage;
