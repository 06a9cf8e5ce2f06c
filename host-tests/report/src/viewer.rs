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

/// The address of a flight, from a page beside the viewer's.
pub fn address(flight: &str) -> String {
    let escaped = flight.replace('%', "%25").replace(' ', "%20");
    format!("{FILE}#{}", escaped.replace('#', "%23"))
}

/// Fastest airspeed of the curves \[m/s\].
const FASTEST: f64 = 40.0;

/// A flight to be shown.
pub struct Flight {
    /// Its name: `view.html#NAME` shows it first.
    pub name: String,
    /// One sentence about it.
    pub lead: String,
    /// What is seen of it.
    pub scene: Scene,
    /// The curves of its vehicle, if that is known.
    pub curves: Option<Curves>,
}

/// A flight that a page holds.
#[derive(Serialize)]
struct Held<'a> {
    name: &'a str,
    lead: &'a str,
    names: &'a [&'a str],
    /// The rows, as floats in base 64.
    rows: String,
    words: &'a [(f64, [String; 3])],
    candidate: &'a [&'a str],
    /// The candidates of plans, as floats in base 64.
    plans: String,
    /// Which of the page's curves are its vehicle's.
    curves: Option<usize>,
}

/// The flights that a page holds, and the curves of their vehicles, each once.
#[derive(Serialize)]
struct All<'a> {
    flights: Vec<Held<'a>>,
    curves: Vec<&'a Curves>,
}

/// An experiment that the page flies by name.
#[derive(Serialize)]
struct Flown {
    name: String,
    description: String,
    /// Whether its vehicle is one of parts.
    of_parts: bool,
}

/// What a page flies by name.
#[derive(Serialize)]
struct Names {
    experiments: Vec<Flown>,
    vehicles: Vec<&'static str>,
}

impl Flight {
    /// The flight of a record.
    pub fn of(name: &str, experiment: &Experiment, record: &[Step]) -> Self {
        Self {
            name: name.to_owned(),
            lead: experiment.description.clone(),
            scene: Scene::of(experiment, record),
            curves: Some(curves(experiment)),
        }
    }
}

/// The page of a recorded flight.
pub fn page(
    document: &Document,
    experiment: &Experiment,
    record: &[Step],
) -> anyhow::Result<String> {
    let flight = Flight::of(&document.name, experiment, record);
    recorded(&document.name, &[flight])
}

/// A log, with what the controller of an experiment says to it.
pub fn replayed(
    name: &str,
    document: &Document,
    experiment: &Experiment,
    record: &[Step],
) -> Flight {
    let of = &document.name;
    Flight {
        lead: format!("The log, with what the controller of {of} says to it."),
        ..Flight::of(name, experiment, record)
    }
}

/// The curves of an experiment's vehicle.
pub fn curves(experiment: &Experiment) -> Curves {
    Curves::of(&experiment.vehicle.reference(), FASTEST)
}

/// The page of recorded flights, of which one is chosen.
pub fn recorded(title: &str, flights: &[Flight]) -> anyhow::Result<String> {
    let mut curves: Vec<&Curves> = Vec::new();
    let mut place = Vec::new();
    for flight in flights {
        place.push(flight.curves.as_ref().map(|of| {
            let known = curves.iter().position(|known| *known == of);
            known.unwrap_or_else(|| {
                curves.push(of);
                curves.len() - 1
            })
        }));
    }
    let held = flights.iter().zip(place).map(|(flight, curves)| Held {
        name: &flight.name,
        lead: &flight.lead,
        names: flight.scene.names,
        rows: floats(&flight.scene.rows),
        words: &flight.scene.words,
        candidate: flight.scene.candidate,
        plans: floats(&flight.scene.plans),
        curves,
    });
    let flights = held.collect();
    render(title, Some(&All { flights, curves }), None)
}

/// Numbers as floats in base 64.
fn floats(numbers: &[f64]) -> String {
    let bytes = numbers.iter().flat_map(|x| (*x as f32).to_le_bytes());
    STANDARD.encode(bytes.collect::<Vec<u8>>())
}

/// The page that flies experiments itself, by the `library` (WebAssembly).
pub fn live(library: &[u8]) -> anyhow::Result<String> {
    render("Fly alula", None, Some(library))
}

/// Every built-in experiment of the guidance, as only that is steered, and the vehicles of parts.
fn names() -> anyhow::Result<Names> {
    let mut all = Vec::new();
    for (name, _) in BUILT_IN {
        let document = Document::load(name)?;
        if document.is_flight() && document.controller() == "guidance" {
            let description = document.get("description").and_then(|text| text.as_str());
            all.push(Flown {
                of_parts: document.data()?.tail_sitter.is_some(),
                name: (*name).to_owned(),
                description: description.unwrap_or_default().to_owned(),
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

fn render(title: &str, held: Option<&All>, library: Option<&[u8]>) -> anyhow::Result<String> {
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
            title, experiments,
            flights => json(&held)?,
            library => library.map(|bytes| STANDARD.encode(bytes)),
            version => env!("CARGO_PKG_VERSION"),
        })
        .context("the page's template")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Flights of one vehicle share its curves, a trace has none, and addresses lead to names with blanks.
    #[test]
    fn a_page_holds_curves_once() {
        let experiment = Document::load("circle-40").unwrap().checked().unwrap();
        let flight = |name: &str, curves| Flight {
            name: name.to_owned(),
            lead: String::new(),
            scene: Scene::default(),
            curves,
        };
        let known = || Some(curves(&experiment));
        let flights = [
            flight("flight 3", known()),
            flight("trace", None),
            flight("flight 7", known()),
        ];
        let page = recorded("several", &flights).unwrap();
        assert_eq!(page.matches("\"weight_n\":").count(), 1);
        for held in ["\"curves\":0}", "\"curves\":null}"] {
            assert!(page.contains(held), "{held}");
        }
        assert_eq!(address("flight 3"), "view.html#flight%203");
        assert_eq!(address("50 % of #2"), "view.html#50%20%25%20of%20%232");
    }
}
