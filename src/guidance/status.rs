//! What limited a guidance step, as a bit mask.

use core::fmt::{self, Write};

/// A set of flags. The default is the empty set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Status(u16);

bitflags::bitflags! {
    impl Status: u16 {
        /// Thrust stands at its lower limit.
        const THRUST_LOW = 1;
        /// Thrust stands at its upper limit.
        const THRUST_HIGH = 1 << 1;
        /// A body rate stands at its limit.
        const RATE = 1 << 2;
        /// A body rate changes as fast as it may.
        const SLEW = 1 << 3;
        /// The velocity towards the reference position stands at its limit.
        const POSITION = 1 << 4;
        /// The integral stands at its limit.
        const INTEGRAL = 1 << 5;
        /// The reference is stale or invalid: the last velocity is held.
        const REFERENCE_HELD = 1 << 6;
        /// The position error was invalid and is left out.
        const POSITION_INVALID = 1 << 7;
        /// The air data were invalid and are left out.
        const AIR_INVALID = 1 << 8;
        /// The guidance state was corrupt: it has been reset or, by `Hardened`, restored from its copy.
        const STATE_RESET = 1 << 9;
        /// The specific force was invalid and is left out.
        const FORCE_INVALID = 1 << 10;
    }
}

impl Status {
    /// `self` if `condition`, else no flag.
    #[inline(always)]
    pub(super) const fn when(self, condition: bool) -> Self {
        if condition { self } else { Self::empty() }
    }
}

/// The names of the flags in lower case, separated by `|`; nothing for the empty set.
impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (n, (name, _)) in self.iter_names().enumerate() {
            if n > 0 {
                f.write_char('|')?;
            }
            for letter in name.chars() {
                f.write_char(letter.to_ascii_lowercase())?;
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
    fn a_set_is_written_by_the_names_of_its_flags() {
        assert_eq!(Status::empty().to_string(), "");
        assert_eq!(Status::RATE.to_string(), "rate");
        let two = Status::INTEGRAL | Status::THRUST_LOW;
        assert_eq!(two.to_string(), "thrust_low|integral");
        assert_eq!(Status::all().iter_names().count(), 11);
    }

    #[test]
    fn a_condition_keeps_or_drops_a_flag() {
        assert_eq!(Status::SLEW.when(true), Status::SLEW);
        assert_eq!(Status::SLEW.when(false), Status::empty());
    }
}
