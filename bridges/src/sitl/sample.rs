//! The answer: what ArduPilot's simulated sensors are made of.

use std::fmt::Write as _;

/// One answer. Body components are forward-right-down, world components north-east-down.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Time of the physics \[s\].
    pub timestamp: f64,
    /// Angular velocity [rad/s], body.
    pub gyro: [f64; 3],
    /// Specific force [m/s²], body: (g, 0, 0) at rest, nose up.
    pub accel_body: [f64; 3],
    /// Position from home \[m\].
    pub position: [f64; 3],
    /// Velocity over ground [m/s].
    pub velocity: [f64; 3],
    /// Attitude, w x y z, from body to world.
    pub quaternion: [f64; 4],
    /// Airspeed along the nose [m/s]. Without it ArduPilot takes the air to be at rest.
    pub airspeed: Option<f64>,
    /// Velocity of the air over ground [m/s].
    pub velocity_wind: Option<[f64; 3]>,
}

/// What is not finite would stop ArduPilot: 0 takes its place.
fn number(value: f64) -> f64 {
    if value.is_finite() { value } else { 0.0 }
}

fn array(values: &[f64]) -> String {
    let cells: Vec<String> = values
        .iter()
        .map(|v| format!("{:.9}", number(*v)))
        .collect();
    format!("[{}]", cells.join(","))
}

impl Sample {
    /// The answer's text. ArduPilot finds a key by the first occurrence of its name, and the value behind the colon at once: there is no
    /// blank, and `velocity` stands before `velocity_wind`.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = format!(
            "\n{{\"timestamp\":{:.6},\"imu\":{{\"gyro\":{},\"accel_body\":{}}},\"position\":{},\"velocity\":{},\"quaternion\":{}",
            number(self.timestamp),
            array(&self.gyro),
            array(&self.accel_body),
            array(&self.position),
            array(&self.velocity),
            array(&self.quaternion),
        );
        // Writing to a string does not fail.
        if let Some(airspeed) = self.airspeed {
            let _ = write!(text, ",\"airspeed\":{:.9}", number(airspeed));
        }
        if let Some(wind) = &self.velocity_wind {
            let _ = write!(text, ",\"velocity_wind\":{}", array(wind));
        }
        text.push_str("}\n");
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_text_is_as_ardupilot_reads_it() {
        let sample = Sample {
            timestamp: 0.0025,
            gyro: [0.0, -0.5, f64::NAN],
            accel_body: [9.81, 0.0, 0.0],
            velocity: [1.0, 2.0, 3.0],
            quaternion: [1.0, 0.0, 0.0, 0.0],
            airspeed: Some(4.0),
            velocity_wind: Some([-3.0, 0.0, 0.0]),
            ..Sample::default()
        };
        assert_eq!(
            sample.text(),
            "\n{\"timestamp\":0.002500,\
             \"imu\":{\"gyro\":[0.000000000,-0.500000000,0.000000000],\"accel_body\":[9.810000000,0.000000000,0.000000000]},\
             \"position\":[0.000000000,0.000000000,0.000000000],\"velocity\":[1.000000000,2.000000000,3.000000000],\
             \"quaternion\":[1.000000000,0.000000000,0.000000000,0.000000000],\
             \"airspeed\":4.000000000,\"velocity_wind\":[-3.000000000,0.000000000,0.000000000]}\n"
        );
        let bare = Sample::default().text();
        assert!(!bare.contains("airspeed") && !bare.contains("wind") && bare.ends_with("]}\n"));
    }
}
