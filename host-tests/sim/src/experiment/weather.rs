//! The wind: steady, a 1-cosine gust, and Dryden turbulence at low altitude (MIL-F-8785C).

use rand::Rng;
use serde::Deserialize;

use super::document::{FieldError, finite, positive, require, speed};
use super::dryden::{LEAST_SPEED, Scales, Transverse, along, normal};
use crate::reference::Vector;

/// `[weather]`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct WeatherSpec {
    /// Steady wind \[m/s\], (down, forward): positive forward is a tailwind.
    pub steady_m_s: [f64; 2],
    /// A gust on top.
    pub gust: Option<GustSpec>,
    /// Turbulence on top.
    pub turbulence: Option<TurbulenceSpec>,
}

/// A 1-cosine gust: ½ peak (1 − cos 2π(t − start)/duration) while it lasts.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GustSpec {
    /// When it begins \[s\].
    pub start_s: f64,
    /// How long it lasts \[s\].
    pub duration_s: f64,
    /// Its peak \[m/s\], (down, forward).
    pub peak_m_s: [f64; 2],
}

/// Dryden turbulence of MIL-F-8785C, 3.7.2.2 and 3.7.3: low altitude.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TurbulenceSpec {
    /// Wind speed at 20 ft \[m/s\], W_20: 7.7 is light, 15.4 moderate, 23.1 severe.
    pub wind_at_20_ft_m_s: f64,
    /// Height above ground \[m\], 3 to 305.
    pub height_m: f64,
}

impl WeatherSpec {
    pub(super) fn validate(&self) -> Result<(), FieldError> {
        for value in self.steady_m_s {
            speed("weather.steady_m_s", value)?;
        }
        if let Some(gust) = &self.gust {
            finite("weather.gust.start_s", gust.start_s)?;
            positive("weather.gust.duration_s", gust.duration_s)?;
            for value in gust.peak_m_s {
                speed("weather.gust.peak_m_s", value)?;
            }
        }
        self.turbulence.map_or(Ok(()), |t| t.validate())
    }
}

impl TurbulenceSpec {
    pub(crate) fn validate(&self) -> Result<(), FieldError> {
        let field = "weather.turbulence.wind_at_20_ft_m_s";
        positive(field, self.wind_at_20_ft_m_s)?;
        speed(field, self.wind_at_20_ft_m_s)?;
        let (field, problem) = ("weather.turbulence.height_m", "must be from 3 to 305 m");
        require((3.0..=305.0).contains(&self.height_m), field, problem)
    }
}

/// The wind over a flight.
pub struct Weather {
    spec: WeatherSpec,
    dryden: Option<Dryden>,
}

impl Weather {
    /// The weather at the start; `random` draws the turbulence's first state.
    pub fn new(spec: WeatherSpec, random: &mut impl Rng) -> Self {
        Self {
            spec,
            dryden: spec.turbulence.map(|t| Dryden::new(&t, random)),
        }
    }

    /// The wind \[m/s\] at `t` \[s\].
    pub fn wind(&self, t: f64) -> Vector {
        let mut wind = Vector::from(self.spec.steady_m_s);
        if let Some(gust) = &self.spec.gust {
            let phase = (t - gust.start_s) / gust.duration_s;
            if (0.0..=1.0).contains(&phase) {
                let part = 0.5 * (1.0 - (std::f64::consts::TAU * phase).cos());
                wind += part * Vector::from(gust.peak_m_s);
            }
        }
        if let Some(dryden) = &self.dryden {
            wind += dryden.velocity();
        }
        wind
    }

    /// Lets the turbulence pass for `dt` \[s\] at an `airspeed` \[m/s\].
    pub fn advance(&mut self, airspeed: f64, dt: f64, random: &mut impl Rng) {
        if let Some(dryden) = &mut self.dryden {
            dryden.advance(airspeed, dt, random);
        }
    }
}

/// Turbulence as frozen fields that the vehicle flies through: one component along the wind, one across it.
struct Dryden {
    scales: Scales,
    /// Along the wind, of unit variance.
    u: f64,
    w: Transverse,
}

impl Dryden {
    fn new(spec: &TurbulenceSpec, random: &mut impl Rng) -> Self {
        Self {
            scales: Scales::of(spec),
            u: normal(random),
            w: Transverse::new(random),
        }
    }

    fn velocity(&self) -> Vector {
        let Scales {
            sigma_u, sigma_w, ..
        } = self.scales;
        Vector::new(sigma_w * self.w.value(), sigma_u * self.u)
    }

    fn advance(&mut self, airspeed: f64, dt: f64, random: &mut impl Rng) {
        let path = airspeed.max(LEAST_SPEED) * dt;
        self.u = along(self.u, path, self.scales.length_u, random);
        self.w.advance(path, self.scales.length_w, random);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn a_gust_is_one_cosine() {
        let spec = WeatherSpec {
            steady_m_s: [0.0, -3.0],
            gust: Some(GustSpec {
                start_s: 2.0,
                duration_s: 4.0,
                peak_m_s: [5.0, 1.0],
            }),
            turbulence: None,
        };
        let weather = Weather::new(spec, &mut ChaCha8Rng::seed_from_u64(0));
        let at = |t| weather.wind(t);
        assert_eq!(at(1.9), Vector::new(0.0, -3.0));
        assert!((at(4.0) - Vector::new(5.0, -2.0)).norm() < 1e-12);
        assert!((at(3.0) - Vector::new(2.5, -2.5)).norm() < 1e-12);
        assert_eq!(at(6.1), Vector::new(0.0, -3.0));
    }

    /// Variances and the autocorrelations of the printed spectra, from 4000 s at 20 m/s.
    #[test]
    fn turbulence_has_the_printed_statistics() {
        let spec = TurbulenceSpec {
            wind_at_20_ft_m_s: 15.0,
            height_m: 30.48,
        };
        // 100 ft: σ_w = 1.5 m/s, σ_u = σ_w/(0.2593)^0.4, L_w = 100 ft, L_u = 100/(0.2593)^1.2 ft.
        let sigma = [1.5, 1.5 / 0.2593_f64.powf(0.4)];
        let length = [30.48, 30.48 / 0.2593_f64.powf(1.2)];
        let random = &mut ChaCha8Rng::seed_from_u64(7);
        let (dt, n, lag) = (0.02, 400_000, 25);
        let samples: Vec<_> = {
            let mut dryden = Dryden::new(&spec, random);
            let mut next = || {
                dryden.advance(20.0, dt, random);
                dryden.velocity()
            };
            (0..n).map(|_| next()).collect()
        };
        let mean = |f: &dyn Fn(usize) -> f64| (0..n - lag).map(f).sum::<f64>() / (n - lag) as f64;
        for axis in 0..2 {
            let variance = mean(&|i| samples[i][axis].powi(2)) / sigma[axis].powi(2);
            // 8000 s hold some 1900 independent lengths of L_u: a standard error of 3 %; four of them.
            assert!((variance - 1.0).abs() < 0.12, "{axis}: {variance}");
            let correlation =
                mean(&|i| samples[i][axis] * samples[i + lag][axis]) / sigma[axis].powi(2);
            let z = 20.0 * dt * lag as f64 / length[axis];
            // Inverse transforms of the spectra: e^{−z} along the wind, (1 − z/2) e^{−z} across.
            let shape = [1.0 - 0.5 * z, 1.0][axis];
            assert!((correlation - shape * (-z).exp()).abs() < 0.12, "{axis}");
        }
    }
}
