//! Every built-in experiment in space is flown; its bounds are those of its own file.

use alula_sim::experiment::{BUILT_IN, Document, Experiment, V3};
use alula_sim::figures::Figures;
use alula_sim::simulate::{Step, fly, fly_by};
use alula_study::starts::starts;

fn document(name: &str, settings: &[&str]) -> Document {
    let mut document = Document::load(name).unwrap();
    for setting in settings {
        document.assign(setting).unwrap();
    }
    document
}

fn experiment(name: &str, settings: &[&str]) -> Experiment {
    document(name, settings).checked().unwrap()
}

fn figures_of(experiment: &Experiment) -> Figures {
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
        let experiment = document.checked().unwrap();
        // The bounds are those of the ideal plant.
        if experiment.tail_sitter.is_some() {
            continue;
        }
        flights += 1;
        let figures = figures_of(&experiment);
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
        let beyond = figures.beyond(&experiment);
        assert!(beyond.is_empty(), "{name}: {beyond:?}");
        assert_eq!(figures.get("lost"), 0.0, "{name}");
        // Measured: 5.7 m below the path where it starts off it, 0.9 m elsewhere. A flight that is lost ends tens of metres below.
        assert!(least > -8.0, "{name}: {least}");
        let turbulent = experiment.weather.turbulence.is_some();
        let end = figures.get("late_velocity_error_rms_m_s");
        // Measured: 0.65 m/s in turbulence and 0.18 m/s without, in the tightest circle.
        assert!(end < if turbulent { 1.0 } else { 0.25 }, "{name}: {end}");
    }
    assert!(flights > 15);
}

/// What is asked of flights in space stands in their files, no wider: turns, wind, hover and the turned transition.
#[test]
fn the_bounds_are_those_asked_for() {
    const RMS: [&str; 3] = [
        "velocity_error_rms_m_s",
        "position_error_rms_m",
        "sideslip_rms_deg",
    ];
    let asked: &[(&str, &[(&str, f64)])] = &[
        (
            "circle-40-slow",
            &[(RMS[0], 0.15), (RMS[1], 0.3), (RMS[2], 0.2)],
        ),
        ("circle-40", &[(RMS[0], 0.15), (RMS[1], 0.3), (RMS[2], 0.2)]),
        ("circle-33", &[(RMS[0], 0.6), (RMS[1], 0.8), (RMS[2], 0.2)]),
        ("eight", &[(RMS[0], 0.3), (RMS[1], 0.4), (RMS[2], 0.5)]),
        (
            "climbing-turn",
            &[(RMS[0], 0.1), (RMS[1], 0.3), (RMS[2], 0.1)],
        ),
        ("cross-wind", &[(RMS[0], 0.1), (RMS[1], 0.1), (RMS[2], 0.2)]),
        (
            "unknown-side-wind",
            &[(RMS[0], 0.5), (RMS[1], 1.2), (RMS[2], 3.0)],
        ),
        ("side-gust", &[(RMS[0], 0.2), (RMS[1], 0.2), (RMS[2], 2.0)]),
        ("hover-cross-wind", &[(RMS[0], 0.05)]),
        ("heading-steps", &[(RMS[0], 0.1), (RMS[1], 0.1)]),
        ("transition-turned", &[("max_velocity_error_m_s", 2.0)]),
    ];
    for (name, bounds) in asked {
        let experiment = experiment(name, &[]);
        for (figure, most) in *bounds {
            let bound = experiment.bounds.get(*figure);
            assert!(
                bound.is_some_and(|b| b <= most),
                "{name}: {figure} {bound:?}"
            );
        }
    }
}

/// Steps of 90° and 180° end at the heading asked for, and the second is turned all the way.
#[test]
fn headings_in_hover_are_reached() {
    let record = fly(&experiment("heading-steps", &[])).unwrap();
    let heading = |t: f64| {
        let step = record.iter().find(|s| s.t >= t - 1e-9).unwrap();
        let belly = step.truth.axes()[1];
        belly.y.atan2(belly.x).to_degrees().rem_euclid(360.0)
    };
    for (t, asked) in [(4.9, 0.0), (14.9, 90.0), (25.0, 270.0)] {
        let off = (heading(t) - asked + 180.0).rem_euclid(360.0) - 180.0;
        // 4e-6° of single precision.
        assert!(off.abs() < 1e-4, "{t}: {off}");
    }
    // Five seconds into a step 0.01° of 90° and 0.04° of 180° are left.
    assert!((heading(10.0) - 90.0).abs() < 0.02 && (heading(20.0) - 270.0).abs() < 0.06);
}

/// The braking out of the turn is at 2 m/s² and level: from 20 m/s to hover in 10 s, within 1.5 m of the altitude (measured 1.1) and then
/// within 0.2 m of the path (0.11).
#[test]
fn braking_out_of_a_turn_is_level() {
    let record = fly(&experiment("mission", &[])).unwrap();
    let (begin, end) = (35.708, 45.708);
    let braking = || record.iter().filter(|s| (begin..end).contains(&s.t));
    assert_eq!(braking().count(), 1000);
    for step in braking() {
        let asked = step.target.acceleration;
        assert!(
            (asked.norm() - 2.0).abs() < 1e-6 && asked.z == 0.0,
            "{}",
            step.t
        );
        assert!(
            step.altitude().abs() < 1.5,
            "{}: {}",
            step.t,
            step.altitude()
        );
    }
    let first = braking().next().unwrap();
    // It begins in the turn: 45° of bank and 20 m/s.
    assert!(first.bank().abs() > 0.7 && first.truth.velocity.norm() > 19.9);
    let after = record.iter().filter(|s| s.t > end + 3.0);
    let off = after.map(|s| s.position_error().norm()).fold(0.0, f64::max);
    assert!(off < 0.2, "{off}");
}

/// Sensors of a flight in space fail, one at a time, for some seconds of a turn: what is told is what the fault says, what is
/// noticed is said, and the circle is found again. How far off the flights are stands with each: measured, and half as much again.
#[test]
fn sensors_fail_in_a_turn() {
    use alula::guidance::{AirUse, Status};
    let with_fault = |fault: &str, during_m: f64, after_m: f64| {
        let fault = format!("sensors.faults=[{{ {fault}, from_s = 10.0, to_s = 13.0 }}]");
        let record = fly(&experiment("circle-40", &[&fault])).unwrap();
        let worst = |from: f64, to: f64| {
            let part = record.iter().filter(|s| (from..to).contains(&s.t));
            part.map(|s| s.position_error().norm()).fold(0.0, f64::max)
        };
        let (during, after) = (worst(10.0, 20.0), worst(40.0, 50.0));
        println!("{fault}: {during:.1} m, then {after:.2} m");
        let at = |t: f64| record.iter().find(|s| s.t >= t - 1e-9).unwrap().clone();
        let [most, left] = [during_m, after_m].map(|measured| 1.5 * measured);
        assert!(during < most && after < left, "{fault}: {during} {after}");
        (at(9.99), at(12.9), at(20.0))
    };
    let (before, during, after) = with_fault("kind = \"air\"", 0.1, 0.08);
    assert_eq!(before.answer.guided().unwrap().air, AirUse::Velocity);
    assert_eq!(during.answer.guided().unwrap().air, AirUse::None);
    assert_eq!(after.answer.guided().unwrap().air, AirUse::Velocity);
    let (.., during, _) = with_fault("kind = \"wind-stuck\"", 0.1, 0.08);
    assert_eq!(during.answer.guided().unwrap().air, AirUse::Wind);
    with_fault("kind = \"air-scale\", size = -0.2", 1.1, 0.09);
    with_fault("kind = \"air-drift\", size = 0.5", 0.2, 0.08);
    let (_, during, _) = with_fault("kind = \"attitude-offset\", size = 3.0", 0.4, 0.09);
    let told = during.input.sample.orientation.right();
    let [.., right] = during.truth.axes();
    let turned = f64::from(told.north) * right.x
        + f64::from(told.east) * right.y
        + f64::from(told.down) * right.z;
    // 3° about each of three axes turn the wing by √2 times that, less 5e-4° of the third order.
    let degrees = turned.acos().to_degrees();
    assert!((degrees - 18f64.sqrt()).abs() < 1e-3, "{degrees}");
    let (_, during, _) = with_fault("kind = \"position-jump\", size = 10.0", 20.6, 0.21);
    let told = f64::from(during.input.sample.position_error.unwrap().east);
    let off = told - (during.truth.position - during.target.position).y;
    assert!((off - 10.0).abs() < 1e-4, "{off}");
    let (_, during, after) = with_fault("kind = \"position-nan\"", 0.1, 0.08);
    assert!(
        during
            .answer
            .guided()
            .unwrap()
            .status
            .contains(Status::POSITION_INVALID)
    );
    assert!(
        !after
            .answer
            .guided()
            .unwrap()
            .status
            .contains(Status::POSITION_INVALID)
    );
    let (_, during, _) = with_fault("kind = \"accelerometer\"", 0.7, 0.12);
    assert!(during.input.sample.specific_force.is_none());
    let (_, during, _) = with_fault("kind = \"accelerometer-dead\"", 5.9, 0.71);
    assert_eq!(during.input.sample.specific_force, Some(Default::default()));
    with_fault("kind = \"accelerometer-drift\", size = 0.5", 0.5, 0.09);
    // A bit of the memory at every step: the spare copy undoes it, and the flight is the same.
    let (_, _, after) = with_fault("kind = \"memory-bit\"", 0.1, 0.08);
    let clean = fly(&experiment(
        "circle-40",
        &["duration_s=21.0", "settle_time_s=0.0"],
    ))
    .unwrap();
    let same = clean.iter().find(|s| s.t >= 20.0 - 1e-9).unwrap();
    assert_eq!(after.truth, same.truth);
}

/// What an accelerometer tells stands still to the bit while it is frozen, in noise that changes it at every step before and after.
#[test]
fn a_frozen_accelerometer_stands_still() {
    let settings = [
        "duration_s=4.0",
        "settle_time_s=0.0",
        "sensors.acceleration_m_s2.noise=0.1",
        "sensors.faults=[{ kind = \"accelerometer-frozen\", from_s = 1.0, to_s = 3.0 }]",
    ];
    let record = fly(&experiment("circle-40", &settings)).unwrap();
    let told = |step: &Step| step.input.sample.specific_force.unwrap();
    let changes = |from: f64, to: f64| {
        let steps = record.windows(2).filter(|w| from <= w[0].t && w[1].t < to);
        steps.filter(|w| told(&w[0]) != told(&w[1])).count()
    };
    assert_eq!(changes(1.0, 3.0 - 1e-9), 0);
    assert_eq!((changes(0.0, 1.0 - 1e-9), changes(3.0, 4.0)), (99, 99));
    // What is held is what was measured first, while the vehicle goes on to feel its turn: 1.4 g of it.
    let first = record.iter().find(|s| s.t >= 1.0 - 1e-9).unwrap();
    let last = record.iter().rfind(|s| s.t < 3.0 - 1e-9).unwrap();
    assert_eq!(told(first), told(last));
    let felt = first.load_factor
        - V3::new(
            told(first).forward.into(),
            told(first).right.into(),
            told(first).down.into(),
        )
        .norm()
            / 9.81;
    // Three standard deviations of 0.1 m/s².
    assert!(felt.abs() < 0.031, "{felt}");
}

/// To a velocity, to a place behind, and a stop on the way, told in goals alone.
#[test]
fn goals_are_reached() {
    use alula::guidance::{Goal, GoalState, Goals, Preferences};
    use alula::ned::Ned;
    use alula_sim::controllers::{Answer, Controller, Input};

    /// The experiment's controller, told goals in place of its path.
    struct ByGoals {
        controller: Box<dyn Controller>,
        goals: Goals,
        state: GoalState,
        t: f32,
    }

    impl Controller for ByGoals {
        fn answer(&mut self, input: &Input, dt: f32) -> anyhow::Result<Answer> {
            let goal = match self.t {
                t if t < 20.0 => Goal::Velocity(Ned::new(0.0, 20.0, 0.0)),
                t if t < 40.0 => Goal::Stop,
                _ => Goal::Hover(Ned::new(-60.0, -200.0, -20.0)),
            };
            self.t += dt;
            let mut input = *input;
            let sample = &mut input.sample;
            // The experiment's path stays at the origin.
            let position = sample.position_error.unwrap();
            let output = (self.goals).step(&mut self.state, &goal, position, sample.velocity, dt);
            sample.reference = output.reference;
            sample.position_error = Some(output.position_error);
            self.controller.answer(&input, dt)
        }
    }

    let hover = ["path.hover={}", "duration_s=110.0", "initial.thrust_n=98.1"];
    let experiment = experiment("space", &hover);
    let mut controller = ByGoals {
        controller: experiment.controller().unwrap(),
        goals: Goals::new(Preferences::default().speed(18.0).climb(2.0)).unwrap(),
        state: GoalState::default(),
        t: 0.0,
    };
    let record = fly_by(&experiment, &mut controller).unwrap();
    let at = |t: f64| &record[(100.0 * t) as usize].truth;
    // The velocity asked for to 1 mm/s, and a stop nearly at rest: 12 mm/s are left of it.
    assert!((at(19.9).velocity.y - 20.0).abs() < 2e-3);
    assert!(at(39.9).velocity.norm() < 0.02);
    // A stop from 20 m/s takes 26.3 m, its last half second included: one that coasts takes 165 m. Its altitude is the one at which it began.
    let stop = at(39.9).position - at(20.0).position;
    assert!(stop.xy().norm() < 28.0 && stop.z.abs() < 1e-3, "{stop}");
    let last = record.last().unwrap().truth;
    let off = last.position - V3::new(-60.0, -200.0, -20.0);
    // 1.5 mm are left of the way there.
    assert!(off.norm() < 3e-3 && last.velocity.norm() < 1e-3, "{off}");
}

/// It never slows down to cross the stall: of 20 m/s at least 14.4 are left (a crossing goes below 5). At the end it flies south, belly down.
#[test]
fn a_reversal_is_a_turn() {
    let record = fly(&experiment("reversal", &[])).unwrap();
    assert!(
        record
            .iter()
            .all(|s| (s.truth.velocity - s.wind).norm() > 13.5)
    );
    let last = record.last().unwrap();
    assert!((last.truth.velocity.x + 20.0).abs() < 1e-3 && last.truth.axes()[1].z > 0.99);
    // 74° of bank at most.
    assert!(record.iter().any(|s| s.bank().abs() > 1.2));
}

/// Hover, circle, hover in moderate turbulence, 5 m/s of wind and noise. Of 200 seeds the deepest sinks 12.0 m, of these eight 3.9 m; the nose is
/// within 29° of up at the end.
#[test]
fn missions_in_turbulence_are_not_lost() {
    for seed in 1..9 {
        let seed = format!("seed={seed}");
        let figures = figures_of(&experiment("mission-turbulence", &[&seed]));
        let least = figures.get("altitude_least_m");
        println!("{seed}: {least:.2} m");
        assert!(
            least > -6.0 && figures.get("final_nose_deg") < 45.0,
            "{seed}: {least}"
        );
    }
}

/// Of the campaign `attitudes`, 60 of each; 99.5 % of 10,000 and 30 m are asked for.
#[test]
fn random_starts_converge() {
    for name in ["start-hover", "start-cruise"] {
        let starts = starts(name, 60, None, || Ok(())).unwrap();
        for start in starts {
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
        let figures = figures_of(&experiment(name, settings));
        let [off, load] = ["max_position_error_m", "max_load_factor"].map(|n| figures.get(n));
        println!("{name} {settings:?}: {off:.1} m, load factor {load:.2}");
        (off, load)
    };
    for (x, y) in [(0.0, 2.0), (-1.4, 1.4)] {
        let (off, load) = worst("circle-33", &[&wind(x, y)]);
        // 1.0 m and 3.2 g.
        assert!(off < 1.5 && load < 3.5);
    }
    for seed in ["seed=0", "seed=1", "seed=2", "seed=3"] {
        let (off, load) = worst("circle-33", &[turbulent, "duration_s=40.0", seed]);
        // 2.0 m and 3.7 g.
        assert!(off < 3.0 && load < 4.5);
    }
    // The first seconds are the way to the circle, from any attitude. After them seven of eight are within 1.1 m and one 15 m off, with 3.2 g at most.
    let mut offs = Vec::new();
    for seed in 0..8 {
        let seed = format!("seed={seed}");
        let (off, load) = worst("circle-33", &[scatter, "settle_time_s=15.0", &seed]);
        assert!(off < 23.0 && load < 4.8);
        offs.push(off);
    }
    offs.sort_by(f64::total_cmp);
    assert!(offs[5] < 1.0, "{offs:?}");
    for (x, y) in [(0.0, 3.0), (2.1, -2.1), (5.0, 0.0)] {
        let (off, load) = worst("circle-40", &[&wind(x, y)]);
        // 6.0 m and 3.4 g.
        assert!(off < 9.0 && load < 4.5);
    }
    for seed in ["seed=271", "seed=237"] {
        let (off, load) = worst("mission-turbulence", &[seed]);
        // 7.1 m and 3.5 g.
        assert!(off < 10.5 && load < 4.5);
    }
}

/// A heading that is off its course is kept through the transition, on any course. 2 m/s are asked for with 180°. With others the
/// stall is crossed at other moments, which the wrong belief makes rough: of 60 drawn the half stay below 0.7 m/s, and the
/// worst is 3.6 m/s.
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
        figures_of(&experiment("transition-turned", &settings)).get("max_velocity_error_m_s")
    };
    for course in [7.0, 45.0, 123.0, 250.0] {
        let peak = peak(course, 180.0);
        assert!(peak < 2.0, "{course}: {peak}");
    }
    for (course, off) in [(4.0, 17.0), (45.0, 105.0), (123.0, -140.0), (250.0, 60.0)] {
        let peak = peak(course, off);
        assert!(peak < 4.0, "{course} {off}: {peak}");
    }
}

/// Starts that were once lost, or lost 27 to 58 m: the vehicle was not in its plane of flight, went there by pitch, tilt and twist, each
/// on its own, and fell meanwhile. By the shortest way none loses more than 18.1 m; at the end belly and nose are within 16°.
#[test]
fn starts_that_were_lost_converge() {
    let cruise = [
        9892, 186, 561, 1422, 1188, 4154, 8997, 3324, 7908, 834, 11059, 13089, 4640, 23835,
    ];
    for seed in cruise {
        let figures = figures_of(&experiment("start-cruise", &[&format!("seed={seed}")]));
        let least = figures.get("altitude_least_m");
        assert!(
            least > -24.0 && figures.get("final_belly_deg") < 30.0,
            "{seed}: {least}"
        );
    }
    for seed in [21619, 3201] {
        let figures = figures_of(&experiment("start-hover", &[&format!("seed={seed}")]));
        let least = figures.get("altitude_least_m");
        assert!(
            least > -12.0 && figures.get("final_nose_deg") < 30.0,
            "{seed}: {least}"
        );
    }
}

/// Without an accelerometer what is believed wrongly of the wing is found by the integral alone, which a turn turns away
/// from. What is left of the error chooses crossings of the stall on some courses: of twelve, begun 30° apart, six keep 0.4 m/s
/// (rms), and the others are 0.7 to 3.3 m/s off; the deepest sinks 7.9 m. Which ones cross is decided by little: of 36 courses 17
/// keep 0.4 m/s, and the mean is 1.1 m/s.
#[test]
fn a_circle_without_an_accelerometer() {
    let mut errors: Vec<f64> = (0..12)
        .map(|n| {
            let course = format!("initial.course_deg={}.0", 30 * n);
            let none = "sensors.accelerometer='none'";
            let figures = figures_of(&experiment("circle-40", &[none, &course]));
            let least = figures.get("altitude_least_m");
            assert!(least > -12.0, "{course}: {least}");
            figures.get("velocity_error_rms_m_s")
        })
        .collect();
    errors.sort_by(f64::total_cmp);
    let mean = errors.iter().sum::<f64>() / 12.0;
    assert!(
        errors[5] < 0.5 && errors[11] < 5.0 && mean < 1.5,
        "{errors:?}"
    );
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
        assert_eq!(step.input.sample.air, Air::Unknown);
        assert!(
            step.input.sample.specific_force.is_none()
                && step.input.sample.position_error.is_none()
        );
    }
    // White noise of 0.05 m/s on each component, over 51 steps: four standard deviations of 0.005 m/s.
    let noise = |s: &Step| f64::from(s.input.sample.velocity.north) - s.truth.velocity.x;
    let mean = record.iter().map(|s| noise(s).powi(2)).sum::<f64>() / record.len() as f64;
    assert!((0.03..0.07).contains(&mean.sqrt()), "{mean}");
}

/// A lag, and inertia under torques far beyond what is needed, are the same loop; the delay acts.
#[test]
fn actuators_act() {
    let inertia = "plant.rate_loop={ inertia = { moment_of_inertia_kg_m2 = [0.8, 0.4, 0.6], \
        bandwidth_1_s = 10.0, max_torque_n_m = [500.0, 500.0, 500.0] } }";
    let end = |settings: &[&str]| {
        let settings = [settings, &["duration_s=3.0", "settle_time_s=0.0"]].concat();
        let record = fly(&experiment("circle-40", &settings)).unwrap();
        record.last().unwrap().truth.position
    };
    let lag = end(&[]);
    // The same but for rounding: 1.4e-14 m.
    let off = (end(&[inertia]) - lag).norm();
    assert!(off < 1e-10, "{off}");
    // 0.08 m by 30 ms of delay, 0.16 m by no lag.
    assert!((end(&["plant.delay_s=0.03"]) - lag).norm() > 0.05);
    assert!((end(&["plant.rate_loop=\"ideal\"", "plant.thrust_lag_s=0.0"]) - lag).norm() > 0.1);
}

#[test]
fn wrong_fields_are_refused_by_file_line_and_name() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mine.toml");
    let refused = |line: &str, message: &str| {
        let text = format!("base = \"circle-40\"\nduration_s = 30.0\n{line}\n");
        std::fs::write(&file, text).unwrap();
        let document = Document::load(file.to_str().unwrap());
        let error = document.and_then(|d| d.checked()).unwrap_err();
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
    refused("settle_time_s = 40.0", "settle_time_s: must be from 0");
    refused(
        "vehicle.mass_kg = -1",
        "vehicle.mass_kg: mass must be positive, from 0.001 to 1000000 kg",
    );
    refused(
        "weather.steady_m_s = [1.0, 2.0]",
        "weather.steady_m_s: has 2 numbers, must be [north, east, down]",
    );
    refused(
        "weather.gust = { start_s = 1.0, duration_s = 0.0, peak_m_s = [1.0, 0.0, 0.0] }",
        "weather.gust.duration_s: must",
    );
    refused(
        "sensors.theta_deg.noise = 1.0",
        "sensors.theta_deg: unknown field `theta_deg`",
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
        "controller.guidance.max_lateral_acceleration_g = -1.0",
        "controller.guidance.max_lateral_acceleration_g: max_lateral_acceleration",
    );
    refused(
        "initial.scatter = { velocity_m_s = -1.0, rate_rad_s = 1.0 }",
        "initial.scatter.velocity_m_s: must",
    );
    refused(
        "bounds.altitude = 3.0",
        "bounds.altitude: altitude is not the name of a figure",
    );
    refused(
        "sensors.faults = [{ kind = \"air-drift\", from_s = 1.0, to_s = 2.0 }]",
        "sensors.faults[0].size: this kind has a size",
    );
    refused("reference.knots = []", "reference.knots: must have");
}
