//! The picture of a flight in its vertical plane: the vehicle along its track, to scale but for its size.

use std::fmt::Write as _;

use super::chart::ends;
use super::svg::{Drawn, Format, title};
use super::ticks;
use alula_sim::experiment::{Experiment, V3};
use alula_sim::simulate::Step;

/// Width, and greatest height of the track \[px\].
const WIDE: f64 = 1200.0;
const HIGHEST: f64 = 380.0;
/// Length of a drawn vehicle, and the room around the track \[px\].
const LONG: f64 = 46.0;
const ROOM: f64 = 56.0;
/// Least extent of the world that is drawn \[m\].
const LEAST: f64 = 4.0;

/// Body coordinates (ahead, towards the belly) of the outline, over the vehicle's length: a fuselage and a fin.
const OUTLINE: [(f64, f64); 8] = [
    (0.52, 0.0),
    (0.36, 0.09),
    (-0.3, 0.08),
    (-0.42, 0.05),
    (-0.42, -0.06),
    (-0.5, -0.22),
    (-0.28, -0.08),
    (0.36, -0.09),
];

/// How the plane is seen: forward to the right, down downward.
struct View {
    /// \[px/m\].
    scale: f64,
    origin: [f64; 2],
}

impl View {
    fn pixel(&self, position: V3) -> [f64; 2] {
        [
            self.origin[0] + self.scale * position.x,
            self.origin[1] + self.scale * position.z,
        ]
    }

    fn line(&self, text: &mut String, class: &str, points: impl Iterator<Item = V3>) {
        // A point where the last one is would show nothing.
        let mut last = [f64::NAN; 2];
        let mut data = String::new();
        for [x, y] in points.map(|p| self.pixel(p)) {
            let near = (x - last[0]).hypot(y - last[1]) < 0.7;
            if !near {
                let _ = write!(data, "{x:.1},{y:.1} ");
                last = [x, y];
            }
        }
        let _ = writeln!(
            text,
            "<polyline class=\"{class}\" points=\"{}\"/>",
            data.trim_end()
        );
    }
}

/// Directions on the picture of the nose and of the belly at an orientation θ.
fn axes(theta: f64) -> [[f64; 2]; 2] {
    let (sin, cos) = theta.sin_cos();
    // θ = 0 is nose up, −90° nose forward; the belly is ahead in hover and below in cruise.
    [[-sin, -cos], [cos, -sin]]
}

/// The vehicle, its nose and its belly in these directions, with the thrust that acts on it, as an arrow as long as the vehicle where thrust is the weight.
pub(super) fn vehicle(
    text: &mut String,
    [x, y]: [f64; 2],
    [nose, belly]: [[f64; 2]; 2],
    thrust_to_weight: f64,
) {
    let at = |ahead: f64, below: f64| {
        [
            x + LONG * (ahead * nose[0] + below * belly[0]),
            y + LONG * (ahead * nose[1] + below * belly[1]),
        ]
    };
    let [from, to] = [at(-0.5, 0.0), at(-0.5 - 0.5 * thrust_to_weight, 0.0)];
    if thrust_to_weight > 0.02 {
        let _ = writeln!(
            text,
            "<path class=\"thrust\" d=\"M{:.1} {:.1}L{:.1} {:.1}\"/>",
            from[0], from[1], to[0], to[1]
        );
    }
    let outline = OUTLINE.map(|(ahead, below)| {
        let [x, y] = at(ahead, below);
        format!("{x:.1},{y:.1}")
    });
    let _ = writeln!(
        text,
        "<polygon class=\"craft back\" points=\"{}\"/>",
        outline.join(" ")
    );
}

/// The flight from the side.
pub fn side(experiment: &Experiment, record: &[Step], format: Format) -> Drawn {
    let wide = format.wide(WIDE);
    let highest = match format {
        Format::Sheet => HIGHEST,
        Format::Narrow => 300.0,
        Format::Small => 90.0,
    };
    let all = || {
        let pairs = record.iter();
        pairs.flat_map(|s| [s.truth.position, s.target.position])
    };
    let extent = |of: fn(&V3) -> f64| {
        let values = all().map(|p| of(&p)).filter(|x| x.is_finite());
        let (low, high) = ends(values);
        match low <= high {
            true => (0.5 * (low + high), (high - low).max(LEAST)),
            false => (0.0, LEAST),
        }
    };
    let ((forward, long), (down, deep)) = (extent(|p| p.x), extent(|p| p.z));
    let scale = ((wide - 2.0 * ROOM) / long).min(highest / deep);
    let mut text = String::new();
    let words = "the flight from the side: to scale, the vehicle drawn larger; thrust behind it";
    let top = match format {
        Format::Small => 0.0,
        _ => 30.0 + title(&mut text, words, [2.0, 15.0], wide),
    };
    let bottom = top + 2.0 * ROOM + scale * deep;
    let view = View {
        scale,
        origin: [
            0.5 * wide - scale * forward,
            0.5 * (top + bottom) - scale * down,
        ],
    };
    // Distance over ground.
    let ends = [0.0, wide].map(|x| (x - view.origin[0]) / scale);
    for x in ticks::linear((ends[0], ends[1]), 14.0 * wide / WIDE, false) {
        let at = view.pixel(V3::new(x, 0.0, 0.0))[0];
        if !(24.0..wide - 24.0).contains(&at) {
            continue;
        }
        let _ = writeln!(
            text,
            "<path class=\"ground\" d=\"M{at:.1} {top:.1}V{bottom:.1}\"/>\n<text class=\"tick x\" x=\"{at:.1}\" y=\"{:.1}\">{} m</text>",
            bottom + 16.0,
            ticks::label(x)
        );
    }
    view.line(
        &mut text,
        "line dash orange",
        record.iter().map(|s| s.target.position),
    );
    view.line(
        &mut text,
        "line blue",
        record.iter().map(|s| s.truth.position),
    );
    // A vehicle where none drawn before is near. Times beside every other one, clear of the last one written.
    let mut drawn: Vec<[f64; 2]> = Vec::new();
    let mut written: Vec<[f64; 2]> = Vec::new();
    let last = record.len().saturating_sub(1);
    for (i, step) in record.iter().enumerate() {
        let at = view.pixel(step.truth.position);
        let room = if i == last { 0.9 } else { 1.5 } * LONG;
        let near = |there: &[f64; 2], most: f64| (at[0] - there[0]).hypot(at[1] - there[1]) < most;
        if !at.iter().all(|x| x.is_finite()) || drawn.iter().any(|there| near(there, room)) {
            continue;
        }
        drawn.push(at);
        let thrust = step.truth.thrust / experiment.weight();
        vehicle(&mut text, at, axes(step.theta), thrust);
        if !written.iter().any(|there| near(there, 2.2 * LONG)) {
            written.push(at);
            let _ = writeln!(
                text,
                "<text class=\"tick x\" x=\"{:.1}\" y=\"{:.1}\">{:.1} s</text>",
                at[0],
                at[1] - 0.62 * LONG,
                step.t
            );
        }
    }
    Drawn {
        size: [wide, bottom + 26.0],
        attributes: String::new(),
        body: text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hover_is_nose_up_and_cruise_nose_to_the_right() {
        let near = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-12;
        let [nose, belly] = axes(0.0);
        assert!(near(nose, [0.0, -1.0]) && near(belly, [1.0, 0.0]));
        let [nose, belly] = axes(-std::f64::consts::FRAC_PI_2);
        assert!(near(nose, [1.0, 0.0]) && near(belly, [0.0, 1.0]));
    }

    #[test]
    fn down_is_downward_and_forward_to_the_right() {
        let view = View {
            scale: 2.0,
            origin: [10.0, 20.0],
        };
        assert_eq!(view.pixel(V3::new(5.0, 0.0, 3.0)), [20.0, 26.0]);
    }
}
