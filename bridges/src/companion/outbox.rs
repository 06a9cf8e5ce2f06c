//! The companion's messages.

use mavlink::dialects::ardupilotmega::{
    AttitudeTargetTypemask, COMMAND_LONG_DATA, HEARTBEAT_DATA, MavAutopilot, MavCmd, MavModeFlag,
    MavState, MavType, RC_CHANNELS_OVERRIDE_DATA, SET_ATTITUDE_TARGET_DATA, TIMESYNC_DATA,
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

/// Pulses \[µs\] of channels 1 to 4, for the system `target`. A pulse of 0 gives a channel back to the transmitter; the other channels stay as
/// they are.
pub fn sticks(target: u8, [chan1_raw, chan2_raw, chan3_raw, chan4_raw]: [u16; 4]) -> MavMessage {
    MavMessage::RC_CHANNELS_OVERRIDE(RC_CHANNELS_OVERRIDE_DATA {
        chan1_raw,
        chan2_raw,
        chan3_raw,
        chan4_raw,
        chan5_raw: u16::MAX,
        chan6_raw: u16::MAX,
        chan7_raw: u16::MAX,
        chan8_raw: u16::MAX,
        target_system: target,
        target_component: 1,
    })
}

/// Asks the system `target` for a mode of its own.
pub fn request(target: u8, [param2, param3]: [f32; 2]) -> MavMessage {
    command(target, MavCmd::MAV_CMD_DO_SET_MODE, [1.0, param2, param3])
}

/// Asks the system `target` for its state at 50 Hz, and at 5 Hz for the air and whether it flies.
pub fn requests_of_state(target: u8) -> impl Iterator<Item = MavMessage> {
    // ATTITUDE_QUATERNION, LOCAL_POSITION_NED, HIGHRES_IMU; VFR_HUD, WIND, WIND_COV, EXTENDED_SYS_STATE, GPS_GLOBAL_ORIGIN. A period is in
    // microseconds.
    let often = [31.0, 32.0, 105.0].map(|id| [id, 20e3, 0.0]);
    let seldom = [74.0, 168.0, 231.0, 245.0, 49.0].map(|id| [id, 200e3, 0.0]);
    let all = often.into_iter().chain(seldom);
    all.map(move |parameters| command(target, MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL, parameters))
}

fn command(target: u8, command: MavCmd, [param1, param2, param3]: [f32; 3]) -> MavMessage {
    MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
        command,
        param1,
        param2,
        param3,
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
