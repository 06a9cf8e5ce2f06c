//! Where a wing stalls: at the greatest lift of attached flow, if lift falls behind it, or the flow separates.
//!
//! Polars at Reynolds numbers of 1e5 to 3e5 have saw-teeth, steps where a laminar bubble bursts, and double stalls: lift falls and comes back.
//! Behind the stall lift grows again, too, up to 45°, and may exceed that at the stall. Both are told apart by the secant, lift per degree from the
//! angle of zero lift, where lift has come back: attached flow keeps near its steepest, and the deeper the fall, the nearer, unless lift grows far beyond
//! what it was. That of separated flow is
//! less than half of it, and somewhat more where a section with a small slope of lift stalls early.

/// Part of the steepest secant that attached flow keeps. At their stalls sections keep 0.7 to 1, and the thickest, which stall at 25°, 0.49; separated
/// flow has 0.2 to 0.45.
const ATTACHED: f64 = 0.48;
/// What that grows by with the depth of a fall, up to [`REATTACHED`]. The depth is relative to the lift that comes back, and counts in proportion to
/// the lift before the fall over that: a plate has hardly more than the wing had at its stall, and a bubble bursts where it had half of what follows.
const DEEPER: f64 = 0.6;
/// Part of the steepest secant that lift has at least where it comes back behind the burst of a bubble, however deep it fell.
const REATTACHED: f64 = 0.7;
/// Part of the greatest lift from which on a secant counts: near zero lift noise makes it steep.
const COUNTS: f64 = 1.0 / 3.0;
/// Distance from the angle of zero lift from which on it counts \[°\]: thin sections at a Reynolds number of 1e5 are three times as steep up to 1° or 2° as
/// from there on.
const FOOT: f64 = 3.0;
/// What lift falls by behind a stall, relative to the greatest. Less than that is a ripple.
const FALL: f64 = 0.05;
/// Length over which a slope is taken where a table begins above zero lift \[°\].
const CHORD: f64 = 4.0;

/// Attached flow of a table, upright.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attached {
    /// Steepest secant: lift per degree from the angle of zero lift.
    pub slope: f64,
    /// Place of the greatest lift of attached flow.
    pub top: usize,
    /// Place of the last row before lift has fallen behind it, or the flow has separated.
    pub end: usize,
    /// Whether there is a row behind that: then lift stalls at the top.
    pub stalls: bool,
}

impl Attached {
    /// Of `rows` \[°, c_L, …\] by increasing angle. None without lift above 0.
    pub fn of<const N: usize>(rows: &[[f64; N]]) -> Option<Self> {
        let zero = zero_lift(rows)?;
        let lifts = |row: &[f64; N]| row[0] > zero && row[0] <= 90.0 && row[1] > 0.0;
        let side = || rows.iter().enumerate().filter(|(_, row)| lifts(row));
        let secant = |row: &[f64; N]| row[1] / (row[0] - zero);
        let most = side().fold(0.0, |most, (_, row)| f64::max(most, row[1]));
        let counted = side().filter(|(_, row)| row[1] >= COUNTS * most && row[0] >= zero + FOOT);
        let slope = counted.fold(0.0, |steepest, (_, row)| f64::max(steepest, secant(row)));
        let part = |row: &[f64; N]| secant(row) / slope;
        // Up to its top, and the least lift behind that; of several with the same lift the first.
        let mut flow: Option<(usize, f64)> = None;
        for (i, row) in side() {
            let needed = flow.map_or(ATTACHED, |(top, least)| {
                let [before, lift] = [rows[top][1], row[1]];
                let depth = (before - least) * before / (lift * lift);
                (ATTACHED + DEEPER * depth).min(REATTACHED)
            });
            let higher = flow.is_none_or(|(top, _)| row[1] > rows[top][1]);
            flow = match flow {
                _ if higher && part(row) >= needed => Some((i, row[1])),
                Some((top, least)) => Some((top, least.min(row[1]))),
                None => None,
            };
        }
        let (top, _) = flow?;
        let behind = || rows.iter().enumerate().skip(top + 1);
        let upright = || behind().take_while(|(_, row)| row[0] <= 90.0);
        let held = |row: &[f64; N]| row[1] >= (1.0 - FALL) * rows[top][1] && part(row) >= ATTACHED;
        let end = upright().take_while(|(_, row)| held(row)).last();
        Some(Self {
            slope,
            top,
            end: end.map_or(top, |(end, _)| end),
            stalls: upright().any(|(_, row)| !held(row)),
        })
    }

    /// The same of the flow from above, upside down: `top` and `end` are places in `rows`.
    pub fn inverted<const N: usize>(rows: &[[f64; N]]) -> Option<Self> {
        let turned: Vec<[f64; 2]> = rows.iter().rev().map(|row| [-row[0], -row[1]]).collect();
        let attached = Attached::of(&turned)?;
        Some(Self {
            top: rows.len() - 1 - attached.top,
            end: rows.len() - 1 - attached.end,
            ..attached
        })
    }
}

/// Place of the stall in `rows` \[°, c_L, …\] by increasing angle. None if lift does not fall and the flow stays attached.
pub fn stall<const N: usize>(rows: &[[f64; N]]) -> Option<usize> {
    let attached = Attached::of(rows).filter(|attached| attached.stalls);
    attached.map(|attached| attached.top)
}

/// The angle of zero lift \[°\]: the one nearest to 0 at which lift becomes positive, or where that would be below the first row.
fn zero_lift<const N: usize>(rows: &[[f64; N]]) -> Option<f64> {
    let first = rows.first()?;
    if first[0] > -1e-6 && first[1].abs() < 1e-3 {
        return Some(first[0]);
    }
    let crossings = rows.windows(2).filter_map(|pair| {
        let [a, b] = [pair[0], pair[1]];
        let crosses = a[1] < 0.0 && b[1] >= 0.0;
        crosses.then(|| a[0] - a[1] * (b[0] - a[0]) / (b[1] - a[1]))
    });
    let nearest = crossings.min_by(|a, b| a.abs().total_cmp(&b.abs()));
    nearest.or_else(|| {
        let next = rows.iter().find(|row| row[0] >= first[0] + CHORD)?;
        let slope = (next[1] - first[1]) / (next[0] - first[0]);
        let below = first[1] / slope;
        Some(first[0] - if below > 0.0 { below } else { 0.0 })
    })
}

/// Places before that of the greatest lift, `top`, behind which lift falls and comes back.
pub fn kinks<const N: usize>(rows: &[[f64; N]], top: usize) -> Vec<usize> {
    let Some(least) = rows.get(top).map(|row| FALL * row[1]) else {
        return Vec::new();
    };
    let mut kinks = Vec::new();
    let (mut greatest, mut fallen) = (0, false);
    for (i, row) in rows.iter().enumerate().take(top + 1) {
        fallen |= row[1] < rows[greatest][1] - least;
        if row[1] > rows[greatest][1] {
            kinks.extend(fallen.then_some(greatest));
            (greatest, fallen) = (i, false);
        }
    }
    kinks
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polar::Polar;

    /// Lift with its greatest value of 1 at 12°, every half degree to 24°.
    fn rounded(degrees: f64) -> f64 {
        1.0 - ((degrees - 12.0) / 12.0).powi(2)
    }

    fn angles() -> impl Iterator<Item = f64> {
        (0..=48).map(|n| 0.5 * f64::from(n))
    }

    fn rows(angles: impl Iterator<Item = f64>, lift: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
        angles.map(|a| [a, lift(a)]).collect()
    }

    /// The stall of what lifts so, in rows.
    fn of(lift: impl Fn(f64) -> f64) -> Option<usize> {
        stall(&rows(angles(), lift))
    }

    #[test]
    fn a_kink_is_no_stall() {
        let clean = of(rounded).unwrap();
        assert_eq!(clean, 24);
        // A row that is 0.005 lower than the one before it, at 5.5°.
        let kinked = |a: f64| match a {
            5.5 => rounded(5.0) - 0.005,
            a => rounded(a),
        };
        assert_eq!(of(kinked), Some(24));
        assert_eq!(of(|a| 0.1 * a), None);
        assert_eq!(stall::<2>(&[]), None);
    }

    /// Noise of ±0.02, as of a balance: the stall moves by no more than what is as flat as the noise is high, 12° · √0.04.
    #[test]
    fn noise_moves_the_stall_by_little() {
        for seed in 0..200_u32 {
            let mut state = seed.wrapping_mul(2_654_435_761).wrapping_add(1);
            let noisy = angles().map(|a| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let noise = f64::from(state >> 8) / f64::from(1 << 24) - 0.5;
                [a, rounded(a) + 0.04 * noise]
            });
            let at = 0.5 * stall(&noisy.collect::<Vec<_>>()).unwrap() as f64;
            assert!((at - 12.0).abs() <= 2.4, "{seed}: {at}");
        }
    }

    /// The presets' stall angles, as their tables say: NACA 0021 at Re = 5e6 has a dent of 0.001 at 20° and its greatest lift at 25°.
    #[test]
    fn the_presets_stall_where_their_tables_do() {
        let expected = [
            ("naca-0012-re-160e3", 9.0),
            ("naca-0012-re-5e6", 14.0),
            ("naca-0015-re-160e3", 10.0),
            ("naca-0015-re-5e6", 15.0),
            ("naca-0018-re-160e3", 10.0),
            ("naca-0018-re-5e6", 16.0),
            ("naca-0021-re-160e3", 11.0),
            ("naca-0021-re-5e6", 25.0),
        ];
        for (name, degrees) in expected {
            let rows = Polar::load(name).unwrap().degrees();
            let at = stall(&rows).unwrap();
            assert_eq!(rows[at][0], degrees, "{name}");
        }
    }

    /// A step of a tenth at 6°, saw-teeth, and a double stall: lift comes back above what it was, and the stall is where it falls for good.
    #[test]
    fn lift_that_comes_back_is_no_stall() {
        let step = |a: f64| if a > 6.0 { 0.1 * a - 0.12 } else { 0.1 * a };
        let stalls = |a: f64| if a > 13.0 { 0.8 } else { step(a) };
        assert_eq!(of(stalls), Some(26));
        assert_eq!(kinks(&rows(angles(), stalls), 26), [12]);
        assert_eq!(of(step), None);
        let teeth = |a: f64| rounded(a) - 0.1 * (a / 3.0).fract();
        assert_eq!(of(teeth), Some(24));
        // 1.2 at 10°, 1.05 at 12°, 1.25 at 16°, and down.
        let double = |a: f64| match a {
            a if a <= 10.0 => 0.12 * a,
            a if a <= 12.0 => 1.2 - 0.075 * (a - 10.0),
            a if a <= 16.0 => 1.05 + 0.05 * (a - 12.0),
            a => 1.25 - 0.05 * (a - 16.0),
        };
        assert_eq!(of(double), Some(32));
    }

    /// Saw-teeth, a stall at 9° with 0.95, a fall to 0.6 at 12°, and a rise as of a plate to 1.05 at 20°, where the secant is 0.49 of the steepest: the
    /// fall was too deep for that to be attached. Where it was a twentieth, it is.
    #[test]
    fn lift_of_a_plate_behind_a_deep_fall_is_none() {
        let rises = |least: f64| {
            move |a: f64| match a {
                a if a <= 3.0 => 0.95 / 9.0 * a,
                a if a <= 9.0 => 0.95 / 9.0 * a - 0.06 * ((9.0 - a) / 2.0).fract(),
                a if a <= 12.0 => 0.95 + (least - 0.95) * (a - 9.0) / 3.0,
                a if a <= 20.0 => least + (1.05 - least) * (a - 12.0) / 8.0,
                a => 1.05 - 0.05 * (a - 20.0),
            }
        };
        let deep = rows(angles(), rises(0.6));
        let [_, lift] = deep[40];
        let attached = Attached::of(&deep).unwrap();
        assert!(lift / 20.0 > ATTACHED * attached.slope);
        assert_eq!((attached.top, attached.stalls), (18, true));
        // Where the table ends on the rise, too.
        assert_eq!(stall(&deep[..40]), Some(18));
        assert_eq!(of(rises(0.9)), Some(40));
    }

    /// A thin section at a Reynolds number of 1e5: 0.25 per degree up to 1.5°, and 0.07 from there on.
    #[test]
    fn a_steep_foot_is_not_the_slope() {
        let lift = |a: f64| match a {
            a if a <= 1.5 => 0.25 * a,
            a if a <= 10.5 => 0.375 + 0.07 * (a - 1.5),
            _ => 0.6,
        };
        assert!(lift(10.5) / 10.5 < ATTACHED * 0.25);
        assert_eq!(of(lift), Some(21));
    }

    /// A plateau, with the greatest lift where it begins: the stall is there, and the rows are attached up to where it falls. Without a fall there is none.
    #[test]
    fn a_plateau_is_attached_to_its_end() {
        let thin = |a: f64| match a {
            a if a <= 7.0 => 0.1 * a,
            a if a <= 12.0 => 0.7 - 0.004 * (a - 7.0),
            a => 0.68 - 0.08 * (a - 12.0),
        };
        let rows = rows(angles(), thin);
        let attached = |rows: &[[f64; 2]]| {
            let attached = Attached::of(rows).unwrap();
            (attached.top, attached.end, attached.stalls)
        };
        assert_eq!(attached(&rows), (14, 24, true));
        assert_eq!(attached(&rows[..23]), (14, 22, false));
        let turned: Vec<[f64; 2]> = rows.iter().rev().map(|[a, l]| [-a, -l]).collect();
        let below = Attached::inverted(&turned).unwrap();
        assert_eq!((below.top, below.end), (48 - 14, 48 - 24));
    }

    /// Lift of a plate behind a stall exceeds that at the stall, at 20° as at 45°; and the end of a table may grow at the rate of attached flow.
    #[test]
    fn lift_behind_the_stall_is_none() {
        let plate = |a: f64| match a {
            a if a <= 8.0 => 0.085 * a,
            a => f64::max(0.5, 1.2 * (2.0 * a).to_radians().sin()),
        };
        let whole = (0..=180).map(|n| 0.5 * f64::from(n));
        assert_eq!(stall(&rows(whole, plate)), Some(16));
        // Without a fall of a twentieth before it grows on.
        let soft = |a: f64| match a {
            a if a <= 10.0 => 0.09 * a,
            a if a <= 20.0 => 0.88,
            a => 0.88 + 0.02 * (a - 20.0),
        };
        let whole = (0..=80).map(|n| 0.5 * f64::from(n));
        assert_eq!(stall(&rows(whole, soft)), Some(20));
        let grows = |a: f64| match a {
            a if a <= 11.0 => 0.1 * a,
            a if a <= 22.0 => 0.6,
            a => 0.6 + 0.1 * (a - 22.0),
        };
        assert_eq!(of(grows), Some(22));
    }

    /// A laminar bubble that bursts at 3° to 5° takes up to half of the little lift there; attached flow follows to 13°. As much of the lift lost at 10° is
    /// a stall, though it grows on at the same rate.
    #[test]
    fn a_fall_from_little_lift_is_no_stall() {
        for burst in [3.0, 4.0, 5.0] {
            for slope in [0.11, 0.12, 0.13] {
                for fall in [0.15, 0.2, 0.25] {
                    let grows = |a: f64| match a {
                        a if a <= burst => slope * a,
                        a if a <= burst + 1.0 => slope * burst - fall * (a - burst),
                        a => slope * burst - fall + 0.1 * (a - burst - 1.0),
                    };
                    let lift = |a: f64| grows(a.min(13.0)) - 0.08 * (a - 13.0).max(0.0);
                    assert_eq!(of(lift), Some(26), "{burst} {slope} {fall}");
                }
            }
        }
        let late = |a: f64| match a {
            a if a <= 10.0 => 0.11 * a,
            a if a <= 12.0 => 1.1 - 0.25 * (a - 10.0),
            a => 0.6 + 0.07 * (a - 12.0),
        };
        assert!(late(24.0) > late(10.0));
        assert_eq!(of(late), Some(20));
    }

    /// A step of a bubble is none, however small the slope of lift is: a wing of an aspect ratio of 1.5 has a third of a section's.
    #[test]
    fn a_bubble_on_a_small_slope_is_no_stall() {
        for slope in [0.03, 0.045, 0.11] {
            let lift = |a: f64| match a {
                a if a <= 6.0 => slope * a,
                a if a <= 20.0 => slope * (a - 2.0),
                a => slope * (18.0 - (a - 20.0)),
            };
            assert_eq!(of(lift), Some(40), "{slope}");
        }
    }

    /// Reflexed: lift begins above 0°. And a dead zone, without lift up to 4°, or against the angle up to 3°.
    #[test]
    fn zero_lift_may_be_late() {
        let whole = || (-28..=48).map(|n| 0.5 * f64::from(n));
        let at = |lift: &dyn Fn(f64) -> f64| -> [f64; 2] {
            let rows = rows(whole(), lift);
            let below = Attached::inverted(&rows).unwrap();
            [rows[below.top][0], rows[stall(&rows).unwrap()][0]]
        };
        let reflexed = |a: f64| match a {
            a if a < -9.0 => -0.6,
            a if a <= 5.0 => 0.1 * (a - 1.5),
            a if a <= 12.0 => 0.1 * (a - 2.7),
            a => 0.93 - 0.05 * (a - 12.0),
        };
        assert_eq!(at(&reflexed), [-9.0, 12.0]);
        let dead = |a: f64| a.signum() * (0.1 * (a.abs() - 4.0).max(0.0)).min(1.7 - 0.1 * a.abs());
        assert_eq!(at(&|a| dead(a)), [-10.5, 10.5]);
        let against = |a: f64| if a.abs() < 3.0 { -0.02 * a } else { dead(a) };
        assert_eq!(at(&|a| against(a)), [-10.5, 10.5]);
    }
}
