//! Pages: a figure and tables in one file that needs no network, and the same as text.
//! On a target without an operating system the package is empty.
#![cfg_attr(target_os = "none", no_std)]
#![cfg(not(target_os = "none"))]

pub mod campaign;
pub(crate) mod chart;
pub mod comparison;
pub mod design;
pub mod envelope;
pub mod equilibria;
mod figure;
mod film;
pub mod fit;
pub mod flight;
pub mod gallery;
pub mod identify;
mod margins;
pub mod page;
mod panel;
mod picture;
pub mod plans;
pub mod replay;
mod side;
mod strip;
pub(crate) mod svg;
pub mod sweep;
mod ticks;
mod trace;
pub mod viewer;

pub use figure::Figure;
pub use margins::margins_figure;
pub use page::{Page, Table, columns, fixed};
pub(crate) use strip::{Row, Strip};

#[cfg(test)]
#[path = "../../tests/common/refusals.rs"]
pub mod refusals;
