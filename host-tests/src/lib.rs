//! Software in the loop: a plant in double precision flown by the core's control laws.
//!
//! Layers, each using only those before it: [`named`] (texts asked for by name), [`reference`](mod@reference)
//! (aerodynamics and laws in double precision, independent of the core), [`plant`], [`polar`] (measured
//! coefficients), [`scenario`], [`flight`] (the loop, closed by any [`flight::Controller`]), [`figures`] of merit,
//! [`trace`] and [`replay`](mod@replay) (CSV), [`report`], [`files`], [`workers`].
//! [`mission`] flies the core's whole guidance, or a [`baseline`], on a vehicle with actuators, sensors and weather;
//! [`campaign`] flies many, drawn at random; [`compare`] flies them against each other; [`margins`] is the linear theory
//! of the law's loop.
//! Of a vehicle alone ([`airframe`]): its [`envelope`]; a [`sweep`](mod@sweep) of its equilibria along a
//! scenario; the [`fit`](mod@fit) of a model to a table.
//! [`spatial_plant`] and [`spatial_weather`] are plant and weather in space.
//! On a target without an operating system the package is empty.
#![cfg_attr(target_os = "none", no_std)]
#![cfg(not(target_os = "none"))]

pub mod airframe;
pub mod baseline;
pub mod campaign;
pub mod compare;
pub mod envelope;
pub mod figures;
pub mod files;
pub mod fit;
pub mod flight;
pub mod margins;
pub mod mission;
pub mod named;
pub mod pil;
pub mod plant;
pub mod polar;
pub mod reference;
pub mod replay;
pub mod report;
pub mod scenario;
pub mod spatial_plant;
pub mod spatial_weather;
pub mod sweep;
pub mod trace;
pub mod workers;
