//! Comparisons: variants flown in the same plant under the same conditions. TOML in, validated experiments out.

use anyhow::{Context, anyhow};
use serde::Deserialize;
use toml::{Table, Value};

use alula::{GuidanceParameters, Parameters};
use alula_sim::experiment::{Document, Experiment, FieldError, file_name, from_toml, require};
use alula_sim::kind::Kind;
use alula_sim::named::{Named, hint, on_one_line};

/// Name and TOML text of every built-in comparison.
pub const COMPARISONS: &[(&str, &str)] = &[
    ("laws", include_str!("../../comparisons/laws.toml")),
    ("missions", include_str!("../../comparisons/missions.toml")),
];

/// A comparison to fly. The format is described in this package's README.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Comparison {
    /// One line for reports.
    #[serde(default)]
    pub description: String,
    /// The experiment that all start from: a built-in, or a TOML file beside this one.
    pub base: String,
    /// Who flies.
    pub variants: Vec<Variant>,
    /// Under which conditions.
    pub conditions: Vec<Condition>,
    /// Names of the conditions that are drawn.
    #[serde(default)]
    pub charts: Vec<String>,
}

/// `[[variants]]`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Variant {
    /// Its name.
    pub name: String,
    /// One line for reports.
    pub title: String,
    /// What it starts from, an earlier variant or an experiment; the comparison's base if left out.
    pub base: Option<String>,
    /// The controller, in place of the one it starts from.
    pub controller: Option<Table>,
    /// Fields set, by dotted path.
    #[serde(default)]
    pub set: Table,
}

/// `[[conditions]]`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Condition {
    /// Its name.
    pub name: String,
    /// One line for reports.
    pub title: String,
    /// Fields set, by dotted path. `controller.*.` stands for whichever controller flies, and sets numbers that it has.
    #[serde(default)]
    pub set: Table,
    /// How many seeds are flown, from the experiment's on.
    #[serde(default = "one")]
    pub seeds: u64,
}

fn one() -> u64 {
    1
}

/// Most seeds of a condition.
const MAX_SEEDS: u64 = 10_000;

/// A comparison with its experiments made.
#[derive(Clone, Debug)]
pub struct Plan {
    /// What was asked for.
    pub comparison: Comparison,
    /// Of every condition, of every variant, of every seed.
    pub experiments: Vec<Vec<Vec<Experiment>>>,
}

/// A comparison with where it came from.
#[derive(Clone, Debug)]
pub struct Source {
    /// Built-in name, or the file's name without its extension.
    pub name: String,
    /// What is flown.
    pub plan: Plan,
}

/// What stands for the controller's name in a condition's paths.
const ANY: &str = "controller.*.";

impl Comparison {
    fn validate(&self) -> Result<(), FieldError> {
        let first = "is not the first of its name";
        let given = !self.variants.is_empty() && !self.conditions.is_empty();
        require(given, "variants", "and conditions must not be empty")?;
        for (i, variant) in self.variants.iter().enumerate() {
            let earlier = |name: &str| self.variants[..i].iter().any(|p| p.name == name);
            let field = format!("variants[{i}]");
            require(!earlier(&variant.name), format!("{field}.name"), first)?;
        }
        for (i, condition) in self.conditions.iter().enumerate() {
            let same = |c: &Condition| c.name == condition.name;
            let field = format!("conditions[{i}]");
            let again = self.conditions[..i].iter().any(same);
            require(!again, format!("{field}.name"), first)?;
            let within = (1..=MAX_SEEDS).contains(&condition.seeds);
            require(within, format!("{field}.seeds"), "must be from 1 to 10000")?;
        }
        for (i, name) in self.charts.iter().enumerate() {
            let known = self.conditions.iter().any(|c| c.name == *name);
            require(known, format!("charts[{i}]"), "is no condition")?;
        }
        Ok(())
    }

    /// The experiment of variant `i`; the comparison's `base` is that of `text`.
    fn variant(&self, i: usize, text: &Named, base: &Document) -> anyhow::Result<Document> {
        let variant = &self.variants[i];
        let before = |name: &str| self.variants[..i].iter().position(|v| v.name == name);
        let mut document = match &variant.base {
            None => base.clone(),
            Some(name) => match before(name) {
                Some(earlier) => self.variant(earlier, text, base)?,
                None => Document::named_in(text, name).context("base")?,
            },
        };
        if let Some(table) = &variant.controller {
            document.set("controller", Value::Table(table.clone()))?;
        }
        for (path, value) in &variant.set {
            document.set(path, value.clone())?;
        }
        Ok(document)
    }

    /// The experiments of `condition`, flown by the variant of `document`: one per seed.
    fn seeded(condition: &Condition, document: &Document) -> Result<Vec<Experiment>, FieldError> {
        let mut document = document.clone();
        // A vehicle that a condition changes is not what the controller believes in.
        if condition.set.keys().any(|path| path.starts_with("vehicle")) {
            document.pin_belief()?;
        }
        for (path, value) in &condition.set {
            match path.strip_prefix(ANY) {
                None => document.set(path, value.clone())?,
                Some(rest) => {
                    let path = format!("controller.{}.{rest}", document.controller());
                    if document.number(&path).is_ok() {
                        document.set(&path, value.clone())?;
                    }
                }
            }
        }
        let experiment = document.experiment()?;
        let seed = |n| Experiment {
            seed: experiment.seed + n,
            ..experiment.clone()
        };
        Ok((0..condition.seeds).map(seed).collect())
    }

    /// The experiments of a comparison that stands in `text`.
    fn experiments(&self, text: &Named) -> anyhow::Result<Vec<Vec<Vec<Experiment>>>> {
        let base = Document::named_in(text, &self.base).context("base")?;
        let variants = self.variants.iter().enumerate().map(|(i, variant)| {
            let made = self.variant(i, text, &base);
            made.with_context(|| format!("variant {}", on_one_line(&variant.name)))
        });
        let variants = variants.collect::<anyhow::Result<Vec<_>>>()?;
        for condition in &self.conditions {
            let anybody = condition
                .set
                .keys()
                .filter_map(|path| path.strip_prefix(ANY));
            for rest in anybody {
                let has = |document: &Document| {
                    let path = format!("controller.{}.{rest}", document.controller());
                    document.number(&path).is_ok()
                };
                if !variants.iter().any(has) {
                    let (name, rest) = (on_one_line(&condition.name), on_one_line(rest));
                    let names: Vec<String> =
                        GuidanceParameters::ROWS.iter().map(file_name).collect();
                    let names: Vec<&str> = names.iter().map(String::as_str).collect();
                    let now = hint(&rest, &names);
                    return Err(anyhow!(
                        "condition {name}: {ANY}{rest}: no controller has this number{now}"
                    ));
                }
            }
        }
        let of_condition = |condition: &Condition| {
            let experiments = self
                .variants
                .iter()
                .zip(&variants)
                .map(|(variant, document)| {
                    let made = Self::seeded(condition, document);
                    made.map_err(|e| {
                        let (variant, condition) = (&variant.name, &condition.name);
                        let names = format!("variant {variant}, condition {condition}");
                        anyhow!("{}: {e}", on_one_line(&names))
                    })
                });
            experiments.collect()
        };
        self.conditions.iter().map(of_condition).collect()
    }
}

impl Plan {
    /// Number of flights.
    pub fn flights(&self) -> usize {
        self.experiments.iter().flatten().map(Vec::len).sum()
    }
}

impl Source {
    /// The comparison that `argument` names: the built-in one, or else a TOML file.
    pub fn load(argument: &str) -> anyhow::Result<Self> {
        Self::new(&Named::find("comparison", COMPARISONS, argument)?)
    }

    /// Experiments against each other, each as it is, by the names that they were asked for by.
    pub fn experiments(named: &[(String, Document)]) -> anyhow::Result<Self> {
        let mut comparison = Comparison {
            description: "Experiments against each other".to_owned(),
            base: String::new(),
            variants: Vec::new(),
            conditions: vec![Condition {
                name: "as-given".to_owned(),
                title: "each experiment as it is".to_owned(),
                set: Table::new(),
                seeds: 1,
            }],
            charts: vec!["as-given".to_owned()],
        };
        let mut experiments = Vec::new();
        for (name, document) in named {
            let experiment = document.checked().with_context(|| on_one_line(name))?;
            comparison.variants.push(Variant {
                name: name.clone(),
                title: experiment.description.clone(),
                base: None,
                controller: None,
                set: Table::new(),
            });
            experiments.push(vec![experiment]);
        }
        comparison.validate()?;
        let names: Vec<&str> = named.iter().map(|(_, document)| &*document.name).collect();
        Ok(Self {
            name: names.join("-"),
            plan: Plan {
                comparison,
                experiments: vec![experiments],
            },
        })
    }

    /// The comparison in the text.
    pub fn new(text: &Named) -> anyhow::Result<Self> {
        let origin = &text.origin;
        Kind::Comparison.expect(origin, text.text.as_bytes())?;
        let comparison: Comparison = from_toml(origin, &text.text, Comparison::validate)?;
        let experiments = comparison.experiments(text);
        let experiments = experiments.with_context(|| origin.to_owned())?;
        Ok(Self {
            name: text.name.clone(),
            plan: Plan {
                comparison,
                experiments,
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(text: &str) -> Named {
        Named::new("x", "x.toml", text)
    }

    const SMALL: &str = r#"
        base = "round-trip"
        [[variants]]
        name = "a"
        title = "as it is"
        [[variants]]
        name = "b"
        title = "with other gains"
        base = "a"
        set = { "controller.guidance.damping" = 0.7 }
        [[conditions]]
        name = "weak"
        title = "weak motors"
        seeds = 2
        set = { "plant.thrust_n[1]" = 112.8, "controller.*.recovery_s" = 0.1 }
    "#;

    fn refused(from: &str, to: &str) -> String {
        assert!(SMALL.contains(from));
        let error = Source::new(&named(&SMALL.replace(from, to))).unwrap_err();
        format!("{error:#}")
    }

    #[test]
    fn variants_and_conditions_set_fields_by_name() {
        let plan = Source::new(&named(SMALL)).unwrap().plan;
        assert_eq!(plan.flights(), 4);
        let [weak] = &plan.experiments[..] else {
            panic!("one condition")
        };
        assert_ne!(weak[0][0].controller, weak[1][0].controller);
        for experiment in weak.iter().flatten() {
            assert_eq!(experiment.plant.thrust_n[1], 112.8);
            // The controller follows.
            assert_eq!(experiment.thrust_limits(None, 90.0), [0.0, 112.8]);
        }
        assert_eq!((weak[1][0].seed, weak[1][1].seed), (0, 1));
    }

    #[test]
    fn a_condition_that_changes_the_vehicle_leaves_the_belief() {
        let text = SMALL.replace(
            "\"plant.thrust_n[1]\" = 112.8",
            "\"vehicle.mass_kg\" = 12.0",
        );
        let text = text.replace("base = \"round-trip\"", "base = \"own.toml\"");
        let folder = tempfile::tempdir().unwrap();
        let own = "base = 'round-trip'\n[controller.guidance]\nvehicle = 'paper'\n";
        std::fs::write(folder.path().join("own.toml"), own).unwrap();
        let mut named = named(&text.replace("*.recovery_s", "guidance.recovery_s"));
        named.file = Some(folder.path().join("x.toml"));
        let plan = Source::new(&named).unwrap().plan;
        let experiment = &plan.experiments[0][0][0];
        let spec = experiment.spec().unwrap();
        assert_eq!(experiment.vehicle.mass_kg, 12.0);
        assert_eq!(spec.belief().unwrap().mass_kg, 10.0);
    }

    #[test]
    fn a_variant_may_start_from_an_experiment_of_its_own() {
        let text = SMALL.replace("base = \"a\"", "base = \"matched\"");
        let text = text.replace("controller.guidance.damping", "seed");
        let text = text.replace("0.7", "7");
        let text = text.replace("plant.thrust_n[1]", "duration_s");
        let plan = Source::new(&named(&text)).unwrap().plan;
        let [a, b] = &plan.experiments[0][..] else {
            panic!("two variants")
        };
        assert_eq!(
            (&*a[0].controller.kind, &*b[0].controller.kind),
            ("guidance", "law")
        );
        assert_eq!((b[0].seed, b[0].duration_s), (7, 112.8));
    }

    #[test]
    fn experiments_are_compared_as_they_are() {
        let load = |name: &str| (name.to_owned(), Document::load(name).unwrap());
        let both = ["round-trip", "matched"].map(load);
        let source = Source::experiments(&both).unwrap();
        assert_eq!(source.name, "round-trip-matched");
        let [experiments] = &source.plan.experiments[..] else {
            panic!("one condition")
        };
        for ((_, document), seeds) in both.iter().zip(experiments) {
            assert_eq!(seeds[..], [document.checked().unwrap()]);
        }
        let twice = ["matched", "matched"].map(load);
        let error = Source::experiments(&twice).unwrap_err().to_string();
        assert!(error.contains("variants[1].name: is not the first"));
    }

    #[test]
    fn errors_say_where() {
        assert!(refused("\"weak\"", "\"weak\"\nseed = 1").contains("conditions[0].seed: unknown"));
        assert!(refused("seeds = 2", "seeds = 0").contains("conditions[0].seeds: must be"));
        assert!(refused("base = \"a\"", "base = \"c\"").contains("variant b: base: c: neither"));
        assert!(refused("\"b\"", "\"a\"").contains("variants[1].name: is not the first"));
        let unknown = refused(".damping\"", ".dampness\"");
        assert!(unknown.contains("variant b, condition weak: controller.guidance.dampness"));
        let nobody = refused("*.recovery_s", "*.switch");
        assert!(nobody.contains("condition weak: controller.*.switch: no"));
        assert!(refused("round-trip", "round").contains("neither a file nor a built-in"));
    }
}
