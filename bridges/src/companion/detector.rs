//! PX4's failure detector, of the simulated autopilot: while PX4 controls the attitude, a pitch or roll beyond `FD_FAIL_P` or `FD_FAIL_R` for longer than
//! `FD_FAIL_P_TTRI` or `FD_FAIL_R_TTRI` is a failure. It ends the flight, unless `CBRK_FLIGHTTERM` is 121212: then PX4 warns.
//! (v1.17: `FailureDetector::updateAttitudeStatus`, `Failsafe::checkStateAndMode`.)
//!
//! The angles are Euler's of the axes of hover in the multicopter state. A tail-sitter in cruise has a pitch near −90° there, and where it banks any roll.

use super::Parameters;

/// The value of `CBRK_FLIGHTTERM` that keeps PX4 from ending a flight.
pub const BREAKER: f64 = 121_212.0;

/// A limit, and since when it is exceeded.
#[derive(Clone, Copy, Debug)]
struct Limit {
    /// \[rad\]; 0 is none.
    most: f64,
    /// Time that it may be exceeded \[s\].
    time: f64,
    since: Option<f64>,
}

/// The detector.
#[derive(Clone, Copy, Debug)]
pub struct Detector {
    /// Of roll and pitch.
    limits: [Limit; 2],
    /// Whether a failure ends the flight.
    pub terminates: bool,
}

impl Detector {
    /// The detector of these parameters; what is not there is as shipped.
    pub fn of(parameters: &Parameters) -> Self {
        let get = |name: &str, shipped| parameters.get(name).unwrap_or(shipped);
        let limits = [
            ["FD_FAIL_R", "FD_FAIL_R_TTRI"],
            ["FD_FAIL_P", "FD_FAIL_P_TTRI"],
        ];
        Self {
            limits: limits.map(|[angle, time]| Limit {
                most: get(angle, 60.0).to_radians(),
                time: get(time, 0.3),
                since: None,
            }),
            terminates: get("CBRK_FLIGHTTERM", BREAKER) != BREAKER,
        }
    }

    /// Whether the attitude w x y z is a failure, `now` \[s\], of a vehicle whose attitude PX4 controls.
    pub fn fails(&mut self, now: f64, [w, x, y, z]: [f64; 4]) -> bool {
        let roll = (2.0 * (w * x + y * z)).atan2(1.0 - 2.0 * (x * x + y * y));
        let pitch = (2.0 * (w * y - z * x)).clamp(-1.0, 1.0).asin();
        let mut fails = false;
        for (limit, angle) in self.limits.iter_mut().zip([roll, pitch]) {
            let beyond = limit.most > 0.0 && angle.abs() > limit.most;
            limit.since = beyond.then(|| limit.since.unwrap_or(now));
            fails |= limit.since.is_some_and(|since| now - since >= limit.time);
        }
        fails
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A turn about the wing by so many degrees.
    fn pitched(degrees: f64) -> [f64; 4] {
        let (sin, cos) = (0.5 * degrees.to_radians()).sin_cos();
        [cos, 0.0, sin, 0.0]
    }

    /// As PX4: longer than 0.3 s on end, and from a limit of 0 on none.
    #[test]
    fn it_fails_beyond_its_angle_for_longer_than_its_time() {
        let mut shipped = Detector::of(&Parameters::default());
        assert!(!shipped.terminates);
        for step in 0..100 {
            let now = 0.01 * f64::from(step);
            // 0.25 s beyond, then a moment short of it, then beyond for good.
            let degrees = if step == 25 { -59.0 } else { -61.0 };
            assert_eq!(
                shipped.fails(now, pitched(degrees)),
                step >= 26 + 30,
                "{step}"
            );
        }
        let none = Parameters::from_text("FD_FAIL_P 0\nFD_FAIL_R 0\nCBRK_FLIGHTTERM 0").unwrap();
        let mut none = Detector::of(&none);
        assert!(none.terminates && !(0..9).any(|t| none.fails(t.into(), pitched(-80.0))));
    }

    /// Level flight with the nose a little low, or a bank with the nose a little high: of pitch and roll at 90° PX4 sees a roll.
    #[test]
    fn a_roll_is_seen_where_pitch_has_no_limit() {
        let parameters = Parameters::from_text("FD_FAIL_P 0").unwrap();
        let fails = |attitude| {
            let mut detector = Detector::of(&parameters);
            detector.fails(0.0, attitude);
            detector.fails(1.0, attitude)
        };
        assert!(!fails(pitched(-85.0)) && fails(pitched(-95.0)));
    }
}
