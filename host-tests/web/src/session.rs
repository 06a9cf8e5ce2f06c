//! What a page has open: an experiment, and its flight.

use alula_design::curves::Curves;
use alula_sim::experiment::{BUILT_IN, Document, Experiment};
use alula_sim::figures::Figures;
use alula_sim::named::Named;
use alula_sim::scene::{CANDIDATE, NUMBERS, Scene};
use alula_sim::simulate;
use anyhow::Context;
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
    /// Greatest thrust over the weight.
    #[serde(default)]
    thrust_to_weight: Option<f64>,
    /// How wrong the controller is about the vehicle.
    #[serde(default)]
    believe: Belief,
}

/// Believed over true.
#[derive(Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Belief {
    mass: f64,
    /// k_a, that is all lift and drag.
    lift: f64,
}

impl Default for Belief {
    fn default() -> Self {
        Self {
            mass: 1.0,
            lift: 1.0,
        }
    }
}

/// What is open.
#[derive(Serialize)]
struct Opened {
    name: String,
    description: String,
    duration_s: f64,
    control_rate_hz: f64,
    /// Whether the plant is a tail-sitter of parts, whose lags and thrust follow from these.
    of_parts: bool,
    names: &'static [&'static str],
    candidate: &'static [&'static str],
    /// The experiment as flown.
    text: String,
    /// What flies the same on a command line.
    command: String,
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
        let (document, set) = request.document()?;
        let experiment = document.checked()?;
        self.answer = serde_json::to_string(&Opened {
            name: document.name.clone(),
            description: experiment.description.clone(),
            duration_s: experiment.duration_s,
            control_rate_hz: experiment.control_rate_hz,
            of_parts: experiment.tail_sitter.is_some(),
            names: &NUMBERS,
            candidate: &CANDIDATE,
            text: document.text(),
            command: set.iter().fold(document.name.clone(), |words, one| {
                format!("{words} --set '{one}'")
            }),
            curves: Curves::of(&experiment.vehicle.reference(), FASTEST),
        })?;
        self.experiment = Some(experiment);
        self.steered = None;
        Ok(())
    }

    /// Flies it whole.
    pub fn fly(&mut self) -> anyhow::Result<()> {
        let experiment = self.experiment()?;
        let record = simulate::fly(experiment)?;
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
    /// The experiment, and what is set of the one that is named.
    fn document(&self) -> anyhow::Result<(Document, Vec<String>)> {
        let named = BUILT_IN.iter().any(|(name, _)| *name == self.experiment);
        let mut document = match named {
            true => Document::load(&self.experiment)?,
            false => Document::new(&Named {
                name: "experiment.toml".to_owned(),
                origin: "experiment.toml".to_owned(),
                text: self.experiment.clone(),
                file: None,
            })?,
        };
        let mut set = self.set.clone();
        if let Some(thrust) = self.thrust_to_weight {
            let experiment = document.data()?;
            let most = thrust * experiment.weight();
            set.push(format!("plant.thrust_n[1]={most:.3}"));
        }
        for assignment in &set {
            document.assign(assignment)?;
        }
        if self.believe != Belief::default() {
            let table = format!("{}.vehicle", document.data()?.controller.path());
            document.pin_belief()?;
            let Belief { mass, lift } = self.believe;
            for (field, times) in [("mass_kg", mass), ("k_a_kg_m", lift)] {
                let path = format!("{table}.{field}");
                let value = document.number(&path)? * times;
                set.push(format!("{path}={value}"));
                document.set(&path, value.into())?;
            }
        }
        Ok((document, set))
    }
}
