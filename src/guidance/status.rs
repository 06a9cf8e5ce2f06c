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
        /// The angular rate stands at its limit.
        const RATE = 1 << 2;
        /// The angular rate changes as fast as it may.
        const SLEW = 1 << 3;
        /// The reference's acceleration stands at its limit: the velocity followed is not the one asked for.
        const REFERENCE = 1 << 4;
        /// The velocity towards the reference position stands at its limit.
        const POSITION = 1 << 5;
        /// The integral stands at its limit.
        const INTEGRAL = 1 << 6;
        /// The equilibrium of the branch flown needs negative thrust.
        const NEGATIVE_THRUST = 1 << 7;
        /// The branch θ̃ = π is flown.
        const OPPOSED = 1 << 8;
        /// The reference is stale or invalid: the last velocity is held.
        const REFERENCE_HELD = 1 << 9;
        /// The position error was invalid and is left out.
        const POSITION_INVALID = 1 << 10;
        /// The air data were invalid and are left out.
        const AIR_INVALID = 1 << 11;
        /// The guidance state was corrupt and has been reset.
        const STATE_RESET = 1 << 12;
        /// The forward velocity error given to the law stands at its limit.
        const VELOCITY_ERROR = 1 << 13;
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
        let two = Status::VELOCITY_ERROR | Status::THRUST_LOW;
        assert_eq!(two.to_string(), "thrust_low|velocity_error");
        assert_eq!(Status::all().iter_names().count(), 14);
    }

    #[test]
    fn a_condition_keeps_or_drops_a_flag() {
        assert_eq!(Status::SLEW.when(true), Status::SLEW);
        assert_eq!(Status::SLEW.when(false), Status::empty());
    }
}
