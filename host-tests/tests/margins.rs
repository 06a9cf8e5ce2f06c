//! The linear margins against flights: a lag, or a delay, a tenth below the limit dies out, a tenth above it grows.

use alula_sil::margins::{Loop, Point};
use alula_sil::mission::{GainChoiceSpec, Mission, MissionSource, RateLoop, fly};

/// The round trip's vehicle, known exactly, under these gains.
fn exact(gains: Option<&str>) -> Mission {
    let mut mission = MissionSource::load("round-trip").unwrap().mission;
    let guidance = mission.controller.guidance_mut().unwrap();
    guidance.vehicle = None;
    if let Some(gains) = gains {
        guidance.gains = GainChoiceSpec::Constant(toml::from_str(gains).unwrap());
    }
    mission
}

const PAPER: &str = "k1 = 0.1529\nk2 = 0.0234\nk3 = 6.0\ntau_n = 80.0";

/// The only equilibrium at `speed`.
fn point(mission: &Mission, speed: f64) -> Point {
    let vehicle = mission.vehicle.plant_vehicle();
    let of = Loop {
        vehicle,
        belief: vehicle,
        gains: mission.controller.guidance().unwrap().gains,
    };
    let points = of.at(speed);
    assert_eq!(points.len(), 1, "{speed} m/s");
    points[0].clone()
}

/// How much a small disturbance of level flight has grown: the ratio of the root mean squares of the velocity error
/// in the last and the second quarter of the flight; 0 if it has died out, but for the roundings of single precision. The law is flown alone, and fast enough for its sampling not to count.
fn growth(mission: &Mission, point: &Point, lag: Option<f64>, delay: f64) -> f64 {
    let limit = lag.unwrap_or(delay);
    let mut mission = mission.clone();
    // A hundred samples in the lag, and periods of growth for some 10 % off the limit to show.
    mission.control_rate_hz = (100.0 / limit).clamp(200.0, 50_000.0);
    mission.substeps = if lag.is_none() { 4 } else { 2 };
    mission.duration_s = 800.0 * limit;
    let guidance = mission.controller.guidance_mut().unwrap();
    guidance.position.gain_1_s = [0.0; 2];
    guidance.position.measured = false;
    guidance.limits.rate_rad_s = 1e3;
    guidance.limits.slew_rad_s2 = 1e6;
    guidance.limits.thrust_n = [-1e4, 1e4];
    guidance.reference.acceleration_m_s2 = 1e3;
    mission.plant.thrust_n = [-1e4, 1e4];
    mission.plant.thrust_lag_s = 0.0;
    mission.plant.delay_s = delay;
    mission.plant.rate_loop = lag.map(|time_constant_s| RateLoop::Lag { time_constant_s });
    mission.initial.forward_m_s = point.speed_m_s;
    mission.initial.theta_deg = point.theta_deg + 0.1;
    let knot = &mut mission.reference.knots[0];
    (knot.t_s, knot.forward_m_s) = (0.0, point.speed_m_s);
    mission.reference.knots.truncate(1);
    // Thrust of level flight, for the time until the first command arrives.
    let vehicle = mission.vehicle.plant_vehicle();
    let v = alula_sil::reference::Vector::new(0.0, point.speed_m_s);
    let theta = point.theta_deg.to_radians();
    let still = alula_sil::reference::Vector::zeros();
    let free = vehicle.acceleration(v, still, theta, 0.0);
    mission.initial.thrust_n = vehicle.mass * (free.x * theta.cos() + free.y * theta.sin());
    mission.validate().unwrap();

    let end = mission.duration_s;
    let mut energy = [0.0_f64; 4];
    fly(&mission, |row| {
        let quarter = ((4.0 * row.t / end) as usize).min(3);
        energy[quarter] += row.velocity_error().norm_squared();
        // Far enough: what follows is no longer small.
        row.velocity_error().norm() < 1.0
    });
    if energy[3] == 0.0 {
        return f64::INFINITY;
    }
    let samples = 0.25 * end * mission.control_rate_hz;
    if (energy[3] / samples).sqrt() < DIED_OUT {
        return 0.0;
    }
    (energy[3] / energy[1]).sqrt()
}

/// Velocity error \[m/s\] of a flight at rest: some ulps of 20 m/s.
const DIED_OUT: f64 = 2e-5;

fn brackets(mission: &Mission, point: &Point, lag: bool) {
    let limit = if lag { point.lag_s } else { point.delay_s }.unwrap();
    let growth = |factor: f64| match lag {
        true => growth(mission, point, Some(factor * limit), 0.0),
        false => growth(mission, point, None, factor * limit),
    };
    let (below, above) = (growth(0.9), growth(1.1));
    assert!(below < 0.9 && above > 1.1, "{point:?}: {below} {above}");
}

/// The figures that double precision gave before this program existed.
#[test]
fn the_papers_gains_bear_the_lags_that_were_measured_before() {
    let mission = exact(Some(PAPER));
    for (speed, lag) in [(5.0, 0.124), (10.0, 0.061), (16.0, 0.0055), (20.0, 0.0020)] {
        let got = point(&mission, speed).lag_s.unwrap();
        assert!((got / lag - 1.0).abs() < 0.01, "{speed}: {got}");
    }
}

#[test]
fn flights_under_the_papers_gains_bracket_the_margins() {
    let mission = exact(Some(PAPER));
    for speed in [5.0, 10.0, 16.0, 20.0] {
        let point = point(&mission, speed);
        brackets(&mission, &point, true);
        brackets(&mission, &point, false);
    }
}

/// Under gains by bandwidth no lag is too long at 16 and 20 m/s: there only the delay has a limit, and a lag of 1 s dies out.
#[test]
fn flights_under_gains_by_bandwidth_bracket_the_margins() {
    let mission = exact(None);
    for speed in [5.0, 10.0, 16.0, 20.0] {
        let point = point(&mission, speed);
        if speed < 15.0 {
            brackets(&mission, &point, true);
        } else {
            assert_eq!(point.lag_s, None);
            assert!(growth(&mission, &point, Some(1.0), 0.0) < 0.1);
        }
        brackets(&mission, &point, false);
    }
}
