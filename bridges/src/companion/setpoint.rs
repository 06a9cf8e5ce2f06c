//! What somebody asks for over the link.

use alula::ned::Ned;
use mavlink::dialects::ardupilotmega::{
    PositionTargetTypemask, SET_POSITION_TARGET_LOCAL_NED_DATA,
};

/// A set-point from the link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setpoint {
    /// Velocity [m/s].
    pub velocity: Ned,
    /// Acceleration [m/s²]; zero if it is not given.
    pub acceleration: Ned,
    /// Position \[m\] in the autopilot's frame, if it is given.
    pub position: Option<Ned>,
}

impl Setpoint {
    /// Whether every number is one.
    pub fn is_finite(&self) -> bool {
        let position = self.position.unwrap_or_default();
        [self.velocity, self.acceleration, position]
            .iter()
            .all(|v| v.north.is_finite() && v.east.is_finite() && v.down.is_finite())
    }
}

/// The set-point of a message in the local frame to one of `systems` or to all; none if it asks for no velocity.
pub fn setpoint(m: &SET_POSITION_TARGET_LOCAL_NED_DATA, systems: &[u32]) -> Option<Setpoint> {
    type Mask = PositionTargetTypemask;
    let ignores = |mask: Mask| m.type_mask.intersects(mask);
    let position = Mask::POSITION_TARGET_TYPEMASK_X_IGNORE
        | Mask::POSITION_TARGET_TYPEMASK_Y_IGNORE
        | Mask::POSITION_TARGET_TYPEMASK_Z_IGNORE;
    let velocity = Mask::POSITION_TARGET_TYPEMASK_VX_IGNORE
        | Mask::POSITION_TARGET_TYPEMASK_VY_IGNORE
        | Mask::POSITION_TARGET_TYPEMASK_VZ_IGNORE;
    let acceleration = Mask::POSITION_TARGET_TYPEMASK_AX_IGNORE
        | Mask::POSITION_TARGET_TYPEMASK_AY_IGNORE
        | Mask::POSITION_TARGET_TYPEMASK_AZ_IGNORE;
    let meant = m.target_system == 0 || systems.contains(&m.target_system.into());
    if !meant || ignores(velocity) || m.coordinate_frame as u32 != 1 {
        return None;
    }
    Some(Setpoint {
        velocity: Ned::new(m.vx, m.vy, m.vz),
        acceleration: match ignores(acceleration) {
            true => Ned::default(),
            false => Ned::new(m.afx, m.afy, m.afz),
        },
        position: (!ignores(position)).then(|| Ned::new(m.x, m.y, m.z)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use mavlink::dialects::ardupilotmega::MavFrame;

    #[test]
    fn a_set_point_is_of_velocity_and_may_have_more() {
        type Mask = PositionTargetTypemask;
        let message = |mask: Mask| SET_POSITION_TARGET_LOCAL_NED_DATA {
            vx: 3.0,
            z: -20.0,
            afx: 1.0,
            type_mask: mask,
            coordinate_frame: MavFrame::MAV_FRAME_LOCAL_NED,
            ..SET_POSITION_TARGET_LOCAL_NED_DATA::default()
        };
        let all = setpoint(&message(Mask::empty()), &[]).unwrap();
        assert_eq!(all.position, Some(Ned::new(0.0, 0.0, -20.0)));
        assert_eq!((all.velocity.north, all.acceleration.north), (3.0, 1.0));
        let bare =
            Mask::POSITION_TARGET_TYPEMASK_Z_IGNORE | Mask::POSITION_TARGET_TYPEMASK_AY_IGNORE;
        let bare = setpoint(&message(bare), &[]).unwrap();
        assert_eq!((bare.position, bare.acceleration), (None, Ned::default()));
        assert_eq!(
            setpoint(&message(Mask::POSITION_TARGET_TYPEMASK_VX_IGNORE), &[]),
            None
        );
        let mut elsewhere = message(Mask::empty());
        elsewhere.target_system = 2;
        assert_eq!(setpoint(&elsewhere, &[1, 255]), None);
        assert!(setpoint(&elsewhere, &[255, 2]).is_some());
    }
}
