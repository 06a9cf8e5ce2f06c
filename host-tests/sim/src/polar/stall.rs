//! Where a wing stalls: at the greatest lift before it falls, and falls for good.
//!
//! Polars at Reynolds numbers of 1e5 to 3e5 have saw-teeth, steps where a laminar bubble bursts, and double stalls: lift falls and comes back.
//! Behind the stall lift grows again, too, up to 45°, and may exceed that at the stall. What comes back is told from that by three signs: it
//! exceeds the lift from before the fall, soon, and is more than separated flow gives.

/// What lift falls by at a stall, relative to the greatest so far. Less than that is a ripple: measured tables have some, and those of
/// other programs where they converge badly.
const FALL: f64 = 0.05;
/// What it falls by at least, in coefficients: near zero lift a part of it says nothing.
const LEAST_FALL: f64 = 0.05;
/// Within how many degrees of the greatest lift it comes back where the flow attaches again. Bubbles and double stalls take 1 to 8, and lift of
/// separated flow exceeds that of a stall at 8° to 16° after 15 and more.
const SOON: f64 = 10.0;
/// Greatest normal force coefficient of separated flow: that of a flat plate is 1.98, and thick and cambered sections have up to 2.5 at 45°
/// (SAND80-2114, NACA TN 3361). With a margin.
const SEPARATED: f64 = 2.7;

/// What separated flow lifts at most at an angle of attack \[°\].
fn separated(degrees: f64) -> f64 {
    0.5 * SEPARATED * (2.0 * degrees).to_radians().sin()
}

/// Place of the stall in `rows`, α \[°\] and c_L by increasing angle from zero lift on: the greatest lift before it falls for good. None if it
/// does not: then nothing stalls.
pub fn stall(rows: impl IntoIterator<Item = (f64, f64)>) -> Option<usize> {
    search(rows, separated).0
}

/// The same of the force across the path, c_L + c_D tan (α + δ), at angles of attack \[°\] and for δ \[rad\].
pub fn stall_of_force(rows: impl IntoIterator<Item = (f64, f64)>, delta: f64) -> Option<usize> {
    let most = |degrees: f64| {
        let alpha = degrees.to_radians();
        SEPARATED * alpha.sin() * delta.cos() / (alpha + delta).cos().max(1e-6)
    };
    search(rows, most).0
}

/// Where lift falls and comes back: places in `rows`, each of the greatest lift before it falls.
pub fn kinks(rows: impl IntoIterator<Item = (f64, f64)>) -> Vec<usize> {
    search(rows, separated).1
}

/// The stall, and the kinks before it.
fn search(
    rows: impl IntoIterator<Item = (f64, f64)>,
    separated: impl Fn(f64) -> f64,
) -> (Option<usize>, Vec<usize>) {
    let mut kinks = Vec::new();
    // Place, angle and lift of the greatest so far.
    let mut greatest: Option<(usize, f64, f64)> = None;
    let (mut lower, mut fallen) = (false, false);
    for (i, (degrees, lift)) in rows.into_iter().enumerate() {
        let Some((at, there, most)) = greatest else {
            greatest = Some((i, degrees, lift));
            continue;
        };
        if lift <= most {
            lower = true;
            fallen |= lift < most - f64::max(FALL * most, LEAST_FALL);
            continue;
        }
        let soon = degrees - there <= SOON;
        if lower && !soon {
            return (Some(at), kinks);
        }
        if fallen && lift <= separated(degrees) {
            continue;
        }
        if fallen {
            kinks.push(at);
        }
        greatest = Some((i, degrees, lift));
        (lower, fallen) = (false, false);
    }
    let at = greatest.filter(|_| fallen).map(|(at, ..)| at);
    (at, kinks)
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

    /// The stall of what lifts so, in rows.
    fn of(lift: impl Fn(f64) -> f64) -> Option<usize> {
        stall(angles().map(|a| (a, lift(a))))
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
        assert_eq!(stall([]), None);
    }

    /// Noise of ±0.02, as of a balance: the stall moves by no more than what is as flat as the noise is high, 12° · √0.04.
    #[test]
    fn noise_moves_the_stall_by_little() {
        for seed in 0..200_u32 {
            let mut state = seed.wrapping_mul(2_654_435_761).wrapping_add(1);
            let noisy = angles().map(|a| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let noise = f64::from(state >> 8) / f64::from(1 << 24) - 0.5;
                (a, rounded(a) + 0.04 * noise)
            });
            let at = 0.5 * stall(noisy).unwrap() as f64;
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
            let at = stall(rows.iter().map(|row| (row[0], row[1]))).unwrap();
            assert_eq!(rows[at][0], degrees, "{name}");
        }
    }

    /// A step of a tenth at 6°, saw-teeth, and a double stall: lift comes back above what it was, and the stall is where it falls for good.
    #[test]
    fn lift_that_comes_back_is_no_stall() {
        let step = |a: f64| if a > 6.0 { 0.1 * a - 0.12 } else { 0.1 * a };
        let stalls = |a: f64| if a > 13.0 { 0.8 } else { step(a) };
        assert_eq!(of(stalls), Some(26));
        assert_eq!(kinks(angles().map(|a| (a, stalls(a)))), [12]);
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

    /// Lift of a plate behind a stall exceeds that at the stall, at 20° as at 45°; and the end of a table may grow at the rate of attached flow.
    #[test]
    fn lift_behind_the_stall_is_none() {
        let plate = |a: f64| match a {
            a if a <= 8.0 => 0.085 * a,
            a => f64::max(0.5, 1.2 * (2.0 * a).to_radians().sin()),
        };
        let whole = (0..=180).map(|n| 0.5 * f64::from(n));
        assert_eq!(stall(whole.map(|a| (a, plate(a)))), Some(16));
        // Without a fall of a twentieth before it grows on.
        let soft = |a: f64| match a {
            a if a <= 10.0 => 0.09 * a,
            a if a <= 20.0 => 0.88,
            a => 0.88 + 0.02 * (a - 20.0),
        };
        let whole = (0..=80).map(|n| 0.5 * f64::from(n));
        assert_eq!(stall(whole.map(|a| (a, soft(a)))), Some(20));
        let grows = |a: f64| match a {
            a if a <= 11.0 => 0.1 * a,
            a if a <= 22.0 => 0.6,
            a => 0.6 + 0.1 * (a - 22.0),
        };
        assert_eq!(of(grows), Some(22));
    }
}
