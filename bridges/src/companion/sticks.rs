//! The sticks of ArduPlane's QACRO: body rates and throttle as pulses of a transmitter.
//!
//! In QACRO a tail-sitter's rate is its stick times `Q_ACRO_RLL_RATE`, `Q_ACRO_PIT_RATE` and `Q_ACRO_YAW_RATE`, about the axes of a fixed wing:
//! roll about the nose, yaw about the belly. The throttle is taken in whole per cent. The channels are those of `RCMAP_*` as
//! shipped: roll, pitch, throttle, yaw on 1 to 4, from 1000 to 2000 µs with their trim at 1500 (throttle: 1000), not reversed, without a dead
//! zone. (ArduPlane 4.6, `ModeQAcro::run`, `RC_Channel::norm_input`, `RC_Channel::pwm_to_range`.)

/// Rates at full stick [rad/s].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sticks {
    /// About the nose: `Q_ACRO_RLL_RATE`.
    pub roll: f32,
    /// About the wing: `Q_ACRO_PIT_RATE`.
    pub pitch: f32,
    /// About the belly's axis: `Q_ACRO_YAW_RATE`.
    pub yaw: f32,
}

/// As ArduPlane ships them, but the yaw: 90°/s is too slow for a turn in cruise, so that it has the pitch's.
impl Default for Sticks {
    fn default() -> Self {
        Self {
            roll: 360_f32.to_radians(),
            pitch: 180_f32.to_radians(),
            yaw: 180_f32.to_radians(),
        }
    }
}

/// Middle of a stick, and its throw to either side \[µs\].
const MIDDLE: f32 = 1500.0;
const THROW: f32 = 500.0;
/// A pulse \[µs\] of no throttle, and of a per cent of it.
const LEAST: f32 = 1000.0;
const PER_CENT: f32 = 10.0;

/// The pulse \[µs\] nearest to a stick from −1 to 1. What is no number is the middle.
fn pulse(stick: f32) -> u16 {
    let stick = if stick.is_finite() { stick } else { 0.0 };
    (MIDDLE + THROW * stick.clamp(-1.0, 1.0)).round() as u16
}

impl Sticks {
    /// Pulses \[µs\] of channels 1 to 4 for body rates [rad/s] about hover's axes and a share of the throttle, and the share that it is in whole
    /// per cent.
    #[must_use]
    pub fn pulses(&self, [x, y, z]: [f32; 3], share: f32) -> ([u16; 4], f32) {
        let share = if share > 0.0 { share.min(1.0) } else { 0.0 };
        let per_cent = (100.0 * share).round();
        let throttle = (LEAST + PER_CENT * per_cent) as u16;
        let pulses = [
            pulse(-z / self.roll),
            pulse(y / self.pitch),
            throttle,
            pulse(x / self.yaw),
        ];
        (pulses, 0.01 * per_cent)
    }

    /// What ArduPlane makes of the pulses: a share of the throttle, in whole per cent, rounded down, and body rates [rad/s] about hover's axes.
    #[must_use]
    pub fn read(&self, [roll, pitch, throttle, yaw]: [u16; 4]) -> (f64, [f64; 3]) {
        let stick = |pulse: u16| f64::from((f32::from(pulse) - MIDDLE) / THROW).clamp(-1.0, 1.0);
        let per_cent = ((f32::from(throttle) - LEAST) / PER_CENT)
            .clamp(0.0, 100.0)
            .floor();
        let rates = [
            stick(yaw) * f64::from(self.yaw),
            stick(pitch) * f64::from(self.pitch),
            -stick(roll) * f64::from(self.roll),
        ];
        (0.01 * f64::from(per_cent), rates)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pulse is a microsecond of 500: 0.7°/s about the nose, half that about the others; the throttle is a per cent.
    #[test]
    fn what_is_sent_is_read_to_the_pulses_resolution() {
        let sticks = Sticks::default();
        for n in 0..200 {
            let part = n as f32 / 199.0;
            let rates = [2.0 - 4.0 * part, 3.1 * part - 1.0, 6.0 * part - 3.0];
            let (pulses, told) = sticks.pulses(rates, part);
            assert!(pulses.iter().all(|p| (1000..=2000).contains(p)));
            let (share, read) = sticks.read(pulses);
            assert!((share - f64::from(told)).abs() < 1e-6, "{part}: {share}");
            assert!((share - f64::from(part)).abs() < 0.00501, "{part}: {share}");
            let most = [sticks.yaw, sticks.pitch, sticks.roll];
            for axis in 0..3 {
                let off = (read[axis] - f64::from(rates[axis])).abs();
                assert!(off < f64::from(most[axis]) / 999.0, "{axis} {part}: {off}");
            }
        }
    }

    /// Nose up is a stick above the middle, yaw to the right is one about the belly, roll to the right turns about the nose, away from the tail.
    #[test]
    fn each_rate_has_its_stick() {
        let sticks = Sticks::default();
        let pulses = |rates| sticks.pulses(rates, 0.5).0;
        assert_eq!(pulses([0.0; 3]), [1500, 1500, 1500, 1500]);
        assert_eq!(pulses([0.0, sticks.pitch, 0.0]), [1500, 2000, 1500, 1500]);
        assert_eq!(pulses([sticks.yaw, 0.0, 0.0]), [1500, 1500, 1500, 2000]);
        assert_eq!(pulses([0.0, 0.0, -sticks.roll]), [2000, 1500, 1500, 1500]);
        // Beyond full stick, and no numbers.
        assert_eq!(pulses([9.0, -9.0, f32::NAN]), [1500, 1000, 1500, 2000]);
        assert_eq!(sticks.pulses([0.0; 3], f32::NAN).0[2], 1000);
        assert_eq!(sticks.pulses([0.0; 3], 7.0).0[2], 2000);
        // ArduPlane drops what is left of a per cent.
        assert!((sticks.read([1500, 1500, 1479, 1500]).0 - 0.47).abs() < 1e-6);
        assert_eq!(sticks.read([0, 0, 0, 65_534]).0, 0.0);
    }
}
