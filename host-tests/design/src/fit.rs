//! The combined model's parameters from a table, by nonlinear least squares.

use std::f64::consts::PI;

use anyhow::anyhow;
use nalgebra::{SMatrix, SVector};
use serde::Serialize;

use alula_sim::experiment::AerodynamicsSpec;
use alula_sim::reference::{Aerodynamics, Combined, Row};

/// The parameters as free numbers.
type Vector7 = SVector<f64, 7>;

/// Ends of the ranges of attached flow and of stall \[rad\]: 8° and 30°.
const LIMITS: [f64; 2] = [8.001 * PI / 180.0, 30.001 * PI / 180.0];

/// Bounds of c_0…c_3, ᾱ \[°\], k_L ᾱ² and k_D ᾱ²: beyond any wing, and what the core takes.
const BOUNDS: [(f64, f64); 7] = [
    (1e-4, 1.0),
    (0.05, 10.0),
    (0.5, 20.0),
    (1e-3, 10.0),
    (3.0, 60.0),
    (0.05, 39.0),
    (0.05, 39.0),
];

/// The parameters as free numbers: on a logarithmic scale, from −∞ at the lower bound to ∞ at the upper.
fn free(p: &Combined) -> Vector7 {
    let (bar, square) = (p.alpha_bar_deg, p.alpha_bar().powi(2));
    let values = Vector7::from([p.c0, p.c1, p.c2, p.c3, bar, p.k_l * square, p.k_d * square]);
    let mut bounds = BOUNDS.iter();
    values.map(|value| {
        let (low, high) = bounds.next().copied().unwrap_or_default();
        let part = ((value / low).ln() / (high / low).ln()).clamp(0.01, 0.99);
        (part / (1.0 - part)).ln()
    })
}

/// The parameters of these free numbers.
fn from_free(x: &Vector7) -> Combined {
    let mut bounds = BOUNDS.iter();
    let [[c0, c1, c2, c3, alpha_bar_deg, lift, drag]] = x
        .map(|x| {
            let (low, high) = bounds.next().copied().unwrap_or_default();
            low * (high / low).powf(1.0 / (1.0 + (-x).exp()))
        })
        .data
        .0;
    let square = alpha_bar_deg.to_radians().powi(2);
    Combined {
        c0,
        c1,
        c2,
        c3,
        alpha_bar_deg,
        k_l: lift / square,
        k_d: drag / square,
    }
}

/// What a fit minimises: the root of the mean square relative error of lift and drag, over three ranges of |α|.
///
/// Attached flow, up to 8°; stall, up to 30°; and beyond. A row weighs the range of α that it stands for, half the distance to either
/// neighbour. Errors of c_L and c_D are relative to the root mean square of c_L and c_D in the range. The
/// ranges count alike, and lift as much as drag: so neither the many large angles nor the large drag there drown what an
/// aircraft cruises by.
pub struct Metric {
    rows: Vec<Weighted>,
}

/// A row, and what its errors of lift and drag are multiplied by.
struct Weighted {
    row: Row,
    lift: f64,
    drag: f64,
}

impl Metric {
    /// The metric of the table `rows`.
    pub fn new(rows: &[Row]) -> Self {
        let width = |i: usize| {
            let before = rows[i.saturating_sub(1)][0];
            let after = rows[(i + 1).min(rows.len() - 1)][0];
            0.5 * (after - before)
        };
        let part = |row: &Row| LIMITS.iter().filter(|limit| row[0].abs() > **limit).count();
        // Σ width, Σ width c_L², Σ width c_D² of each range.
        let mut sums = [[0.0; 3]; LIMITS.len() + 1];
        for (i, row) in rows.iter().enumerate() {
            let sum = &mut sums[part(row)];
            sum[0] += width(i);
            sum[1] += width(i) * row[1] * row[1];
            sum[2] += width(i) * row[2] * row[2];
        }
        let count = 2.0 * sums.len() as f64;
        let rows = rows.iter().enumerate().map(|(i, row)| {
            let [_, lift, drag] = sums[part(row)];
            let weight = |square: f64| (width(i) / square.max(1e-12) / count).sqrt();
            Weighted {
                row: *row,
                lift: weight(lift),
                drag: weight(drag),
            }
        });
        Self {
            rows: rows.collect(),
        }
    }

    fn residuals(&self, model: &Aerodynamics) -> impl Iterator<Item = f64> {
        self.rows.iter().flat_map(|weighted| {
            let [alpha, c_l, c_d] = weighted.row;
            let c = model.at(alula_sim::reference::wrap(alpha));
            [weighted.lift * (c.c_l - c_l), weighted.drag * (c.c_d - c_d)]
        })
    }

    /// The distance of `model` from the table.
    pub fn of(&self, model: &Aerodynamics) -> f64 {
        self.residuals(model).map(|r| r * r).sum::<f64>().sqrt()
    }
}

/// The free parameters around `start` at which the sum of the squared residuals is least, by the method of Levenberg and
/// Marquardt with the damping of H. B. Nielsen (IMM-REP-1999-05). Seven parameters and a metric of mean 1 leave the normal
/// equations well enough conditioned for Cholesky's decomposition in double precision.
fn minimise(metric: &Metric, start: Vector7) -> Vector7 {
    // Central differences: exact to 1e-9 of the residuals.
    const DIFFERENCE: f64 = 1e-5;
    // Bounds the time of a search along a flat valley.
    const STEPS: usize = 400;
    let at = |x: &Vector7| -> Vec<f64> {
        metric
            .residuals(&Aerodynamics::Combined(from_free(x)))
            .collect()
    };
    let square = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>();
    let mut x = start;
    let mut residuals = at(&x);
    let (mut damping, mut growth) = (1e-3, 2.0);
    for _ in 0..STEPS {
        let columns: [Vec<f64>; 7] = std::array::from_fn(|i| {
            let (mut up, mut down) = (x, x);
            up[i] += DIFFERENCE;
            down[i] -= DIFFERENCE;
            let pairs = at(&up).into_iter().zip(at(&down));
            pairs.map(|(u, d)| (u - d) / (2.0 * DIFFERENCE)).collect()
        });
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let normal = SMatrix::<f64, 7, 7>::from_fn(|i, j| dot(&columns[i], &columns[j]));
        let slope = Vector7::from_fn(|i, _| dot(&columns[i], &residuals));
        // A parameter at its bound has hardly any column left: it is damped as if it had a little.
        let least = 1e-9 * normal.diagonal().max();
        let scale = normal.diagonal().map(|d| damping * d.max(least));
        let damped = normal + SMatrix::from_diagonal(&scale);
        let Some(step) = damped.cholesky().map(|c| -c.solve(&slope)) else {
            break;
        };
        if step.amax() < 1e-12 * (1.0 + x.amax()) {
            break;
        }
        let there = at(&(x + step));
        // What the squares fell by, over what the linear model foretold.
        let foretold = step.dot(&(scale.component_mul(&step) - slope));
        let gain = (square(&residuals) - square(&there)) / foretold;
        if gain > 0.0 {
            x += step;
            residuals = there;
            damping *= (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0);
            growth = 2.0;
        } else {
            damping *= growth;
            growth *= 2.0;
        }
    }
    x
}

/// The parameters closest to the table `rows` by [`Metric`], from several starting points.
pub fn fit(rows: &[Row]) -> anyhow::Result<Combined> {
    let metric = Metric::new(rows);
    if rows.iter().filter(|row| row[0].abs() <= LIMITS[1]).count() < 7 {
        return Err(anyhow!(
            "at least seven rows within 30° are needed to fit the seven parameters"
        ));
    }
    let fitted = starts(rows)
        .into_iter()
        .map(|start| from_free(&minimise(&metric, free(&start))));
    let off = |p: &Combined| metric.of(&Aerodynamics::Combined(*p));
    fitted
        .filter(|p| AerodynamicsSpec::Combined(*p).core().is_ok())
        .min_by(|a, b| off(a).total_cmp(&off(b)))
        .ok_or_else(|| anyhow!("no starting point led to parameters that the model accepts"))
}

/// Starting points: what the table shows directly, and stalls early to late, sharp and mild.
fn starts(rows: &[Row]) -> Vec<Combined> {
    let least = |f: &dyn Fn(&Row) -> f64| rows.iter().map(f).fold(f64::INFINITY, f64::min);
    let c0 = least(&|row| row[2]);
    let broadside = -least(&|row| -row[2]);
    // Lift slope through the origin up to 5°.
    let below = rows.iter().filter(|row| row[0].abs() < 5.5f64.to_radians());
    let (lift, angle) = below.fold((0.0, 0.0), |sum, row| {
        (sum.0 + row[0] * row[1], sum.1 + row[0] * row[0])
    });
    let slope = if lift > 0.0 { lift / angle } else { 2.0 * PI };
    let stalls = [8.0, 11.0, 14.0, 18.0, 22.0];
    let sharpness = [(12.0, 86.0), (28.0, 167.0), (100.0, 100.0)];
    stalls
        .iter()
        .flat_map(|&alpha_bar_deg| {
            sharpness.iter().map(move |&(k_l, k_d)| Combined {
                c0,
                c1: 0.5 * (broadside - c0).max(0.1),
                c2: slope,
                c3: 0.3,
                alpha_bar_deg,
                k_l,
                k_d,
            })
        })
        .collect()
}

/// How far a model is from a table over a range of angles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Errors {
    /// Root mean square over the rows, c_L.
    pub rms_cl: f64,
    /// Largest, c_L.
    pub max_cl: f64,
    /// Root mean square over the rows, c_D.
    pub rms_cd: f64,
    /// Largest, c_D.
    pub max_cd: f64,
}

impl Errors {
    /// Over the rows up to `limit_deg` degrees in magnitude.
    pub fn of(model: &Aerodynamics, rows: &[Row], limit_deg: f64) -> Self {
        let limit = limit_deg.to_radians() + 1e-9;
        let errors: Vec<[f64; 2]> = rows
            .iter()
            .filter(|row| row[0].abs() <= limit)
            .map(|&[alpha, c_l, c_d]| {
                let c = model.at(alula_sim::reference::wrap(alpha));
                [c.c_l - c_l, c.c_d - c_d]
            })
            .collect();
        let rms = |k: usize| {
            let squares: f64 = errors.iter().map(|e| e[k] * e[k]).sum();
            (squares / errors.len() as f64).sqrt()
        };
        let max = |k: usize| errors.iter().map(|e| e[k].abs()).fold(0.0, f64::max);
        Self {
            rms_cl: rms(0),
            max_cl: max(0),
            rms_cd: rms(1),
            max_cd: max(1),
        }
    }
}

/// How far a model is from a sphere, for δ = 0: the residuals of `eq:condition` and, times sin² α, `eq:condSimpler`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Sphericity {
    /// Root mean square of the residual of `eq:condition` over all angles.
    pub rms_condition: f64,
    /// Its largest magnitude.
    pub max_condition: f64,
    /// Where that is \[°\].
    pub at_alpha_deg: f64,
    /// Root mean square of sin² α (c_D + c_L cot α)'.
    pub rms_simpler: f64,
}

impl Sphericity {
    /// Of `model`, sampled every 0.1°.
    pub fn of(model: &Aerodynamics) -> Self {
        /// The paper's condition and the simpler one at an angle.
        struct Sample {
            alpha_deg: f64,
            condition: f64,
            simpler: f64,
        }
        let samples: Vec<Sample> = (0..3600)
            .map(|n| f64::from(n) * 0.1 - 179.95)
            .map(|alpha_deg| {
                let alpha = alpha_deg.to_radians();
                let (c, (s, cos)) = (model.at(alpha), alpha.sin_cos());
                let condition = (c.ddc_d - 2.0 * c.dc_l) * s + (c.ddc_l + 2.0 * c.dc_d) * cos;
                let simpler = c.dc_d * s * s + c.dc_l * s * cos - c.c_l;
                Sample {
                    alpha_deg,
                    condition,
                    simpler,
                }
            })
            .collect();
        let rms = |of: fn(&Sample) -> f64| {
            let squares: f64 = samples.iter().map(|s| of(s).powi(2)).sum();
            (squares / samples.len() as f64).sqrt()
        };
        let worst = samples
            .iter()
            .max_by(|a, b| a.condition.abs().total_cmp(&b.condition.abs()));
        Self {
            rms_condition: rms(|s| s.condition),
            max_condition: worst.map_or(0.0, |s| s.condition.abs()),
            at_alpha_deg: worst.map_or(0.0, |s| s.alpha_deg),
            rms_simpler: rms(|s| s.simpler),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alula_sim::polar::Polar;
    use alula_sim::reference::LargeAngle;

    #[test]
    fn at_least_as_close_to_naca_0021_as_the_paper() {
        let rows = Polar::load("naca-0021-re-160e3").unwrap().rows;
        let (metric, fitted) = (Metric::new(rows), fit(rows).unwrap());
        let of = |p: Combined| metric.of(&Aerodynamics::Combined(p));
        let (ours, paper) = (of(fitted), of(Combined::NACA_0021_RE_160E3));
        println!("{fitted:?}\n{ours} against {paper}");
        assert!(ours <= paper);
        // And it is a minimum: no parameter is better 1 % off.
        for i in 0..7 {
            for step in [-0.01, 0.01] {
                let mut x = free(&fitted);
                x[i] += step;
                let off = of(from_free(&x));
                assert!(off >= ours, "{i} {step}");
            }
        }
    }

    #[test]
    fn a_table_of_the_model_gives_its_parameters_back() {
        let truth = Combined {
            c0: 0.02,
            c1: 0.8,
            c2: 5.0,
            c3: 0.4,
            alpha_bar_deg: 13.0,
            k_l: 35.0,
            k_d: 120.0,
        };
        let model = Aerodynamics::Combined(truth);
        let rows: Vec<Row> = (0..=180)
            .map(|degrees| f64::from(degrees).to_radians())
            .map(|alpha| {
                let c = model.at(alpha.min(PI - 1e-12));
                [alpha, c.c_l, c.c_d]
            })
            .collect();
        let fitted = fit(&rows).unwrap();
        let off = (free(&fitted) - free(&truth)).amax();
        assert!(off < 1e-6, "{fitted:?}");
        let errors = Errors::of(&Aerodynamics::Combined(fitted), &rows, 180.0);
        assert!(errors.max_cl < 1e-6 && errors.max_cd < 1e-6);
    }

    /// A model without lift or drag is off by all of both.
    #[test]
    fn errors_are_relative_and_the_ranges_count_alike() {
        let rows = Polar::load("naca-0021-re-5e6").unwrap().rows;
        let nothing = Aerodynamics::LargeAngle(LargeAngle { c0: 0.0, c1: 0.0 });
        assert!((Metric::new(rows).of(&nothing) - 1.0).abs() < 1e-12);
        for (i, weighted) in Metric::new(rows).rows.iter().enumerate() {
            assert_eq!(weighted.row, rows[i]);
        }
        let part = |from: f64, to: f64| -> f64 {
            let rows = Metric::new(rows).rows;
            let inside = rows
                .iter()
                .filter(|w| (from..to).contains(&w.row[0].to_degrees()));
            inside.map(|w| (w.lift * w.row[1]).powi(2)).sum()
        };
        for (from, to) in [(-0.1, 8.1), (8.1, 30.1), (30.1, 180.1)] {
            assert!((part(from, to) - 1.0 / 6.0).abs() < 1e-12);
        }
    }
}
