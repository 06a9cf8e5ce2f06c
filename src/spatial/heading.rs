//! The heading asked for.

use crate::math;
use crate::ned::Ned;

/// Where the belly side is to point while there is little air velocity to decide it: a unit horizontal vector, or free.
///
/// In hover with the nose up this is the heading of multicopter axes. As the air takes over (see
/// [`LateralParameters`](super::LateralParameters)) it loses its say.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "Ned"))]
pub struct Heading(Ned);

impl From<Ned> for Heading {
    /// The heading whose unit vector this is; of any other length or with a part down, that of its horizontal part.
    fn from(v: Ned) -> Self {
        let square = v.north * v.north + v.east * v.east;
        if v.down == 0.0 && (square - 1.0).abs() < 1e-5 {
            Self(v)
        } else {
            Self::along(v)
        }
    }
}

impl Heading {
    /// None asked for.
    pub const FREE: Self = Self(Ned::ZERO);

    /// The heading `angle` \[rad\] from north towards east; free if it is not finite.
    pub const fn from_angle(angle: f32) -> Self {
        let (sin, cos) = math::sin_cos(angle);
        // NaN: neither is a number.
        if sin.is_nan() {
            Self::FREE
        } else {
            Self(Ned::new(cos, sin, 0.0))
        }
    }

    /// The heading of the horizontal part of `v`; free if it is shorter than 1e-3 or not a number.
    pub fn along(v: Ned) -> Self {
        let length = math::sqrt(v.north * v.north + v.east * v.east);
        if matches!(length, l if (1e-3..1e9).contains(&l)) {
            Self(Ned::new(v.north / length, v.east / length, 0.0))
        } else {
            Self::FREE
        }
    }

    /// Its angle \[rad\] from north towards east, in [−π, π]; none if it is free.
    pub fn angle(&self) -> Option<f32> {
        (*self != Self::FREE).then(|| math::atan2(self.0.east, self.0.north))
    }

    /// The heading along `unit`, a horizontal unit vector.
    #[inline(always)]
    pub(crate) const fn of_unit(unit: Ned) -> Self {
        Self(unit)
    }

    /// The unit vector, or zero.
    #[inline(always)]
    pub(crate) const fn vector(&self) -> Ned {
        self.0
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn an_angle_is_told_as_it_was_given() {
        for angle in [-3.1, -1.0, 0.0, 0.5, 2.0] {
            let told = Heading::from_angle(angle).angle().unwrap();
            assert!((told - angle).abs() < 1e-6, "{angle}: {told}");
        }
        assert_eq!(Heading::FREE.angle(), None);
    }

    #[test]
    fn what_is_no_heading_is_free() {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert_eq!(Heading::from_angle(bad), Heading::FREE);
            assert_eq!(Heading::along(Ned::new(bad, 1.0, 0.0)), Heading::FREE);
        }
        assert_eq!(Heading::along(Ned::new(0.0, 1e-4, 9.0)), Heading::FREE);
    }

    #[test]
    fn a_quarter_turn_from_north_is_east() {
        let east = Heading::from_angle(core::f32::consts::FRAC_PI_2).vector();
        assert!((east.east - 1.0).abs() < 1e-6 && east.north.abs() < 1e-6);
        assert_eq!(
            Heading::along(Ned::new(0.0, 7.0, -3.0)).vector(),
            Ned::new(0.0, 1.0, 0.0)
        );
    }
}
