//! What is behind a lag of first order, and what a lag is fitted to: rows of even spacing that follow each other.

use super::regression::Measured;

/// A gap \[s\] after which what was before says nothing.
pub(super) const GAP: f64 = 0.5;

/// A value behind its lag, and its derivative by the lag.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Behind {
    pub(super) value: f64,
    pub(super) by_lag: f64,
}

/// Values, each held from its time \[s\] to the next, behind a `lag` \[s\]; over a gap anew.
pub(super) fn behind(values: impl Iterator<Item = [f64; 2]>, lag: f64) -> Vec<Behind> {
    let mut last: Option<([f64; 2], Behind)> = None;
    let step = |[t, value]: [f64; 2]| {
        let anew = Behind { value, by_lag: 0.0 };
        let next = match last {
            Some(([then, held], Behind { value, by_lag })) if t - then <= GAP => {
                let dt = t - then;
                let rest = (-dt / lag).exp();
                Behind {
                    value: held + rest * (value - held),
                    by_lag: rest * (by_lag + (value - held) * dt / (lag * lag)),
                }
            }
            _ => anew,
        };
        last = Some(([t, value], next));
        next
    };
    values.map(step).collect()
}

/// Rows whose times \[s\] follow each other by a usual spacing.
pub(super) struct Even {
    /// The usual spacing \[s\].
    pub(super) spacing: f64,
    /// The rows that others have gone before, evenly, for [`GAP`] and for as many rows as are asked for.
    pub(super) known: Vec<usize>,
}

impl Even {
    /// Of these times, in order, with so many rows before each that is known; none of fewer than two.
    pub(super) fn of(times: &[f64], past: usize) -> Option<Self> {
        let mut spacings: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        spacings.sort_by(f64::total_cmp);
        let spacing = *spacings.get(spacings.len() / 2)?;
        let (mut begin, mut known) = (0, Vec::new());
        for n in 1..times.len() {
            let dt = times[n] - times[n - 1];
            if !(0.5 * spacing..1.5 * spacing).contains(&dt) {
                begin = n;
            }
            if n - begin >= past && times[n] - times[begin] > GAP {
                known.push(n);
            }
        }
        Some(Self { spacing, known })
    }

    /// A lag with what the rows leave open: when, since the row before, what was asked for was asked for.
    pub(super) fn within_a_row(&self, lag: Measured) -> Measured {
        Measured {
            within: lag.within.hypot(0.5 * self.spacing),
            ..lag
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step is there by 63 % after the lag, its derivative is that of the exponential, and over a gap it begins anew.
    #[test]
    fn a_step_is_behind_by_its_lag() {
        let values = (0..30).map(|n| [0.01 * f64::from(n), if n == 0 { 0.0 } else { 1.0 }]);
        let values = values.chain([[2.0, 5.0]]);
        let (lag, near) = (0.1, 1e-6);
        let [all, other] = [lag, lag + near].map(|lag| behind(values.clone(), lag));
        assert!((all[11].value - (1.0 - (-1.0_f64).exp())).abs() < 1e-12);
        let slope = (other[11].value - all[11].value) / near;
        assert!((all[11].by_lag - slope).abs() < 1e-4, "{slope}");
        assert_eq!(
            all[30],
            Behind {
                value: 5.0,
                by_lag: 0.0
            }
        );
    }

    /// After a row that is missing the past begins anew.
    #[test]
    fn a_row_is_known_by_its_past() {
        let times = (0..200).filter(|n| *n != 100).map(|n| 0.01 * f64::from(n));
        let even = Even::of(&times.collect::<Vec<_>>(), 4).unwrap();
        assert!((even.spacing - 0.01).abs() < 1e-12);
        let known = (51..100).chain(151..199).collect::<Vec<_>>();
        assert_eq!(even.known, known);
    }
}
