//! What limited a guidance step, as a bit mask.

use core::fmt;
use core::ops::{BitOr, BitOrAssign};

/// A set of the flags below. The default is the empty set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Status(u16);

impl Status {
    /// No flag.
    pub const NONE: Self = Self(0);
    /// Thrust stands at its lower limit.
    pub const THRUST_LOW: Self = Self(1);
    /// Thrust stands at its upper limit.
    pub const THRUST_HIGH: Self = Self(1 << 1);
    /// The angular rate stands at its limit.
    pub const RATE: Self = Self(1 << 2);
    /// The angular rate changes as fast as it may.
    pub const SLEW: Self = Self(1 << 3);
    /// The reference's acceleration stands at its limit: the velocity followed is not the one asked for.
    pub const REFERENCE: Self = Self(1 << 4);
    /// The pull towards the reference position stands at its limit.
    pub const POSITION: Self = Self(1 << 5);
    /// The integral stands at its limit.
    pub const INTEGRAL: Self = Self(1 << 6);
    /// The flown branch's equilibrium needs negative thrust.
    pub const NEGATIVE_THRUST: Self = Self(1 << 7);
    /// The branch θ̃ = π is flown.
    pub const OPPOSED: Self = Self(1 << 8);
    /// The reference is stale or invalid: the last velocity is held.
    pub const REFERENCE_HELD: Self = Self(1 << 9);
    /// The position error was invalid and is left out.
    pub const POSITION_INVALID: Self = Self(1 << 10);
    /// The air data were invalid and are left out.
    pub const AIR_INVALID: Self = Self(1 << 11);
    /// The guidance state was corrupt and has been reset.
    pub const STATE_RESET: Self = Self(1 << 12);

    /// The forward velocity error given to the law stands at its limit.
    pub const VELOCITY_ERROR: Self = Self(1 << 13);

    const NAMES: [(Self, &'static str); 14] = [
        (Self::THRUST_LOW, "thrust_low"),
        (Self::THRUST_HIGH, "thrust_high"),
        (Self::RATE, "rate"),
        (Self::SLEW, "slew"),
        (Self::REFERENCE, "reference"),
        (Self::POSITION, "position"),
        (Self::INTEGRAL, "integral"),
        (Self::NEGATIVE_THRUST, "negative_thrust"),
        (Self::OPPOSED, "opposed"),
        (Self::REFERENCE_HELD, "reference_held"),
        (Self::POSITION_INVALID, "position_invalid"),
        (Self::AIR_INVALID, "air_invalid"),
        (Self::STATE_RESET, "state_reset"),
        (Self::VELOCITY_ERROR, "velocity_error"),
    ];

    /// The names of all flags.
    pub fn names() -> impl Iterator<Item = &'static str> {
        Self::NAMES.iter().map(|(_, name)| *name)
    }

    /// The mask, one bit for each flag.
    pub const fn bits(self) -> u16 {
        self.0
    }

    /// Whether every flag of `other` is set.
    #[inline(always)]
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// `self` if `condition`, else no flag.
    #[inline(always)]
    pub(super) const fn when(self, condition: bool) -> Self {
        if condition { self } else { Self::NONE }
    }
}

impl BitOr for Status {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl BitOrAssign for Status {
    #[inline(always)]
    fn bitor_assign(&mut self, other: Self) {
        self.0 |= other.0;
    }
}

/// The names of the flags, separated by `|`; nothing for the empty set.
impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut first = true;
        for (flag, name) in Self::NAMES {
            if self.contains(flag) {
                if !first {
                    f.write_str("|")?;
                }
                f.write_str(name)?;
                first = false;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::ToString;

    #[test]
    fn every_flag_is_a_bit_of_its_own_and_has_a_name() {
        let mut all = Status::NONE;
        for (flag, name) in Status::NAMES {
            assert_eq!(flag.bits().count_ones(), 1);
            assert!(!all.contains(flag));
            all |= flag;
            assert_eq!(flag.to_string(), name);
        }
        assert_eq!(Status::NONE.to_string(), "");
        assert_eq!((Status::RATE | Status::SLEW).to_string(), "rate|slew");
        assert_eq!(Status::names().count(), 14);
        assert!(all.contains(Status::NONE) && !Status::RATE.contains(all));
    }
}
