//! Which orientations hold a reference, with what thrust, and how far the next jump is.
//!
//! An orientation θ is an equilibrium of a reference velocity if the apparent external force at it has no component
//! across the thrust line: `F̄_2 = 0`. There may be several; [`Equilibria`] is the set Θ of them. On a ray of given
//! apparent weight the set is the graph of one explicit function, [`a(α; β)`](Ratio); two equilibria meet and vanish at
//! its folds, and the distance to them is the [`FoldMargin`]. What can be said of every reference at once is in
//! [`existence`], and the closed form for vehicles that are equivalent to a sphere in [`Spherical`].
//!
//! With W = m(g i0 − a_r), the apparent weight, e_v the direction of the air velocity, e_n = S e_v and φ = α + δ:
//!
//! - `F̄_2 = W_v sin φ − W_n cos φ − k_a|v_a|² q`, `q = c_L cos φ + c_D sin φ`;
//! - `∂_θ F̄_2 = −F̄_p1`, so that an equilibrium with |F_p| > 0 is isolated (Theorem 3);
//! - `∂²_θ F̄_2 = −F̄_2 − k_a|v_a|² h`, `h = q + q''` being the residual of `eq:condition`.

mod balance;
pub mod existence;
mod fold;
mod grid;
mod ratio;
mod set;
mod spherical;

pub use crate::branch::Branch;
pub use fold::{FoldMap, FoldMargin};
pub use ratio::Ratio;
pub use set::{CAPACITY, Equilibria, Equilibrium, EquilibriumError, MAX_EVALUATIONS};
pub use spherical::{NotSpherical, Spherical};
