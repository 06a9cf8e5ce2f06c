//! Simulation: vehicles, plants, weather, sensors, experiments, and what a flight of one leaves.
//!
//! `Experiment → simulate → Record → figures`, each using only those before it:
//!
//! | module | what is in it |
//! |---|---|
//! | [`named`], [`kind`] | texts asked for by name; what a file looks like |
//! | [`reference`](mod@reference) | aerodynamics and laws in double precision, independent of the core |
//! | [`polar`] | measured coefficients |
//! | [`experiment`] | what is flown |
//! | [`plant`] | the vehicle |
//! | [`controllers`] | by whom |
//! | [`simulate`](mod@simulate) | the loop |
//! | [`columns`], [`figures`] | what a record holds, and what a flight is judged by |
//! | [`scene`], [`flight_log`] | a record for a viewer, as ULog and MCAP |
//! | [`replay`](mod@replay) | a controller over a log |
//! | [`schema`](mod@schema) | experiments' files, for editors |
//! | [`airframe`], [`margins`] | a vehicle by name or file; the linear theory of the law's loop |
//!
//! On a target without an operating system the package is empty.
#![cfg_attr(target_os = "none", no_std)]
#![cfg(not(target_os = "none"))]

pub mod airframe;
mod checked;
pub mod columns;
pub mod controllers;
pub mod experiment;
pub mod figures;
pub mod flight_log;
pub mod flown_mission;
pub mod kind;
pub mod margins;
pub mod named;
pub mod plant;
pub mod polar;
pub mod reference;
pub mod replay;
pub mod scene;
pub mod schema;
pub mod sensor_hold;
pub mod simulate;

#[cfg(test)]
#[path = "../../tests/common/refusals.rs"]
pub mod refusals;
