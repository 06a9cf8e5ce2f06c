//! Altitude and attitude over time: the vehicle at equal times, each at its altitude.

use std::fmt::Write as _;

use super::view::{SPAN, Taken, View, label, metres, round_number};
use crate::chart::ends;
use alula_sim::experiment::V3;
use alula_sim::simulate::Step;

/// Vehicles drawn, at most, and the least width that each has \[px\].
const VEHICLES: f64 = 20.0;
const APART: f64 = 54.0;
/// Least range of altitudes \[m\]: what is level shall look so.
const LEAST: f64 = 10.0;

/// Draws it in the frame (left, top, width, height), with vehicles seen as in `view`. Returns the time between two vehicles \[s\].
pub fn draw(text: &mut String, record: &[Step], view: &View, frame: [f64; 4]) -> f64 {
    let [left, top, width, height] = frame;
    let duration = record[record.len() - 1].t;
    let altitudes = record
        .iter()
        .flat_map(|s| [s.truth.position.z, s.target.position.z])
        .map(|down| 0.0 - down);
    let (low, high) = ends(altitudes);
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low).max(LEAST));
    let x = |t: f64| left + width * t / duration;
    // Room for the vehicles above and below.
    let room = 0.5 * height - 0.55 * SPAN;
    let y = |altitude: f64| top + 0.5 * height - room * (altitude - middle) / half;

    let step = round_number(half / 2.0);
    let mut mark = ((middle - half) / step).ceil() * step;
    while mark <= middle + half {
        let at = y(mark);
        let ends = format!("{left:.1},{at:.1} {:.1},{at:.1}", left + width);
        let _ = writeln!(text, "<polyline class=\"ground\" points=\"{ends}\"/>");
        label(text, [left - 0.6 * SPAN, at + 5.0], &metres(mark), "end");
        mark += step;
    }
    let thin = record.len().div_ceil(1000);
    let mut curve = |class: &str, down: fn(&Step) -> f64| {
        let points = record.iter().step_by(thin);
        let points = points.map(|s| format!("{:.1},{:.1}", x(s.t), y(0.0 - down(s))));
        let points = points.collect::<Vec<_>>().join(" ");
        let _ = writeln!(text, "<polyline class=\"{class}\" points=\"{points}\"/>");
    };
    curve("line dash orange", |s| s.target.position.z);
    curve("line blue", |s| s.truth.position.z);

    let every = round_number(duration / VEHICLES.min(width / APART));
    let mut below = Taken::new([left - 40.0, top + height, width + 80.0, 24.0]);
    let mut due = 0.0;
    for step in record {
        // A rounding error early rather than a step late.
        if step.t < due - 1e-9 {
            continue;
        }
        due += every;
        let at = [x(step.t), y(0.0 - step.truth.position.z)];
        let view = View {
            scale: 1.0,
            origin: at,
            ..*view
        };
        view.vehicle(text, &step.truth, V3::zeros());
        let words = format!("{} s", (step.t * 10.0).round() / 10.0);
        below.words(text, [at[0], top + height + 30.0], 18.0, &words);
    }
    every
}
