//! Software in the loop: a plant in double precision flown by the core's control laws.
//!
//! `Experiment → simulate → Record → figures → study → page`, each using only those before it:
//! [`named`], [`files`], [`decimal`] (texts and files), [`reference`](mod@reference) (aerodynamics and laws in double precision, independent of
//! the core), [`polar`] (measured coefficients), [`experiment`] (what is flown), [`plant`] (the vehicle), [`controllers`] (by whom), [`simulate`](mod@simulate) (the loop),
//! [`columns`] (what a record holds), [`figures`] (what a flight is judged by), [`flight_log`] (a record as ULog and MCAP), [`replay`](mod@replay) (a controller over a log), [`study`]
//! (many flights), [`page`] (what is left of them to read).
//! Of a vehicle alone ([`airframe`]): its [`envelope`]; a [`sweep`](mod@sweep) of its equilibria along a reference; the [`fit`](mod@fit) of a
//! model to a table; [`margins`], the linear theory of the law's loop.
//! [`ardupilot`] is the plant behind ArduPilot's interface, and [`companion`] the
//! controller beside an autopilot.
//! On a target without an operating system the package is empty.
#![cfg_attr(target_os = "none", no_std)]
#![cfg(not(target_os = "none"))]

pub mod airframe;
pub mod ardupilot;
mod checked;
pub mod columns;
pub mod companion;
pub mod controllers;
pub mod decimal;
pub mod design;
pub mod envelope;
pub mod experiment;
pub mod figures;
pub mod files;
pub mod fit;
pub mod flight_log;
pub mod margins;
pub mod named;
pub mod page;
pub mod pil;
pub mod plant;
pub mod polar;
pub mod reference;
pub mod replay;
mod sensor_hold;
pub mod simulate;
pub mod study;
pub mod sweep;
