//! The sliders of a page: where they stand in an experiment, and what moving one sets.

use std::collections::BTreeMap;

use alula_sim::experiment::{Document, Experiment, RateLoop, WeatherSpec};
use anyhow::bail;

/// Their names, in the order in which they are set: wind to the north and to the east, turbulence by its wind at 20 ft \[m/s\]; mass and k_a
/// believed over true; greatest thrust over the weight; lags of rate loop and thrust \[s\].
pub const NAMES: [&str; 8] = [
    "north",
    "east",
    "turbulence",
    "thrust",
    "rate",
    "motor",
    "mass",
    "lift",
];

/// Height of turbulence where there was none \[m\].
const HEIGHT: f64 = 50.0;

/// Where the sliders stand; nothing where the experiment has no such value. Of a vehicle of parts thrust and lags follow from these.
pub fn values(experiment: &Experiment) -> anyhow::Result<BTreeMap<&'static str, Option<f64>>> {
    let (vehicle, spec) = (&experiment.vehicle, experiment.spec()?);
    let belief = spec.belief().unwrap_or(vehicle);
    let (weather, plant) = (&experiment.weather, &experiment.plant);
    let lag = match plant.rate_loop {
        RateLoop::Ideal => Some(0.0),
        RateLoop::Lag { time_constant_s } => Some(time_constant_s),
        RateLoop::Inertia { .. } => None,
    };
    let most = plant.thrust_n[1] / experiment.weight();
    let whole = experiment.tail_sitter.is_none();
    let of = |name| {
        Some(match name {
            "north" => weather.steady().x,
            "east" => weather.steady().y,
            "turbulence" => weather.turbulence.map_or(0.0, |t| t.wind_at_20_ft_m_s),
            "mass" => belief.mass_kg / vehicle.mass_kg,
            "lift" => belief.k_a_kg_m / vehicle.k_a_kg_m,
            "thrust" => return (whole && most.is_finite()).then_some(most),
            "rate" => return lag.filter(|_| whole),
            _ => return whole.then_some(plant.thrust_lag_s),
        })
    };
    Ok(NAMES.map(|name| (name, of(name))).into())
}

/// What moving the slider `name` to `value` sets of the experiment.
pub fn assignment(document: &Document, name: &str, value: f64) -> anyhow::Result<String> {
    let experiment = document.checked()?;
    let weather = &experiment.weather;
    let believed = |field: &str, whole: f64| {
        let table = experiment.controller.path();
        format!("{table}.vehicle.{field}={:?}", value * whole)
    };
    let wind = |axis: usize| {
        let mut steady = weather.steady();
        steady[axis] = value;
        // As it stands before the weather is turned.
        let turned_deg = -weather.turned_deg;
        let before = WeatherSpec {
            steady,
            turned_deg,
            ..WeatherSpec::default()
        };
        let [north, east, down] = before.steady().into();
        format!("weather.steady_m_s=[{north:?},{east:?},{down:?}]")
    };
    Ok(match name {
        "north" => wind(0),
        "east" => wind(1),
        "turbulence" if weather.turbulence.is_some() => {
            format!("weather.turbulence.wind_at_20_ft_m_s={value:?}")
        }
        "turbulence" => {
            format!("weather.turbulence={{wind_at_20_ft_m_s={value:?},height_m={HEIGHT:?}}}")
        }
        "mass" => believed("mass_kg", experiment.vehicle.mass_kg),
        "lift" => believed("k_a_kg_m", experiment.vehicle.k_a_kg_m),
        _ if experiment.tail_sitter.is_some() => {
            bail!("thrust and lags of a vehicle of parts follow from these")
        }
        "thrust" => {
            let [least, _] = experiment.plant.thrust_n;
            let most = value * experiment.weight();
            format!("plant.thrust_n=[{least:?},{most:?}]")
        }
        "rate" if value == 0.0 => "plant.rate_loop=\"ideal\"".to_owned(),
        "rate" => format!("plant.rate_loop.lag.time_constant_s={value:?}"),
        _ => format!("plant.thrust_lag_s={value:?}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use alula_sim::experiment::BUILT_IN;

    /// Every built-in experiment of the guidance that a page flies, and its document.
    fn flown() -> impl Iterator<Item = (&'static str, Document, Experiment)> {
        let all = BUILT_IN.iter().map(|(name, _)| *name);
        all.filter_map(|name| {
            let document = Document::load(name).unwrap();
            let experiment = document.experiment().ok()?;
            Some((name, document, experiment))
        })
    }

    /// A slider that is moved stands where it was moved to, and no other one moves: of the experiments with a belief by name, a wind of both
    /// axes, turbulence, turned weather, and a vehicle of parts, too.
    #[test]
    fn a_slider_changes_what_it_names_alone() {
        let mut moved = 0;
        for (name, document, experiment) in flown() {
            let before = values(&experiment).unwrap();
            for slider in NAMES.iter().filter(|slider| before[*slider].is_some()) {
                let to = before[slider].unwrap() * 0.75 + 0.25;
                let mut changed = document.clone();
                changed
                    .assign(&assignment(&document, slider, to).unwrap())
                    .unwrap_or_else(|e| panic!("{name}, {slider}: {e:#}"));
                let after = values(&changed.checked().unwrap()).unwrap();
                for (other, value) in &after {
                    let expected = if other == slider {
                        Some(to)
                    } else {
                        before[other]
                    };
                    let [value, expected] = [value, &expected].map(|x| x.unwrap_or(f64::NAN));
                    let same =
                        (value - expected).abs() < 1e-12 || value.is_nan() && expected.is_nan();
                    assert!(
                        same,
                        "{name}: {slider} to {to} moves {other} to {value} from {expected}"
                    );
                }
                moved += 1;
            }
        }
        // Eight of each experiment of the ideal plant, five of the others.
        assert!(moved > 200, "{moved}");
    }

    /// Zero is none: of wind and turbulence, and of lags.
    #[test]
    fn zero_is_none() {
        let mut document = Document::load("mission-turbulence").unwrap();
        for slider in ["north", "east", "turbulence", "rate", "motor"] {
            let set = assignment(&document, slider, 0.0).unwrap();
            document.assign(&set).unwrap();
        }
        let experiment = document.checked().unwrap();
        assert_eq!(experiment.weather.steady().norm(), 0.0);
        assert_eq!(experiment.plant.rate_loop, RateLoop::Ideal);
        let calm = |document: &Document| {
            let record = alula_sim::simulate::fly(&document.checked().unwrap()).unwrap();
            record.iter().all(|step| step.wind.norm() == 0.0)
        };
        document.assign("duration_s=1.0").unwrap();
        assert!(calm(&document));
        document
            .assign(&assignment(&document, "turbulence", 5.0).unwrap())
            .unwrap();
        assert!(!calm(&document));
    }
}
