//! The two branches of the equivalent sphere: thrust along F_p (θ̃ = 0), and against it (θ̃ = π).

/// Which of the two equilibria of the equivalent sphere is stabilised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Branch {
    /// θ̃ = 0: thrust along F_p, as in the paper.
    #[default]
    Aligned,
    /// θ̃ = π: thrust against F_p.
    Opposed,
}

impl Branch {
    /// 1 on θ̃ = 0, −1 on θ̃ = π.
    #[inline(always)]
    pub(crate) const fn sign(self) -> f32 {
        match self {
            Self::Aligned => 1.0,
            Self::Opposed => -1.0,
        }
    }
}
