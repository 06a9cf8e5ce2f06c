//! Wind, hover, heading and transition. Bounds are the requirement's.

use std::f64::consts::PI;

use super::course::{self, Course};
use super::scenario::{Sample, Setup, Target, V3, Wind, cruise, hover, report, rms, with};

/// Cruise to the north at 20 m/s through a gust that begins at 10 s; figures from then on, for 20 s.
fn through(name: &str, gust: &str, known: Wind) -> [f64; 3] {
    let setup = Setup {
        wind_known: known,
        ..Setup::new()
    };
    let mut course = Course::new(course::north, 20.0);
    let samples = setup.fly(&mut course, 30.0, &with(cruise(20.0), [gust]));
    report(name, &samples, 10.0)
}

#[test]
fn an_unknown_side_wind_is_found_out() {
    let gust = "weather.gust={ start_s = 10.0, duration_s = inf, peak_m_s = [0.0, 6.0, 0.0] }";
    let [velocity, position, sideslip] = through(
        "unknown side wind, step of 6 m/s",
        gust,
        Wind::Only(V3::zeros()),
    );
    assert!(velocity <= 0.5 && position <= 1.2 && sideslip <= 3.0);
}

#[test]
fn a_known_side_gust_is_flown_through() {
    let gust = "weather.gust={ start_s = 10.0, duration_s = 4.0, peak_m_s = [0.0, 8.0, 0.0] }";
    let [velocity, position, sideslip] = through("known side gust of 8 m/s", gust, Wind::All);
    assert!(velocity <= 0.2 && position <= 0.2 && sideslip <= 2.0);
}

/// Stays at the origin, with this heading as a function of time.
fn stay(heading: impl Fn(f64) -> f64) -> impl FnMut(f64) -> Target {
    move |t| Target {
        heading: Some(heading(t)),
        ..Target::default()
    }
}

#[test]
fn hover_in_a_cross_wind() {
    let windy = with(hover(0.0), ["weather.steady_m_s=[0.0, 8.0, 0.0]"]);
    let samples = Setup::new().fly(&mut stay(|_| 0.0), 40.0, &windy);
    let [velocity, ..] = report("hover, 8 m/s of cross wind", &samples, 15.0);
    assert!(velocity <= 0.05);
}

/// The last sample's heading is `want` \[rad\] to 1°.
fn faces(samples: &[Sample], want: f64) {
    let d = samples[samples.len() - 1].heading - want;
    assert!(d.cos() > 1.0_f64.to_radians().cos(), "{d}");
}

#[test]
fn heading_steps_in_hover() {
    for (name, step) in [
        ("heading step of 90°, hover", 0.5 * PI),
        ("heading step of 180°, hover", PI),
    ] {
        let mut task = stay(|t| if t < 5.0 { 0.0 } else { step });
        let samples = Setup::new().fly(&mut task, 15.0, &hover(0.0));
        let [velocity, ..] = report(name, &samples, 5.0);
        assert!(velocity <= 0.1);
        faces(&samples, step);
    }
}

/// From hover to 20 m/s northward at 2 m/s², the belly behind to begin with: `off` \[°\] from north. The heading is
/// held there, or free.
fn transition(name: &str, off: f64, held: bool) -> f64 {
    let heading = off.to_radians();
    let mut task = |t: f64| {
        let ramp = t.min(10.0);
        let along = |x: f64| V3::new(x, 0.0, 0.0);
        Target {
            position: along(ramp * ramp + 20.0 * (t - ramp)),
            velocity: along(2.0 * ramp),
            acceleration: along(if t < 10.0 { 2.0 } else { 0.0 }),
            heading: held.then_some(heading),
            ..Target::default()
        }
    };
    let samples = Setup::new().fly(&mut task, 25.0, &hover(heading));
    report(name, &samples, 0.0);
    // In cruise the belly is down: turned the right way up.
    let last = samples[samples.len() - 1];
    assert!(last.belly_down > 0.99 && rms(&samples, 20.0, |s| s.velocity_error) < 0.1);
    samples.iter().map(|s| s.velocity_error).fold(0.0, f64::max)
}

#[test]
fn transition_with_the_heading_behind() {
    assert!(transition("transition, heading 179° off and held", 179.0, true) <= 2.0);
    assert!(transition("transition, belly 179° off, heading free", 179.0, false) <= 2.0);
    // Exactly behind is an equilibrium of the twist, and left late: at 13 m/s, where turning the wing through the wind
    // costs more. Measured 2.65 m/s.
    assert!(transition("transition, heading 180.00° off and held", 180.0, true) <= 3.0);
}

/// The lowest altitude over the start \[m\] on a circle of 40 m at 20 m/s over ground, in 5 m/s of wind and turbulence of
/// this wind at 20 ft \[m/s\]; over eight seeds.
fn lowest_in_turbulence(name: &str, wind_at_20_ft: f64, known: Wind) -> f64 {
    let mut lowest = f64::INFINITY;
    for seed in 0..8 {
        let setup = Setup {
            wind_known: known,
            ..Setup::new()
        };
        let mut course = Course::new(course::circle_40, 20.0);
        let turbulence = format!(
            "weather.turbulence={{ wind_at_20_ft_m_s = {wind_at_20_ft:?}, height_m = 50.0 }}"
        );
        let settings = [&format!("seed={seed}"), STEADY_WIND, &turbulence];
        let samples = setup.fly(&mut course, 60.0, &with(cruise(20.0), settings));
        report(&format!("{name} {seed}"), &samples, 10.0);
        lowest = samples.iter().map(|s| s.altitude).fold(lowest, f64::min);
    }
    lowest
}

const STEADY: V3 = V3::new(0.0, 5.0, 0.0);
const STEADY_WIND: &str = "weather.steady_m_s=[0.0, 5.0, 0.0]";

/// Airspeeds are from 10 to 30 m/s in moderate turbulence, the folds at 15 and 17 m/s among them; and a constant ground
/// speed asks for 1.6 m/s² of braking, where drag gives 0.6. Measured 2.8 m below the start at most: what is lost goes on
/// down. (Moderate turbulence that is not measured is too much: see `docs/three-dimensions.md`.)
#[test]
fn a_circle_in_turbulence_is_not_lost() {
    let measured = lowest_in_turbulence("moderate turbulence, measured", 15.4, Wind::All);
    let light = lowest_in_turbulence("light turbulence, unmeasured", 7.7, Wind::Only(STEADY));
    assert!(measured > -5.0 && light > -5.0, "{measured} {light}");
}

/// With torques behind the rates the figures are those of the lag.
#[test]
fn a_circle_with_bounded_torques() {
    let torques = "plant.rate_loop={ inertia = { moment_of_inertia_kg_m2 = [0.8, 0.4, 0.6], bandwidth_1_s = 10.0, \
                   max_torque_n_m = 15.0 } }";
    let mut course = Course::new(course::circle_40, 20.0);
    let samples = Setup::new().fly(&mut course, 40.0, &with(cruise(20.0), [torques]));
    let [velocity, position, sideslip] =
        report("circle 40 m, 20 m/s, torques within 15 N m", &samples, 10.0);
    assert!(velocity <= 0.15 && position <= 0.3 && sideslip <= 0.2);
}
