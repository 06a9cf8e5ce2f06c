//! A table with fewer rows, for on board: rows of the table itself, and how far the interpolant through them is from that through all.

use crate::reference::{Row, Table};

/// Fewest rows of a table.
const LEAST: usize = 5;
/// Angles at which tables are compared, per degree.
const PER_DEGREE: i32 = 5;

/// How far two tables are apart at most.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Apart {
    /// Greatest difference of c_L.
    pub c_l: f64,
    /// Where \[°\].
    pub c_l_at_deg: f64,
    /// Greatest difference of c_D.
    pub c_d: f64,
    /// Where \[°\].
    pub c_d_at_deg: f64,
}

impl Apart {
    /// In words, of a table of `rows` rows taken from one of `whole`; none if they are all.
    pub fn text(&self, rows: usize, whole: usize) -> Option<String> {
        let Self {
            c_l,
            c_l_at_deg,
            c_d,
            c_d_at_deg,
        } = self;
        (rows < whole).then(|| {
            format!(
                "Thinned to {rows} of {whole} rows: c_L within {c_l:.4} (at {c_l_at_deg:.0}°), c_D within {c_d:.4} (at {c_d_at_deg:.0}°) of the whole table"
            )
        })
    }
}

/// At most `count` of the `rows` \[rad, c_L, c_D\] of a whole table, and how far the table through them is from that through all.
///
/// Beginning with both ends and what is spread most evenly between, the row nearest to where the tables are farthest apart is added
/// until there are enough.
pub fn resampled(rows: &[Row], count: usize) -> (Vec<Row>, Apart) {
    let count = count.max(LEAST);
    if rows.len() <= count {
        return (rows.to_vec(), Apart::default());
    }
    let whole = coefficients(rows);
    let last = rows.len() - 1;
    let mut taken: Vec<usize> = (0..LEAST).map(|n| n * last / (LEAST - 1)).collect();
    loop {
        let part: Vec<Row> = taken.iter().map(|&i| rows[i]).collect();
        let there = coefficients(&part);
        if taken.len() == count {
            return (part, apart(&whole, &there));
        }
        let off = |n: usize| {
            let (a, b) = (whole[n], there[n]);
            f64::max((a[1] - b[1]).abs(), (a[2] - b[2]).abs())
        };
        let mut worst: Vec<usize> = (0..whole.len()).collect();
        worst.sort_by(|a, b| off(*b).total_cmp(&off(*a)));
        let free = |n: &usize| {
            let distance = |i: &usize| (rows[*i][0] - whole[*n][0].to_radians()).abs();
            let nearest = (0..=last).min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
            (!taken.contains(&nearest)).then_some(nearest)
        };
        let next = worst.iter().find_map(free);
        let next = next.or_else(|| (0..=last).find(|i| !taken.contains(i)));
        taken.extend(next);
        taken.sort_unstable();
    }
}

/// α \[°\], c_L and c_D over all angles of the table through `rows`.
fn coefficients(rows: &[Row]) -> Vec<[f64; 3]> {
    let table = Table::new(rows);
    let angles = (-180 * PER_DEGREE + 1)..180 * PER_DEGREE;
    angles
        .map(|n| {
            let degrees = f64::from(n) / f64::from(PER_DEGREE);
            let [c_l, c_d] = table.lift_and_drag(degrees.to_radians());
            [degrees, c_l, c_d]
        })
        .collect()
}

fn apart(a: &[[f64; 3]], b: &[[f64; 3]]) -> Apart {
    let mut apart = Apart::default();
    for (a, b) in a.iter().zip(b) {
        let [lift, drag] = [(a[1] - b[1]).abs(), (a[2] - b[2]).abs()];
        if lift > apart.c_l {
            (apart.c_l, apart.c_l_at_deg) = (lift, a[0]);
        }
        if drag > apart.c_d {
            (apart.c_d, apart.c_d_at_deg) = (drag, a[0]);
        }
    }
    apart
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polar::Polar;
    use crate::refusals::begins;

    #[test]
    fn what_thinning_costs_is_said_where_rows_are_left_out() {
        let apart = Apart {
            c_l: 0.01234,
            c_l_at_deg: 12.0,
            ..Apart::default()
        };
        assert_eq!(apart.text(96, 96), None);
        let text = apart.text(40, 96).unwrap();
        begins(
            &text,
            "Thinned to 40 of 96 rows: c_L within 0.0123 (at 12°)",
        );
    }

    #[test]
    fn more_rows_are_nearer_and_all_are_the_same() {
        let rows = Polar::load("naca-0012-re-160e3").unwrap().rows;
        let at = |count| resampled(rows, count);
        let (all, nothing) = at(rows.len());
        assert_eq!((all.len(), nothing), (rows.len(), Apart::default()));
        let (few, far) = at(16);
        let (many, near) = at(40);
        assert_eq!((few.len(), many.len()), (16, 40));
        assert!(
            near.c_l < 0.5 * far.c_l && near.c_l < 0.03 && near.c_d < 0.03,
            "{far:?} {near:?}"
        );
        // The error told is one that is there.
        let table = |rows: &[Row]| Table::new(rows);
        let (whole, part) = (table(rows), table(&few));
        let lift = |t: &Table| t.lift_and_drag(far.c_l_at_deg.to_radians())[0];
        assert!(((lift(&whole) - lift(&part)).abs() - far.c_l).abs() < 1e-12);
    }
}
