//! Pages: a figure and tables in one file that needs no network, and the same as text.

pub mod campaign;
pub(crate) mod chart;
pub mod comparison;
pub mod design;
pub mod envelope;
pub mod equilibria;
pub mod fit;
pub mod flight;
mod margins;
mod markdown;
#[allow(clippy::module_inception, reason = "the page itself")]
mod page;
pub mod replay;
pub mod sweep;

pub use margins::margins_svg;
pub use markdown::markdown;
pub use page::{Page, Table, columns, fixed};
