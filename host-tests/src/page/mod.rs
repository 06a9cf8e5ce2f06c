//! Pages: a figure and tables in one file that needs no network, and the same as text.

pub mod campaign;
pub(crate) mod chart;
pub mod comparison;
pub mod design;
pub mod envelope;
pub mod equilibria;
mod figure;
pub mod fit;
pub mod flight;
mod margins;
#[allow(clippy::module_inception, reason = "the page itself")]
mod page;
mod panel;
mod picture;
pub mod replay;
mod side;
mod strip;
pub(crate) mod svg;
pub mod sweep;
mod ticks;
mod trace;

pub use figure::Figure;
pub use margins::margins_figure;
pub use page::{Page, Table, columns, fixed};
pub(crate) use strip::{Row, Strip};
