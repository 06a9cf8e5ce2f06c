//! What `alula_guide` remembers between calls.

use alula::HardenedState;
use alula::ned::{BodyAxes, Quaternion};
use alula::spatial::Orientation;

/// The guidance's state, and the last attitude set-point.
#[derive(Clone, Copy)]
pub(crate) struct Memory {
    pub state: HardenedState,
    set_point: [f32; 4],
    /// The body axes that it is in: 1 nose forward, 2 nose up, else there is none. A number, not `Option`: every bit pattern
    /// has a meaning.
    axes: u8,
}

impl Default for Memory {
    fn default() -> Self {
        HardenedState::default().into()
    }
}

impl From<HardenedState> for Memory {
    /// Without a set-point.
    fn from(state: HardenedState) -> Self {
        Self {
            state,
            set_point: [1.0, 0.0, 0.0, 0.0],
            axes: 0,
        }
    }
}

impl Memory {
    /// Keeps a set-point.
    #[inline(always)]
    pub fn keep(&mut self, set_point: [f32; 4], axes: BodyAxes) {
        self.set_point = set_point;
        self.axes = match axes {
            BodyAxes::NoseForward => 1,
            BodyAxes::NoseUp => 2,
        };
    }

    /// The set-point that was kept, in the body axes `axes`, if there is one. A corrupt one, not of unit length, is none.
    pub fn last(&self, axes: BodyAxes) -> Option<Quaternion> {
        let kept_in = match self.axes {
            1 => BodyAxes::NoseForward,
            2 => BodyAxes::NoseUp,
            _ => return None,
        };
        let [w, x, y, z] = self.set_point;
        let q = Quaternion { w, x, y, z };
        match Orientation::from_quaternion(&q, kept_in) {
            Ok(_) => Some(q.in_axes(kept_in, axes)),
            Err(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_corrupt_set_point_is_not_held() {
        let mut memory = Memory::default();
        let axes = BodyAxes::NoseUp;
        assert_eq!(memory.last(axes), None);
        memory.keep([0.0, 0.6, 0.0, 0.8], axes);
        let (w, x, y, z) = (0.0, 0.6, 0.0, 0.8);
        assert_eq!(memory.last(axes), Some(Quaternion { w, x, y, z }));
        memory.axes = 3;
        assert_eq!(memory.last(axes), None);
        for bad in [f32::NAN, f32::INFINITY, 0.1] {
            memory.keep([0.0, 0.6, bad, 0.8], axes);
            assert_eq!(memory.last(axes), None);
        }
    }
}
