//! One view of a flight: the way flown and the path, their track on the ground, and the vehicle at equal times.

use super::ground::Ground;
use super::view::{SPAN, Taken, View, arrow};
use crate::svg::escape;
use alula_sim::experiment::V3;
use alula_sim::simulate::Step;

/// Between two vehicles along the way \[spans\], about.
const APART: f64 = 1.5;
/// Below this \[spans\] from one that is drawn, another is left out.
const NEAR: f64 = 1.15;
/// What is slower is hovering \[m/s\].
const HOVERING: f64 = 1.0;

/// The time between two vehicles \[s\]: a round number, by which they stand apart on the way in `view`.
pub fn spacing(record: &[Step], view: &View) -> f64 {
    let flat = |v: V3| v.dot(&view.right).hypot(v.dot(&view.up));
    let moving = record.iter().map(|s| s.truth.velocity);
    let moving: Vec<V3> = moving.filter(|v| v.norm() > HOVERING).collect();
    let duration = record[record.len() - 1].t;
    if moving.is_empty() {
        return nice(duration / 10.0);
    }
    let speed = moving.iter().map(|&v| flat(v)).sum::<f64>() / moving.len() as f64;
    nice((APART * SPAN / (view.scale * speed)).min(duration / 4.0))
}

/// The first of 1, 2, 5, 10, … tenths of a second that is not less.
fn nice(seconds: f64) -> f64 {
    super::view::round_number(seconds.max(0.1))
}

/// The ground under a flight, fitted into the frame (left, top, width, height).
pub fn fitted(view: View, record: &[Step], ground: &Ground, frame: [f64; 4], raised: bool) -> View {
    let mut points = ground.extent(&view, raised);
    if raised {
        points.extend(record.iter().map(|s| s.truth.position));
    }
    view.fitted(&points, frame)
}

/// Draws the flight in `view`, with a vehicle every `spacing` \[s\]; `raised` over the ground, else from above.
pub fn draw(
    text: &mut String,
    record: &[Step],
    ground: &Ground,
    view: &View,
    frame: [f64; 4],
    (spacing, raised): (f64, bool),
) {
    let mut taken = Taken::new(frame);
    ground.draw(text, view, &mut taken);
    let thin = record.len().div_ceil(1000);
    let positions = || record.iter().step_by(thin).map(|s| s.truth.position);
    if raised {
        ground.draw_ruler(text, view, &mut taken);
        view.line(text, positions().map(|p| ground.under(p)), "line grey");
    }
    let path = record.iter().step_by(thin).map(|s| s.target.position);
    view.line(text, path, "line dash orange");
    view.line(text, positions(), "line blue");

    let vehicles = vehicles(record, view, spacing);
    for step in &vehicles {
        let p = step.truth.position;
        if raised {
            view.line(text, [p, ground.under(p)].into_iter(), "shadow dotted");
        }
        view.vehicle(text, &step.truth, p);
        taken.take(view.pixel(p), [0.9 * SPAN, 0.9 * SPAN]);
    }
    compass(text, record, view, &mut taken);
    // The first and the last before the others.
    let ends = [0, vehicles.len() - 1];
    let order = ends.into_iter().chain(1..vehicles.len().max(2) - 1);
    for i in order {
        let step = vehicles[i];
        let words = format!("{} s", (step.t * 10.0).round() / 10.0);
        taken.words(text, view.pixel(step.truth.position), 0.62 * SPAN, &words);
    }
}

/// The steps at which the vehicle is drawn: every `spacing` \[s\] and the last one, unless it would cover another.
fn vehicles<'a>(record: &'a [Step], view: &View, spacing: f64) -> Vec<&'a Step> {
    let last = &record[record.len() - 1];
    let mut drawn: Vec<&Step> = Vec::new();
    let far = |a: &Step, b: &Step| {
        let [a, b] = [a, b].map(|s| view.pixel(s.truth.position));
        (a[0] - b[0]).hypot(a[1] - b[1]) >= NEAR * SPAN
    };
    let mut due = 0.0;
    for step in record {
        // A rounding error early rather than a step late.
        if step.t < due - 1e-9 {
            continue;
        }
        due += spacing;
        if drawn.iter().all(|other| far(other, step)) {
            drawn.push(step);
        }
    }
    if drawn.iter().all(|other| far(other, last)) {
        drawn.push(last);
    }
    drawn
}

/// North, and the mean wind, in a corner.
fn compass(text: &mut String, record: &[Step], view: &View, taken: &mut Taken) {
    let wind: V3 = record.iter().map(|s| s.wind).sum::<V3>() / record.len() as f64;
    let level = V3::new(wind.x, wind.y, 0.0);
    let is_windy = level.norm() > 0.5;
    let [left, top] = taken.corner(if is_windy {
        [220.0, 150.0]
    } else {
        [80.0, 90.0]
    });
    let at = [left + 40.0, top + 45.0];
    arrow(text, view, at, V3::x(), "line black", "N");
    if is_windy {
        let words = escape(&format!("mean wind {:.1} m/s", level.norm()));
        let at = [left + 40.0, top + 120.0];
        arrow(text, view, at, level.normalize(), "line green", &words);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alula_sim::experiment::Document;
    use alula_sim::simulate::fly;

    /// On a circle of which a lap takes 12.6 s a vehicle stands every so many seconds, none on another one, none between; the
    /// time is round.
    #[test]
    fn vehicles_stand_at_equal_times_and_apart() {
        let mut document = Document::load("circle-40").unwrap();
        document.assign("duration_s=40.0").unwrap();
        let record = fly(&document.checked().unwrap()).unwrap();
        let view = View {
            scale: 4.0,
            ..View::along(0.0, 90.0)
        };
        let every = spacing(&record, &view);
        // 69 px at 80 px/s.
        assert_eq!(every, 1.0);
        let drawn = vehicles(&record, &view, every);
        // 1005 px around, and those of the first lap 80 px apart: there is no room between.
        assert!((12..=13).contains(&drawn.len()), "{}", drawn.len());
        for (i, step) in drawn.iter().enumerate() {
            let off = step.t / every - (step.t / every).round();
            assert!(off.abs() < 1e-6 || step.t == 40.0, "{}", step.t);
            for other in &drawn[..i] {
                let off = 4.0 * (step.truth.position - other.truth.position).xy().norm();
                assert!(off >= NEAR * SPAN);
            }
        }
    }
}
