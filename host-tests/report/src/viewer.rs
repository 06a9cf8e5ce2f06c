//! The page on which a flight is seen in three dimensions: a recorded one, or those that the library flies in the page itself.

use anyhow::Context;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use minijinja::{Environment, context};
use serde::Serialize;

use alula_design::curves::Curves;
use alula_sim::experiment::tail_sitter::VEHICLES;
use alula_sim::experiment::{BUILT_IN, Document, Experiment};
use alula_sim::scene::Scene;
use alula_sim::simulate::Step;

/// Name of the page in a folder of results.
pub const FILE: &str = "view.html";
/// Fastest airspeed of the curves \[m/s\].
const FASTEST: f64 = 40.0;

/// The flight that a page holds.
#[derive(Serialize)]
struct Held<'a> {
    names: &'a [&'a str],
    /// The rows, as floats in base 64.
    rows: String,
    words: &'a [(f64, [String; 3])],
    candidate: &'a [&'a str],
    /// The candidates of plans, as floats in base 64.
    plans: String,
    curves: Option<&'a Curves>,
}

/// An experiment that the page flies by name, and the text of one that is steered.
#[derive(Serialize)]
struct Flown {
    name: String,
    description: String,
    steered: String,
    /// Whether its vehicle is one of parts.
    of_parts: bool,
}

/// What a page flies by name.
#[derive(Serialize)]
struct Names {
    experiments: Vec<Flown>,
    vehicles: Vec<&'static str>,
}

/// The page of a recorded flight.
pub fn page(
    document: &Document,
    experiment: &Experiment,
    record: &[Step],
) -> anyhow::Result<String> {
    let scene = Scene::of(experiment, record);
    let (title, lead) = (&document.name, &experiment.description);
    of_scene(title, lead, &scene, Some(&curves(experiment)))
}

/// The curves of an experiment's vehicle.
pub fn curves(experiment: &Experiment) -> Curves {
    Curves::of(&experiment.vehicle.reference(), FASTEST)
}

/// The page of a scene, of a vehicle with these curves if it is known.
pub fn of_scene(
    title: &str,
    lead: &str,
    scene: &Scene,
    curves: Option<&Curves>,
) -> anyhow::Result<String> {
    let held = Held {
        names: scene.names,
        rows: floats(&scene.rows),
        words: &scene.words,
        candidate: scene.candidate,
        plans: floats(&scene.plans),
        curves,
    };
    render(title, lead, Some(&held), None)
}

/// Numbers as floats in base 64.
fn floats(numbers: &[f64]) -> String {
    let bytes = numbers.iter().flat_map(|x| (*x as f32).to_le_bytes());
    STANDARD.encode(bytes.collect::<Vec<u8>>())
}

/// The page that flies experiments itself, by the `library` (WebAssembly).
pub fn live(library: &[u8]) -> anyhow::Result<String> {
    render("Fly alula", "", None, Some(library))
}

/// Every built-in experiment of the guidance, as only that is steered, and the vehicles of parts.
fn names() -> anyhow::Result<Names> {
    let mut all = Vec::new();
    for (name, _) in BUILT_IN {
        let document = Document::load(name)?;
        let flies = ["path", "reference"]
            .iter()
            .any(|key| document.get(key).is_some());
        if flies && document.controller() == "guidance" {
            let description = document.get("description").and_then(|text| text.as_str());
            all.push(Flown {
                of_parts: document.data()?.tail_sitter.is_some(),
                name: (*name).to_owned(),
                description: description.unwrap_or_default().to_owned(),
                steered: format!("base = \"{name}\"\ndescription = \"as {name}\"\nduration_s = 3600.0\n[path.hover]\n"),
            });
        }
    }
    Ok(Names {
        experiments: all,
        vehicles: VEHICLES.iter().map(|(name, _)| *name).collect(),
    })
}

/// JSON inside a page, of which no text ends the element that it is in.
fn json(of: &impl Serialize) -> anyhow::Result<String> {
    Ok(serde_json::to_string(of)?.replace("</", "<\\/"))
}

fn render(
    title: &str,
    lead: &str,
    held: Option<&Held>,
    library: Option<&[u8]>,
) -> anyhow::Result<String> {
    let mut environment = Environment::new();
    environment.add_template("style.css", include_str!("style.css"))?;
    environment.add_template("view.css", include_str!("viewer/view.css"))?;
    environment.add_template("three.js", include_str!("viewer/three.iife.min.js"))?;
    environment.add_template("three-LICENSE", include_str!("viewer/LICENSE"))?;
    environment.add_template("view.js", include_str!("viewer/view.js"))?;
    environment.add_template("view.html", include_str!("viewer/view.html"))?;
    let experiments = match library {
        Some(_) => json(&names()?)?,
        None => String::new(),
    };
    environment
        .get_template("view.html")?
        .render(context! {
            title, lead, experiments,
            flight => json(&held)?,
            library => library.map(|bytes| STANDARD.encode(bytes)),
            version => env!("CARGO_PKG_VERSION"),
        })
        .context("the page's template")
}
