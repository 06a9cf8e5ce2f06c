//! Angles within half a turn.

use super::reference_model::limited;
use crate::math;

/// `angle` \[rad\] within ±π.
#[inline(always)]
pub(super) fn wrap(angle: f32) -> f32 {
    // Less than half a turn is itself, to the bit, and most angles are that.
    if angle.abs() > math::PI {
        core::hint::cold_path();
        // 1.5·2²³: adding it leaves the nearest integer in the low bits of the sum.
        const ROUND: f32 = 12_582_912.0;
        let turns = (limited(angle, 1e3) * (0.5 / math::PI) + ROUND) - ROUND;
        angle - turns * (2.0 * math::PI)
    } else {
        angle
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_wrapped() {
        for turns in -3..=3 {
            let angle = 0.4 + turns as f32 * 2.0 * math::PI;
            // 2e-6: an ulp of 19.
            assert!((wrap(angle) - 0.4).abs() < 2e-6);
        }
        assert!(wrap(f32::NAN).is_nan());
    }
}
