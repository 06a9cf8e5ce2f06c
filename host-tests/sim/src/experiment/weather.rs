//! The wind: steady, a 1-cosine gust, and Dryden turbulence on three axes (MIL-F-8785C, low altitude).

use rand::Rng;
use schemars::JsonSchema;
use serde::Deserialize;

use super::V3;
use super::document::{FieldError, angle, finite, require, speed};
use super::dryden::{LEAST_SPEED, Scales, Transverse, along};
use super::normal::normal;
use super::vector::{vector, velocity};

/// `[weather]`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct WeatherSpec {
    /// Steady wind \[m/s\], north-east-down: where the air goes.
    #[serde(rename = "steady_m_s", deserialize_with = "vector")]
    #[schemars(with = "[f64; 3]")]
    pub steady: V3,
    /// By how much steady wind and gust are turned about the vertical, clockwise from above \[°\].
    pub turned_deg: f64,
    /// A gust on top.
    pub gust: Option<Gust>,
    /// Turbulence on top; the steady wind's direction is its own, or north.
    pub turbulence: Option<TurbulenceSpec>,
}

impl WeatherSpec {
    pub(super) fn validate(&self) -> Result<(), FieldError> {
        velocity("weather.steady_m_s", &self.steady)?;
        angle("weather.turned_deg", self.turned_deg)?;
        if let Some(gust) = &self.gust {
            finite("weather.gust.start_s", gust.start)?;
            velocity("weather.gust.peak_m_s", &gust.peak)?;
            // NaN is not positive. An infinite duration is a step's.
            let field = "weather.gust.duration_s";
            require(gust.duration > 0.0, field, "must be positive")?;
        }
        self.turbulence.map_or(Ok(()), |t| t.validate())
    }

    /// Whether nothing blows out of the vertical plane to the north but turbulence.
    pub(super) fn in_plane(&self) -> bool {
        let gust = self.gust.map_or(0.0, |gust| gust.peak.y);
        self.steady.y == 0.0 && gust == 0.0 && self.turned_deg == 0.0
    }

    /// The steady wind \[m/s\], turned.
    pub fn steady(&self) -> V3 {
        self.turned(self.steady)
    }

    fn turned(&self, v: V3) -> V3 {
        // Exactly, where nothing is turned.
        if self.turned_deg == 0.0 {
            return v;
        }
        let (s, c) = libm::sincos(self.turned_deg.to_radians());
        V3::new(c * v.x - s * v.y, s * v.x + c * v.y, v.z)
    }
}

/// Dryden turbulence of MIL-F-8785C, 3.7.2.2 and 3.7.3: low altitude.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TurbulenceSpec {
    /// Wind speed at 20 ft \[m/s\], W_20: 0 is calm, 7.7 light, 15.4 moderate, 23.1 severe.
    pub wind_at_20_ft_m_s: f64,
    /// Height above ground \[m\], 3 to 305.
    pub height_m: f64,
}

impl TurbulenceSpec {
    pub(crate) fn validate(&self) -> Result<(), FieldError> {
        let field = "weather.turbulence.wind_at_20_ft_m_s";
        speed(field, self.wind_at_20_ft_m_s)?;
        require(self.wind_at_20_ft_m_s >= 0.0, field, "must not be negative")?;
        let (field, problem) = ("weather.turbulence.height_m", "must be from 3 to 305 m");
        require((3.0..=305.0).contains(&self.height_m), field, problem)
    }
}

/// The wind over a flight.
pub struct Weather {
    spec: WeatherSpec,
    turbulence: Option<Turbulence>,
}

impl Weather {
    /// The weather at the start; `random` draws the turbulence's first state. `in_plane` keeps the turbulence in the vertical plane to the north.
    pub fn new(spec: WeatherSpec, in_plane: bool, random: &mut impl Rng) -> Self {
        let steady = spec.steady();
        let heading = libm::atan2(steady.y, steady.x);
        let rough = spec.turbulence.filter(|t| t.wind_at_20_ft_m_s > 0.0);
        let turbulence = rough.map(|t| match in_plane {
            true => Turbulence::in_plane(&t, random),
            false => Turbulence::new(&t, heading, random),
        });
        Self { spec, turbulence }
    }

    /// The wind \[m/s\] at `t` \[s\].
    pub fn wind(&self, t: f64) -> V3 {
        let gust = self.spec.gust.map_or(V3::zeros(), |gust| gust.at(t));
        let mean = self.spec.turned(self.spec.steady + gust);
        let turbulence = self.turbulence.as_ref();
        mean + turbulence.map_or(V3::zeros(), Turbulence::velocity)
    }

    /// Lets the turbulence pass for `dt` \[s\] at an `airspeed` \[m/s\].
    pub fn advance(&mut self, airspeed: f64, dt: f64, random: &mut impl Rng) {
        if let Some(turbulence) = &mut self.turbulence {
            turbulence.advance(airspeed, dt, random);
        }
    }
}

/// A 1-cosine gust: ½ peak (1 − cos 2π(t − start)/duration) while it lasts; or, without an end, a step of `peak`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Gust {
    /// When it begins \[s\].
    #[serde(rename = "start_s")]
    pub start: f64,
    /// How long it lasts \[s\]; infinite for a step.
    #[serde(rename = "duration_s")]
    pub duration: f64,
    /// Its peak \[m/s\], north-east-down.
    #[serde(rename = "peak_m_s", deserialize_with = "vector")]
    #[schemars(with = "[f64; 3]")]
    pub peak: V3,
}

impl Gust {
    /// Its velocity at `t` \[s\].
    pub fn at(&self, t: f64) -> V3 {
        if t < self.start {
            V3::zeros()
        } else if self.duration.is_infinite() {
            self.peak
        } else {
            let phase = ((t - self.start) / self.duration).min(1.0);
            0.5 * (1.0 - libm::cos(std::f64::consts::TAU * phase)) * self.peak
        }
    }
}

/// Dryden turbulence: two horizontal components of intensity σ_u and scale L_u, a vertical one of σ_w and L_w.
pub struct Turbulence {
    scales: Scales,
    /// Unit vector of the mean wind, horizontal.
    along: V3,
    /// Along the mean wind, of unit variance.
    u: f64,
    /// Across it, horizontally; none in a vertical plane.
    side: Option<Transverse>,
    /// Downward.
    down: Transverse,
}

impl Turbulence {
    /// Turbulence in a mean wind that blows towards `heading` \[rad\] from north.
    pub fn new(spec: &TurbulenceSpec, heading: f64, random: &mut impl Rng) -> Self {
        let side = Transverse::new(random);
        Self {
            along: V3::new(libm::cos(heading), libm::sin(heading), 0.0),
            side: Some(side),
            ..Self::in_plane(spec, random)
        }
    }

    /// Turbulence that stays in the vertical plane to the north.
    pub fn in_plane(spec: &TurbulenceSpec, random: &mut impl Rng) -> Self {
        let down = Transverse::new(random);
        Self {
            scales: Scales::of(spec),
            along: V3::x(),
            u: normal(random),
            side: None,
            down,
        }
    }

    /// The velocity now \[m/s\], north-east-down.
    pub fn velocity(&self) -> V3 {
        let Scales {
            sigma_u, sigma_w, ..
        } = self.scales;
        let side = self.side.as_ref().map_or(0.0, Transverse::value);
        let across = V3::new(-self.along.y, self.along.x, 0.0);
        let level = sigma_u * self.u * self.along + sigma_u * side * across;
        level + V3::new(0.0, 0.0, sigma_w * self.down.value())
    }

    /// Lets it pass for `dt` \[s\] at an `airspeed` \[m/s\].
    pub fn advance(&mut self, airspeed: f64, dt: f64, random: &mut impl Rng) {
        let path = airspeed.max(LEAST_SPEED) * dt;
        self.u = along(self.u, path, self.scales.length_u, random);
        if let Some(side) = &mut self.side {
            side.advance(path, self.scales.length_u, random);
        }
        self.down.advance(path, self.scales.length_w, random);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn a_gust_rises_and_falls_and_a_step_stays() {
        let peak = V3::new(0.0, 8.0, -1.0);
        let gust = |duration| Gust {
            start: 2.0,
            duration,
            peak,
        };
        assert_eq!(gust(4.0).at(1.99), V3::zeros());
        assert!((gust(4.0).at(4.0) - peak).norm() < 1e-12);
        assert!((gust(4.0).at(3.0) - 0.5 * peak).norm() < 1e-12);
        assert!(gust(4.0).at(9.0).norm() < 1e-12);
        assert_eq!(gust(f64::INFINITY).at(50.0), peak);
    }

    /// Standard deviations and the correlation over half a second of each axis, from 6000 s at 20 m/s.
    #[test]
    fn turbulence_has_the_printed_statistics_on_each_axis() {
        let random = &mut ChaCha8Rng::seed_from_u64(3);
        let spec = TurbulenceSpec {
            wind_at_20_ft_m_s: 15.0,
            height_m: 30.48,
        };
        let mut t = Turbulence::new(&spec, 0.0, random);
        let (dt, n, lag) = (0.02, 300_000, 25);
        let samples: Vec<_> = (0..n)
            .map(|_| {
                t.advance(20.0, dt, random);
                t.velocity()
            })
            .collect();
        let sigma_u = 1.5 / 0.2593_f64.powf(0.4);
        let length_u = 30.48 / 0.2593_f64.powf(1.2);
        let axes = [
            (sigma_u, length_u, 0.0),
            (sigma_u, length_u, 0.5),
            (1.5, 30.48, 0.5),
        ];
        let mean = |f: &dyn Fn(usize) -> f64| (0..n - lag).map(f).sum::<f64>() / (n - lag) as f64;
        for (axis, (sigma, length, half)) in axes.into_iter().enumerate() {
            let over = sigma * sigma;
            let variance = mean(&|i| samples[i][axis].powi(2)) / over;
            let together = mean(&|i| samples[i][axis] * samples[i + lag][axis]) / over;
            let z = 20.0 * dt * lag as f64 / length;
            // Some 800 independent lengths of L_u: a standard error of 5 %; four of them.
            assert!((variance - 1.0).abs() < 0.2, "{axis}: {variance}");
            let want = (1.0 - half * z) * (-z).exp();
            assert!((together - want).abs() < 0.2, "{axis}: {together} {want}");
        }
    }
}
