//! What an autopilot's estimator makes of what is measured: lags, and an attitude error that drifts.

use nalgebra::UnitQuaternion;
use rand_chacha::ChaCha8Rng;
use schemars::JsonSchema;
use serde::Deserialize;

use super::document::{FieldError, require, sensor_error};
use super::normal::normal;
use super::{V3, stream};

/// `[sensors.estimator]`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct EstimatorSpec {
    /// Time constant of velocity and position \[s\]; 0 for none.
    pub lag_s: f64,
    /// Standard deviation of the attitude error that drifts, about each axis \[°\].
    pub drift_deg: f64,
    /// Its correlation time \[s\]. Assumed.
    pub drift_time_s: f64,
    /// Time constant of the level wind \[s\]. Assumed: how fast PX4's `ekf2` follows a change of wind in flight.
    pub wind_lag_s: f64,
}

impl Default for EstimatorSpec {
    fn default() -> Self {
        Self {
            lag_s: 0.0,
            drift_deg: 0.0,
            drift_time_s: 60.0,
            wind_lag_s: 4.0,
        }
    }
}

impl EstimatorSpec {
    pub(super) fn validate(&self) -> Result<(), FieldError> {
        let numbers = [
            ("lag_s", self.lag_s),
            ("drift_deg", self.drift_deg),
            ("drift_time_s", self.drift_time_s),
            ("wind_lag_s", self.wind_lag_s),
        ];
        for (name, value) in numbers {
            let field = format!("sensors.estimator.{name}");
            sensor_error(&field, value)?;
            require(value >= 0.0, field, "must not be negative")?;
        }
        Ok(())
    }
}

/// The estimator's memory.
pub struct Estimates {
    random: ChaCha8Rng,
    wind: Option<V3>,
    /// How far velocity and position are behind: estimate less value [m/s], \[m\].
    last: Option<[V3; 2]>,
    /// Attitude error \[rad\].
    drift: Option<V3>,
}

/// The part of a change that a lag of `time` \[s\] lets through in `dt` \[s\].
fn passed(dt: f64, time: f64) -> f64 {
    if time > 0.0 {
        1.0 - libm::exp(-dt / time)
    } else {
        1.0
    }
}

impl Estimates {
    /// None so far, for a flight with this `seed`.
    pub fn new(seed: u64) -> Self {
        Self {
            random: stream(seed, 4),
            wind: None,
            last: None,
            drift: None,
        }
    }

    /// The level part of the `wind` \[m/s\], `dt` \[s\] after the last; at first the `steady` one.
    pub(super) fn wind(&mut self, spec: &EstimatorSpec, wind: V3, steady: V3, dt: f64) -> V3 {
        let level = |v: V3| V3::new(v.x, v.y, 0.0);
        let last = self.wind.unwrap_or(level(steady));
        let next = last + (level(wind) - last) * passed(dt, spec.wind_lag_s);
        self.wind = Some(next);
        next
    }

    /// The level wind estimated last \[m/s\].
    pub fn last_wind(&self) -> V3 {
        self.wind.unwrap_or_default()
    }

    /// Velocity \[m/s\] and position \[m\], `dt` \[s\] after the last.
    pub(super) fn motion(&mut self, spec: &EstimatorSpec, now: [V3; 2], dt: f64) -> [V3; 2] {
        // Exactly, where nothing lags.
        if spec.lag_s == 0.0 {
            return now;
        }
        let part = passed(dt, spec.lag_s);
        let last = self.last.unwrap_or(now);
        let next = [0, 1].map(|n| last[n] + (now[n] - last[n]) * part);
        self.last = Some(next);
        next
    }

    /// The turn from the attitude to its estimate, `dt` \[s\] after the last; in a vertical plane about the right wing alone.
    pub(super) fn turn(
        &mut self,
        spec: &EstimatorSpec,
        in_plane: bool,
        dt: f64,
    ) -> UnitQuaternion<f64> {
        if spec.drift_deg == 0.0 {
            return UnitQuaternion::identity();
        }
        let deviation = spec.drift_deg.to_radians();
        let part = passed(dt, spec.drift_time_s);
        let random = &mut self.random;
        let mut drawn = || {
            V3::from_fn(|i, _| {
                if in_plane && i != 1 {
                    0.0
                } else {
                    normal(random)
                }
            })
        };
        let next = match self.drift {
            None => drawn() * deviation,
            // Stationary: the variance lost is the variance that comes.
            Some(last) => {
                last * (1.0 - part) + drawn() * (deviation * (part * (2.0 - part)).sqrt())
            }
        };
        self.drift = Some(next);
        UnitQuaternion::from_scaled_axis(next)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 0.01;

    /// A wind that begins at once is estimated by 63 % after 4 s, without its vertical part; a flight begins with the steady one.
    #[test]
    fn the_wind_lags_and_is_level() {
        let spec = EstimatorSpec::default();
        let mut estimates = Estimates::new(1);
        let steady = V3::new(1.0, 0.0, 0.0);
        assert_eq!(estimates.wind(&spec, steady, steady, DT), steady);
        let mut told = V3::zeros();
        for _ in 0..400 {
            told = estimates.wind(&spec, V3::new(1.0, 5.0, -2.0), steady, DT);
        }
        let expected = V3::new(1.0, 5.0 * (1.0 - (-1.0_f64).exp()), 0.0);
        assert!((told - expected).norm() < 1e-9, "{told}");
    }

    /// On a ramp velocity and position are behind by the lag.
    #[test]
    fn on_a_ramp_motion_is_behind_by_the_lag() {
        let spec = EstimatorSpec {
            lag_s: 0.2,
            ..EstimatorSpec::default()
        };
        let mut estimates = Estimates::new(1);
        let at = |t: f64| [V3::new(3.0 * t, 0.0, 0.0), V3::new(0.0, 7.0 * t, 0.0)];
        let mut behind = [V3::zeros(); 2];
        for n in 0..500 {
            let now = at(f64::from(n) * DT);
            let told = estimates.motion(&spec, now, DT);
            behind = [now[0] - told[0], now[1] - told[1]];
        }
        // A step of a lag that is exact in steps is behind by half a step less.
        assert!((behind[0].x - 3.0 * 0.2).abs() < 3.0 * DT, "{behind:?}");
        assert!((behind[1].y - 7.0 * 0.2).abs() < 7.0 * DT, "{behind:?}");
        let exact = EstimatorSpec::default();
        assert_eq!(Estimates::new(1).motion(&exact, at(2.0), DT), at(2.0));
    }

    /// The attitude error has its deviation from the first step on, and after its correlation time 1/e of it is left.
    #[test]
    fn the_attitude_drifts_with_its_deviation_and_time() {
        let spec = EstimatorSpec {
            drift_deg: 1.5,
            drift_time_s: 10.0,
            ..EstimatorSpec::default()
        };
        let flights = 4000;
        let (mut first, mut last, mut product) = (0.0, 0.0, 0.0);
        for seed in 0..flights {
            let mut estimates = Estimates::new(seed);
            let mut next = || estimates.turn(&spec, true, 5.0).scaled_axis();
            let (a, _, b) = (next(), next(), next());
            assert_eq!((a.x, a.z), (0.0, 0.0));
            first += a.y * a.y;
            last += b.y * b.y;
            product += a.y * b.y;
        }
        let variance = 1.5_f64.to_radians().powi(2) * flights as f64;
        // Four standard errors of a variance and of a correlation.
        assert!((first / variance - 1.0).abs() < 0.09 && (last / variance - 1.0).abs() < 0.09);
        assert!((product / variance - (-1.0_f64).exp()).abs() < 0.07);
        let exact = EstimatorSpec::default();
        assert_eq!(
            Estimates::new(1).turn(&exact, false, DT),
            UnitQuaternion::identity()
        );
    }
}
