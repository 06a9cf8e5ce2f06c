//! The steps of a log, which tell whether its time is in seconds.

use anyhow::bail;

/// Shortest and longest step \[s\] that the guidance runs on: `MIN_STEP` and `MAX_STEP` of the core.
const STEPS: [f64; 2] = [1e-4, 0.2];
/// What the usual step may be beyond those, as a factor: of a log at 5 Hz every second step is a little longer.
const BEYOND: f64 = 1.5;

/// A unit that a time may be in instead.
struct Unit {
    /// Seconds each.
    seconds: f64,
    name: &'static str,
    /// How a header says it.
    sign: &'static str,
}

const UNITS: [Unit; 5] = [
    unit(1e-3, "milliseconds", "ms"),
    unit(1e-6, "microseconds", "us"),
    unit(1e-9, "nanoseconds", "ns"),
    unit(60.0, "minutes", "min"),
    unit(3600.0, "hours", "h"),
];

const fn unit(seconds: f64, name: &'static str, sign: &'static str) -> Unit {
    Unit {
        seconds,
        name,
        sign,
    }
}

/// What formats have whose times have a unit.
const CLOCKS: &str = "ULog and DataFlash have microseconds; MCAP has nanoseconds, and a `timestamp` of its messages seconds";

/// How a user may say the unit of a log's times.
pub enum Times<'a> {
    /// In the column of a trace: in no way.
    Trace,
    /// In the header of a table, of which this is the name of the time.
    Header(&'a str),
    /// In a map, of which this is the factor.
    Map(f64),
    /// The log says it itself.
    Own,
}

/// Refuses times \[s\] whose usual step, the median, no controller runs on, and says what can be done. Those that run backwards or are none are left to
/// the reader of the rows, who names the line.
pub fn check(times: &[f64], said: &Times) -> anyhow::Result<()> {
    let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if steps.len() > 1 && steps.iter().all(|step| *step == 0.0) {
        bail!("the time stands still at {} s in every row", times[0]);
    }
    // A log may repeat rows.
    let mut moving: Vec<f64> = steps.into_iter().filter(|step| *step > 0.0).collect();
    moving.sort_by(f64::total_cmp);
    let Some(&usual) = moving.get(moving.len().saturating_sub(1) / 2) else {
        return Ok(());
    };
    let [least, most] = STEPS;
    if (least / BEYOND..=most * BEYOND).contains(&usual) {
        return Ok(());
    }
    let fits = |seconds: f64| (least..=most).contains(&(usual * seconds));
    let unit = UNITS.into_iter().find(|unit| fits(unit.seconds));
    let advice = match (unit, said) {
        (None, Times::Trace | Times::Header(_) | Times::Map(_)) => {
            "is the time in another unit?".to_owned()
        }
        (Some(Unit { seconds, name, .. }), Times::Trace) => {
            format!(
                "is the time in {name}? The column t_s is in seconds: multiply it by {seconds:?}"
            )
        }
        (Some(Unit { name, sign, .. }), Times::Header(header)) => {
            format!("is the time in {name}? The header says so by `{header} [{sign}]`")
        }
        (Some(Unit { seconds, name, .. }), Times::Map(factor)) => format!(
            "is the time in {name}? In the map's `time` that is `scale = {:?}`",
            factor * seconds
        ),
        (_, Times::Own) => {
            let times = [1e3, 1e6, 1e9, 1e-3, 1e-6, 1e-9];
            let factor = times.into_iter().find(|factor| fits(*factor));
            let off = factor.map_or("is its clock in another unit?".to_owned(), |factor| {
                let (by, wrong) = if factor > 1.0 {
                    (factor, "slow")
                } else {
                    (factor.recip().round(), "fast")
                };
                format!("its clock seems to run {by} times too {wrong}.")
            });
            format!("{off} {CLOCKS}")
        }
    };
    bail!(
        "the usual step is {usual} s, and no controller runs on less than {least} s or more than {most} s: {advice}"
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::refusals::says;

    /// Of so many rows.
    fn rows(count: u32, step: f64) -> anyhow::Result<()> {
        let times: Vec<f64> = (0..count).map(|n| 2.0 + f64::from(n) * step).collect();
        check(&times, &Times::Trace)
    }

    fn ok(times: &[f64]) -> bool {
        check(times, &Times::Own).is_ok()
    }

    /// However few rows there are.
    #[test]
    fn steps_that_no_controller_runs_on_ask_for_the_unit() {
        for count in [2, 3, 5, 11, 100] {
            for fine in [0.001, 0.0025, 0.02, 0.1, 0.2, 0.201] {
                assert!(rows(count, fine).is_ok(), "{fine}");
            }
            for Unit { seconds, name, .. } in UNITS {
                // At 50 Hz; minutes at less than 250 Hz may be seconds at some kHz.
                let step = if seconds > 1.0 { 0.002 } else { 0.02 };
                let error = rows(count, step / seconds).unwrap_err().to_string();
                says(&error, &[name]);
            }
        }
        says(
            &rows(9, 1e30).unwrap_err().to_string(),
            &["in another unit?"],
        );
        assert!([0, 1, 2].iter().all(|n| ok(&vec![1.0; *n])));
        // One gap among few rows.
        assert!(ok(&[0.0, 0.02, 9.0]) && !ok(&[0.0, 1.0]));
        // What only runs backwards, or is no number, has no step forward: its line is named elsewhere.
        let backwards: Vec<f64> = (0..20).rev().map(f64::from).collect();
        assert!(ok(&backwards) && ok(&[f64::NAN; 20]));
        says(
            &check(&[1.0; 3], &Times::Own).unwrap_err().to_string(),
            &["stands still at 1 s"],
        );
        // Rows that are repeated, and one gap.
        let repeated: Vec<f64> = (0..100).map(|n| f64::from(n / 5) * 0.02).collect();
        assert!(ok(&repeated));
        let gap: Vec<f64> = (0..20)
            .map(|n| f64::from(n) * 0.02 + if n < 10 { 0.0 } else { 50.0 })
            .collect();
        assert!(ok(&gap));
    }

    /// A log that has its own clock says how far that is off, and which units its format has: whichever of two clocks is wrong.
    #[test]
    fn a_clock_of_its_own_is_said_to_be_off() {
        for (step, words) in [
            (2e-5, "run 1000 times too slow"),
            (2e-8, "run 1000000 times too slow"),
            (20.0, "run 1000 times too fast"),
            (2e7, "run 1000000000 times too fast"),
            (1e30, "in another unit?"),
        ] {
            let times: Vec<f64> = (0..9).map(|n| f64::from(n) * step).collect();
            let error = check(&times, &Times::Own).unwrap_err().to_string();
            says(
                &error,
                &[
                    words,
                    "MCAP has nanoseconds",
                    "`timestamp` of its messages seconds",
                ],
            );
        }
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
