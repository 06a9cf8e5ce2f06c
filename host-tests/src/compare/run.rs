//! Flying a comparison on all cores.

use std::num::NonZero;
use std::sync::Mutex;

use super::{Cell, Flight, Plan, Results, Sample};
use crate::mission::Mission;
use crate::workers::for_each;

/// Flies every mission of `plan` on `threads` threads; `visit` is told after each flight. Flights share nothing: the
/// results do not depend on the number of threads.
pub fn fly(plan: &Plan, threads: NonZero<usize>, visit: impl Fn() + Sync) -> Results {
    let missions: Vec<&Mission> = plan.missions.iter().flatten().flatten().collect();
    let flown = Mutex::new(Vec::with_capacity(missions.len()));
    for_each(&missions, threads, |number, mission| {
        let flight = Flight::of(mission);
        let mut flown = flown.lock().expect("no thread panics while it holds it");
        flown.push((number, flight));
        visit();
        true
    });
    let mut flown = flown.into_inner().expect("all threads have ended");
    flown.sort_by_key(|(number, _)| *number);
    let mut flown = flown.into_iter().map(|(_, flight)| flight);

    let comparison = &plan.comparison;
    let mut cells = Vec::new();
    for (condition, missions) in comparison.conditions.iter().zip(&plan.missions) {
        for (policy, missions) in comparison.policies.iter().zip(missions) {
            let (flights, mut samples): (Vec<Flight>, Vec<Vec<Sample>>) =
                flown.by_ref().take(missions.len()).unzip();
            cells.push(Cell {
                policy: policy.name.clone(),
                condition: condition.name.clone(),
                flights,
                samples: samples.swap_remove(0),
            });
        }
    }
    Results { cells }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    use crate::compare::Source;
    use crate::named::Named;

    #[test]
    fn results_do_not_depend_on_the_number_of_threads() {
        let text = r#"
            mission = "rough-day"
            [[policies]]
            name = "a"
            title = "as it is"
            [[policies]]
            name = "b"
            title = "without switching branches"
            set = { "controller.guidance.branch.switch" = false }
            [[conditions]]
            name = "short"
            title = "10 s"
            seeds = 3
            set = { duration_s = 10.0 }
        "#;
        let named = Named {
            name: "x".to_owned(),
            origin: "x.toml".to_owned(),
            text: text.to_owned(),
            file: None,
        };
        let plan = Source::new(&named).unwrap().plan;
        let count = AtomicUsize::new(0);
        let run = |threads| {
            let threads = NonZero::new(threads).unwrap();
            fly(&plan, threads, || {
                count.fetch_add(1, Ordering::Relaxed);
            })
        };
        let one = run(1);
        assert_eq!(count.load(Ordering::Relaxed), 6);
        assert_eq!(run(3), one);
        assert_eq!(one.cells[1].policy, "b");
        let seeds: Vec<_> = one.cells[1].flights.iter().map(|f| f.seed).collect();
        assert_eq!(seeds, [1, 2, 3]);
        assert_ne!(one.cells[0].flights[0], one.cells[0].flights[1]);
    }
}
