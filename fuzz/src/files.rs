//! Every parser of files: experiments, campaigns, comparisons, vehicles (TOML), logs to replay (CSV), polars, ULog,
//! MCAP, DataFlash, CSV of any columns. Any bytes are read or refused in words; what is read is used.

use std::io::Cursor;
use std::sync::LazyLock;

use alula::AngleOfAttack;
use alula::aero::Aerodynamics;
use alula_design::Known;
use alula_logs::{Error, Log, csv, dataflash, mcap, states, ulog};
use alula_sim::airframe::Airframe;
use alula_sim::experiment::{Document, Experiment};
use alula_sim::named::Named;
use alula_sim::polar::Polar;
use alula_sim::replay;
use alula_sim::simulate::{Step, simulate};
use alula_study::{CampaignSource, Source};

/// Bytes that are no UTF-8 are no text file to begin with.
fn text(data: &[u8]) -> String {
    String::from_utf8_lossy(data).into_owned()
}

/// A refusal is one of words, on one line.
fn refused(error: &str) {
    assert!(
        !error.trim().is_empty() && error.lines().count() == 1,
        "{error}"
    );
}

fn named(data: &[u8]) -> Named {
    Named {
        name: "x".to_owned(),
        origin: "x.toml".to_owned(),
        text: text(data),
        file: None,
    }
}

/// An experiment that is accepted is flown for three steps.
pub fn experiment(data: &[u8]) -> u64 {
    let experiment = match Document::new(&named(data)).and_then(|document| document.checked()) {
        Ok(experiment) => experiment,
        Err(error) => {
            refused(&format!("{error:#}"));
            return 1;
        }
    };
    let mut steps = 0;
    let mut controller = experiment.controller().expect("checked");
    let outcome = simulate(&experiment, controller.as_mut(), |step| {
        steps += 1;
        finite(step);
        steps < 3
    });
    assert!(outcome.is_ok());
    1 + steps
}

/// What is commanded is a number.
fn finite(step: &Step) {
    let (thrust, rates) = (step.answer.thrust, step.answer.rates);
    crate::assert_finite(&[thrust, rates.roll, rates.pitch, rates.yaw]);
}
/// A vehicle's file, of which a flight need not be there.
pub fn vehicle(data: &[u8]) -> u64 {
    match Document::new(&named(data)).and_then(|document| Airframe::of(&document)) {
        Ok(airframe) => {
            let thrust = [0.0, 2.0 * airframe.spec.weight()];
            let _ = airframe.spec.limited(thrust);
            2
        }
        Err(error) => {
            refused(&format!("{error:#}"));
            1
        }
    }
}

/// What is known of a vehicle, in ten lines.
pub fn known(data: &[u8]) -> u64 {
    let read = Known::from_text("x.toml", &text(data));
    match read.map(|known| known.facts()) {
        Ok(Ok(facts)) => {
            assert!(facts.mass_kg.is_finite() && facts.k_a().is_finite());
            2
        }
        Ok(Err(error)) => {
            refused(&error.to_string());
            1
        }
        Err(error) => {
            refused(&format!("{error:#}"));
            1
        }
    }
}

/// Variants under conditions: refused, or every flight is planned.
pub fn comparison(data: &[u8]) -> u64 {
    match Source::new(&named(data)) {
        Ok(source) => 1 + source.plan.flights() as u64,
        Err(error) => {
            refused(&format!("{error:#}"));
            1
        }
    }
}

static CAMPAIGN: LazyLock<CampaignSource> =
    LazyLock::new(|| CampaignSource::load("faults", None).expect("a built-in campaign"));

/// A campaign that is accepted draws two flights.
pub fn campaign(data: &[u8]) -> u64 {
    let mut texts = CAMPAIGN.texts.clone();
    texts.campaign = text(data);
    match CampaignSource::from_texts(texts, "x.toml") {
        Ok(source) => {
            for number in 0..2 {
                let _ = source.campaign.draw(&source.base, number);
            }
            3
        }
        Err(error) => {
            refused(&format!("{error:#}"));
            1
        }
    }
}

static REPLAYED: LazyLock<[Experiment; 3]> = LazyLock::new(|| {
    ["hover-to-cruise", "round-trip", "circle-40"].map(|name| {
        let document = Document::load(name).expect("a built-in experiment");
        document.checked().expect("a sound experiment")
    })
});

/// A log over which a law and the guidance are run.
pub fn replay(data: &[u8]) -> u64 {
    for experiment in &*REPLAYED {
        if let Err(error) = replay::trace::replay("log.csv", data, experiment) {
            refused(&format!("{error:#}"));
        }
    }
    2
}

/// A law, the guidance in the plane and the guidance in space over states.
fn replay_states(states: &states::States) -> u64 {
    for experiment in &*REPLAYED {
        match replay::log::replay(states, experiment) {
            Ok((record, _)) => record.iter().for_each(finite),
            Err(error) => refused(&format!("{error:#}")),
        }
    }
    3
}

/// What was read is searched for states, which are replayed, and is written and read again.
fn log(read: Result<Log, Error>) -> u64 {
    let log = match read {
        Ok(log) => log,
        Err(error) => {
            refused(&error.to_string());
            return 1;
        }
    };
    let mut calls = 3;
    match states::find(&log) {
        Ok(states) => calls += replay_states(&states),
        Err(error) => refused(&error.to_string()),
    }
    let mut file = Vec::new();
    if ulog::write(&log, &mut file).is_ok() {
        assert!(ulog::read("again", &file).is_ok());
    }
    let mut file = Cursor::new(Vec::new());
    if mcap::write(&log, &mut file).is_ok() {
        let again = mcap::read("again", file.get_ref()).expect("as written");
        assert_eq!(again.notes, [""; 0]);
    }
    calls
}

pub fn ulog(data: &[u8]) -> u64 {
    log(ulog::read("x.ulg", data))
}

pub fn mcap(data: &[u8]) -> u64 {
    log(mcap::read("x.mcap", data))
}

pub fn dataflash(data: &[u8]) -> u64 {
    log(dataflash::read("x.bin", data))
}

/// A map of columns, by which a log is read.
pub fn map(data: &[u8]) -> u64 {
    const LOG: &[u8] = b"t,w,x,qw\n0,1,2,3\n1.5e0,.5,.5,nan\n";
    match csv::Map::parse("m.toml", &text(data)) {
        Ok(map) => 1 + log(csv::read("x.csv", LOG, Some(&map))),
        Err(error) => {
            refused(&error.to_string());
            1
        }
    }
}

/// Measured coefficients: refused, or finite at every angle. What is accepted is kept for ever, as the harness does.
pub fn polar(data: &[u8]) -> u64 {
    let polar = match Polar::from_text("x.csv", &text(data)) {
        Ok(polar) => polar,
        Err(error) => {
            refused(&format!("{error:#}"));
            return 1;
        }
    };
    for n in -63..=63 {
        let alpha = AngleOfAttack::from_radians(n as f32 * 0.05);
        let c = polar.core.coefficients(alpha);
        crate::assert_finite(&[c.c_l, c.c_d]);
    }
    128
}

pub fn csv(data: &[u8]) -> u64 {
    log(csv::read("x.csv", data, None))
}
