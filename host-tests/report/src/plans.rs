//! The figure of plans: what was looked at, what it costs, and what is chosen.

use serde::Serialize;

use super::Figure;
use super::chart::{BLUE, Chart, Color, GREY, ORANGE, RED, Series, Stroke};
use super::panel::{Panel, chart, panels};
use alula_sim::experiment::Experiment;
use alula_sim::reference::wrap;
use alula_sim::scene::{CANDIDATE, Scene};
use alula_sim::simulate::Step;

/// The flight around the plans.
const FLIGHT: &[Panel] = panels! {
    ["forward velocity [m/s]"]
    "v_north_m_s", "v", BLUE;
    "path_v_north_m_s", "v_r", ORANGE dashed;
    ["altitude over the reference [m]"]
    "altitude_m", "h", BLUE;
    ["angle of attack α [°]"]
    "wing_alpha_rad", "α", BLUE;
};

/// Height of a plot \[px\].
const HIGH: f64 = 190.0;
/// Where a candidate is drawn that was cut short, over the greatest cost that is known.
const DEARER: f64 = 1.15;

/// A plan that is adopted in place of the one in force.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Choice {
    /// When.
    pub t_s: f64,
    /// The attitude that it turns to; none if all is left to the servo.
    pub theta_deg: Option<f64>,
    /// The angle of attack there.
    pub alpha_deg: Option<f64>,
    /// The push-over before.
    pub push_over_s: f64,
    /// What it costs.
    pub cost_s: f64,
    /// What the one in force costs.
    pub in_force_s: f64,
    /// How many were looked at, the one in force included.
    pub looked_at: usize,
}

/// A plan that was looked at, as [`CANDIDATE`] says.
#[derive(Clone, Copy)]
struct Looked {
    t: f64,
    theta: f64,
    alpha: f64,
    push: f64,
    cost: f64,
    mark: f64,
}

/// An angle \[°\]; NaN where all is left to the servo.
fn degrees(angle: f64) -> f64 {
    match angle.is_nan() {
        true => angle,
        false => wrap(angle).to_degrees(),
    }
}

/// What each plan looked at, in that order.
fn plans(scene: &Scene) -> Vec<Vec<Looked>> {
    let rows = scene.plans.as_chunks::<{ CANDIDATE.len() }>().0.iter();
    let rows = rows.map(|&[t, theta, alpha, push, cost, mark]| Looked {
        t,
        theta: degrees(theta),
        alpha: degrees(alpha),
        push,
        cost,
        mark,
    });
    let rows: Vec<Looked> = rows.collect();
    let plans = rows.chunk_by(|a, b| a.t == b.t);
    plans.map(<[Looked]>::to_vec).collect()
}

/// The candidate that takes the place of the plan in force, if one does.
fn chosen(plan: &[Looked]) -> Option<&Looked> {
    plan.iter().find(|one| one.mark == 2.0)
}

/// The plans of `scene` that are adopted in place of those in force.
pub fn choices(scene: &Scene) -> Vec<Choice> {
    let number = |x: f64| x.is_finite().then_some(x);
    let choice = |plan: &Vec<Looked>| {
        let one = chosen(plan)?;
        Some(Choice {
            t_s: one.t,
            theta_deg: number(one.theta),
            alpha_deg: number(one.alpha),
            push_over_s: one.push,
            cost_s: one.cost,
            in_force_s: plan.first()?.cost,
            looked_at: plan.len(),
        })
    };
    plans(scene).iter().filter_map(choice).collect()
}

/// Dots of those that are `of` a kind, at `x` and `y`, where they have both.
fn dots(
    name: &'static str,
    color: Color,
    looked: &[Looked],
    of: impl Fn(&Looked) -> bool,
    [x, y]: [&dyn Fn(&Looked) -> f64; 2],
) -> Series<'static> {
    let of = looked.iter().filter(|one| of(one));
    let points = of.map(|one| (x(one), y(one)));
    let points = points.filter(|(x, y)| x.is_finite() && y.is_finite());
    Series {
        stroke: Stroke::Dots,
        ..Series::line(name, color, points.collect())
    }
}

/// The chart of one plan: costs over the angles of attack that are turned to.
fn of_one<'a>(title: &'a str, plan: &[Looked]) -> Chart<'a> {
    let known = plan.iter().map(|one| one.cost).filter(|x| x.is_finite());
    let dearer = DEARER * known.fold(0.0, f64::max);
    let at: [&dyn Fn(&Looked) -> f64; 2] = [&|one| one.alpha, &|one| one.cost];
    let mut series = vec![
        dots(
            "flown ahead to the end",
            BLUE,
            plan,
            |one| one.mark < 2.0,
            at,
        ),
        dots("chosen", RED, plan, |one| one.mark >= 2.0, at),
        dots(
            "dearer: cut short",
            GREY,
            plan,
            |one| one.cost.is_nan(),
            [&|one| one.alpha, &|_| dearer],
        ),
    ];
    if let Some(servo) = plan
        .iter()
        .find(|one| one.alpha.is_nan() && one.cost.is_finite())
    {
        let line = vec![(-90.0, servo.cost), (110.0, servo.cost)];
        series.push(Series::dashed("no turn", ORANGE, line));
    }
    Chart::over(title, "angle of attack that is turned to [°]", series)
}

/// The figure of the plans of a `record`, of which `scene` is the scene.
pub fn figure(experiment: &Experiment, record: &[Step], scene: &Scene) -> Figure {
    let plans = plans(scene);
    let looked = plans.concat();
    let in_force = plans.iter().filter_map(|plan| plan.first());
    let in_force = in_force.map(|one| (one.t, one.cost)).collect();
    let costs = Chart::over_time(
        "cost of the plan in force, and of what is chosen in its place [s]",
        vec![
            Series::line("in force", BLUE, in_force),
            dots(
                "chosen",
                RED,
                &looked,
                |one| one.mark == 2.0,
                [&|one| one.t, &|one| one.cost],
            ),
        ],
    );
    let at: [&dyn Fn(&Looked) -> f64; 2] = [&|one| one.t, &|one| one.theta];
    let flown = |step: &Step| (step.t, wrap(step.theta).to_degrees());
    let attitudes = Chart::over_time(
        "attitude θ that is turned to [°]: 0 nose up, −90 ahead",
        vec![
            dots("candidates", GREY, &looked, |one| one.mark == 0.0, at),
            dots("in force", BLUE, &looked, |one| one.mark % 2.0 == 1.0, at),
            dots("chosen", RED, &looked, |one| one.mark == 2.0, at),
            Series::line("flown", ORANGE, record.iter().map(flown).collect()),
        ],
    );
    let flight = FLIGHT.iter();
    let mut charts: Vec<Chart> = flight
        .filter_map(|panel| chart(panel, experiment, record))
        .collect();
    charts.extend([attitudes, costs]);
    let turned = |one: &Looked| {
        let then = record.iter().find(|step| step.t == one.t);
        then.map_or(0.0, |then| wrap(one.theta.to_radians() - then.theta).abs())
    };
    let turns = plans.iter().filter_map(|plan| {
        let one = chosen(plan).filter(|one| one.theta.is_finite())?;
        Some((turned(one), plan))
    });
    let farthest = turns.max_by(|a, b| a.0.total_cmp(&b.0));
    let title = farthest.map(|(_, plan)| {
        format!(
            "cost [s] of what the plan at {:.2} s looked at, which turns farthest",
            plan[0].t
        )
    });
    let farthest = farthest.zip(title.as_deref());
    charts.extend(farthest.map(|((_, plan), title)| of_one(title, plan)));
    Figure::new(&charts, HIGH)
}

#[cfg(test)]
mod tests {
    use super::*;
    use alula_sim::experiment::Document;
    use alula_sim::simulate::fly;

    /// A vehicle brakes from the wing by a turn to an angle of attack far behind the stall, which costs less than the plan in force.
    #[test]
    fn a_braking_chooses_a_turn_behind_the_stall() {
        let mut document = Document::load("round-trip").unwrap();
        document.assign("duration_s=50.0").unwrap();
        let experiment = document.checked().unwrap();
        let record = fly(&experiment).unwrap();
        let braking: Vec<Step> = record.into_iter().filter(|step| step.t >= 40.0).collect();
        let scene = Scene::of(&experiment, &braking);
        let choices = choices(&scene);
        assert!(
            choices
                .iter()
                .all(|one| one.cost_s < one.in_force_s && one.looked_at > 1)
        );
        let behind = |one: &Choice| one.alpha_deg.is_some_and(|alpha| alpha > 40.0);
        assert!(choices.iter().any(behind), "{choices:?}");
        let sheet = figure(&experiment, &braking, &scene).svg();
        // The plan that is drawn by itself is that which crosses the stall.
        let crosses = choices.iter().find(|one| behind(one)).unwrap();
        assert!(sheet.contains(&format!("the plan at {:.2} s", crosses.t_s)));
    }
}
