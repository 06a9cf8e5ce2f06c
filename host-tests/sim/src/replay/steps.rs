//! The steps of a log, which tell whether its time is in seconds.

use anyhow::bail;

/// Shortest and longest step \[s\] that the guidance runs on: `MIN_STEP` and `MAX_STEP` of the core.
const STEPS: [f64; 2] = [1e-4, 0.2];
/// What the usual step may be beyond those, as a factor: of a log at 5 Hz every second step is a little longer.
const BEYOND: f64 = 1.5;

/// Units that a time may be in instead: seconds each, and the name.
const UNITS: [(f64, &str); 5] = [
    (1e-3, "milliseconds"),
    (1e-6, "microseconds"),
    (1e-9, "nanoseconds"),
    (60.0, "minutes"),
    (3600.0, "hours"),
];

/// Fewer steps than these have no usual one: a row or two may be repeated, or be all that there is.
const FEWEST: usize = 10;

/// Refuses times \[s\] whose usual step, the median, no controller runs on. Few times, and those that run backwards or are none, are left to the reader
/// of the rows, who names the line.
pub fn check(times: &[f64]) -> anyhow::Result<()> {
    let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if steps.len() < FEWEST {
        return Ok(());
    }
    if steps.iter().all(|step| *step == 0.0) {
        bail!("the time stands still at {} s in every row", times[0]);
    }
    // A log may repeat rows.
    let mut moving: Vec<f64> = steps.into_iter().filter(|step| *step > 0.0).collect();
    moving.sort_by(f64::total_cmp);
    let Some(&usual) = moving.get(moving.len() / 2) else {
        return Ok(());
    };
    let [least, most] = STEPS;
    if (least / BEYOND..=most * BEYOND).contains(&usual) {
        return Ok(());
    }
    let fits = |(scale, _): &(f64, &str)| (least..=most).contains(&(usual * scale));
    let unit = UNITS.into_iter().find(fits);
    let unit = unit.map_or("in another unit?".to_owned(), |(scale, name)| {
        format!(
            "in {name}? In a map (--map) that is `time = {{ from = \"…\", scale = {scale:?} }}`"
        )
    });
    bail!(
        "the usual step is {usual} s, and no controller runs on less than {least} s or more than {most} s: is the time {unit}"
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::refusals::says;

    fn at(step: f64) -> anyhow::Result<()> {
        let times: Vec<f64> = (0..100).map(|n| 2.0 + f64::from(n) * step).collect();
        check(&times)
    }

    #[test]
    fn steps_that_no_controller_runs_on_ask_for_the_unit() {
        for fine in [0.001, 0.0025, 0.02, 0.1, 0.2, 0.201] {
            assert!(at(fine).is_ok(), "{fine}");
        }
        for (seconds, name) in UNITS {
            // At 50 Hz; minutes at less than 250 Hz may be seconds at some kHz.
            let step = if seconds > 1.0 { 0.002 } else { 0.02 };
            let error = at(step / seconds).unwrap_err().to_string();
            says(&error, &[name, &format!("scale = {seconds:?}")]);
        }
        says(&at(1e30).unwrap_err().to_string(), &["in another unit?"]);
        assert!([0, 1, 2, 10].iter().all(|n| check(&vec![1.0; *n]).is_ok()));
        // A row or two a second apart have no usual step.
        assert!(check(&[0.0, 1.0]).is_ok() && check(&[0.0, 1.0, 2.0]).is_ok());
        // What only runs backwards, or is no number, has no step forward: its line is named elsewhere.
        let backwards: Vec<f64> = (0..20).rev().map(f64::from).collect();
        assert!(check(&backwards).is_ok() && check(&[f64::NAN; 20]).is_ok());
        says(
            &check(&[1.0; 11]).unwrap_err().to_string(),
            &["stands still at 1 s"],
        );
        // Rows that are repeated, and one gap.
        let repeated: Vec<f64> = (0..100).map(|n| f64::from(n / 5) * 0.02).collect();
        assert!(check(&repeated).is_ok());
        let gap: Vec<f64> = (0..20)
            .map(|n| f64::from(n) * 0.02 + if n < 10 { 0.0 } else { 50.0 })
            .collect();
        assert!(check(&gap).is_ok());
    }

    /// The core's limits are what stands here.
    #[test]
    fn the_limits_are_the_cores() {
        let [least, most] = STEPS;
        let source = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../src/guidance/supervision.rs"
        );
        let source = std::fs::read_to_string(source).unwrap();
        says(
            &source,
            &[
                &format!("MIN_STEP: f32 = {least:e};"),
                &format!("MAX_STEP: f32 = {most};"),
            ],
        );
    }
}
