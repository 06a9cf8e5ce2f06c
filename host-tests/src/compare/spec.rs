//! What is compared: the base mission, the policies, the conditions. TOML in, validated missions out.

use anyhow::{Context, anyhow};
use serde::Deserialize;
use toml::{Table, Value};

use crate::mission::{Draft, Mission, MissionSource};
use crate::named::Named;
use crate::scenario::{FieldError, from_toml};

/// Name and TOML text of the built-in comparison.
const BUILT_IN: &[(&str, &str)] = &[(
    "tail-sitter",
    include_str!("../../comparisons/tail-sitter.toml"),
)];

/// A comparison to fly. The format is described in this package's README.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Comparison {
    /// One line for reports.
    #[serde(default)]
    pub description: String,
    /// The base mission: a built-in or a TOML file.
    pub mission: String,
    /// Who flies.
    pub policies: Vec<Policy>,
    /// Under which conditions.
    pub conditions: Vec<Condition>,
    /// Names of the conditions that are drawn.
    #[serde(default)]
    pub charts: Vec<String>,
    /// Markdown before the tables: a template that knows the results.
    #[serde(default)]
    pub introduction: String,
    /// Markdown after the summary: a template that knows the results.
    #[serde(default)]
    pub discussion: String,
}

/// `[[policies]]`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Policy {
    /// Its name.
    pub name: String,
    /// One line for reports.
    pub title: String,
    /// An earlier policy that it starts from; the base mission if left out.
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
    /// How many seeds are flown, from the mission's on.
    #[serde(default = "one")]
    pub seeds: u64,
}

fn one() -> u64 {
    1
}

/// Most seeds of a condition.
const MAX_SEEDS: u64 = 10_000;

/// A comparison with its missions made.
#[derive(Clone, Debug)]
pub struct Plan {
    /// What was asked for.
    pub comparison: Comparison,
    /// The missions: of every condition, of every policy, of every seed.
    pub missions: Vec<Vec<Vec<Mission>>>,
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
        let error = |field: String, problem: &str| Err(FieldError::new(field, problem));
        if self.policies.is_empty() || self.conditions.is_empty() {
            return error("policies".into(), "and conditions must not be empty");
        }
        for (i, policy) in self.policies.iter().enumerate() {
            let earlier = |name: &str| self.policies[..i].iter().any(|p| p.name == name);
            if earlier(&policy.name) {
                return error(
                    format!("policies[{i}].name"),
                    "is not the first of its name",
                );
            }
            if policy.base.as_ref().is_some_and(|base| !earlier(base)) {
                return error(format!("policies[{i}].base"), "is no earlier policy");
            }
        }
        for (i, condition) in self.conditions.iter().enumerate() {
            let same = |c: &Condition| c.name == condition.name;
            if self.conditions[..i].iter().any(same) {
                return error(
                    format!("conditions[{i}].name"),
                    "is not the first of its name",
                );
            }
            if !(1..=MAX_SEEDS).contains(&condition.seeds) {
                return error(format!("conditions[{i}].seeds"), "must be from 1 to 10000");
            }
        }
        for (i, name) in self.charts.iter().enumerate() {
            if !self.conditions.iter().any(|c| c.name == *name) {
                return error(format!("charts[{i}]"), "is no condition");
            }
        }
        Ok(())
    }

    /// The base mission with the fields of policy `i`, and the name of its controller.
    fn policy(&self, i: usize, base: &Draft, flown: &str) -> Result<(Draft, String), FieldError> {
        let policy = &self.policies[i];
        let before = |name: &String| self.policies.iter().position(|p| p.name == *name);
        let (mut draft, mut controller) = match policy.base.as_ref().and_then(before) {
            Some(earlier) => self.policy(earlier, base, flown)?,
            None => (base.clone(), flown.to_owned()),
        };
        if let Some(table) = &policy.controller {
            controller = table.keys().next().cloned().unwrap_or_default();
            draft.set("controller", Value::Table(table.clone()))?;
        }
        for (path, value) in &policy.set {
            draft.set(path, value.clone())?;
        }
        Ok((draft, controller))
    }

    /// The missions, on the base mission whose text is `base`.
    fn missions(&self, base: &str) -> anyhow::Result<Vec<Vec<Vec<Mission>>>> {
        let flown = base.parse::<Table>()?;
        let flown = flown.get("controller").and_then(Value::as_table);
        let flown = flown.and_then(|c| c.keys().next()).map_or("", |k| k);
        let base = Draft::new(base)?;
        let policies = self.policies.iter().enumerate().map(|(i, policy)| {
            let made = self.policy(i, &base, flown);
            made.map_err(|e| anyhow!("policy {}: {}: {}", policy.name, e.field, e.problem))
        });
        let policies = policies.collect::<anyhow::Result<Vec<_>>>()?;
        for condition in &self.conditions {
            for path in condition.set.keys() {
                let Some(rest) = path.strip_prefix(ANY) else {
                    continue;
                };
                let has = |(draft, name): &(Draft, String)| {
                    draft.number(&format!("controller.{name}.{rest}")).is_ok()
                };
                if !policies.iter().any(has) {
                    let name = &condition.name;
                    return Err(anyhow!(
                        "condition {name}: {path}: no controller has this number"
                    ));
                }
            }
        }
        let seeded = |condition: &Condition, policy: usize| -> Result<Vec<Mission>, FieldError> {
            let (mut draft, controller) = policies[policy].clone();
            for (path, value) in &condition.set {
                match path.strip_prefix(ANY) {
                    None => draft.set(path, value.clone())?,
                    Some(rest) => {
                        let path = format!("controller.{controller}.{rest}");
                        if draft.number(&path).is_ok() {
                            draft.set(&path, value.clone())?;
                        }
                    }
                }
            }
            let mission = draft.mission()?;
            let seed = |n| Mission {
                seed: mission.seed + n,
                ..mission.clone()
            };
            Ok((0..condition.seeds).map(seed).collect())
        };
        self.conditions
            .iter()
            .map(|condition| {
                (0..self.policies.len())
                    .map(|i| {
                        seeded(condition, i).map_err(|e| {
                            let (policy, name) = (&self.policies[i].name, &condition.name);
                            let FieldError { field, problem } = e;
                            anyhow!("policy {policy}, condition {name}: {field}: {problem}")
                        })
                    })
                    .collect()
            })
            .collect()
    }
}

impl Plan {
    /// Number of flights.
    pub fn flights(&self) -> usize {
        self.missions.iter().flatten().map(Vec::len).sum()
    }
}

impl Source {
    /// The comparison that `argument` names: the built-in one, or else a TOML file.
    pub fn load(argument: &str) -> anyhow::Result<Self> {
        Self::new(&Named::find("comparison", BUILT_IN, argument)?)
    }

    /// The comparison in the text.
    pub fn new(text: &Named) -> anyhow::Result<Self> {
        let origin = &text.origin;
        let comparison: Comparison = from_toml(origin, &text.text, Comparison::validate)?;
        let base = MissionSource::named_in(text, &comparison.mission)?;
        let missions = comparison.missions(&base.text).context(origin.to_owned())?;
        Ok(Self {
            name: text.name.clone(),
            plan: Plan {
                comparison,
                missions,
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mission::ControllerSpec;

    fn named(text: &str) -> Named {
        Named {
            name: "x".to_owned(),
            origin: "x.toml".to_owned(),
            text: text.to_owned(),
            file: None,
        }
    }

    const SMALL: &str = r#"
        mission = "round-trip"
        [[policies]]
        name = "a"
        title = "as it is"
        [[policies]]
        name = "b"
        title = "with other gains"
        base = "a"
        set = { "controller.guidance.gains.bandwidth.damping" = 0.7 }
        [[conditions]]
        name = "weak"
        title = "weak motors"
        seeds = 2
        set = { "plant.thrust_n[1]" = 112.8, "controller.*.limits.thrust_n[1]" = 112.8 }
    "#;

    fn refused(from: &str, to: &str) -> String {
        assert!(SMALL.contains(from));
        let error = Source::new(&named(&SMALL.replace(from, to))).unwrap_err();
        format!("{error:#}")
    }

    #[test]
    fn policies_and_conditions_set_fields_by_name() {
        let plan = Source::new(&named(SMALL)).unwrap().plan;
        assert_eq!(plan.flights(), 4);
        let [weak] = &plan.missions[..] else {
            panic!("one condition")
        };
        assert_ne!(weak[0][0].controller, weak[1][0].controller);
        for mission in weak.iter().flatten() {
            let limits = mission.controller.guidance().unwrap().limits;
            assert_eq!(
                (mission.plant.thrust_n[1], limits.thrust_n[1]),
                (112.8, 112.8)
            );
        }
        assert_eq!((weak[1][0].seed, weak[1][1].seed), (0, 1));
    }

    #[test]
    fn the_built_in_sets_each_policys_own_switch() {
        let plan = Source::load("tail-sitter").unwrap().plan;
        let position = |name: &str| {
            let conditions = &plan.comparison.conditions;
            conditions.iter().position(|c| c.name == name).unwrap()
        };
        let slow = &plan.missions[position("stall-band")];
        let speeds: Vec<_> = slow
            .iter()
            .filter_map(|missions| match &missions[0].controller {
                ControllerSpec::Guidance(_) => None,
                ControllerSpec::Px4Like(spec) => Some(spec.switch.cruise_m_s),
                ControllerSpec::ArduPilotLike(spec) => Some(spec.switch.cruise_m_s),
            })
            .collect();
        assert_eq!(speeds, [14.5; 4]);
    }

    #[test]
    fn errors_say_where() {
        assert!(refused("\"weak\"", "\"weak\"\nseed = 1").contains("conditions[0].seed: unknown"));
        assert!(refused("seeds = 2", "seeds = 0").contains("conditions[0].seeds: must be"));
        assert!(refused("base = \"a\"", "base = \"c\"").contains("policies[1].base: is no"));
        assert!(refused("\"b\"", "\"a\"").contains("policies[1].name: is not the first"));
        let unknown = refused(".damping\"", ".dampness\"");
        assert!(unknown.contains("policy b, condition weak: controller.guidance.gains"));
        let nobody = refused("*.limits", "*.switch");
        assert!(nobody.contains("condition weak: controller.*.switch.thrust_n[1]: no"));
        assert!(refused("round-trip", "round").contains("neither a file nor a built-in"));
    }
}
