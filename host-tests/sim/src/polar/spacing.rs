//! The rule of a table that rows stand apart, kept by what is made of one.

/// Least distance of two rows of a table \[°\]: 0.05, and a little for roundings.
pub const CLOSEST: f64 = 0.0501;

/// The `rows` \[°, …\] by increasing angle without those that come too close to one before, or go back. The first and the last stay: they are where the wing
/// stalls.
pub fn spaced(rows: Vec<[f64; 3]>) -> Vec<[f64; 3]> {
    let mut kept: Vec<[f64; 3]> = Vec::with_capacity(rows.len());
    let last = rows.last().copied();
    for row in rows {
        if kept
            .last()
            .is_none_or(|before| row[0] - before[0] >= CLOSEST)
        {
            kept.push(row);
        }
    }
    let Some(last) = last.filter(|last| kept.last() != Some(last)) else {
        return kept;
    };
    while kept.len() > 1
        && kept
            .last()
            .is_some_and(|before| last[0] - before[0] < CLOSEST)
    {
        kept.pop();
    }
    kept.push(last);
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stand_apart_and_both_ends_stay() {
        let angles = |angles: &[f64]| -> Vec<f64> {
            let rows = angles.iter().map(|a| [*a, 0.0, 0.1]).collect();
            spaced(rows).iter().map(|row| row[0]).collect()
        };
        assert_eq!(angles(&[0.0, 0.1, 0.2]), [0.0, 0.1, 0.2]);
        // One that is too close, one that goes back, and the last in place of two before it.
        assert_eq!(angles(&[0.0, 0.04, 0.1, 0.05, 0.3]), [0.0, 0.1, 0.3]);
        assert_eq!(angles(&[0.0, 0.1, 0.2, 0.26, 0.24]), [0.0, 0.1, 0.24]);
        assert_eq!(angles(&[1.0]), [1.0]);
        assert_eq!(angles(&[]), [0.0; 0]);
    }
}
