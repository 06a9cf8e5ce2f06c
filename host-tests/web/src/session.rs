//! What a page has open: an experiment, and its flight.

use alula_design::curves::Curves;
use alula_sim::experiment::{BUILT_IN, Document, Experiment};
use alula_sim::figures::Figures;
use alula_sim::named::Named;
use alula_sim::scene::{NUMBERS, Scene};
use alula_sim::simulate::{End, simulate};
use anyhow::{Context, bail};
use serde::{Deserialize, Serialize};

use crate::steered::Steered;

/// What a page has open.
#[derive(Default)]
pub struct Session {
    /// The request's bytes.
    pub request: Vec<u8>,
    /// The answer's text.
    pub answer: String,
    /// The scene of the last call.
    pub scene: Scene,
    experiment: Option<Experiment>,
    steered: Option<Steered>,
}

/// A request.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Request {
    /// A built-in experiment, or the text of one.
    experiment: String,
    /// Fields that are changed.
    #[serde(default)]
    set: Vec<String>,
}

/// What is open.
#[derive(Serialize)]
struct Opened {
    name: String,
    description: String,
    duration_s: f64,
    control_rate_hz: f64,
    names: &'static [&'static str],
    text: String,
    curves: Curves,
}

/// Fastest airspeed of the curves \[m/s\].
const FASTEST: f64 = 40.0;

impl Session {
    fn experiment(&self) -> anyhow::Result<&Experiment> {
        self.experiment.as_ref().context("no experiment is open")
    }

    /// Takes the request.
    pub fn open(&mut self) -> anyhow::Result<()> {
        let request: Request = serde_json::from_slice(&self.request)?;
        let document = request.document()?;
        let experiment = document.checked()?;
        self.answer = serde_json::to_string(&Opened {
            name: document.name.clone(),
            description: experiment.description.clone(),
            duration_s: experiment.duration_s,
            control_rate_hz: experiment.control_rate_hz,
            names: &NUMBERS,
            text: document.text(),
            curves: Curves::of(&experiment.vehicle.reference(), FASTEST),
        })?;
        self.experiment = Some(experiment);
        self.steered = None;
        Ok(())
    }

    /// Flies it whole.
    pub fn fly(&mut self) -> anyhow::Result<()> {
        let experiment = self.experiment()?;
        let mut controller = experiment.controller()?;
        let mut record = Vec::with_capacity(experiment.steps() + 1);
        let end = simulate(experiment, controller.as_mut(), |step| {
            record.push(step.clone());
            true
        })?;
        if let End::Diverged(t) = end {
            bail!(
                "diverged at {t:.2} s: no aircraft flies like this, or the plant's steps are too long for it"
            );
        }
        let scene = Scene::of(experiment, &record);
        let figures = Figures::of(experiment, &record);
        self.answer =
            serde_json::json!({ "words": scene.words, "figures": figures.table(experiment) })
                .to_string();
        self.scene = scene;
        Ok(())
    }

    /// Begins to be steered.
    pub fn begin(&mut self) -> anyhow::Result<()> {
        self.steered = Some(Steered::new(self.experiment()?.clone())?);
        Ok(())
    }

    fn steered(&mut self) -> anyhow::Result<&mut Steered> {
        self.steered.as_mut().context("no flight has begun")
    }

    /// The goal from now on.
    pub fn aim(&mut self, kind: u32, target: [f64; 3]) -> anyhow::Result<()> {
        self.steered()?.aim(kind, target)
    }

    /// Goes on by `steps`.
    pub fn step(&mut self, steps: u32) -> anyhow::Result<()> {
        let scene = self.steered()?.step(steps)?;
        self.answer = serde_json::to_string(&scene.words)?;
        self.scene = scene;
        Ok(())
    }
}

impl Request {
    fn document(&self) -> anyhow::Result<Document> {
        let named = BUILT_IN.iter().any(|(name, _)| *name == self.experiment);
        let mut document = match named {
            true => Document::load(&self.experiment)?,
            false => Document::new(&Named {
                name: "experiment".to_owned(),
                origin: "experiment".to_owned(),
                text: self.experiment.clone(),
                file: None,
            })?,
        };
        for assignment in &self.set {
            document.assign(assignment)?;
        }
        Ok(document)
    }
}
