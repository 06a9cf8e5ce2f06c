//! What a page has open: an experiment, and its flight.

use std::collections::BTreeMap;

use alula_design::curves::Curves;
use alula_sim::experiment::{Document, Experiment};
use alula_sim::figures::Figures;
use alula_sim::scene::{CANDIDATE, NUMBERS, Scene};
use alula_sim::simulate;
use anyhow::{Context, ensure};
use serde::{Deserialize, Serialize};

use crate::sliders::{self, NAMES};
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
    /// A built-in experiment.
    experiment: String,
    /// Fields that are changed.
    #[serde(default)]
    set: Vec<String>,
    /// Sliders that were moved: their names and values.
    #[serde(default)]
    sliders: BTreeMap<String, f64>,
    /// Whether it is steered, in place of its path.
    #[serde(default)]
    steered: bool,
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
    /// What flies its vehicle, weather and controller on a command line, over its path.
    command: String,
    /// Where the sliders stand; nothing where the experiment has no such value.
    sliders: BTreeMap<&'static str, Option<f64>>,
    curves: Curves,
}

/// Fastest airspeed of the curves \[m/s\].
const FASTEST: f64 = 40.0;
/// Longest flight that is steered \[s\].
const LONGEST: f64 = 3600.0;

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
            sliders: sliders::values(&experiment)?,
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
        let mut document = Document::load(&self.experiment)?;
        let mut set = Vec::new();
        for assignment in &self.set {
            document.assign(assignment)?;
            set.push(assignment.clone());
        }
        for name in self.sliders.keys() {
            ensure!(NAMES.contains(&&**name), "no slider is called {name}");
        }
        for name in NAMES {
            if let Some(&value) = self.sliders.get(name) {
                let assignment = sliders::assignment(&document, name, value)?;
                document.assign(&assignment)?;
                set.push(assignment);
            }
        }
        if self.steered {
            document.set("duration_s", LONGEST.into())?;
            document.set("path.hover", toml::Table::new().into())?;
        }
        Ok((document, set))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    /// What is open after this request.
    fn opened(request: &Value) -> (Session, Value) {
        let mut session = Session {
            request: request.to_string().into_bytes(),
            ..Session::default()
        };
        session.open().unwrap();
        let answer = serde_json::from_str(&session.answer).unwrap();
        (session, answer)
    }

    /// The command is that of the same experiment: assigned one by one it gives the text that the page flies, of a belief by name, too.
    #[test]
    fn the_command_says_the_same() {
        let sliders = json!({ "mass": 0.8, "lift": 1.3, "east": 3.0, "turbulence": 0.0, "thrust": 1.7, "rate": 0.08, "motor": 0.0 });
        for name in ["round-trip", "mission-turbulence", "hover-cross-wind"] {
            let (_, answer) = opened(&json!({ "experiment": name, "sliders": sliders }));
            let command = answer["command"].as_str().unwrap();
            let mut words = command.split(" --set ");
            let mut document = Document::load(words.next().unwrap()).unwrap();
            for word in words {
                document.assign(word.trim_matches('\'')).unwrap();
            }
            assert_eq!(answer["text"], document.text());
            for (slider, value) in sliders.as_object().unwrap() {
                let stands = answer["sliders"][slider].as_f64().unwrap();
                assert!((stands - value.as_f64().unwrap()).abs() < 1e-12, "{slider}");
            }
        }
        let unknown = json!({ "experiment": "mission", "sliders": { "weight": 2.0 } });
        let mut session = Session {
            request: unknown.to_string().into_bytes(),
            ..Session::default()
        };
        let error = session.open().unwrap_err().to_string();
        assert!(error.contains("no slider is called weight"), "{error}");
    }

    /// What is steered has the experiment's vehicle and weather, its command leads to an experiment that is there, and its path is no more.
    #[test]
    fn what_is_steered_is_the_experiment_without_its_path() {
        let (mut session, answer) =
            opened(&json!({ "experiment": "mission-turbulence", "steered": true }));
        assert_eq!(answer["command"], "mission-turbulence");
        let experiment = session.experiment().unwrap();
        let of = Document::load("mission-turbulence").unwrap().checked();
        let of = of.unwrap();
        assert_eq!(experiment.vehicle, of.vehicle);
        assert_eq!(experiment.weather, of.weather);
        assert_eq!(experiment.duration_s, LONGEST);
        session.begin().unwrap();
        session.aim(3, [5.0, 0.0, 0.0]).unwrap();
        session.step(500).unwrap();
        let rows = &session.scene.rows;
        // 5 s at 3 m/s², to 5 m/s.
        let north = rows[rows.len() - NUMBERS.len() + 4];
        assert!((north - 5.0).abs() < 1.5, "{north}");
    }
}
