//! The linear margins against flights: a lag, or a delay, a tenth below the limit dies out, a tenth above it grows.

use alula_sim::experiment::{Document, Experiment, PlantSpec};
use alula_sim::margins::{Loop, Point};
use alula_sim::simulate::simulate;
use toml::Value;

/// The round trip's vehicle, known exactly, under these gains of the bare law, or else under the guidance's gains by bandwidth.
fn exact(gains: Option<&str>) -> Document {
    let mut document = Document::load("round-trip").unwrap();
    let law = match gains {
        Some(gains) => format!("[law.gains]\n{gains}"),
        None => "[law.bandwidth]\ngain_schedule_floor_mg = 0.51\ntau_mg = 0.8155".to_owned(),
    };
    let law: toml::Table = law.parse().unwrap();
    set(&mut document, "controller", law);
    document
}

fn set(document: &mut Document, path: &str, value: impl Into<Value>) {
    document.set(path, value.into()).unwrap();
}

const PAPER: &str = "k1 = 0.1529\nk2 = 0.0234\nk3 = 6.0\ntau_n = 80.0";

/// The only equilibrium at `speed` of the bare loop.
fn point(document: &Document, speed: f64) -> Point {
    let experiment = document.experiment().unwrap();
    let vehicle = experiment.vehicle.reference();
    let spec = experiment.spec().unwrap();
    let of = Loop {
        vehicle,
        belief: vehicle,
        gains: spec.gains(&experiment.vehicle).unwrap(),
        actuators: PlantSpec::default(),
    };
    let points = of.at(speed);
    assert_eq!(points.len(), 1, "{speed} m/s");
    points[0].clone()
}

/// How much a small disturbance of level flight has grown: the ratio of the root mean squares of the velocity error
/// in the last and the second quarter of the flight; 0 if it has died out, but for the roundings of single precision. The law is flown alone, and fast enough for its sampling not to count.
fn growth(document: &Document, point: &Point, lag: Option<f64>, delay: f64) -> f64 {
    let limit = lag.unwrap_or(delay);
    let mut document = document.clone();
    let mut put = |path: &str, value: Value| set(&mut document, path, value);
    // A hundred samples in the lag, and periods of growth for some 10 % off the limit to show.
    let rate = (100.0 / limit).clamp(200.0, 50_000.0);
    put("control_rate_hz", rate.into());
    put("substeps", if lag.is_none() { 4 } else { 2 }.into());
    put("duration_s", (800.0 * limit).into());
    put("sensors.position", "none".into());
    let thrust = vec![Value::Float(-1e4), Value::Float(1e4)];
    let mut put = |path: &str, value: Value| set(&mut document, path, value);
    put("plant.thrust_n", thrust.into());
    put("plant.thrust_lag_s", 0.0.into());
    put("plant.delay_s", delay.into());
    match lag {
        Some(lag) => put("plant.rate_loop.lag.time_constant_s", lag.into()),
        None => put("plant.rate_loop", "ideal".into()),
    }
    put(
        "initial.velocity_m_s",
        vec![point.speed_m_s, 0.0, 0.0].into(),
    );
    put("initial.theta_deg", (point.theta_deg + 0.1).into());
    let knots = format!(
        "knots = [{{ t_s = 0.0, down_m_s = 0.0, forward_m_s = {:?} }}]",
        point.speed_m_s
    );
    let reference: toml::Table = knots.parse().unwrap();
    put("reference", reference.into());
    // Thrust of level flight, for the time until the first command arrives.
    let vehicle = document.experiment().unwrap().vehicle.reference();
    let v = alula_sim::reference::Vector::new(0.0, point.speed_m_s);
    let theta = point.theta_deg.to_radians();
    let still = alula_sim::reference::Vector::zeros();
    let free = vehicle.acceleration(v, still, theta, 0.0);
    let level = vehicle.mass * (free.x * theta.cos() + free.y * theta.sin());
    set(&mut document, "initial.thrust_n", level);
    let experiment: Experiment = document.experiment().unwrap();

    let end = experiment.duration_s;
    let mut energy = [0.0_f64; 4];
    let mut controller = experiment.controller().unwrap();
    simulate(&experiment, controller.as_mut(), |row| {
        let quarter = ((4.0 * row.t / end) as usize).min(3);
        energy[quarter] += row.velocity_error().norm_squared();
        // Far enough: what follows is no longer small.
        row.velocity_error().norm() < 1.0
    })
    .unwrap()
    .sound()
    .unwrap();
    if energy[3] == 0.0 {
        return f64::INFINITY;
    }
    let samples = 0.25 * end * experiment.control_rate_hz;
    if (energy[3] / samples).sqrt() < DIED_OUT {
        return 0.0;
    }
    (energy[3] / energy[1]).sqrt()
}

/// Velocity error \[m/s\] of a flight at rest: some ulps of 20 m/s.
const DIED_OUT: f64 = 2e-5;

fn brackets(document: &Document, point: &Point, lag: bool) {
    let limit = if lag { point.lag_s } else { point.delay_s }.unwrap();
    let growth = |factor: f64| match lag {
        true => growth(document, point, Some(factor * limit), 0.0),
        false => growth(document, point, None, factor * limit),
    };
    let (below, above) = (growth(0.9), growth(1.1));
    assert!(below < 0.9 && above > 1.1, "{point:?}: {below} {above}");
}

/// The figures that double precision gave before this program existed.
#[test]
fn the_papers_gains_bear_the_lags_that_were_measured_before() {
    let document = exact(Some(PAPER));
    for (speed, lag) in [(5.0, 0.124), (10.0, 0.061), (16.0, 0.0055), (20.0, 0.0020)] {
        let got = point(&document, speed).lag_s.unwrap();
        assert!((got / lag - 1.0).abs() < 0.01, "{speed}: {got}");
    }
}

#[test]
fn flights_under_the_papers_gains_bracket_the_margins() {
    let document = exact(Some(PAPER));
    for speed in [5.0, 10.0, 16.0, 20.0] {
        let point = point(&document, speed);
        brackets(&document, &point, true);
        brackets(&document, &point, false);
    }
}

/// Under gains by bandwidth no lag is too long at 16 and 20 m/s: there only the delay has a limit, and a lag of 1 s dies out.
#[test]
fn flights_under_gains_by_bandwidth_bracket_the_margins() {
    let document = exact(None);
    for speed in [5.0, 10.0, 16.0, 20.0] {
        let point = point(&document, speed);
        if speed < 15.0 {
            brackets(&document, &point, true);
        } else {
            assert_eq!(point.lag_s, None);
            assert!(growth(&document, &point, Some(1.0), 0.0) < 0.1);
        }
        brackets(&document, &point, false);
    }
}
