//! The time of messages: their own `timestamp`, whose unit the times at which they were logged tell.

use super::Rows;

/// A unit: how many are a second, and its name.
type Unit = (f64, &'static str);

/// Units that a `timestamp` may have.
const UNITS: [Unit; 4] = [
    (1.0, "seconds"),
    (1e3, "milliseconds"),
    (1e6, "microseconds"),
    (1e9, "nanoseconds"),
];
/// How far the two clocks may be apart \[s\] from one channel to the next, and be two of one time.
const APART: f64 = 1.0;

/// Steps \[s\] that rows of a flight log may have.
const STEPS: [f64; 2] = [1e-4, 2.0];

/// The time \[s\] of each row of the channels, named. What was assumed is added to `notes`.
pub(super) fn times<'a>(
    channels: impl Iterator<Item = (&'a str, &'a Rows)>,
    notes: &mut Vec<String>,
) -> Vec<Vec<f64>> {
    let channels: Vec<(&str, &Rows)> = channels.collect();
    let logged = || {
        channels
            .iter()
            .map(|(_, rows)| rows.logged.clone())
            .collect()
    };
    let stamped = |rows: &Rows| rows.stamps.iter().filter(|stamp| stamp.is_finite()).count();
    if channels.iter().all(|(_, rows)| stamped(rows) == 0) {
        return logged();
    }
    // Where the log has one time for all there is no second clock.
    let all = channels.iter().flat_map(|(_, rows)| &rows.logged);
    if span(all.copied()) == 0.0 {
        return channels
            .iter()
            .map(|(_, rows)| rows.stamps.clone())
            .collect();
    }
    // The time logged is nanoseconds by the format, and some writers have others: it then tells no unit.
    let whole = channels
        .iter()
        .all(|(_, rows)| stamped(rows) == rows.stamps.len());
    let longest = channels.iter().max_by_key(|(_, rows)| rows.stamps.len());
    if let Some((_, rows)) = longest.filter(|_| whole)
        && !is_step(&rows.logged)
        && is_step(&rows.stamps)
    {
        notes.push(format!(
            "the time logged runs over {} s where `timestamp` runs over {}: the time logged is none, and `timestamp` is taken for seconds",
            span(rows.logged.iter().copied()),
            span(rows.stamps.iter().copied())
        ));
        return channels
            .iter()
            .map(|(_, rows)| rows.stamps.clone())
            .collect();
    }
    // That of all messages counts for a channel that does not last, as where each message has a channel of its own.
    let pairs = |rows: &Rows| pairs(rows).collect::<Vec<_>>();
    let common = by_span(
        &channels
            .iter()
            .flat_map(|(_, rows)| pairs(rows))
            .collect::<Vec<_>>(),
    );
    let common = common.unwrap_or(Some(UNITS[0]));
    let mut times = Vec::new();
    let mut offsets: Vec<f64> = Vec::new();
    let mut units: Vec<&str> = Vec::new();
    for (name, rows) in &channels {
        let own = pairs(rows);
        let unit = by_span(&own).unwrap_or_else(|| by_epoch(&own).or(common));
        let Some((per_second, word)) = unit else {
            notes.push(format!(
                "{name}: its `timestamp` runs over {} where it was logged over {:.3} s: the time logged is taken",
                span(rows.stamps.iter().copied()),
                span(rows.logged.iter().copied())
            ));
            return logged();
        };
        let time: Vec<f64> = rows.stamps.iter().map(|stamp| stamp / per_second).collect();
        let off = std::iter::zip(&time, &rows.logged).map(|(time, logged)| time - logged);
        let mut off: Vec<f64> = off.filter(|off| off.is_finite()).collect();
        off.sort_by(f64::total_cmp);
        offsets.extend(off.get(off.len() / 2));
        if stamped(rows) < rows.stamps.len() {
            // Rows without one have the time logged.
            offsets.push(0.0);
        }
        if stamped(rows) > 0 && per_second != 1.0 && !units.contains(&word) {
            units.push(word);
        }
        let time = std::iter::zip(time, &rows.logged);
        times.push(
            time.map(|(time, logged)| if time.is_finite() { time } else { *logged })
                .collect(),
        );
    }
    if span(offsets.iter().copied()) > APART {
        notes.push(
            "`timestamp` and the time logged are of different clocks, and not every message has the one: the time logged is taken".into(),
        );
        return logged();
    }
    if !units.is_empty() {
        notes.push(format!(
            "`timestamp` is in {}, by the times at which messages were logged",
            units.join(" and ")
        ));
    }
    times
}

/// Whether the usual step of these times, if there is one, is one of a flight log in seconds.
fn is_step(times: &[f64]) -> bool {
    let steps = times.windows(2).map(|pair| pair[1] - pair[0]);
    let mut steps: Vec<f64> = steps.filter(|step| *step > 0.0).collect();
    steps.sort_by(f64::total_cmp);
    let usual = steps.get(steps.len() / 2);
    usual.is_none_or(|usual| (STEPS[0]..=STEPS[1]).contains(usual))
}

/// Both times of each message that has a stamp: when it was logged \[s\], and the stamp.
fn pairs(rows: &Rows) -> impl Iterator<Item = (f64, f64)> {
    let both = std::iter::zip(&rows.logged, &rows.stamps);
    both.filter(|(_, stamp)| stamp.is_finite())
        .map(|(logged, stamp)| (*logged, *stamp))
}

/// The unit of the stamps, by how long they last: none if they do not, and `Some(None)` if none fits.
fn by_span(pairs: &[(f64, f64)]) -> Option<Option<Unit>> {
    let logged = span(pairs.iter().map(|pair| pair.0));
    let stamps = span(pairs.iter().map(|pair| pair.1));
    if logged <= 0.0 {
        return None;
    }
    let fits = |(per_second, _): &Unit| (0.5..2.0).contains(&(stamps / logged / per_second));
    Some(UNITS.into_iter().find(fits))
}

/// The unit in which a stamp is about the time at which its message was logged, if there is one.
fn by_epoch(pairs: &[(f64, f64)]) -> Option<Unit> {
    let &(logged, stamp) = pairs.first()?;
    let apart = |unit: &Unit| (stamp / unit.0 - logged).abs();
    let nearest = UNITS
        .into_iter()
        .min_by(|a, b| apart(a).total_cmp(&apart(b)))?;
    (apart(&nearest) <= f64::min(APART, 0.1 * logged)).then_some(nearest)
}

/// From the least to the greatest of the finite values.
fn span(values: impl Iterator<Item = f64>) -> f64 {
    let finite = values.filter(|v| v.is_finite());
    let ends = finite.fold(None, |ends, v| match ends {
        None => Some((v, v)),
        Some((least, most)) => Some((f64::min(least, v), f64::max(most, v))),
    });
    ends.map_or(0.0, |(least, most)| most - least)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(logged: &[f64], stamps: &[f64]) -> Rows {
        Rows {
            logged: logged.to_vec(),
            stamps: stamps.to_vec(),
            columns: Vec::new(),
            places: std::collections::BTreeMap::new(),
        }
    }

    fn of(channels: &[Rows]) -> (Vec<Vec<f64>>, Vec<String>) {
        let mut notes = Vec::new();
        let times = times(channels.iter().map(|rows| ("x", rows)), &mut notes);
        (times, notes)
    }

    #[test]
    fn the_unit_is_told_by_the_second_clock() {
        let logged = [2.0, 2.05, 2.1];
        for (per_second, word) in UNITS {
            let stamps = logged.map(|t| t * per_second);
            // A channel of one message has the unit of the others.
            let (times, notes) = of(&[rows(&logged, &stamps), rows(&[2.0], &[2.0 * per_second])]);
            let close = |a: f64, b: f64| (a - b).abs() < 1e-12;
            assert!(
                std::iter::zip(&times[0], logged).all(|(a, b)| close(*a, b)),
                "{times:?}"
            );
            assert_eq!(times[1], [2.0]);
            assert_eq!(notes.len(), usize::from(per_second != 1.0));
            assert!(notes.iter().all(|note| note.contains(word)), "{notes:?}");
        }
        // Of an epoch of its own, as since power-on.
        let (times, notes) = of(&[rows(&[1e9, 1e9 + 1.0], &[5e6, 6e6])]);
        assert_eq!((&times[0][..], notes.len()), (&[5.0, 6.0][..], 1));
    }

    /// A writer of MCAP that puts microseconds, milliseconds or seconds where nanoseconds belong, beside a right `timestamp`.
    #[test]
    fn a_time_logged_in_another_unit_tells_none() {
        let stamps = [2.0, 2.05, 2.1];
        for wrong in [1e3, 1e6, 1e9] {
            let logged = stamps.map(|t| t / wrong);
            let (times, notes) = of(&[rows(&logged, &stamps), rows(&logged[..1], &stamps[..1])]);
            assert_eq!(times, [&stamps[..], &[2.0]]);
            assert!(notes[0].contains("`timestamp` is taken"), "{notes:?}");
        }
        // Where neither is right, it is the time logged that is converted.
        let (times, _) = of(&[rows(&[2e-3, 2.05e-3], &[2e3, 2.05e3])]);
        assert!((times[0][0] - 2e-3).abs() < 1e-12, "{times:?}");
    }

    #[test]
    fn clocks_that_disagree_are_said_to() {
        let (times, notes) = of(&[rows(&[0.0, 1.0], &[0.0, 30.0])]);
        assert_eq!(times, [[0.0, 1.0]]);
        assert!(
            notes[0].contains("runs over 30 where it was logged over 1.000 s"),
            "{notes:?}"
        );
        // A channel without stamps beside one with those of another epoch.
        let without = rows(&[1e9, 1e9 + 1.0], &[f64::NAN; 2]);
        let (times, notes) = of(&[rows(&[1e9, 1e9 + 1.0], &[5.0, 6.0]), without]);
        assert_eq!(times, [[1e9, 1e9 + 1.0]; 2]);
        assert!(notes[0].contains("different clocks"), "{notes:?}");
        // Of one epoch, each has its own.
        let without = rows(&[5.1, 6.1], &[f64::NAN; 2]);
        let (times, notes) = of(&[rows(&[5.1, 6.1], &[5.0, 6.0]), without]);
        assert_eq!(
            (times, notes.len()),
            (vec![vec![5.0, 6.0], vec![5.1, 6.1]], 0)
        );
        // Without a second clock the stamps are seconds.
        let (times, notes) = of(&[rows(&[0.0, 0.0], &[5.0, 6.0])]);
        assert_eq!((times, notes.len()), (vec![vec![5.0, 6.0]], 0));
    }

    /// Each message a channel of its own: the unit is that of all, or told by the second clock at each.
    #[test]
    fn channels_of_one_message_have_the_unit_of_all() {
        for epoch in [2.0, 1.7e9] {
            for (per_second, word) in UNITS {
                let times = [epoch, epoch + 0.05, epoch + 4.0];
                let channels = times.map(|t| rows(&[t], &[t * per_second]));
                let (read, notes) = of(&channels);
                for (read, want) in std::iter::zip(read, times) {
                    // Nanoseconds since 1970 have 61 bits, and a float 53.
                    assert!((read[0] - want).abs() < 1e-6, "{read:?} {want}");
                }
                assert_eq!(notes.len(), usize::from(per_second != 1.0));
                assert!(notes.iter().all(|note| note.contains(word)), "{notes:?}");
            }
        }
        // Since power-on, and the log's since 1970.
        let channels = [0.0, 0.05, 4.0].map(|t| rows(&[1.7e9 + t], &[(t + 7.0) * 1e6]));
        let (times, _) = of(&channels);
        assert_eq!(times, [[7.0], [7.05], [11.0]]);
        // A channel in milliseconds beside one in microseconds, of one message each, and one that lasts.
        let channels = [rows(&[20.0, 21.0], &[20e6, 21e6]), rows(&[20.5], &[20.5e3])];
        let (times, notes) = of(&channels);
        assert_eq!(times, [vec![20.0, 21.0], vec![20.5]]);
        assert!(
            notes[0].contains("microseconds and milliseconds"),
            "{notes:?}"
        );
    }
}
