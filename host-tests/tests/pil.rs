//! The image under QEMU: the same bits as in this process, and no others, whatever the link does.
//!
//! Ignored by a plain `cargo test`, which asks for no emulator: `cargo pil-check` runs them.
#![cfg(not(target_os = "none"))]

use std::collections::{HashMap, HashSet};
use std::path::PathBuf;
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use alula::BodyRates;
use alula::GuidanceInput;
use alula::planar::{Inertial, PlanarGuidanceInput};
use alula_link::damage::Mangler;
use alula_link::{
    Configuration, Envelope, InForce, MAX_FRAME, Pacing, Phase, Status, ToTarget, encode,
};
use alula_sil::pil::{Build, Heard, Qemu, Target, build, core_answer, link_input};
use alula_sim::controllers::{Answer, Controller, Input};
use alula_sim::experiment::{BUILT_IN, Document, Experiment};
use alula_sim::simulate::{Record, Step, fly_by, simulate};
use anyhow::{Context, ensure};

/// The built-in experiment of this name.
fn experiment(name: &str) -> Experiment {
    Document::load(name).unwrap().checked().unwrap()
}

/// Every built-in experiment that a controller of the core flies, with what the target is told of it.
fn core_experiments(pacing: Pacing) -> Vec<(&'static str, Experiment, Configuration)> {
    let mut all = Vec::new();
    for (name, _) in BUILT_IN {
        // Documents without a reference are vehicles.
        if !Document::load(name)
            .unwrap()
            .data()
            .is_ok_and(|e| e.in_plane())
        {
            continue;
        }
        let experiment = experiment(name);
        if let Ok(configuration) = experiment.configuration(pacing) {
            all.push((*name, experiment, configuration));
        }
    }
    // Laws and guidance are both among them.
    let kinds: HashSet<_> = all.iter().map(|(_, e, _)| &*e.controller.kind).collect();
    assert_eq!(kinds, HashSet::from(["law", "guidance"]));
    all
}

/// The images, built one after the other: they share the place they are built in.
static IMAGES: LazyLock<[(Build, PathBuf); 2]> =
    LazyLock::new(|| [Build::Perturbed, Build::Release].map(|b| (b, build(b).unwrap())));

/// The image of `which` under QEMU, before it has been told anything.
fn boot(which: Build) -> (Qemu, Target) {
    let image = IMAGES.iter().find(|(b, _)| *b == which).unwrap();
    let (qemu, port) = Qemu::start(&image.1).unwrap();
    (qemu, Target::new(port).unwrap())
}

/// The controller that the target has, in this process: made of the same configuration by the same code.
struct Here(alula_link::Controller);

impl Here {
    fn new(configuration: &Configuration) -> Self {
        Self(alula_link::Controller::new(configuration).unwrap())
    }

    fn guided(&self) -> bool {
        matches!(self.0, alula_link::Controller::Guidance(..))
    }

    fn step(&mut self, input: &Input, dt: f32) -> alula_link::Answer {
        let input = link_input(self.guided(), input, dt);
        self.0.step(&input)
    }
}

/// Every bit of an answer, NaN and the sign of zero included: what it is on the wire.
fn bits(answer: &alula_link::Answer) -> Vec<u8> {
    encode(answer, &mut [0; MAX_FRAME]).unwrap().to_vec()
}

/// Asks the target, the controller of its configuration in this process, and the experiment's own controller, and insists on
/// the same bits.
struct Compared {
    target: Target,
    here: Here,
    own: Box<dyn Controller>,
    steps: usize,
}

impl Controller for Compared {
    fn answer(&mut self, input: &Input, dt: f32) -> anyhow::Result<Answer> {
        let sent = ToTarget::Input(link_input(self.here.guided(), input, dt));
        let Heard::Answer(there) = self.target.ask(sent)? else {
            anyhow::bail!("no answer to an input");
        };
        let here = self.here.step(input, dt);
        let step = self.steps;
        ensure!(
            bits(&there) == bits(&here),
            "step {step}: {there:?} is not {here:?}"
        );
        // What the experiment flies without a target is that same controller.
        let (there, own) = (core_answer(there)?, self.own.answer(input, dt)?);
        ensure!(
            format!("{there:?}") == format!("{own:?}"),
            "step {step}: {there:?} is not the experiment's {own:?}"
        );
        self.steps += 1;
        Ok(there)
    }
}

/// Flies all of `experiment` on the image of `which`; an error at the first answer that is not the one in this
/// process. The flights are the same up to there, so that equal answers are equal flights.
fn same_bits(
    which: Build,
    experiment: &Experiment,
    configuration: &Configuration,
) -> anyhow::Result<()> {
    let (_qemu, mut target) = boot(which);
    target.configure(*configuration)?;
    let mut compared = Compared {
        target,
        here: Here::new(configuration),
        own: experiment.controller()?,
        steps: 0,
    };
    simulate(experiment, &mut compared, |_| true)?.sound()?;
    assert_eq!(compared.steps, experiment.steps() + 1);
    Ok(())
}

#[test]
#[ignore = "needs QEMU: cargo pil-check"]
fn every_built_in_experiment_of_the_core_flies_the_same_bits() {
    for (name, mut experiment, configuration) in core_experiments(Pacing::Lockstep) {
        // The emulation takes 3 to 9 ms an answer: the round trip is flown whole, of the others the beginning. One unit in the last
        // place of one coefficient is found there within 522 answers.
        if name != "round-trip" {
            let beginning = 600.0 / experiment.control_rate_hz;
            experiment.duration_s = experiment.duration_s.min(beginning);
        }
        let begin = Instant::now();
        same_bits(Build::Release, &experiment, &configuration)
            .context(name)
            .unwrap();
        let (steps, took) = (experiment.steps() + 1, begin.elapsed());
        println!("{name}: {steps} answers the same to the bit, in {took:.1?}");
    }
}

/// Flies the beginning of the built-in experiment `name` in space, `seconds` long, on the image of `which`; an error at the first
/// answer that is not the one in this process.
fn same_bits_in_space(
    which: Build,
    name: &str,
    seconds: f64,
    pacing: Pacing,
) -> anyhow::Result<Record> {
    let mut experiment = Document::load(name)?.checked()?;
    (experiment.duration_s, experiment.settle_time_s) = (seconds, 0.0);
    let configuration = experiment.configuration(pacing)?;
    let (_qemu, mut target) = boot(which);
    target.configure(configuration)?;
    let mut compared = Compared {
        target,
        here: Here::new(&configuration),
        own: experiment.controller()?,
        steps: 0,
    };
    let begin = Instant::now();
    let record = fly_by(&experiment, &mut compared)?;
    let (steps, took) = (compared.steps, begin.elapsed());
    assert_eq!(steps, experiment.steps() + 1);
    println!("{name}: {steps} answers the same to the bit, in {took:.1?}");
    Ok(record)
}

/// The beginnings of a circle, of an eight and of a mission in turbulence, with air data, position and specific force told.
#[test]
#[ignore = "needs QEMU: cargo pil-check"]
fn flights_in_space_are_the_same_bits() {
    let fly = |name, seconds, pacing| {
        same_bits_in_space(Build::Release, name, seconds, pacing)
            .context(name)
            .unwrap()
    };
    let circle = fly("circle-40", 3.0, Pacing::Lockstep);
    // They turn: that is not a flight in a plane.
    assert!(circle.last().unwrap().bank() > 0.7);
    fly("eight", 2.0, Pacing::Timer);
    let mission = fly("mission-turbulence", 3.0, Pacing::Lockstep);
    assert!(
        mission
            .iter()
            .all(|step| step.input.sample.specific_force.is_some())
    );
}

/// Whole flights, in real time: minutes.
#[test]
#[ignore = "takes minutes: cargo pil-check-whole"]
fn whole_flights_in_space_are_the_same_bits() {
    for name in ["circle-40", "eight", "mission", "mission-turbulence"] {
        let experiment = Document::load(name).unwrap().checked().unwrap();
        let (duration, pacing) = (experiment.duration_s, Pacing::Lockstep);
        same_bits_in_space(Build::Release, name, duration, pacing)
            .context(name)
            .unwrap();
    }
}

#[test]
#[ignore = "needs QEMU: cargo pil-check"]
fn one_unit_in_the_last_place_is_found_in_space() {
    let outcome = same_bits_in_space(Build::Perturbed, "circle-40", 3.0, Pacing::Lockstep);
    let error = outcome.unwrap_err().to_string();
    assert!(error.starts_with("step "), "{error}");
}

#[test]
#[ignore = "needs QEMU: cargo pil-check"]
fn the_timer_releases_the_same_bits() {
    for name in ["hover-to-cruise", "round-trip"] {
        let mut experiment = experiment(name);
        experiment.duration_s = experiment.duration_s.min(10.0);
        let configuration = experiment.configuration(Pacing::Timer).unwrap();
        same_bits(Build::Release, &experiment, &configuration)
            .context(name)
            .unwrap();
    }
}

#[test]
#[ignore = "needs QEMU: cargo pil-check"]
fn one_unit_in_the_last_place_of_one_coefficient_is_found() {
    for (name, experiment, configuration) in core_experiments(Pacing::Lockstep) {
        let outcome = same_bits(Build::Perturbed, &experiment, &configuration);
        let error = outcome.expect_err(name).to_string();
        assert!(error.starts_with("step "), "{name}: {error}");
        println!("{name}: {}", error.split(':').next().unwrap_or_default());
    }
}

#[test]
fn a_measured_table_is_refused_by_name() {
    let mut document = Document::load("round-trip").unwrap();
    let polar = "vehicle.aerodynamics={ table = { polar = \"naca-0021-re-160e3\" } }";
    for assignment in ["controller={ guidance = {} }", polar] {
        document.assign(assignment).unwrap();
    }
    let experiment = document.checked().unwrap();
    let refused = experiment.configuration(Pacing::Lockstep).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "controller.guidance.vehicle.aerodynamics.table: cannot be sent to a target"
    );
}

/// A controller whose link is cut for some of the steps. The vehicle flies on under the safe command of what the target has.
struct Outage<C> {
    controller: C,
    here: Here,
    step: usize,
    cut: std::ops::Range<usize>,
}

impl<C: Linked> Controller for Outage<C> {
    fn answer(&mut self, input: &Input, dt: f32) -> anyhow::Result<Answer> {
        let step = self.step;
        self.step += 1;
        if !self.cut.contains(&step) {
            self.here.step(input, dt);
            return self.controller.answer(input, dt);
        }
        let safe = self.here.0.safe();
        if step == self.cut.start {
            self.controller.lost(safe)?;
        }
        let mut command = alula::planar::Command::default();
        command.thrust = safe.thrust;
        Ok(Ok(command).into())
    }
}

/// What sees that its link is cut.
trait Linked: Controller {
    /// It has gone to its safe command.
    fn lost(&mut self, safe: InForce) -> anyhow::Result<()>;
}

impl Linked for Target {
    fn lost(&mut self, safe: InForce) -> anyhow::Result<()> {
        let status = self.await_status(|s| s.phase == Phase::LinkLost)?;
        let in_force = (status.thrust, status.rates);
        ensure!(
            in_force == (safe.thrust, safe.rates) && status.losses > 0,
            "{status:?} is not {safe:?}"
        );
        Ok(())
    }
}

/// The experiment's own controller.
struct Own(Box<dyn Controller>);

impl Controller for Own {
    fn answer(&mut self, input: &Input, dt: f32) -> anyhow::Result<Answer> {
        self.0.answer(input, dt)
    }
}

impl Linked for Own {
    fn lost(&mut self, _: InForce) -> anyhow::Result<()> {
        Ok(())
    }
}

/// Nothing flies.
fn is_still(status: &Status) -> bool {
    (status.thrust, status.rates) == (0.0, BodyRates::default())
}

#[test]
#[ignore = "needs QEMU: cargo pil-check"]
fn without_a_link_it_is_safe_and_with_it_it_flies_again() {
    // Power-on without a link: safe, and said so again and again.
    let (_qemu, mut target) = boot(Build::Release);
    for ticks in [500, 1000, 1500] {
        let status = target.await_status(|s| s.ticks >= ticks).unwrap();
        assert_eq!(status.phase, Phase::NotConfigured);
        assert!(is_still(&status), "{status:?}");
    }

    // The link is cut at 5 s, for 0.2 s of the flight.
    let mut experiment = experiment("hover-to-cruise");
    experiment.duration_s = 10.0;
    let at = |t: f64| (t * experiment.control_rate_hz) as usize;
    let cut = at(5.0)..at(5.2);
    let configuration = experiment.configuration(Pacing::Timer).unwrap();
    target.configure(configuration).unwrap();
    let there = fly_cut(&experiment, &configuration, target, cut.clone());
    let own = Own(experiment.controller().unwrap());
    let here = fly_cut(&experiment, &configuration, own, cut);
    let all = |steps: &[Step]| {
        let answers = steps.iter().map(|step| format!("{:?}", step.answer));
        answers.collect::<Vec<_>>()
    };
    assert!(all(&there) == all(&here));
    // 0.2 s of the safe command leave a velocity error of 0.95 m/s, half of what 0.2 s without thrust would (1.9 m/s), and
    // the law takes it away again.
    let errors = || there.iter().map(|step| step.velocity_error().norm());
    let (most, last) = (errors().fold(0.0, f64::max), errors().next_back().unwrap());
    assert!((0.9..1.0).contains(&most), "{most}");
    assert!(last < 0.01, "{last}");
}

fn fly_cut<C: Linked>(
    experiment: &Experiment,
    configuration: &Configuration,
    controller: C,
    cut: std::ops::Range<usize>,
) -> Vec<Step> {
    let mut outage = Outage {
        controller,
        here: Here::new(configuration),
        step: 0,
        cut,
    };
    let mut steps = Vec::new();
    simulate(experiment, &mut outage, |step| {
        steps.push(step.clone());
        true
    })
    .and_then(|end| Ok(end.sound()?))
    .unwrap();
    steps
}

/// Sends `message` through the mangler, so that it is expected, after closing what is open.
fn send(target: &mut Target, mangler: &mut Mangler, message: ToTarget) -> Envelope<ToTarget> {
    let envelope = target.envelope(message);
    let mut bytes = mangler.end().to_vec();
    bytes.extend(mangler.genuine(&envelope));
    target.send(&bytes).unwrap();
    envelope
}

#[test]
#[ignore = "needs QEMU: cargo pil-check"]
fn a_hundred_thousand_damaged_frames_do_nothing_and_are_counted() {
    const DAMAGED: usize = 100_000;
    /// Bytes sent before the target is waited for: fewer than it can hold, with the frames that follow.
    const WINDOW: usize = 300;
    let experiment = experiment("hover-to-cruise");
    let (_qemu, mut target) = boot(Build::Release);
    let mut mangler = Mangler::new(5);
    let configuration = experiment.configuration(Pacing::Lockstep).unwrap();
    send(
        &mut target,
        &mut mangler,
        ToTarget::Configure(configuration),
    );

    let mut here = Here::new(&configuration);
    let mut inputs = HashMap::new();
    let mut damaged = 0;
    let mut answered = HashSet::new();
    loop {
        let mut sent = 0;
        while sent < WINDOW && damaged < DAMAGED {
            let message = match damaged % 8 {
                0 => ToTarget::Input(link_input(false, &input(damaged), 0.0)),
                _ => ToTarget::StatusRequest,
            };
            let envelope = target.envelope(message);
            if let ToTarget::Input(_) = message {
                inputs.insert(place(&envelope), damaged);
            }
            let bytes = mangler.damaged(&envelope);
            target.send(&bytes).unwrap();
            (sent, damaged) = (sent + bytes.len(), damaged + 1);
        }
        let sent = send(
            &mut target,
            &mut mangler,
            ToTarget::Input(link_input(false, &input(damaged), 0.0)),
        );
        inputs.insert(place(&sent), damaged);
        // Left over from an earlier session, and newer than all of this one by its number alone.
        let mut stale = target.envelope(ToTarget::StatusRequest);
        stale.session -= 1;
        target.send(&mangler.genuine(&stale)).unwrap();
        let request = send(&mut target, &mut mangler, ToTarget::StatusRequest);
        // Everything up to the status, which is the answer to the last thing sent.
        let deadline = Instant::now() + Duration::from_secs(20);
        let status = loop {
            let (answers, heard) = target.hear(deadline).unwrap();
            match heard {
                Heard::Answer(answer) => {
                    let expected = here.step(&input(inputs[&answers]), 0.0);
                    assert_eq!(bits(&answer), bits(&expected));
                    assert!(answered.insert(answers), "answered twice");
                }
                Heard::Status(status) if answers == place(&request) => break status,
                _ => {}
            }
        };
        let expected = mangler.expected();
        assert!(expected.agrees(&status.counters), "{expected:?} {status:?}");
        if damaged == DAMAGED {
            println!("{damaged} damaged frames: {:?}", status.counters);
            // Answered were the inputs that arrived undamaged and in order, and nothing else.
            let arrived = mangler.accepted().iter().filter(|p| inputs.contains_key(p));
            assert_eq!(answered, arrived.copied().collect());
            break;
        }
    }
}

/// Session and number.
fn place(envelope: &Envelope<ToTarget>) -> (u32, u32) {
    (envelope.session, envelope.sequence)
}

/// An input of its own for every number.
fn input(n: usize) -> Input {
    let theta = n as f32 * 1e-5;
    Input {
        sample: GuidanceInput::from(
            &PlanarGuidanceInput::default()
                .velocity(Inertial::new(n as f32 * 1e-4, 8.0))
                .attitude(alula::planar::Attitude::from_angle(theta)),
        ),
        feed_forward: None,
    }
}
