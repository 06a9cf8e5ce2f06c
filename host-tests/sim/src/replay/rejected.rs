//! Rows of a replay that the guidance rejects though a log knows them: a state that is old, and a time step that it does not run on.

use alula::guidance::RejectReason;

use crate::controllers::Report;
use crate::simulate::Step;

/// What is to be said of them, by their reason.
pub fn notes(record: &[Step]) -> Vec<String> {
    let rejected = |reason: RejectReason, what: &str| {
        let rows = record.iter().filter(|step| match step.answer.report {
            // What is not known at all has no age, and is told as that.
            Report::Guidance(output) => {
                output.reject_reason == Some(reason) && step.input.sample.state_age.is_finite()
            }
            Report::Law(_) | Report::Outside => false,
        });
        let times: Vec<f64> = rows.map(|step| step.t).collect();
        let (first, last) = (times.first()?, times.last()?);
        Some(format!(
            "{what} in {} of {} rows, from {first} to {last} s: the guidance rejects them ({})",
            times.len(),
            record.len(),
            reason.name()
        ))
    };
    [
        rejected(
            RejectReason::StateAge,
            "the state is older than the guidance's `state_age`",
        ),
        rejected(
            RejectReason::TimeStep,
            "the time step is none that the guidance runs on",
        ),
    ]
    .into_iter()
    .flatten()
    .collect()
}

#[cfg(test)]
mod tests {
    use crate::columns;
    use crate::experiment::Document;
    use crate::refusals::says;
    use crate::replay::Source;
    use crate::simulate::fly;

    /// A flight's trace of 2 s, in which some states are old and a row comes late: both are counted, with the times.
    #[test]
    fn states_that_are_old_and_steps_that_are_long_are_counted() {
        let mut document = Document::load("round-trip").unwrap();
        document.assign("duration_s=2").unwrap();
        let experiment = document.checked().unwrap();
        let record = fly(&experiment).unwrap();
        let mut csv = Vec::new();
        columns::write_trace(&experiment, &record, &mut csv).unwrap();
        let text = String::from_utf8(csv).unwrap();
        let mut lines: Vec<Vec<String>> = text
            .lines()
            .map(|line| line.split(',').map(str::to_owned).collect())
            .collect();
        let place = |name: &str| lines[0].iter().position(|cell| cell == name).unwrap();
        let (t, age) = (place("t_s"), place("state_age_s"));
        for line in &mut lines[101..111] {
            line[age] = "0.3".to_owned();
        }
        // Half a second without rows.
        for line in &mut lines[151..] {
            line[t] = (line[t].parse::<f64>().unwrap() + 0.5).to_string();
        }
        let rows = record.len();
        let text: Vec<String> = lines.iter().map(|line| line.join(",")).collect();
        let file = tempfile::NamedTempFile::with_suffix(".csv").unwrap();
        std::fs::write(&file, text.join("\n")).unwrap();
        let (_, said) = Source::open(file.path(), None)
            .unwrap()
            .replay(&experiment)
            .unwrap();
        let [old, late] = &said[..] else {
            panic!("{said:?}");
        };
        says(
            old,
            &[
                &format!("in 10 of {rows} rows, from 1 to 1.09 s"),
                "(state_age)",
            ],
        );
        says(late, &[&format!("in 1 of {rows} rows"), "(time_step)"]);
    }
}
