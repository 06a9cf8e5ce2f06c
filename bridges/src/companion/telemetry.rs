//! What the simulated autopilot says of its body.

use mavlink::dialects::ardupilotmega::{
    ATTITUDE_QUATERNION_DATA, EXTENDED_SYS_STATE_DATA, GPS_GLOBAL_ORIGIN_DATA, HEARTBEAT_DATA,
    HIGHRES_IMU_DATA, LOCAL_POSITION_NED_DATA, MavAutopilot, MavLandedState, MavModeFlag, MavState,
    MavType, VFR_HUD_DATA, WIND_COV_DATA, WIND_DATA,
};

use super::{BodyState, Kind, MavMessage, milliseconds};

fn single(v: [f64; 3]) -> [f32; 3] {
    v.map(|c| c as f32)
}

/// A vector along hover's axes, in those of the kind.
fn axes(kind: Kind, v: [f64; 3]) -> [f32; 3] {
    let [x, y, z] = single(v);
    match kind {
        Kind::Px4 => [x, y, z],
        Kind::ArduPlane(_) => [-z, y, x],
    }
}

/// Its mode.
pub fn heartbeat(kind: Kind, custom_mode: u32) -> MavMessage {
    MavMessage::HEARTBEAT(HEARTBEAT_DATA {
        custom_mode,
        mavtype: MavType::MAV_TYPE_VTOL_TAILSITTER_DUOROTOR,
        autopilot: match kind {
            Kind::Px4 => MavAutopilot::MAV_AUTOPILOT_PX4,
            Kind::ArduPlane(_) => MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA,
        },
        base_mode: MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED
            | MavModeFlag::MAV_MODE_FLAG_CUSTOM_MODE_ENABLED,
        system_status: MavState::MAV_STATE_ACTIVE,
        mavlink_version: 3,
    })
}

/// Attitude, motion and specific force.
pub fn state(kind: Kind, now: f64, body: &BodyState) -> [MavMessage; 3] {
    let time_boot_ms = milliseconds(now);
    let [w, x, y, z] = body.quaternion;
    // Turned on by 90° about the wing: from hover's axes to those of a fixed wing.
    let c = std::f64::consts::FRAC_1_SQRT_2;
    let attitude = match kind {
        Kind::Px4 => [w, x, y, z],
        Kind::ArduPlane(_) => [c * (w - y), c * (x - z), c * (y + w), c * (z + x)],
    };
    let [q1, q2, q3, q4] = attitude.map(|c| c as f32);
    let [rollspeed, pitchspeed, yawspeed] = axes(kind, body.rates);
    let ([x, y, z], [vx, vy, vz]) = (single(body.position), single(body.velocity));
    let [xacc, yacc, zacc] = axes(kind, body.specific_force);
    [
        MavMessage::ATTITUDE_QUATERNION(ATTITUDE_QUATERNION_DATA {
            time_boot_ms,
            q1,
            q2,
            q3,
            q4,
            rollspeed,
            pitchspeed,
            yawspeed,
        }),
        MavMessage::LOCAL_POSITION_NED(LOCAL_POSITION_NED_DATA {
            time_boot_ms,
            x,
            y,
            z,
            vx,
            vy,
            vz,
        }),
        MavMessage::HIGHRES_IMU(HIGHRES_IMU_DATA {
            time_usec: (now * 1e6) as u64,
            xacc,
            yacc,
            zacc,
            ..HIGHRES_IMU_DATA::default()
        }),
    ]
}

/// Where its position is counted from: latitude and longitude \[1e-7 °\], altitude \[mm\]. PX4's simulations begin there.
const ORIGIN: [i32; 3] = [473_977_420, 85_455_940, 488_000];

/// Wind and airspeed, that it flies, and where it counts from.
pub fn air(kind: Kind, now: f64, body: &BodyState) -> [MavMessage; 4] {
    let [wind_x, wind_y, wind_z] = single(body.wind);
    let wind = match kind {
        Kind::Px4 => MavMessage::WIND_COV(WIND_COV_DATA {
            time_usec: (now * 1e6) as u64,
            wind_x,
            wind_y,
            wind_z,
            ..WIND_COV_DATA::default()
        }),
        Kind::ArduPlane(_) => MavMessage::WIND(WIND_DATA {
            // Where it comes from.
            direction: (-wind_y).atan2(-wind_x).to_degrees(),
            speed: wind_x.hypot(wind_y).hypot(wind_z),
            speed_z: wind_z,
        }),
    };
    let square: f64 = (0..3)
        .map(|i| (body.velocity[i] - body.wind[i]).powi(2))
        .sum();
    let ground = body.velocity[0].hypot(body.velocity[1]);
    let hud = MavMessage::VFR_HUD(VFR_HUD_DATA {
        airspeed: square.sqrt() as f32,
        groundspeed: ground as f32,
        alt: -body.position[2] as f32,
        climb: -body.velocity[2] as f32,
        ..VFR_HUD_DATA::default()
    });
    let landed = MavMessage::EXTENDED_SYS_STATE(EXTENDED_SYS_STATE_DATA {
        landed_state: MavLandedState::MAV_LANDED_STATE_IN_AIR,
        ..EXTENDED_SYS_STATE_DATA::default()
    });
    let [latitude, longitude, altitude] = ORIGIN;
    let origin = MavMessage::GPS_GLOBAL_ORIGIN(GPS_GLOBAL_ORIGIN_DATA {
        latitude,
        longitude,
        altitude,
    });
    [wind, hud, landed, origin]
}
