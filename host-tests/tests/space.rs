//! Every built-in experiment in space is flown; its bounds are those of its own file.

use alula_sil::experiment::{BUILT_IN, Document};
use alula_sil::space::{Experiment, Figures, fly};
use alula_sil::study::starts::starts;

fn document(name: &str, settings: &[&str]) -> Document {
    let mut document = Document::load(name).unwrap();
    for setting in settings {
        document.assign(setting).unwrap();
    }
    document
}

fn experiment(name: &str, settings: &[&str]) -> Experiment {
    Experiment::of(&document(name, settings)).unwrap()
}

fn flown(experiment: &Experiment) -> Figures {
    Figures::of(experiment, &fly(experiment).unwrap())
}

#[test]
fn every_built_in_keeps_its_bounds() {
    let mut flights = 0;
    for (name, _) in BUILT_IN {
        let document = document(name, &[]);
        if document.get("path").is_none() {
            continue;
        }
        flights += 1;
        let experiment = Experiment::of(&document).unwrap();
        let figures = flown(&experiment);
        let values = [
            "velocity_error_rms_m_s",
            "position_error_rms_m",
            "sideslip_rms_deg",
        ];
        let [velocity, position, sideslip] = values.map(|name| figures.get(name));
        let [least, peak] = ["altitude_least_m", "max_velocity_error_m_s"].map(|n| figures.get(n));
        println!(
            "| `{name}` | {velocity:.2} | {position:.2} | {sideslip:.2} | {peak:.2} | {least:.2} |"
        );
        if let Some((figure, value, bound)) = figures.beyond(&experiment).first() {
            panic!("{name}: {figure} {value} > {bound}");
        }
        assert_eq!(figures.get("lost"), 0.0, "{name}");
        assert!(least > -10.0, "{name}: {least}");
        let turbulent = experiment.weather.turbulence.is_some();
        let end = figures.get("late_velocity_error_m_s");
        assert!(end < if turbulent { 5.0 } else { 0.5 }, "{name}: {end}");
    }
    assert!(flights > 15);
}

/// It never slows down to cross the stall: the speed is what the errors leave of 20 m/s. At the end it flies south, belly down.
#[test]
fn a_reversal_is_a_turn() {
    let record = fly(&experiment("reversal", &[])).unwrap();
    assert!(
        record
            .iter()
            .all(|s| (s.truth.velocity - s.wind).norm() > 12.0)
    );
    let last = record.last().unwrap();
    assert!(last.truth.velocity.x < -19.0 && last.truth.axes()[1].z > 0.99);
    assert!(record.iter().any(|s| s.bank().abs() > 0.7));
}

/// Hover, circle, hover in moderate turbulence, 5 m/s of wind and noise. Of 200 seeds the deepest sinks 14.8 m.
#[test]
fn missions_in_turbulence_are_not_lost() {
    for seed in 1..9 {
        let seed = format!("seed={seed}");
        let figures = flown(&experiment("mission-turbulence", &[&seed]));
        let least = figures.get("altitude_least_m");
        println!("{seed}: {least:.2} m");
        assert!(
            least > -20.0 && figures.get("final_nose_deg") < 45.0,
            "{seed}: {least}"
        );
    }
}

/// Of the campaign `attitudes`, 60 of each; 99.5 % of 10,000 and 30 m are asked for.
#[test]
fn random_starts_converge() {
    for name in ["start-hover", "start-cruise"] {
        let flown = starts(name, 60, None, || Ok(())).unwrap();
        for start in flown {
            assert!(
                start.converged && start.height_lost_m < 30.0,
                "{name} {start:?}"
            );
        }
    }
}

/// Turning and crossing the stall get in each other's way where a crossing is taken for cheap: these flights crossed again and
/// again, up to 164 m off their path and with load factors of up to 18.
#[test]
fn turns_in_wind_do_not_end_in_the_stall() {
    let wind = |x: f64, y: f64| format!("weather.steady_m_s=[{x:.1}, {y:.1}, 0.0]");
    let turbulent = "weather.turbulence={ wind_at_20_ft_m_s = 7.7, height_m = 50.0 }";
    let scatter = "initial.scatter={ velocity_m_s = 5.0, rate_rad_s = 2.0 }";
    let worst = |name: &str, settings: &[&str]| {
        let figures = flown(&experiment(name, settings));
        let [off, load] = ["max_position_error_m", "max_load_factor"].map(|n| figures.get(n));
        println!("{name} {settings:?}: {off:.1} m, load factor {load:.2}");
        (off, load)
    };
    for (x, y) in [(0.0, 2.0), (-1.4, 1.4)] {
        let (off, load) = worst("circle-33", &[&wind(x, y)]);
        assert!(off < 3.0 && load < 3.5);
    }
    for seed in ["seed=0", "seed=1", "seed=2", "seed=3"] {
        let (off, load) = worst("circle-33", &[turbulent, "duration_s=40.0", seed]);
        assert!(off < 10.0 && load < 5.0);
        // The first seconds are the way to the circle, from any attitude.
        let (off, load) = worst("circle-33", &[scatter, "entry_s=15.0", seed]);
        assert!(off < 30.0 && load < 5.0);
    }
    for (x, y) in [(0.0, 3.0), (2.1, -2.1), (5.0, 0.0)] {
        let (off, load) = worst("circle-40", &[&wind(x, y)]);
        assert!(off < 10.0 && load < 5.0);
    }
    for seed in ["seed=271", "seed=237"] {
        let (off, load) = worst("mission-turbulence", &[seed]);
        assert!(off < 25.0 && load < 5.0);
    }
}

/// A heading that is off its course is kept through the transition, on any course. 2 m/s are asked for with 180°. With others the
/// stall is crossed at other moments, which the wrong belief makes rough: of 100 drawn the half stay below 1.5 m/s, and the
/// worst is 4.9 m/s.
#[test]
fn a_transition_keeps_any_heading_on_any_course() {
    let peak = |course: f64, off: f64| {
        let set = |path: &str, x: f64| format!("{path}={x:.1}");
        let heading = course + off;
        let settings = [
            set("path.legs[0].course_deg", course),
            set("path.legs[0].heading_deg", heading),
            set("path.legs[1].heading_deg", heading),
            set("initial.heading_deg", heading),
        ];
        let settings: Vec<&str> = settings.iter().map(String::as_str).collect();
        flown(&experiment("transition-turned", &settings)).get("max_velocity_error_m_s")
    };
    for course in [7.0, 45.0, 123.0, 250.0] {
        let peak = peak(course, 180.0);
        assert!(peak < 2.0, "{course}: {peak}");
    }
    for (course, off) in [(4.0, 17.0), (45.0, 105.0), (123.0, -140.0), (250.0, 60.0)] {
        let peak = peak(course, off);
        assert!(peak < 5.5, "{course} {off}: {peak}");
    }
}

/// Starts that were once lost, or nearly: the virtual flight was in a plane that the vehicle was not in.
#[test]
fn starts_that_were_lost_converge() {
    for seed in ["seed=9892", "seed=186", "seed=561", "seed=1422"] {
        let figures = flown(&experiment("start-cruise", &[seed]));
        let least = figures.get("altitude_least_m");
        assert!(
            least > -30.0 && figures.get("final_belly_deg") < 80.0,
            "{seed}: {least}"
        );
    }
}

/// The same seed gives the same start and the same flight, another one another.
#[test]
fn a_flight_is_a_function_of_its_seed() {
    let fly = |seed: &str| {
        let settings = [seed, "duration_s=1.0"];
        let record = fly(&experiment("start-cruise", &settings)).unwrap();
        (record[0].truth, record.last().unwrap().truth)
    };
    assert_eq!(fly("seed=7"), fly("seed=7"));
    let (a, b) = (fly("seed=7"), fly("seed=8"));
    assert!(a.0.attitude.angle_to(&b.0.attitude) > 1e-3 && a.1 != b.1);
}

/// Without what is measured of the air, and without an accelerometer, the guidance is told just that.
#[test]
fn what_is_not_measured_is_not_told() {
    use alula::guidance::Air;
    let settings = [
        "duration_s=0.5",
        "sensors.air=\"none\"",
        "sensors.position=\"none\"",
        "sensors.accelerometer=\"none\"",
    ];
    let record = fly(&experiment("mission-turbulence", &settings)).unwrap();
    for step in &record {
        assert_eq!(step.input.air, Air::Unknown);
        assert!(step.input.specific_force.is_none() && step.input.position_error.is_none());
    }
    // White noise of 0.05 m/s on each component, over 51 steps.
    let noise = |s: &alula_sil::space::Step| f64::from(s.input.velocity.north) - s.truth.velocity.x;
    let mean = record.iter().map(|s| noise(s).powi(2)).sum::<f64>() / record.len() as f64;
    assert!((0.03..0.07).contains(&mean.sqrt()), "{mean}");
}

/// A lag, and inertia under torques far beyond what is needed, are the same loop; the delay acts.
#[test]
fn actuators_act() {
    let inertia = "plant.rate_loop={ inertia = { inertia_kg_m2 = [0.6, 0.4, 0.8], \
        bandwidth_1_s = 10.0, torque_max_n_m = [500.0, 500.0, 500.0] } }";
    let end = |settings: &[&str]| {
        let settings = [settings, &["duration_s=3.0", "entry_s=0.0"]].concat();
        let record = fly(&experiment("circle-40", &settings)).unwrap();
        record.last().unwrap().truth.position
    };
    let lag = end(&[]);
    // The same but for rounding, which the guidance in single precision makes more of.
    let off = (end(&[inertia]) - lag).norm();
    assert!(off < 1e-3, "{off}");
    assert!((end(&["plant.delay_s=0.03"]) - lag).norm() > 1e-2);
    assert!((end(&["plant.rate_loop=\"ideal\"", "plant.thrust_lag_s=0.0"]) - lag).norm() > 1e-2);
}

#[test]
fn wrong_fields_are_refused_by_file_line_and_name() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mine.toml");
    let refused = |line: &str, message: &str| {
        let text = format!("base = \"circle-40\"\nduration_s = 30.0\n{line}\n");
        std::fs::write(&file, text).unwrap();
        let document = Document::load(file.to_str().unwrap());
        let error = document.and_then(|d| Experiment::of(&d)).unwrap_err();
        let (error, place) = (format!("{error:#}"), format!("{}:3: ", file.display()));
        let rest = error.strip_prefix(&place);
        assert!(
            rest.is_some_and(|rest| rest.starts_with(message)),
            "{error}"
        );
    };
    refused("path.circle.radius = 3.0", "path.circle");
    refused(
        "path.circle.radius_m = -3.0",
        "path.circle.radius_m: must be positive",
    );
    refused("path.spiral.radius_m = 3.0", "path");
    refused("entry_s = 40.0", "entry_s: must be from 0");
    refused(
        "vehicle.mass_kg = -1",
        "vehicle.mass_kg: mass must be positive",
    );
    refused(
        "weather.steady_m_s = [1.0, 2.0]",
        "weather.steady_m_s: invalid length 2",
    );
    refused(
        "weather.gust = { start_s = 1.0, duration_s = 0.0, peak_m_s = [1.0, 0.0, 0.0] }",
        "weather.gust.duration_s: must",
    );
    refused(
        "sensors.theta_deg.noise = 1.0",
        "sensors.theta_deg: unknown field",
    );
    refused(
        "sensors.attitude_deg.noise = -1.0",
        "sensors.attitude_deg.noise: must not",
    );
    refused(
        "plant.thrust_n = [3.0, 2.0]",
        "plant.thrust_n: must be [least, most]",
    );
    refused(
        "controller.guidance.max_turn_g = -1.0",
        "controller.guidance.max_turn_g: max_turn",
    );
    refused(
        "controller.law.form = \"full\"",
        "controller.law: unknown field",
    );
    refused(
        "initial.scatter = { velocity_m_s = -1.0, rate_rad_s = 1.0 }",
        "initial.scatter.velocity_m_s: must",
    );
    refused("bounds.altitude = 3.0", "bounds.altitude: is no figure");
    refused("reference.knots = []", "reference: unknown field");
}
