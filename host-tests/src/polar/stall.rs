//! Where a wing stalls: at the greatest lift before it falls, and falls for good.

/// What lift falls by at a stall, relative to the greatest so far. Less than that is a kink: measured tables have some, and those of
/// other programs where they converge badly.
const FALL: f64 = 0.05;
/// What it falls by at least, in coefficients: near zero lift a part of it says nothing.
const LEAST_FALL: f64 = 0.05;

/// Place of the stall in `lift`, the coefficients by increasing angle from zero lift on: the greatest of them before they fall by more than
/// a kink. None if they do not: then nothing stalls.
pub fn stall(lift: impl IntoIterator<Item = f64>) -> Option<usize> {
    let mut greatest: Option<(usize, f64)> = None;
    for (i, lift) in lift.into_iter().enumerate() {
        match greatest {
            Some((at, most)) if lift < most - f64::max(FALL * most, LEAST_FALL) => {
                return Some(at);
            }
            Some((_, most)) if lift <= most => {}
            _ => greatest = Some((i, lift)),
        }
    }
    None
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

    #[test]
    fn a_kink_is_no_stall() {
        let clean = stall(angles().map(rounded)).unwrap();
        assert_eq!(clean, 24);
        // A row that is 0.005 lower than the one before it, at 5.5°.
        let kinked = angles().map(|a| match a {
            5.5 => rounded(5.0) - 0.005,
            a => rounded(a),
        });
        assert_eq!(stall(kinked), Some(24));
        assert_eq!(stall(angles().map(|a| 0.1 * a)), None);
        assert_eq!(stall([]), None);
    }

    /// Noise of ±0.02, as of a balance: the stall moves by no more than what is as flat as the noise is high, 12° · √0.04.
    #[test]
    fn noise_moves_the_stall_by_little() {
        for seed in 0..200_u32 {
            let mut state = seed.wrapping_mul(2_654_435_761).wrapping_add(1);
            let noisy: Vec<f64> = angles()
                .map(|a| {
                    state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    rounded(a) + 0.04 * (f64::from(state >> 8) / f64::from(1 << 24) - 0.5)
                })
                .collect();
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
            let at = stall(rows.iter().map(|row| row[1])).unwrap();
            assert_eq!(rows[at][0], degrees, "{name}");
        }
    }
}
