//! From newtons to a motor controller's pulse.

use core::fmt;
use embedded_hal::pwm::SetDutyCycle;

/// Static thrust of a motor with its propeller, as measured on a stand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorCurve<'a> {
    points: &'a [(f32, f32)],
}

/// Why a curve or a pulse was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ThrustOutputError {
    /// Fewer than two points, the first not (0 N, 0), thrusts that do not increase, throttles that decrease or
    /// leave [0, 1], or numbers that are not finite.
    Curve,
    /// Not 0 ≤ disarmed ≤ minimum < maximum ≤ 1.
    Pulse,
}

impl fmt::Display for ThrustOutputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Curve => "motor curve must rise from (0, 0), in throttle up to 1",
            Self::Pulse => "pulse must be 0 <= disarmed <= minimum < maximum <= 1",
        })
    }
}

impl core::error::Error for ThrustOutputError {}

impl<'a> MotorCurve<'a> {
    /// The curve through `points`, each (thrust \[N\], throttle in [0, 1]), straight in between.
    ///
    /// # Errors
    /// [`ThrustOutputError::Curve`].
    pub const fn new(points: &'a [(f32, f32)]) -> Result<Self, ThrustOutputError> {
        if points.len() < 2 || points[0].0 != 0.0 || points[0].1 != 0.0 {
            return Err(ThrustOutputError::Curve);
        }
        let mut n = 1;
        while n < points.len() {
            let ((thrust, throttle), (before, throttle_before)) = (points[n], points[n - 1]);
            let rises = thrust > before && thrust.is_finite();
            if !(rises && throttle >= throttle_before && throttle <= 1.0) {
                return Err(ThrustOutputError::Curve);
            }
            n += 1;
        }
        Ok(Self { points })
    }

    /// The throttle for `thrust` \[N\], and the thrust that it gives: the nearest that the motor has.
    fn throttle(&self, thrust: f32) -> (f32, f32) {
        let thrust = if thrust > 0.0 { thrust } else { 0.0 };
        let mut below = (0.0, 0.0);
        for &above in self.points {
            if thrust < above.0 {
                let part = (thrust - below.0) / (above.0 - below.0);
                return (below.1 + part * (above.1 - below.1), thrust);
            }
            below = above;
        }
        (below.1, below.0)
    }
}

/// The motor controller's pulse, as parts of the period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pulse {
    /// The motor stands still.
    pub disarmed: f32,
    /// Armed, throttle 0.
    pub minimum: f32,
    /// Throttle 1.
    pub maximum: f32,
}

/// What happened to a thrust command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Thrust {
    /// The motor gives this thrust \[N\]: the one asked for, or the nearest it has.
    Applied(f32),
    /// Not armed: the motor stands still.
    Disarmed,
    /// NaN or infinite: the motor is at its minimum.
    Refused,
}

/// A thrust on a PWM channel. Starts disarmed.
pub struct ThrustOutput<'a, P> {
    pwm: P,
    curve: MotorCurve<'a>,
    pulse: Pulse,
    armed: bool,
}

impl<'a, P: SetDutyCycle> ThrustOutput<'a, P> {
    /// The output on `pwm`; the caller has set its period.
    ///
    /// # Errors
    /// [`ThrustOutputError::Pulse`].
    pub fn new(pwm: P, curve: MotorCurve<'a>, pulse: Pulse) -> Result<Self, ThrustOutputError> {
        let Pulse {
            disarmed,
            minimum,
            maximum,
        } = pulse;
        if !(0.0 <= disarmed && disarmed <= minimum && minimum < maximum && maximum <= 1.0) {
            return Err(ThrustOutputError::Pulse);
        }
        Ok(Self {
            pwm,
            curve,
            pulse,
            armed: false,
        })
    }

    /// Lets the motor turn from the next thrust on, or stops it now.
    ///
    /// # Errors
    /// The channel's.
    pub fn arm(&mut self, armed: bool) -> Result<(), P::Error> {
        self.armed = armed;
        if armed {
            Ok(())
        } else {
            self.duty(self.pulse.disarmed)
        }
    }

    /// Commands `thrust` \[N\].
    ///
    /// # Errors
    /// The channel's.
    pub fn set(&mut self, thrust: f32) -> Result<Thrust, P::Error> {
        if !self.armed {
            self.duty(self.pulse.disarmed)?;
            return Ok(Thrust::Disarmed);
        }
        let Pulse {
            minimum, maximum, ..
        } = self.pulse;
        if !thrust.is_finite() {
            self.duty(minimum)?;
            return Ok(Thrust::Refused);
        }
        let (throttle, applied) = self.curve.throttle(thrust);
        self.duty(minimum + throttle * (maximum - minimum))?;
        Ok(Thrust::Applied(applied))
    }

    fn duty(&mut self, part: f32) -> Result<(), P::Error> {
        let full = f32::from(self.pwm.max_duty_cycle());
        self.pwm.set_duty_cycle((part * full + 0.5) as u16)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use embedded_hal_mock::eh1::pwm::{Mock, Transaction};
    use std::vec::Vec;

    const POINTS: &[(f32, f32)] = &[(0.0, 0.0), (10.0, 0.4), (40.0, 1.0)];
    const PULSE: Pulse = Pulse {
        disarmed: 0.40,
        minimum: 0.44,
        maximum: 0.80,
    };

    /// Runs `f` on an output; the channel, with 10,000 counts to the period, must be set to `duties`.
    fn sets(duties: &[u16], f: impl FnOnce(&mut ThrustOutput<'_, &mut Mock>)) {
        let set = |&duty| {
            [
                Transaction::max_duty_cycle(10_000),
                Transaction::set_duty_cycle(duty),
            ]
        };
        let mut mock = Mock::new(&duties.iter().flat_map(set).collect::<Vec<_>>());
        let curve = MotorCurve::new(POINTS).unwrap();
        f(&mut ThrustOutput::new(&mut mock, curve, PULSE).unwrap());
        mock.done();
    }

    #[test]
    fn starts_disarmed_and_stays_so() {
        sets(&[4000, 4000], |output| {
            assert_eq!(output.set(20.0), Ok(Thrust::Disarmed));
            assert_eq!(output.set(f32::NAN), Ok(Thrust::Disarmed));
        });
    }

    #[test]
    fn follows_the_curve_between_minimum_and_maximum() {
        sets(&[4400, 5120, 5840, 6920, 8000, 8000, 4400], |output| {
            output.arm(true).unwrap();
            for (asked, applied) in [
                (0.0, 0.0),
                (5.0, 5.0),
                (10.0, 10.0),
                (25.0, 25.0),
                (40.0, 40.0),
                (1e9, 40.0),
                (-3.0, 0.0),
            ] {
                assert_eq!(output.set(asked), Ok(Thrust::Applied(applied)));
            }
        });
    }

    #[test]
    fn refuses_what_is_not_finite_and_stops_when_disarmed() {
        sets(&[4400, 4400, 4400, 8000, 4000, 4000], |output| {
            output.arm(true).unwrap();
            for thrust in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                assert_eq!(output.set(thrust), Ok(Thrust::Refused));
            }
            assert_eq!(output.set(40.0), Ok(Thrust::Applied(40.0)));
            output.arm(false).unwrap();
            assert_eq!(output.set(40.0), Ok(Thrust::Disarmed));
        });
    }

    #[test]
    fn bad_curves_and_pulses_are_refused() {
        for points in [
            &[(0.0, 0.0)][..],
            &[(1.0, 0.0), (2.0, 1.0)],
            &[(0.0, 0.0), (0.0, 1.0)],
            &[(0.0, 0.0), (5.0, 0.5), (6.0, 0.4)],
            &[(0.0, 0.0), (5.0, 1.1)],
            &[(0.0, 0.0), (f32::NAN, 1.0)],
            &[(0.0, 0.0), (f32::INFINITY, 1.0)],
            &[(0.0, 0.0), (5.0, f32::NAN)],
        ] {
            assert_eq!(MotorCurve::new(points), Err(ThrustOutputError::Curve));
        }
        let curve = MotorCurve::new(POINTS).unwrap();
        for (disarmed, minimum, maximum) in [
            (-0.1, 0.1, 0.5),
            (0.2, 0.1, 0.5),
            (0.1, 0.5, 0.5),
            (0.1, 0.2, 1.1),
            (f32::NAN, 0.1, 0.5),
        ] {
            let pulse = Pulse {
                disarmed,
                minimum,
                maximum,
            };
            let mut mock = Mock::new(&[]);
            let output = ThrustOutput::new(&mut mock, curve, pulse);
            assert_eq!(output.err(), Some(ThrustOutputError::Pulse));
            mock.done();
        }
    }
}
