//! The image under QEMU: the same bits as in this process, and no others, whatever the link does.
//!
//! Ignored by a plain `cargo test`, which asks for no emulator: `cargo pil-check` runs them.
#![cfg(not(target_os = "none"))]

use std::collections::{HashMap, HashSet};
use std::path::PathBuf;
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use alula::control::Command;
use alula_link::damage::Mangler;
use alula_link::{Envelope, Pacing, Phase, Status, ToTarget};
use alula_sil::figures::Figures;
use alula_sil::flight::{Answer, Controller, Input, Local, Row, fly};
use alula_sil::pil::{Build, Qemu, Said, Target, build};
use alula_sil::scenario::{BUILT_IN, Scenario, Source};
use anyhow::{Context, ensure};

fn scenario(name: &str) -> Scenario {
    Source::load(name).unwrap().scenario
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

/// Every bit of an answer: thrust, rate and diagnostics, or the fault.
fn bits(answer: &Answer) -> Result<[u32; 10], alula::Fault> {
    match alula_link::Answer::from(*answer) {
        alula_link::Answer::Command(numbers) => Ok(numbers.map(f32::to_bits)),
        _ => Err(answer.unwrap_err()),
    }
}

/// Asks the target and the core in this process, and insists on the same bits.
struct Compared {
    target: Target,
    local: Local,
    steps: usize,
}

impl Controller for Compared {
    fn answer(&mut self, input: &Input) -> anyhow::Result<Answer> {
        let (there, here) = (self.target.answer(input)?, self.local.answer(input)?);
        let step = self.steps;
        ensure!(
            bits(&there) == bits(&here),
            "step {step}: {there:?} is not {here:?}"
        );
        self.steps += 1;
        Ok(there)
    }
}

/// Flies all of `scenario` on the image of `which`; an error at the first answer that is not the core's in this
/// process. The flights are the same up to there, so that equal answers are equal flights.
fn same_bits(which: Build, scenario: &Scenario, pacing: Pacing) -> anyhow::Result<()> {
    let (_qemu, mut target) = boot(which);
    target.configure(scenario.configuration(pacing).unwrap())?;
    let local = Local::new(scenario).unwrap();
    let mut compared = Compared {
        target,
        local,
        steps: 0,
    };
    fly(scenario, &mut compared, |_| {})?;
    assert_eq!(compared.steps, scenario.steps() + 1);
    Ok(())
}

#[test]
#[ignore = "needs QEMU: cargo pil-check"]
fn every_built_in_scenario_flies_the_same_bits() {
    for (name, _) in BUILT_IN {
        let begin = Instant::now();
        let scenario = scenario(name);
        same_bits(Build::Release, &scenario, Pacing::Lockstep)
            .context(*name)
            .unwrap();
        let (steps, took) = (scenario.steps() + 1, begin.elapsed());
        println!("{name}: {steps} answers the same to the bit, in {took:.1?}");
    }
}

#[test]
#[ignore = "needs QEMU: cargo pil-check"]
fn the_timer_releases_the_same_bits() {
    let scenario = scenario("hover-to-cruise");
    same_bits(Build::Release, &scenario, Pacing::Timer).unwrap();
}

#[test]
#[ignore = "needs QEMU: cargo pil-check"]
fn one_unit_in_the_last_place_of_one_coefficient_is_found() {
    for (name, _) in BUILT_IN {
        let found = same_bits(Build::Perturbed, &scenario(name), Pacing::Lockstep);
        let error = found.expect_err(name).to_string();
        assert!(error.starts_with("step "), "{name}: {error}");
        println!("{name}: {}", error.split(':').next().unwrap_or_default());
    }
}

/// A controller whose link is cut for some of the steps. The vehicle flies on under the safe command.
struct Outage<C> {
    controller: C,
    step: usize,
    cut: std::ops::Range<usize>,
}

impl<C: Controller> Controller for Outage<C> {
    fn answer(&mut self, input: &Input) -> anyhow::Result<Answer> {
        let step = self.step;
        self.step += 1;
        if self.cut.contains(&step) {
            return Ok(Ok(Command::default()));
        }
        self.controller.answer(input)
    }
}

fn is_safe(status: &Status) -> bool {
    (status.thrust, status.rate) == (0.0, 0.0)
}

#[test]
#[ignore = "needs QEMU: cargo pil-check"]
fn without_a_link_it_is_safe_and_with_it_it_flies_again() {
    // Power-on without a link: safe, and said so again and again.
    let (_qemu, mut target) = boot(Build::Release);
    for ticks in [500, 1000, 1500] {
        let status = target.await_status(|s| s.ticks >= ticks).unwrap();
        assert_eq!(status.phase, Phase::NotConfigured);
        assert!(is_safe(&status), "{status:?}");
    }

    // The link is cut at 5 s, for 0.2 s of the flight.
    let mut scenario = scenario("hover-to-cruise");
    scenario.duration_s = 10.0;
    let cut = 5000..5200;
    target
        .configure(scenario.configuration(Pacing::Timer).unwrap())
        .unwrap();
    let mut flown = Outage {
        controller: Watching {
            target,
            asked: 0,
            cut: cut.start,
        },
        step: 0,
        cut: cut.clone(),
    };
    let there = fly(&scenario, &mut flown, |_| {}).unwrap();
    let mut local = Outage {
        controller: Local::new(&scenario).unwrap(),
        step: 0,
        cut,
    };
    let here = fly(&scenario, &mut local, |_| {}).unwrap();
    let all = |rows: &[Row]| rows.iter().map(|row| bits(&row.answer)).collect::<Vec<_>>();
    assert!(all(&there) == all(&here));
    // 0.2 s without thrust leave a velocity error of nearly 0.2 g, and the law takes it away again: 0.0025 m/s
    // of it are left at the end.
    let figures = Figures::of(&there);
    assert!(
        (1.8..2.0).contains(&figures.max_velocity_error_m_s),
        "{figures:?}"
    );
    assert!(figures.final_velocity_error_m_s < 0.01, "{figures:?}");
}

/// A target that is watched going to its safe command when nothing more is asked for.
struct Watching {
    target: Target,
    asked: usize,
    cut: usize,
}

impl Controller for Watching {
    fn answer(&mut self, input: &Input) -> anyhow::Result<Answer> {
        let answer = self.target.answer(input)?;
        self.asked += 1;
        if self.asked == self.cut {
            let status = self.target.await_status(|s| s.phase == Phase::LinkLost)?;
            ensure!(is_safe(&status) && status.losses > 0, "{status:?}");
        }
        Ok(answer)
    }
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
    /// Bytes sent before the target is waited for: fewer than it can hold.
    const WINDOW: usize = 300;
    let scenario = scenario("hover-to-cruise");
    let (_qemu, mut target) = boot(Build::Release);
    let mut mangler = Mangler::new(5);
    let configuration = scenario.configuration(Pacing::Lockstep).unwrap();
    send(
        &mut target,
        &mut mangler,
        ToTarget::Configure(configuration),
    );

    let mut local = Local::new(&scenario).unwrap();
    let mut inputs = HashMap::new();
    let mut damaged = 0;
    let mut answered = HashSet::new();
    loop {
        let mut sent = 0;
        while sent < WINDOW && damaged < DAMAGED {
            let message = match damaged % 8 {
                0 => ToTarget::Input(wire(&input(damaged))),
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
        let flown = send(
            &mut target,
            &mut mangler,
            ToTarget::Input(wire(&input(damaged))),
        );
        inputs.insert(place(&flown), damaged);
        // Left over from an earlier session, and newer than all of this one by its number alone.
        let mut stale = target.envelope(ToTarget::StatusRequest);
        stale.session -= 1;
        target.send(&mangler.genuine(&stale)).unwrap();
        let request = send(&mut target, &mut mangler, ToTarget::StatusRequest);
        // Everything up to the status, which is the answer to the last thing sent.
        let deadline = Instant::now() + Duration::from_secs(20);
        let status = loop {
            let (answers, said) = target.hear(deadline).unwrap();
            match said {
                Said::Answer(answer) => {
                    let expected = local.answer(&input(inputs[&answers])).unwrap();
                    assert_eq!(answer, expected.into());
                    assert!(answered.insert(answers), "answered twice");
                }
                Said::Status(status) if answers == place(&request) => break status,
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
    use alula::{Inertial, Reference};
    let velocity = Inertial::new(n as f32 * 1e-4, 8.0);
    let theta = n as f32 * 1e-5;
    Input::new(theta, velocity, Inertial::ZERO, Reference::default(), None)
}

fn wire(input: &Input) -> alula_link::Input {
    alula_link::Input::new(&input.state, &input.reference, None)
}
