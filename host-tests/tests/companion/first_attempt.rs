//! First attempts on simulated autopilots with the loops, ramps and parameters of the real ones: what was lost there is lost here, found before it is
//! flown, and not lost once it is changed.

use std::cell::Cell;

use alula::guidance::Air;
use alula_bridges::companion::messages::AttitudeTargetTypemask;
use alula_bridges::companion::preflight::{Streams, judge};
use alula_bridges::companion::{
    Autopilot, Believed, Body, Command, End, Finding, HOLD, Kind, MavMessage, Nudge, Parameters,
    Pilot, Preflight, Settings, Stage, TERMINATION, Told, Weight, is_go,
};
use alula_design::{Actuators, Design, Known};
use alula_sil::companion::{
    ARDUPLANE_SHIPPED, Craft, Lead, OnPath, PX4_SHIPPED, believed, px4_rate_law, settings,
};
use alula_sim::experiment::{Document, Experiment};
use alula_sim::plant::tail_sitter::Belief;

use super::link::{ARDUPLANE, Channel, GOOD, as_it_is, flies_with, nothing};

/// PX4's gains for three vehicles: of elevons those that follow their slipstream in hover, found by less and less feed-forward and more and more P. They have no
/// integral in the multicopter state: what holds against the wing is P, and the nudge says whether it does.
const SMALL: &str = "FW_PR_P 0.066\nFW_PR_FF 0\nFW_RR_P 0.044\nFW_RR_FF 0\n";
const MAPPING: &str = "FW_PR_P 0.13\nFW_PR_FF 0.02\nFW_RR_P 0.065\nFW_RR_FF 0\nMC_ROLLRATE_P 0.4\n";
const BIPLANE: &str = "MC_ROLLRATE_P 0.5\nMC_ROLLRATE_I 0.3\nMC_ROLLRATE_D 0\nMC_PITCHRATE_P 0.25\nMC_PITCHRATE_I 0.3\nMC_PITCHRATE_D 0.004\nMC_YAWRATE_P 0.6\nMC_YAWRATE_I 0.3\n";
/// Those with which PX4's own simulated tail-sitter flew. Here its motors are of propellers.
const XVERT: [&str; 2] = [
    "THR_MDL_FAC 1",
    include_str!("../../../examples/px4/sihsim_xvert.params"),
];
const QACRO: &str = include_str!("../../../examples/ardupilot/qacro.parm");
const ALULA: &str = include_str!("../../../examples/ardupilot/alula.parm");
const OFFBOARD: &str = include_str!("../../../examples/px4/offboard.params");

fn parameters(texts: &[&str]) -> Parameters {
    let all = texts
        .iter()
        .map(|text| Parameters::from_text(text).unwrap());
    all.reduce(|first, others| first.or(others)).unwrap()
}

/// From hover to `speed` [m/s] at 2 m/s², and back in a climb of 20 m, of a vehicle as it is, with an autopilot's sensors in still air.
fn there_and_back(vehicle: &str, speed: f64, changes: &[&str]) -> Experiment {
    let there = 3.0 + 0.5 * speed;
    let back = there + 8.0;
    let knots = [
        (3.0, 0.0, 0.0),
        (there, 0.0, speed),
        (back, 0.0, speed),
        (back + 3.0, -3.5, 0.7 * speed),
        (back + 5.0, -3.5, 0.5 * speed),
        (back + 10.0, 0.0, 0.0),
    ];
    along(vehicle, &knots, changes)
}

/// Along these knots, time \[s\], velocity down and forward [m/s], and 16 s of hover, of a vehicle as it is, with an autopilot's sensors.
fn along(vehicle: &str, knots: &[(f64, f64, f64)], changes: &[&str]) -> Experiment {
    let mut document = Document::load("tail-sitter-hover").unwrap();
    let (last, ..) = knots[knots.len() - 1];
    let knots: Vec<String> = knots
        .iter()
        .map(|(t, down, forward)| {
            format!("{{t_s={t:?},down_m_s={down:?},forward_m_s={forward:?}}}")
        })
        .collect();
    for change in [
        format!("plant.vehicle={vehicle}"),
        format!("reference.knots=[{}]", knots.join(",")),
        format!("duration_s={:?}", last + 16.0),
    ]
    .iter()
    .map(String::as_str)
    .chain(changes.iter().copied())
    {
        document.assign(change).unwrap();
    }
    document.checked().unwrap()
}

/// How a flight came out: how it ended, how far it sank under where it began \[m\], how far it was below and above what was asked \[m\], and what was found of
/// the loop.
struct Flown {
    end: Stage,
    off: [f64; 2],
    /// The autopilot's mode, and whether it saw a failure.
    mode: u32,
    failed: bool,
    sank: f64,
    findings: Vec<Finding>,
}

fn fly(experiment: &Experiment, kind: Kind, parameters: &Parameters, despite: bool) -> Flown {
    fly_with(experiment, kind, parameters, despite, as_it_is, nothing)
}

/// The vehicle of `experiment` with the rate loop of an autopilot with these parameters.
fn under(experiment: &Experiment, kind: Kind, parameters: &Parameters) -> Experiment {
    let mut experiment = experiment.clone();
    if let (Some(plant), Kind::Px4) = (&mut experiment.tail_sitter, kind) {
        plant.vehicle.rate_loop.law = px4_rate_law(parameters, plant.vehicle.mixer);
    }
    experiment
}

/// The same with messages made into others, and with events.
fn fly_with(
    experiment: &Experiment,
    kind: Kind,
    parameters: &Parameters,
    despite: bool,
    sent: impl Fn(MavMessage, &Craft) -> MavMessage,
    event: impl FnMut(f64, &mut Autopilot<Craft>, &mut Channel),
) -> Flown {
    let experiment = under(experiment, kind, parameters);
    fly_as_believed(
        &experiment,
        &experiment,
        kind,
        parameters,
        despite,
        sent,
        event,
    )
}

/// The same of a vehicle of which the guidance believes what is `believed`.
fn fly_as_believed(
    believed: &Experiment,
    experiment: &Experiment,
    kind: Kind,
    parameters: &Parameters,
    despite: bool,
    sent: impl Fn(MavMessage, &Craft) -> MavMessage,
    mut event: impl FnMut(f64, &mut Autopilot<Craft>, &mut Channel),
) -> Flown {
    let craft = Craft::new(experiment).unwrap();
    let mut pilot = OnPath::new(believed, Lead::Path(None))
        .unwrap()
        .nudged(kind, 0.12, despite);
    let mut settings = Settings {
        kind,
        ..settings(believed, None).unwrap()
    };
    settings.duration += Nudge::DURATION;
    let (lowest, first, mut failed) = (Cell::new(0.0_f64), Cell::new(None), false);
    let look = |craft: &Craft| {
        let down = craft.spatial().position.z;
        let from = first.get().unwrap_or(down);
        first.set(Some(from));
        lowest.set(lowest.get().max(down - from));
    };
    let duration = settings.duration + 6.0;
    let ended = flies_with(
        &mut pilot,
        Autopilot::new(craft, kind).with_parameters(parameters.clone()),
        (settings, duration),
        (GOOD, 0),
        sent,
        |t, autopilot, channel| {
            event(t, autopilot, channel);
            // In the flight: afterwards the vehicle is held by nobody.
            failed |= autopilot.has_failed() && kind.is_commanded(autopilot.mode());
            // Nobody flies it any more, and it falls.
            if autopilot.mode() == TERMINATION {
                look(autopilot.body());
            }
        },
        |_, _, craft| look(craft),
    );
    let off = pilot.record().iter();
    let off = off.map(|step| step.target.position.z - step.truth.position.z);
    let off = off.fold([0.0_f64; 2], |[low, high], up| [low.min(up), high.max(up)]);
    Flown {
        end: ended.stage,
        off,
        mode: ended.mode,
        failed,
        sank: lowest.get(),
        findings: pilot.findings().to_vec(),
    }
}

/// The limits that `new` gave a vehicle whose authority it did not ask for.
const WIDE: [&str; 2] = [
    "controller.guidance.max_rate_rad_s=2.8",
    "controller.guidance.max_slew_rad_s2=37.5",
];

/// Three vehicles of which a person asks `new`: the file, its section, what turns it, and the speed of cruise [m/s]. The small one is a plate.
type Asked = (&'static str, &'static str, Actuators, f64);
const OF_SMALL: Asked = ("small-flying-wing", "flat-plate", Actuators::Elevons, 8.0);
const OF_MAPPING: Asked = ("mapping", "naca-0012", Actuators::Elevons, 14.0);
const OF_BIPLANE: Asked = ("biplane", "naca-0012", Actuators::Motors, 14.0);

/// How far from the truth people measure: mass, sizes, thrust and inertia, drag areas, which are estimated, and what a log shows.
const WEIGHED: f64 = 0.01;
const SIZED: f64 = 0.03;
const PULLED: f64 = 0.05;
const ESTIMATED: f64 = 0.3;
const READ: f64 = 0.1;

/// Age of the state \[s\] that preflight says over this link.
const AGE: f64 = 0.02;

/// What a person answers of a vehicle under an autopilot with these parameters, as the page has it measured: each number off by as much as people are.
fn answers(
    (vehicle, section, actuators, speed): Asked,
    kind: Kind,
    parameters: &Parameters,
    mut off: impl FnMut(f64) -> f64,
) -> Known {
    let flown = under(&there_and_back(vehicle, speed, &[]), kind, parameters);
    let lag = lag_read(&flown);
    let plant = flown.tail_sitter.unwrap().measured();
    let belief = Belief::of(&plant);
    let weight = 9.81 * plant.mass_kg;
    let turned = &belief.authority;
    // In hover differences are what the greatest thrust leaves.
    let room = (belief.thrust_max_n / weight - 1.0).min(1.0);
    let turn = turned.slipstream_rad_s2 + room * turned.difference_rad_s2;
    let mut measured = |value: f64, within: f64| Some(value * off(within));
    Known {
        mass_kg: measured(plant.mass_kg, WEIGHED),
        wing_m2: measured(belief.k_a_kg_m / 0.6125, SIZED),
        section: Some(section.to_owned()),
        aspect_ratio: measured(plant.wing.aspect_ratio, SIZED),
        thrust_to_weight: measured(belief.thrust_max_n / weight, PULLED),
        // Over a link the age of the state is added to both.
        thrust_lag_s: measured(belief.thrust_lag_s + AGE, READ),
        rate_lag_s: measured(lag + AGE, READ),
        turn_rad_s2: measured(turn, READ),
        drag_area_m2: measured(plant.drag_area_m2[0], ESTIMATED),
        actuators: Some(actuators),
        propeller_m: Some(plant.propellers[0].diameter_m),
        cruise_m_s: Some(speed),
        ..Known::default()
    }
}

/// Who measures without an error.
fn exactly(_: f64) -> f64 {
    1.0
}

/// Who is off by up to as much as people are, drawn.
fn as_people_do(mut random: impl rand::Rng) -> impl FnMut(f64) -> f64 {
    use rand::RngExt;
    move |within| 1.0 + within * (2.0 * random.random::<f64>() - 1.0)
}

/// A vehicle with the guidance, and on the flight, that `new` makes of what is `known` of it: hover, out, and back as `new` has it brake. It is the round trip of `new`
/// with a shorter cruise.
fn first_flight(vehicle: &str, known: Known) -> Experiment {
    let design = Design::new(known.facts().unwrap()).unwrap();
    let (design, _) = design.as_it_brakes("known");
    let made = design.document("known").unwrap().checked().unwrap();
    let mut knots = made.path.knots().unwrap().0.clone();
    // Of its half a minute of cruise 8 s, and of its minute of hover 16 s.
    let less = knots[2].t_s - knots[1].t_s - 8.0;
    for knot in &mut knots[2..] {
        knot.t_s -= less;
    }
    let knots = knots.iter();
    let knots: Vec<(f64, f64, f64)> = knots.map(|k| (k.t_s, k.down_m_s, k.forward_m_s)).collect();
    let plant = along(vehicle, &knots, &[]);
    Experiment {
        tail_sitter: plant.tail_sitter,
        sensors: plant.sensors,
        path: plant.path,
        duration_s: plant.duration_s,
        ..made
    }
}

/// What `new` makes of a small flying wing of which a person reads that it turns with `turn` \[rad/s²\] in hover, from what its page asks; with none what it made
/// before it asked: limits of a vehicle of full authority.
fn by_new(speed: f64, turn: Option<f64>, parameters: &Parameters) -> Experiment {
    let (vehicle, section, actuators, _) = OF_SMALL;
    let asked = (vehicle, section, actuators, speed);
    let mut known = answers(asked, Kind::Px4, parameters, exactly);
    known.turn_rad_s2 = turn.or(known.turn_rad_s2);
    let design = Design::new(known.facts().unwrap()).unwrap();
    let (design, _) = design.as_it_brakes("small");
    let mut document = design.document("small").unwrap();
    if turn.is_none() {
        for change in WIDE.into_iter().chain(["vehicle.authority={}"]) {
            document.assign(change).unwrap();
        }
    }
    let plant = there_and_back(vehicle, speed, &[]);
    Experiment {
        tail_sitter: plant.tail_sitter,
        sensors: plant.sensors,
        ..document.checked().unwrap()
    }
}

/// Time \[s\] until 63 % of a step of 1 rad/s in pitch, in hover, are in the log that the page has a person read: the mean of one up and one down.
fn lag_read(flown: &Experiment) -> f64 {
    let dt = 0.001;
    let lag = |step: f64| {
        let mut craft = Craft::new(flown).unwrap();
        let hover = craft.hover();
        for _ in 0..1000 {
            craft.step(hover, [0.0; 3], dt);
        }
        let reached = (0..500).find(|_| {
            craft.step(hover, [0.0, step, 0.0], dt);
            craft.state().rates[1] / step >= 0.63
        });
        dt * f64::from(reached.unwrap_or(500) + 1)
    };
    0.5 * (lag(1.0) + lag(-1.0))
}

/// The greatest angular acceleration in pitch \[rad/s²\] that the page has a person read in a log: of steps of 2 rad/s in hover, there and back.
fn turn_read(experiment: &Experiment, parameters: &Parameters) -> f64 {
    let flown = under(experiment, Kind::Px4, parameters);
    let mut craft = Craft::new(&flown).unwrap();
    let (hover, dt) = (craft.hover(), 0.002);
    let (mut most, mut filtered, mut last) = (0.0_f64, 0.0, 0.0);
    for step in 0..600 {
        let asked = match step {
            0..300 => 0.0,
            300..450 => 2.0,
            _ => -2.0,
        };
        craft.step(hover, [0.0, asked, 0.0], dt);
        let rate = craft.state().rates[1];
        filtered += (1.0 - (-dt / 0.03_f64).exp()) * ((rate - last) / dt - filtered);
        last = rate;
        most = most.max(filtered.abs());
    }
    most
}

/// `new` did not ask what turns a vehicle, and lost it: with PX4's feed-forward of the elevons at half of what is shipped the small flying wing falls by tens and hundreds
/// of metres, and with what `new` makes of the turn that a log shows it does not, the nudges of the loop aside.
#[test]
fn limits_that_ask_for_no_authority_lose_the_vehicle() {
    const HALF: &str = "FW_PR_FF 0.2\nFW_RR_FF 0.2\n";
    let gains = "FW_PR_P 0.066\nFW_RR_P 0.088\n";
    let parameters = parameters(&[HALF, gains, OFFBOARD, PX4_SHIPPED]);
    for speed in [8.0, 10.0, 12.0] {
        let wide = by_new(speed, None, &parameters);
        let turn = turn_read(&wide, &parameters);
        let asked = by_new(speed, Some(turn), &parameters);
        let [wide, asked] = [wide, asked].map(|e| fly(&e, Kind::Px4, &parameters, true));
        println!(
            "{speed} m/s: {:.1} m down; {turn:.0} rad/s² known, {:.1} m",
            wide.sank, asked.sank
        );
        // Lost is 20 m.
        assert!(wide.sank > 20.0, "{speed} m/s: {}", wide.sank);
        assert!(asked.sank < 10.0, "{speed} m/s: {}", asked.sank);
        assert_eq!(asked.end, Stage::Ended(End::Finished));
    }
}

/// PX4's own simulated tail-sitter, whose damping holds the rate at the stop of its elevons, flies with the gains that it flew with there. There a step of the
/// pitch rate was had by 87 %, and with a feed-forward of 0.4 by 197 %.
#[test]
fn px4s_own_tail_sitter_flies_with_the_gains_it_had() {
    let experiment = there_and_back("xvert", 12.0, &[]);
    let [outputs, gains] = XVERT;
    let suited = parameters(&[outputs, gains, OFFBOARD, PX4_SHIPPED]);
    let flown = fly(&experiment, Kind::Px4, &suited, false);
    println!("{:.1} m, {:?}", flown.sank, flown.findings);
    assert!(is_go(&flown.findings), "{:?}", flown.findings);
    assert_eq!(flown.end, Stage::Ended(End::Finished));
    assert!(flown.sank < 2.0, "{}", flown.sank);
    let more = "FW_PR_P 0.03\nFW_PR_FF 0.4\n";
    let more = parameters(&[more, outputs, gains, OFFBOARD, PX4_SHIPPED]);
    let refused = fly(&experiment, Kind::Px4, &more, false);
    assert!(!is_go(&refused.findings), "{:?}", refused.findings);
}

/// With PX4's gains as shipped the elevons of both vehicles are driven to their stops: at the worst of four speeds they leave their height by more than twice as
/// much as with gains that suit. The nudge says so, and they are not flown; with gains that suit their slipstream they fly at the first attempt, and sink by less
/// than the 2 m that are wanted: elevons have no integral.
#[test]
fn gains_as_shipped_are_found_in_hover() {
    use rayon::prelude::*;
    for (vehicle, cruise, gains) in [
        ("small-flying-wing", 8.0, SMALL),
        ("mapping", 14.0, MAPPING),
    ] {
        let shipped = parameters(&[OFFBOARD, PX4_SHIPPED]);
        let suited = parameters(&[gains, OFFBOARD, PX4_SHIPPED]);
        let speeds: Vec<f64> = (0..4)
            .map(|n| cruise * (0.85 + 0.1 * f64::from(n)))
            .collect();
        let off: Vec<[f64; 2]> = speeds
            .par_iter()
            .map(|&speed| {
                let experiment = there_and_back(vehicle, speed, &[]);
                let refused = fly(&experiment, Kind::Px4, &shipped, false);
                assert!(!is_go(&refused.findings), "{:?}", refused.findings);
                let flies = fly(&experiment, Kind::Px4, &suited, false);
                assert!(is_go(&flies.findings), "{:?}", flies.findings);
                assert_eq!(flies.end, Stage::Ended(End::Finished));
                assert!(flies.sank < 2.0, "{vehicle}, {speed} m/s: {}", flies.sank);
                let despite = fly(&experiment, Kind::Px4, &shipped, true);
                [flies, despite].map(|flown| flown.off[1] - flown.off[0])
            })
            .collect();
        println!("{vehicle}: with gains that suit, and as shipped despite the refusal {off:.1?} m");
        let [flies, despite] = [0, 1].map(|of| off.iter().map(|off| off[of]).fold(0.0, f64::max));
        assert!(despite > 2.0 * flies, "{vehicle}: {off:?}");
    }
}

/// A pilot whom nobody tells of the air.
struct Untold(OnPath);

impl Pilot for Untold {
    fn begin(&mut self, told: &Told, heading: f32, last: Command) {
        self.0.begin(told, heading, last);
    }

    fn answer(&mut self, told: &Told, dt: f32) -> Result<Command, End> {
        let air = Air::Unknown;
        self.0.answer(&Told { air, ..*told }, dt)
    }

    fn is_over(&self) -> bool {
        self.0.is_over()
    }
}

/// A vehicle that leans against a wind of which nobody tells is first turned upright, and drifts. That is no swing of its loops: with the first nudge 1.2 s after the
/// take-over the small wings in 0.8 and 2.5 m/s are refused for one.
#[test]
fn a_vehicle_that_leans_against_the_wind_is_taken_over() {
    for (vehicle, gains, winds) in [
        // Up to the wind that `hover_wind` says. `mapping` is left out: in some winds it nods, however it was taken over.
        ("small-flying-wing", SMALL, [0.8, 1.5, 2.5]),
        // In 2.4 m/s less than 40 % of a rate about the nose is had: propellers' torque is weak.
        ("biplane", BIPLANE, [0.5, 1.0, 1.5]),
    ] {
        let parameters = parameters(&[gains, OFFBOARD, PX4_SHIPPED]);
        for wind in winds.into_iter().flat_map(|wind| [wind, -wind]) {
            let mut document = Document::load("tail-sitter-hover").unwrap();
            for change in [
                format!("plant.vehicle={vehicle}"),
                format!("weather.steady_m_s=[{wind:?},0.0,0.0]"),
                "initial.heading_deg=0.0".to_owned(),
                format!("duration_s={:?}", Nudge::DURATION + 4.0),
            ] {
                document.assign(&change).unwrap();
            }
            // As an autopilot holds it: as the guidance does that is told of the wind.
            let held = alula_sim::simulate::fly(&document.checked().unwrap()).unwrap();
            let held = &held.last().unwrap().truth;
            for (field, value) in [
                ("theta_deg", held.theta().to_degrees()),
                ("thrust_n", held.thrust),
            ] {
                document
                    .assign(&format!("initial.{field}={value:?}"))
                    .unwrap();
            }
            let experiment = under(&document.checked().unwrap(), Kind::Px4, &parameters);
            let pilot = OnPath::new(&experiment, Lead::Path(None)).unwrap();
            let mut pilot = Untold(pilot.nudged(Kind::Px4, 0.12, true));
            let settings = settings(&experiment, None).unwrap();
            let duration = settings.duration;
            let craft = Craft::new(&experiment).unwrap();
            let lean = craft.spatial().theta().to_degrees();
            assert!(lean * wind > 5.0 * wind.abs(), "{lean}");
            flies_with(
                &mut pilot,
                Autopilot::new(craft, Kind::Px4).with_parameters(parameters.clone()),
                (settings, duration),
                (GOOD, 0),
                as_it_is,
                nothing,
                |_, _, _| (),
            );
            let findings = pilot.0.findings();
            assert!(!findings.is_empty());
            assert!(is_go(findings), "{vehicle}, {wind} m/s: {findings:?}");
        }
    }
}

/// A feed-forward has what is asked in hover, and holds nothing: with a third of the P that suits, mapping follows every nudge, and where it brakes its wing turns
/// the nose. The nudge says so, by the lag. With the P that suits, and a guidance that turns a quarter slower, it flies.
#[test]
fn a_loop_of_feed_forward_is_found_in_hover() {
    let suited = parameters(&[MAPPING, OFFBOARD, PX4_SHIPPED]);
    let known = answers(OF_MAPPING, Kind::Px4, &suited, exactly);
    let flight = first_flight("mapping", known);
    let with = |gains: &str, flight: &Experiment| {
        let parameters = parameters(&[gains, MAPPING, OFFBOARD, PX4_SHIPPED]);
        fly_as_believed(
            flight,
            &under(flight, Kind::Px4, &parameters),
            Kind::Px4,
            &parameters,
            true,
            as_it_is,
            nothing,
        )
    };
    let fed_forward = with("FW_PR_P 0.035\nFW_PR_FF 0.04", &flight);
    println!("{:?} {:?}", fed_forward.off, fed_forward.findings);
    let refused: Vec<&Finding> = fed_forward
        .findings
        .iter()
        .filter(|f| f.weight == Weight::NoGo)
        .collect();
    // It swings for want of P, too; nothing says less.
    assert!(!refused.is_empty());
    for found in refused {
        let change = found.change.as_ref().unwrap();
        assert!(change.starts_with("FW_PR_P: more"), "{found:?}");
    }
    // The guidance's own loop about it is too fast for its servos, and swings: a quarter less is said, and done.
    let mut slower = flight.clone();
    let table = &mut slower.controller.table;
    let frequency = table.get_mut("natural_frequency_rad_s").unwrap();
    *frequency = (0.75 * frequency.as_float().unwrap()).into();
    let stiff = with("", &slower);
    println!("{:?} {:?}", stiff.off, stiff.findings);
    assert!(is_go(&stiff.findings));
    let [yields, holds] = [fed_forward, stiff].map(|flown| flown.off[1] - flown.off[0]);
    // What is refused leaves its height by more than twice as much as what flies.
    assert!(holds < 10.0 && yields > 2.0 * holds, "{holds} {yields}");
}

/// PX4's outputs as shipped go to motors whose thrust is their square, and so do ArduPlane's without Q_M_THST_EXPO: a change of thrust is had twice. The nudge of
/// the thrust says so, and preflight that it may be, where PX4's parameter is another.
#[test]
fn a_thrust_that_is_not_proportional_is_found_in_hover() {
    let experiment = there_and_back("mapping", 14.0, &[]);
    let (px4, plane) = ([MAPPING, OFFBOARD, PX4_SHIPPED], [QACRO, ARDUPLANE_SHIPPED]);
    for (kind, name, factor, flies) in [
        (Kind::Px4, "THR_MDL_FAC", 0.0, false),
        (Kind::Px4, "THR_MDL_FAC", 1.0, true),
        (ARDUPLANE, "Q_M_THST_EXPO", 0.0, false),
        (ARDUPLANE, "Q_M_THST_EXPO", 0.65, true),
        (ARDUPLANE, "Q_M_THST_EXPO", 1.0, true),
    ] {
        let set = format!("{name} {factor:?}\n");
        let others = match kind {
            Kind::Px4 => &px4[..],
            Kind::ArduPlane(_) => &plane[..],
        };
        let parameters = parameters(&[&[set.as_str()], others].concat());
        let flown = fly(&experiment, kind, &parameters, false);
        let thrust = flown.findings.iter().find(|f| f.what.starts_with("thrust"));
        let thrust = thrust.expect("forces are told");
        assert_eq!(thrust.weight == Weight::NoGo, !flies, "{set}{thrust:?}");
        let change = thrust.change.as_deref().unwrap_or(name);
        assert!(change.contains(name), "{thrust:?}");
        assert_eq!(is_go(&flown.findings), flies, "{set}{:?}", flown.findings);
        assert!(flown.sank < 2.0, "{set}{}", flown.sank);
        let preflight = judge(
            kind,
            &parameters,
            &Streams::default(),
            &believed(&experiment, 0.5).unwrap(),
        );
        let remark = preflight.iter().find(|f| f.what.starts_with(name));
        let of_px4 = kind == Kind::Px4 && !flies;
        assert_eq!(remark.map(|f| f.weight), of_px4.then_some(Weight::Remark));
        // What is right of it the nudge says, and says which way it is wrong.
        assert!(remark.is_none_or(|f| !f.change.as_ref().unwrap().contains("THR_MDL_FAC 1")));
        let more = thrust.change.as_ref().map(|way| way.contains("more"));
        assert_eq!(more, (!flies).then_some(true), "{set}{thrust:?}");
    }
}

/// ArduPlane's ramps of 300 °/s² as shipped are refused by name: a nudge is too small to show them. Flown in spite of that, up to 10 of 24 flights of the mapping
/// tail-sitter sink by 3 to 40 m: which of them is chance. With the parameters of the page none sinks by 3 m, at whatever speed.
#[test]
fn ramps_as_shipped_are_refused_and_those_of_the_page_flown() {
    let shipped = parameters(&[ARDUPLANE_SHIPPED]);
    let wide = there_and_back("mapping", 14.0, &WIDE);
    let ramps = "Q_A_ACCEL_P_MAX";
    let refuses = |parameters: &Parameters| {
        let of = believed(&wide, 0.5).unwrap();
        judge(ARDUPLANE, parameters, &Streams::default(), &of)
            .iter()
            .any(|f| f.weight == Weight::NoGo && f.what.starts_with(ramps))
    };
    assert!(refuses(&shipped));
    let paged = parameters(&[QACRO, ARDUPLANE_SHIPPED]);
    assert!(!refuses(&paged));
    for speed in [12.5, 13.7, 14.4, 15.2] {
        let experiment = there_and_back("mapping", speed, &[]);
        let flown = fly(&experiment, ARDUPLANE, &paged, false);
        assert!(is_go(&flown.findings), "{:?}", flown.findings);
        assert_eq!(flown.end, Stage::Ended(End::Finished));
        println!("page, {speed} m/s: {:.1} m", flown.sank);
        assert!(flown.sank < 3.0, "{speed} m/s: {}", flown.sank);
    }
}

/// The preflight finds what flights were lost by, over a link, and nothing once the files of the page are loaded; ArduPlane arms with them.
#[test]
fn preflight_finds_what_flights_were_lost_by() {
    let experiment = there_and_back("small-flying-wing", 8.0, &[]);
    let hover = settings(&experiment, None).unwrap().hover_thrust;
    let believed = believed(&experiment, hover.into()).unwrap();
    let look = |kind: Kind, parameters: Parameters| {
        let craft = Craft::new(&experiment).unwrap();
        let mut autopilot = Autopilot::new(craft, kind).with_parameters(parameters);
        let arms = autopilot.refuses_to_arm().is_none();
        let mut preflight = Preflight::new(kind, believed);
        let (mut down, mut up) = (Channel::new(GOOD, 1), Channel::new(GOOD, 2));
        for step in 0..10_000 {
            let now = f64::from(step) * 0.002;
            for message in autopilot.send(now) {
                down.send(now, Autopilot::<Craft>::HEADER, &message);
            }
            for (header, message) in down.receive(now) {
                preflight.receive(now, &header, &message);
            }
            for message in preflight.step(now) {
                up.send(now, preflight.header(), &message);
            }
            for (header, message) in up.receive(now) {
                autopilot.receive(now, &header, &message);
            }
            if let Some(findings) = preflight.findings(now) {
                return (findings, arms);
            }
        }
        panic!("it never ends");
    };
    let hover = format!("MPC_THR_HOVER {hover}\nQ_M_THST_HOVER {hover}\n");
    for (kind, shipped, files, lost) in [
        (
            Kind::Px4,
            PX4_SHIPPED,
            vec![OFFBOARD, &hover],
            vec!["VT_ELEV_MC_LOCK is 1"],
        ),
        (
            ARDUPLANE,
            ARDUPLANE_SHIPPED,
            vec![QACRO, ALULA, &hover],
            vec!["Q_A_ACCEL_P_MAX is 30000", "Q_M_SPIN_ARM is 0.1"],
        ),
    ] {
        let (findings, _) = look(kind, parameters(&[shipped]));
        let no_go: Vec<&Finding> = findings
            .iter()
            .filter(|f| f.weight == Weight::NoGo)
            .collect();
        for lost in lost {
            let finding = no_go.iter().find(|f| f.what.starts_with(lost));
            assert!(
                finding.is_some_and(|f| f.change.is_some()),
                "{lost}: {no_go:?}"
            );
        }
        let files: Vec<&str> = files.into_iter().chain([shipped]).collect();
        let (findings, arms) = look(kind, parameters(&files));
        assert!(is_go(&findings) && arms, "{findings:?}");
    }
    // A transmitter's file for the rates alone does not arm.
    let (_, arms) = look(
        ARDUPLANE,
        parameters(&["Q_M_SPIN_MIN 0.05", ARDUPLANE_SHIPPED]),
    );
    assert!(!arms);
}

/// A set-point of body rates as one of an attitude that leads by them, as the module sends it to PX4's attitude loop.
fn by_attitude(message: MavMessage, craft: &Craft) -> MavMessage {
    let MavMessage::SET_ATTITUDE_TARGET(mut m) = message else {
        return message;
    };
    // Half of the lead: PX4's MC_ROLL_P, MC_PITCH_P and MC_YAW_P.
    let lead = [
        m.body_roll_rate / 8.0,
        m.body_pitch_rate / 8.0,
        m.body_yaw_rate / 5.6,
    ];
    let lead = nalgebra::Vector3::from(lead.map(f64::from));
    let lead = nalgebra::Quaternion::from_parts((1.0 - lead.norm_squared()).sqrt(), lead);
    let [w, x, y, z] = craft.state().quaternion;
    let q = nalgebra::Quaternion::new(w, x, y, z) * lead;
    m.q = [q.w, q.i, q.j, q.k].map(|c| c as f32);
    m.type_mask = AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_BODY_ROLL_RATE_IGNORE
        | AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_BODY_PITCH_RATE_IGNORE
        | AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_BODY_YAW_RATE_IGNORE;
    MavMessage::SET_ATTITUDE_TARGET(m)
}

/// PX4's failure detector: by attitude set-points the flight ends on the way to cruise, and by rates where the pilot takes over there. The preflight refuses
/// both and says what to change, and with that they are flown. With the circuit breaker as shipped PX4 warns.
#[test]
fn the_failure_detector_is_refused_before_it_ends_a_flight() {
    let experiment = there_and_back("mapping", 14.0, &[]);
    let shipped = parameters(&[MAPPING, OFFBOARD, PX4_SHIPPED]);
    let armed = parameters(&["CBRK_FLIGHTTERM 0", MAPPING, OFFBOARD, PX4_SHIPPED]);
    let mended = parameters(&[
        "CBRK_FLIGHTTERM 0\nFD_FAIL_P 0\nFD_FAIL_R 0",
        MAPPING,
        OFFBOARD,
        PX4_SHIPPED,
    ]);
    let hover = settings(&experiment, None).unwrap().hover_thrust;
    let found = |parameters: &Parameters, attitudes: bool| {
        let believed = Believed {
            attitudes,
            ..believed(&experiment, hover.into()).unwrap()
        };
        let all = judge(Kind::Px4, parameters, &Streams::default(), &believed);
        all.into_iter().find(|f| f.what.starts_with("FD_FAIL"))
    };
    for attitudes in [true, false] {
        let refused = found(&armed, attitudes).unwrap();
        assert_eq!(refused.weight, Weight::NoGo, "{refused:?}");
        let change = refused.change.unwrap();
        assert!(
            change.starts_with("FD_FAIL_P 0 and FD_FAIL_R 0"),
            "{change}"
        );
        assert_eq!(found(&shipped, attitudes).unwrap().weight, Weight::Remark);
        assert_eq!(found(&mended, attitudes), None);
    }
    let by_attitudes = |parameters| {
        fly_with(
            &experiment,
            Kind::Px4,
            parameters,
            true,
            by_attitude,
            nothing,
        )
    };
    let lost = by_attitudes(&armed);
    assert_eq!(lost.mode, TERMINATION);
    assert!(lost.sank > 20.0, "{}", lost.sank);
    for (parameters, warned) in [(&shipped, true), (&mended, false)] {
        let flown = by_attitudes(parameters);
        println!("by attitudes: {:.1} m, {:?}", flown.sank, flown.end);
        assert_eq!(flown.failed, warned);
        assert_eq!(flown.end, Stage::Ended(End::Finished));
        assert!(flown.sank < 3.0, "{}", flown.sank);
    }
    // The pilot takes over in cruise, 20 s into the flight and what comes before it.
    let taken_over = |parameters| {
        let take_over = |t: f64, autopilot: &mut Autopilot<Craft>, _: &mut Channel| {
            if (t - 20.0).abs() < 1e-6 {
                autopilot.set_mode(HOLD);
            }
        };
        fly_with(
            &experiment,
            Kind::Px4,
            parameters,
            true,
            as_it_is,
            take_over,
        )
    };
    assert_eq!(taken_over(&armed).mode, TERMINATION);
    for parameters in [&shipped, &mended] {
        assert_eq!(taken_over(parameters).mode, HOLD);
    }
    // By rates PX4 does not look.
    let rates = fly(&experiment, Kind::Px4, &armed, false);
    assert_eq!(
        (rates.failed, rates.end),
        (false, Stage::Ended(End::Finished))
    );
}

/// Another throttle in hover than the vehicle's file says is no-go, and so are streams that are slow or late.
#[test]
fn preflight_judges_hover_and_streams() {
    let experiment = there_and_back("mapping", 14.0, &[]);
    let believed = believed(&experiment, 0.5).unwrap();
    let good = Streams {
        attitude_hz: 50.0,
        motion_hz: 50.0,
        force_hz: 50.0,
        age_s: 0.04,
    };
    let verdict = |hover: &str, streams: Streams| {
        is_go(&judge(
            Kind::Px4,
            &parameters(&[hover, OFFBOARD]),
            &streams,
            &believed,
        ))
    };
    assert!(verdict("MPC_THR_HOVER 0.5", good));
    assert!(!verdict("MPC_THR_HOVER 0.3", good));
    assert!(!verdict(
        "MPC_THR_HOVER 0.5",
        Streams {
            attitude_hz: 10.0,
            ..good
        }
    ));
    assert!(!verdict(
        "MPC_THR_HOVER 0.5",
        Streams { age_s: 0.3, ..good }
    ));
    // Without an accelerometer it flies.
    assert!(verdict(
        "MPC_THR_HOVER 0.5",
        Streams {
            force_hz: 0.0,
            ..good
        }
    ));
}

/// A factor within `most`, drawn.
fn factor(random: &mut impl rand::Rng, most: f64) -> f64 {
    use rand::RngExt;
    most.powf(2.0 * random.random::<f64>() - 1.0)
}

/// Whether it was let pass, how far it was below and above what was asked \[m\], and how far it sank \[m\].
type Attempt = (bool, [f64; 2], f64);

/// The gains of PX4's rate loops.
const LOOPS: [&str; 5] = [
    "FW_PR_",
    "FW_RR_",
    "MC_ROLLRATE_",
    "MC_PITCHRATE_",
    "MC_YAWRATE_",
];

/// The first attempt of a vehicle of which a person was `asked`, that flies with `gains`: those of the autopilot and lags are within the factor `most` of those
/// that suit, drawn, and the guidance does not know of it.
fn attempt((asked, gains): (Asked, &str), kind: Kind, most: f64, seed: u64) -> Attempt {
    use rand::SeedableRng;
    let suited = match kind {
        Kind::Px4 => parameters(&[gains, OFFBOARD, PX4_SHIPPED]),
        Kind::ArduPlane(_) => parameters(&[QACRO, ARDUPLANE_SHIPPED]),
    };
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    let mut drawn = suited.clone();
    for (name, value) in suited.iter() {
        if LOOPS.iter().any(|family| name.starts_with(family)) {
            drawn.set(name, (factor(&mut random, most) * value) as f32);
        }
    }
    // Of another stream: those of the gains stay what they were.
    let mut person = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    person.set_stream(1);
    let known = answers(asked, kind, &suited, as_people_do(person));
    let (vehicle, ..) = asked;
    let believed = first_flight(vehicle, known);
    let mut flown = under(&believed, kind, &drawn);
    let plant = flown.tail_sitter.as_mut().unwrap();
    plant.vehicle.motors.lag_s *= factor(&mut random, most);
    plant.vehicle.servo.lag_s *= factor(&mut random, most);
    if kind != Kind::Px4 {
        // ArduPlane's rate loop is that of the experiment.
        plant.unknown.rate_gain = factor(&mut random, most);
    }
    let flight = fly_as_believed(&believed, &flown, kind, &drawn, true, as_it_is, nothing);
    (is_go(&flight.findings), flight.off, flight.sank)
}

/// A small wing that swings at its slowest cruise, where its rate loop has 0.56 to 0.64 of the gain that suits, is not held by the stall. It was taken for held,
/// gathered speed and climbed by 14 to 18 m.
#[test]
fn who_swings_in_cruise_is_not_held() {
    for seed in [203, 212, 216] {
        let (go, [below, above], _) = attempt((OF_SMALL, SMALL), ARDUPLANE, 2.0, seed);
        assert!(go && below > -2.0 && above < 2.0, "{seed}: {below} {above}");
    }
}

/// The first seed, if `FIRST_SEED` does not say another. On those before it the bounds of the nudge were set and what `new` assumes was looked at.
const SEED: u64 = 120;

/// Gains and lags within a factor of two of those that suit, and of four, drawn, of which the guidance does not know; the vehicle brakes as `new` has it. What
/// the nudge lets pass is not lost within a factor of two: nine in ten are within 2 m of their height. All are flown, in spite of what it says.
/// `FIRST_ATTEMPTS` of each.
/// Prints the table of the page.
#[test]
#[ignore = "slow: cargo test-slow"]
fn slow_no_first_attempt_is_lost() {
    use rayon::prelude::*;
    let draws = std::env::var("FIRST_ATTEMPTS").ok();
    let draws: u64 = draws.and_then(|n| n.parse().ok()).unwrap_or(2);
    let first = std::env::var("FIRST_SEED").ok();
    let first: u64 = first.and_then(|n| n.parse().ok()).unwrap_or(SEED);
    println!(
        "| vehicle | autopilot | factor | flown | below [m], median, 95 %, most | above [m], median, 95 %, most | refused | of these held | sank by 20 m |"
    );
    println!("|---|---|---:|---:|---:|---:|---:|---:|---:|");
    let mut off_height: Vec<f64> = Vec::new();
    for ((asked, gains), (name, kind), most) in [
        (OF_SMALL, SMALL),
        (OF_MAPPING, MAPPING),
        (OF_BIPLANE, BIPLANE),
    ]
    .into_iter()
    .flat_map(|of| [("PX4", Kind::Px4), ("ArduPlane", ARDUPLANE)].map(|kind| (of, kind)))
    .flat_map(|(of, kind)| [2.0, 4.0].map(|most| (of, kind, most)))
    {
        let (vehicle, ..) = asked;
        let flights: Vec<Attempt> = (first..first + draws)
            .into_par_iter()
            .map(|seed| attempt((asked, gains), kind, most, seed))
            .collect();
        let (flown, refused): (Vec<Attempt>, Vec<Attempt>) =
            flights.into_iter().partition(|(go, ..)| *go);
        let of = |side: usize| {
            let mut all: Vec<f64> = flown.iter().map(|(_, off, _)| off[side].abs()).collect();
            all.sort_by(f64::total_cmp);
            let last = all.len().saturating_sub(1) as f64;
            let at = |share: f64| all.get((last * share).round() as usize);
            [0.5, 0.95, 1.0]
                .map(|share| at(share).map_or("–".to_owned(), |off| format!("{off:.1}")))
                .join(", ")
        };
        let held = |(_, [low, high], _): &&Attempt| *low > -2.0 && *high < 2.0;
        let held = refused.iter().filter(held).count();
        let lost = |of: &[Attempt]| of.iter().filter(|f| f.2 > 20.0).count();
        println!(
            "| {vehicle} | {name} | {most} | {} | {} | {} | {} | {held} | {}, {} |",
            flown.len(),
            of(0),
            of(1),
            refused.len(),
            lost(&flown),
            lost(&refused)
        );
        if most == 2.0 {
            assert_eq!(lost(&flown), 0, "{vehicle}, {name}: {flown:?}");
            let off = flown.iter().map(|(_, [low, high], _)| high.max(-low));
            off_height.extend(off);
        }
    }
    // Nine in ten, less two deviations of as many draws.
    let count = off_height.len() as f64;
    let near = off_height.iter().filter(|off| **off < 2.0).count() as f64;
    println!("{near} of {count} within 2 m, of a factor of two");
    assert!(
        near >= 0.9 * count - 2.0 * (0.09 * count).sqrt(),
        "{off_height:?}"
    );
}
