//! The companion's messages.

use mavlink::dialects::common::{
    AttitudeTargetTypemask, COMMAND_LONG_DATA, HEARTBEAT_DATA, MavAutopilot, MavCmd, MavModeFlag,
    MavState, MavType, SET_ATTITUDE_TARGET_DATA, TIMESYNC_DATA,
};

use super::{MavMessage, milliseconds};

/// Body rates [rad/s] about hover's axes and a share of the most thrust, for the system `target`.
pub fn set_point(target: u8, now: f64, rates: [f32; 3], share: f32) -> MavMessage {
    MavMessage::SET_ATTITUDE_TARGET(SET_ATTITUDE_TARGET_DATA {
        time_boot_ms: milliseconds(now),
        q: [1.0, 0.0, 0.0, 0.0],
        body_roll_rate: rates[0],
        body_pitch_rate: rates[1],
        body_yaw_rate: rates[2],
        // A thrust that is no number is none.
        thrust: if share > 0.0 { share.min(1.0) } else { 0.0 },
        target_system: target,
        target_component: 1,
        type_mask: AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_ATTITUDE_IGNORE,
    })
}

/// Asks the system `target` for a main mode and sub-mode.
pub fn request(target: u8, (main, sub): (u8, u8)) -> MavMessage {
    MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
        command: MavCmd::MAV_CMD_DO_SET_MODE,
        // A mode of the autopilot's own.
        param1: 1.0,
        param2: main.into(),
        param3: sub.into(),
        target_system: target,
        target_component: 1,
        ..COMMAND_LONG_DATA::default()
    })
}

/// Asks for the autopilot's time.
pub fn time(now: f64) -> MavMessage {
    MavMessage::TIMESYNC(TIMESYNC_DATA {
        tc1: 0,
        ts1: (now * 1e9) as i64,
    })
}

/// The companion is there.
pub fn heartbeat() -> MavMessage {
    MavMessage::HEARTBEAT(HEARTBEAT_DATA {
        custom_mode: 0,
        mavtype: MavType::MAV_TYPE_ONBOARD_CONTROLLER,
        autopilot: MavAutopilot::MAV_AUTOPILOT_INVALID,
        base_mode: MavModeFlag::empty(),
        system_status: MavState::MAV_STATE_ACTIVE,
        mavlink_version: 3,
    })
}
