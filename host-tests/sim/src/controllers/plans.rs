//! `[controller.guidance.plans]`: when plans come, where they are made by a task of lower priority.

use alula::GuidanceOutput;
use alula::guidance::{Candidate, PlanSearch};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// When plans come. The default is at once, whenever one is due.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PlanSpec {
    /// How long after the step that asks for it \[s\].
    pub late_s: f64,
    /// Every so many do not come: 2 is every other one. 0: all come.
    pub missing_every: u32,
    /// From when to when none come \[s\].
    pub none_s: Option<[f64; 2]>,
}

/// A task that makes plans.
#[derive(Clone, Debug)]
pub struct PlanTask {
    spec: PlanSpec,
    t: f64,
    /// What is being made, and when it comes.
    made: Option<(f64, PlanSearch)>,
    begun: u32,
    /// What was looked at in the plan that was begun in the last step.
    looked_at: Vec<Candidate>,
}

impl PlanTask {
    /// The task of `spec`.
    pub fn new(spec: PlanSpec) -> Self {
        Self {
            spec,
            t: 0.0,
            made: None,
            begun: 0,
            looked_at: Vec::new(),
        }
    }

    /// What was looked at in the plan that was begun in the last step, in this order; nothing if none was.
    pub fn looked_at(&self) -> &[Candidate] {
        &self.looked_at
    }

    /// After a step of `dt` \[s\]: the plan that comes now, if one does. `search` begins one, `look` looks at a candidate.
    pub fn after(
        &mut self,
        output: &GuidanceOutput,
        dt: f32,
        search: impl FnOnce() -> PlanSearch,
        look: impl FnMut(&mut PlanSearch) -> Option<Candidate>,
    ) -> Option<PlanSearch> {
        let spec = self.spec;
        self.looked_at.clear();
        self.t += f64::from(dt);
        if output.plan_due && self.made.is_none() {
            self.begun += 1;
            let missing = spec.missing_every > 0 && self.begun.is_multiple_of(spec.missing_every);
            let paused = |[from, to]: [f64; 2]| (from..to).contains(&self.t);
            if !missing && !spec.none_s.is_some_and(paused) {
                let (mut search, mut look) = (search(), look);
                self.looked_at
                    .extend(std::iter::from_fn(|| look(&mut search)));
                self.made = Some((self.t + spec.late_s, search));
            }
        }
        let (_, search) = self.made.take_if(|(comes, _)| *comes <= self.t)?;
        Some(search)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The steps, of 10 ms, after which a plan comes, where one is due whenever none is being made.
    fn come(spec: PlanSpec, steps: u32) -> Vec<u32> {
        let mut task = PlanTask::new(spec);
        let mut output = GuidanceOutput::default();
        output.plan_due = true;
        let mut comes = |_: &u32| {
            let plan = task.after(&output, 0.01, PlanSearch::default, |_| None);
            plan.is_some()
        };
        (1..=steps).filter(|n| comes(n)).collect()
    }

    #[test]
    fn plans_come_as_is_said() {
        let at_once = PlanSpec::default();
        assert_eq!(come(at_once, 4), [1, 2, 3, 4]);
        let late = PlanSpec {
            late_s: 0.045,
            ..at_once
        };
        assert_eq!(come(late, 13), [6, 12]);
        let missing = PlanSpec {
            missing_every: 2,
            ..at_once
        };
        assert_eq!(come(missing, 6), [1, 3, 5]);
        let none = PlanSpec {
            none_s: Some([0.015, 0.035]),
            ..at_once
        };
        assert_eq!(come(none, 5), [1, 4, 5]);
    }
}
