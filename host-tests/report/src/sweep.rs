//! The figure of a sweep: the paper's equilibria-pattern figure, the flown orientation over it.

use super::Figure;
use super::chart::{BLUE, Chart, GREY, Mark, ORANGE, Series, Stroke};
use alula_design::sweep::{Cause, Findings, Instant};
use alula_sim::columns::declared;
use alula_sim::experiment::Experiment;
use alula_sim::reference::wrap;
use alula_sim::simulate::Step;

/// The figure; `least_fp` \[N\] is the bound on |F_p|.
pub fn figure(
    experiment: &Experiment,
    instants: &[Instant],
    record: &[Step],
    findings: &Findings,
    least_fp: f64,
) -> Figure {
    let weight = experiment.weight();
    let end = experiment.duration_s;
    let equilibria = |of: fn(&alula::planar::equilibrium::Equilibrium) -> f32| {
        // A dot every so often.
        let every = instants.len().div_ceil(200);
        let sets = instants.iter().step_by(every).filter_map(|instant| {
            let set = instant.set.as_ref().ok()?;
            Some((instant.t, set))
        });
        sets.flat_map(|(t, set)| set.as_slice().iter().map(move |e| (t, f64::from(of(e)))))
            .collect::<Vec<_>>()
    };
    let followed =
        |of: &dyn Fn(&alula::planar::equilibrium::Equilibrium) -> f64| -> Vec<(f64, f64)> {
            let value = |i: &Instant| (i.t, i.followed.as_ref().map_or(f64::NAN, of));
            instants.iter().map(value).collect()
        };
    let line_of = |name: &str| {
        let column = declared(name);
        let degrees = |step| wrap(column.number(experiment, step)).to_degrees();
        let points = record.iter().map(|step| (step.t, degrees(step)));
        Series::line("flown", ORANGE, points.collect())
    };
    let dots = |points| Series {
        name: "equilibria",
        color: GREY,
        stroke: Stroke::Dots,
        points,
    };
    let line = |name, points| Series::line(name, BLUE, points);
    let bound = |name, y: f64| Series::dashed(name, ORANGE, vec![(0.0, y), (end, y)]);
    let jumps = |of: fn(&alula_design::sweep::Jump) -> f64| -> Vec<Mark> {
        let mark = |jump: &alula_design::sweep::Jump| Mark {
            at: (jump.t_s, of(jump)),
            label: match jump.cause {
                Cause::Fold => format!("fold at {:.2} s", jump.t_s),
                Cause::Corner => "corner".to_owned(),
            },
            shift: 16,
        };
        findings.jumps.iter().map(mark).collect()
    };
    let low: Vec<Mark> = findings
        .low_fp
        .iter()
        .map(|span| {
            let at = instants.iter().filter_map(|i| {
                let norm = i.followed.as_ref()?.f_p_norm();
                (f64::from(norm) == span.least).then_some(i.t)
            });
            Mark {
                at: (at.into_iter().next().unwrap_or(span.from_s), span.least),
                label: format!("{:.1} N", span.least),
                shift: 0,
            }
        })
        .collect();
    let chart = |title, series, marks| Chart {
        marks,
        ..Chart::over_time(title, series)
    };
    // Without air velocity there is no angle of attack.
    let angle = |e: &alula::planar::equilibrium::Equilibrium| match e.alpha {
        0.0 => f64::NAN,
        alpha => f64::from(alpha).to_degrees(),
    };
    let theta =
        |e: &alula::planar::equilibrium::Equilibrium| f64::from(e.attitude.angle()).to_degrees();
    Figure::new(
        &[
            chart(
                "orientation θ [°], and the equilibria of the reference",
                vec![
                    dots(equilibria(|e| e.attitude.angle().to_degrees())),
                    line("followed", followed(&theta)),
                    line_of("theta_rad"),
                ],
                jumps(|jump| jump.to_theta_deg),
            ),
            chart(
                "angle of attack α [°]",
                vec![
                    dots(equilibria(|e| e.alpha.to_degrees())),
                    line("followed", followed(&angle)),
                    line_of("wing_alpha_rad"),
                ],
                jumps(|jump| jump.to_alpha_deg),
            ),
            Chart {
                logarithmic: true,
                ..chart(
                    "|F_p| at the followed equilibrium [N], and its bound",
                    vec![
                        line("|F_p|", followed(&|e| f64::from(e.f_p_norm()))),
                        bound("bound", least_fp),
                    ],
                    low,
                )
            },
            chart(
                "thrust at the followed equilibrium, T/(m g)",
                vec![
                    line("T/(m g)", followed(&|e| f64::from(e.thrust) / weight)),
                    bound("zero", 0.0),
                ],
                Vec::new(),
            ),
        ],
        270.0,
    )
}
