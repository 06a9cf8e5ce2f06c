//! Kinds of autopilots: their modes, their axes, and whom they listen to.

use alula::ned::Quaternion;

use super::{OWN_SYSTEM, Sticks};

/// A kind of autopilot. A mode is a heartbeat's custom mode.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Kind {
    /// PX4, by `SET_ATTITUDE_TARGET` in OFFBOARD.
    #[default]
    Px4,
    /// ArduPlane's tail-sitter, by `RC_CHANNELS_OVERRIDE` in QACRO.
    ArduPlane(Sticks),
}

/// PX4's mode OFFBOARD: the main mode is in the third byte.
pub const OFFBOARD: u32 = 6 << 16;
/// PX4's mode AUTO, sub-mode LOITER: hold.
pub const HOLD: u32 = 4 << 16 | 3 << 24;
/// PX4's mode TERMINATION: outputs at their failsafe values, for good.
pub const TERMINATION: u32 = 10 << 16;
/// ArduPlane's mode QACRO.
pub const QACRO: u32 = 23;
/// ArduPlane's mode QLOITER: hover at a place.
pub const QLOITER: u32 = 19;

/// The byte of PX4's main mode.
const MAIN: u32 = 0xff << 16;

impl Kind {
    /// Whether a mode is the one that the companion flies in.
    #[must_use]
    pub fn is_commanded(&self, mode: u32) -> bool {
        match self {
            Self::Px4 => mode & MAIN == OFFBOARD,
            Self::ArduPlane(_) => mode == QACRO,
        }
    }

    /// The mode that the companion flies in.
    #[must_use]
    pub fn commanded(&self) -> u32 {
        match self {
            Self::Px4 => OFFBOARD,
            Self::ArduPlane(_) => QACRO,
        }
    }

    /// The mode that is asked for at the end.
    #[must_use]
    pub fn hold(&self) -> u32 {
        match self {
            Self::Px4 => HOLD,
            Self::ArduPlane(_) => QLOITER,
        }
    }

    /// The last two parameters of a request for a mode (`DO_SET_MODE`).
    #[must_use]
    pub fn parameters(&self, mode: u32) -> [f32; 2] {
        let [_, _, main, sub] = mode.to_le_bytes();
        match self {
            Self::Px4 => [main.into(), sub.into()],
            Self::ArduPlane(_) => [mode as f32, 0.0],
        }
    }

    /// The mode that a request asks for.
    #[must_use]
    pub fn asked(&self, [first, second]: [f32; 2]) -> u32 {
        match self {
            Self::Px4 => u32::from_le_bytes([0, 0, first as u8, second as u8]),
            Self::ArduPlane(_) => first as u32,
        }
    }

    /// The parameter that says how the thrust goes with the output: as f u² + (1 − f) u.
    #[must_use]
    pub fn thrust_model(&self) -> &'static str {
        match self {
            Self::Px4 => "THR_MDL_FAC",
            Self::ArduPlane(_) => "Q_M_THST_EXPO",
        }
    }

    /// The system as which the companion sends. ArduPlane takes overrides from its ground station alone, which is system 255 as it is
    /// shipped (`SYSID_MYGCS`, later `MAV_GCS_SYSID`).
    #[must_use]
    pub fn own_system(&self) -> u8 {
        match self {
            Self::Px4 => OWN_SYSTEM,
            Self::ArduPlane(_) => 255,
        }
    }

    /// A body's vector, from the autopilot's axes in those of hover. PX4 tells a tail-sitter's in the axes of hover, ArduPlane with x along
    /// the nose and z to the belly.
    #[must_use]
    pub fn hover(&self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        match self {
            Self::Px4 => [x, y, z],
            Self::ArduPlane(_) => [z, y, -x],
        }
    }

    /// An attitude from the autopilot's axes in those of hover: turned on by −90° about the wing.
    #[must_use]
    pub fn hover_attitude(&self, q: Quaternion) -> Quaternion {
        const C: f32 = std::f32::consts::FRAC_1_SQRT_2;
        match self {
            Self::Px4 => q,
            Self::ArduPlane(_) => Quaternion {
                w: C * (q.w + q.y),
                x: C * (q.x + q.z),
                y: C * (q.y - q.w),
                z: C * (q.z - q.x),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alula::ned::{BodyAxes, Frd};
    use alula::spatial::Orientation;

    #[test]
    fn modes_go_there_and_back() {
        let plane = Kind::ArduPlane(Sticks::default());
        for (kind, others) in [(Kind::Px4, [HOLD, QACRO]), (plane, [QLOITER, OFFBOARD])] {
            assert!(kind.is_commanded(kind.commanded()));
            assert!(others.iter().all(|mode| !kind.is_commanded(*mode)));
            for mode in [kind.commanded(), kind.hold()] {
                assert_eq!(kind.asked(kind.parameters(mode)), mode);
            }
        }
        assert_eq!(Kind::Px4.parameters(HOLD), [4.0, 3.0]);
        assert_eq!(plane.parameters(QACRO), [23.0, 0.0]);
    }

    /// The core reads a quaternion of the axes of a fixed wing by itself: the same attitude.
    #[test]
    fn arduplanes_axes_become_those_of_hover() {
        let plane = Kind::ArduPlane(Sticks::default());
        let q = Quaternion {
            w: 0.1,
            x: 0.7,
            y: -0.5,
            z: 0.5,
        };
        let direct = Orientation::from_quaternion(&q, BodyAxes::NoseForward).unwrap();
        let turned = plane.hover_attitude(q);
        let turned = Orientation::from_quaternion(&turned, BodyAxes::NoseUp).unwrap();
        for (a, b) in [
            (direct.forward(), turned.forward()),
            (direct.right(), turned.right()),
            (direct.down(), turned.down()),
        ] {
            let off = a - b;
            assert!(off.north.abs() + off.east.abs() + off.down.abs() < 1e-6);
        }
        let v = [1.0, 2.0, 3.0];
        let (direct, turned) = (
            BodyAxes::NoseForward.vector::<Frd>(v),
            BodyAxes::NoseUp.vector(plane.hover(v)),
        );
        assert_eq!(direct, turned);
    }
}
