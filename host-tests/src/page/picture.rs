//! The picture of a flight: from the side and from above with the vehicle's attitude along the track, and a strip of
//! attitudes over time.

use std::fmt::Write as _;

use super::svg::Drawn;
use crate::space::{SpatialState, Step, V3};

/// Width of the picture, and height of the views and of the whole \[px\].
const WIDE: f64 = 1280.0;
const VIEWS: f64 = 600.0;
const HIGH: f64 = VIEWS + 150.0;
/// Span of a drawn vehicle \[px\].
const SPAN: f64 = 52.0;
/// Least half extent of a view \[m\].
const LEAST: f64 = 3.0;

/// Classes of the vehicle's sides.
const BACK: &str = "back";
const BELLY: &str = "belly";

/// How the world is seen.
struct View {
    right: V3,
    up: V3,
    /// Towards the eye.
    toward: V3,
    /// \[px/m\].
    scale: f64,
    /// Pixel of the world's origin.
    origin: [f64; 2],
}

impl View {
    /// Seen along a course \[°\] from an elevation \[°\].
    fn along(course: f64, elevation: f64) -> Self {
        let (sin, cos) = course.to_radians().sin_cos();
        let (steep, flat) = elevation.to_radians().sin_cos();
        let ahead = V3::new(cos, sin, 0.0);
        Self {
            right: V3::new(-sin, cos, 0.0),
            up: steep * ahead - flat * V3::z(),
            toward: -flat * ahead - steep * V3::z(),
            scale: 1.0,
            origin: [0.0; 2],
        }
    }

    /// Scaled and shifted so that the points lie inside the frame (left, top, width, height).
    fn fitted(mut self, points: &[V3], [left, top, width, height]: [f64; 4]) -> Self {
        let range = |axis: V3| {
            let values = points.iter().map(|p| p.dot(&axis));
            let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
                (l.min(x), h.max(x))
            });
            (0.5 * (low + high), (0.5 * (high - low)).max(LEAST))
        };
        let ((x, half_x), (y, half_y)) = (range(self.right), range(self.up));
        // Room for the drawn vehicles.
        let room = |side: f64| 0.5 * side - 0.7 * SPAN;
        self.scale = (room(width) / half_x).min(room(height) / half_y);
        self.origin = [
            left + 0.5 * width - self.scale * x,
            top + 0.5 * height + self.scale * y,
        ];
        self
    }

    fn pixel(&self, p: V3) -> [f64; 2] {
        [
            self.origin[0] + self.scale * p.dot(&self.right),
            self.origin[1] - self.scale * p.dot(&self.up),
        ]
    }

    fn points(&self, line: impl Iterator<Item = V3>) -> String {
        let pixel = |p| self.pixel(p).map(|x| format!("{x:.1}")).join(",");
        line.map(pixel).collect::<Vec<_>>().join(" ")
    }

    fn line(&self, text: &mut String, line: impl Iterator<Item = V3>, class: &str) {
        let points = self.points(line);
        let _ = writeln!(text, "<polyline class=\"{class}\" points=\"{points}\"/>");
    }

    /// The vehicle at `p`: a delta with the nose in front, its belly in another colour than its back.
    fn vehicle(&self, text: &mut String, state: &SpatialState, p: V3) {
        let [tail, belly, right] = state.axes();
        let size = SPAN / self.scale;
        let at = |ahead: f64, across: f64| p + size * (across * right - ahead * tail);
        let points = [at(0.55, 0.0), at(-0.3, 0.5), at(-0.15, 0.0), at(-0.3, -0.5)];
        let points = self.points(points.into_iter());
        let side = if belly.dot(&self.toward) > 0.0 {
            BELLY
        } else {
            BACK
        };
        let _ = writeln!(
            text,
            "<polygon class=\"craft {side}\" points=\"{points}\"/>"
        );
    }

    fn text(&self, text: &mut String, p: V3, shift: [f64; 2], words: &str) {
        let [x, y] = self.pixel(p);
        let (x, y) = (x + shift[0], y + shift[1]);
        label(text, [x, y], words, "middle");
    }
}

fn label(text: &mut String, [x, y]: [f64; 2], words: &str, anchor: &str) {
    let _ = writeln!(
        text,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{words}</text>"
    );
}

/// An arrow that lies on the ground, through the pixel `at`, with words to its right.
fn arrow(text: &mut String, view: &View, at: [f64; 2], direction: V3, class: &str, words: &str) {
    let view = View {
        scale: 56.0,
        origin: at,
        ..*view
    };
    let across = V3::new(-direction.y, direction.x, 0.0);
    let (tail, head) = (-0.5 * direction, 0.5 * direction);
    view.line(text, [tail, head].into_iter(), class);
    let neck = head - 0.25 * direction;
    let barbs = [neck + 0.12 * across, head, neck - 0.12 * across];
    view.line(text, barbs.into_iter(), class);
    label(text, [at[0] + 36.0, at[1] + 5.0], words, "start");
}

/// 1, 2 or 5 times a power of ten, about `x`.
fn round_number(x: f64) -> f64 {
    let power = 10.0_f64.powf(x.log10().floor());
    let factor = [1.0, 2.0, 5.0, 10.0].into_iter().find(|f| f * power >= x);
    factor.unwrap_or(10.0) * power
}

/// The vertical and horizontal extent of a flight.
struct Extent {
    low: V3,
    high: V3,
    /// Down of the ground drawn.
    ground: f64,
    grid: f64,
}

impl Extent {
    fn of(record: &[Step]) -> Self {
        let points = record
            .iter()
            .flat_map(|s| [s.truth.position, s.target.position]);
        let (low, high) = points.fold(
            (V3::repeat(f64::INFINITY), V3::repeat(f64::NEG_INFINITY)),
            |(low, high), p| (low.inf(&p), high.sup(&p)),
        );
        let size = (high - low).amax().max(2.0 * LEAST);
        let grid = round_number(size / 10.0);
        let down = |x: f64| (x / grid).floor() * grid;
        let up = |x: f64| (x / grid).ceil() * grid;
        Self {
            low: V3::new(down(low.x - 0.5 * grid), down(low.y - 0.5 * grid), low.z),
            high: V3::new(up(high.x + 0.5 * grid), up(high.y + 0.5 * grid), high.z),
            ground: up(high.z + 0.8 * grid),
            grid,
        }
    }

    fn corners(&self) -> Vec<V3> {
        let (l, h) = (self.low, self.high);
        let level =
            |z| [(l.x, l.y), (l.x, h.y), (h.x, l.y), (h.x, h.y)].map(|(x, y)| V3::new(x, y, z));
        level(self.ground).to_vec()
    }

    fn draw_grid(&self, text: &mut String, view: &View) {
        let style = "ground";
        let lines = |low: f64, high: f64| {
            let n = ((high - low) / self.grid).round() as usize;
            (0..=n).map(move |i| low + i as f64 * self.grid)
        };
        let (l, h, z) = (self.low, self.high, self.ground);
        for x in lines(l.x, h.x) {
            view.line(
                text,
                [V3::new(x, l.y, z), V3::new(x, h.y, z)].into_iter(),
                style,
            );
        }
        for y in lines(l.y, h.y) {
            view.line(
                text,
                [V3::new(l.x, y, z), V3::new(h.x, y, z)].into_iter(),
                style,
            );
        }
    }
}

/// One view of the flight; `raised` draws the ground under it.
fn scene(
    text: &mut String,
    record: &[Step],
    extent: &Extent,
    view: View,
    frame: [f64; 4],
    raised: bool,
) {
    let mut points = extent.corners();
    if raised {
        points.extend(record.iter().map(|s| s.truth.position));
    }
    let view = view.fitted(&points, frame);
    extent.draw_grid(text, &view);
    let thin = record.len().div_ceil(1000);
    let on_ground = |p: V3| V3::new(p.x, p.y, extent.ground);
    let positions = || record.iter().step_by(thin).map(|s| s.truth.position);
    if raised {
        view.line(text, positions().map(on_ground), "shadow");
    }
    let path = record.iter().step_by(thin).map(|s| s.target.position);
    view.line(text, path, "line dash orange");
    view.line(text, positions(), "line blue");

    // A vehicle where none drawn before is near, and at the end.
    let mut drawn: Vec<[f64; 2]> = Vec::new();
    let near = |a: [f64; 2], b: [f64; 2], most: f64| (a[0] - b[0]).hypot(a[1] - b[1]) < most;
    for step in record {
        let p = step.truth.position;
        let pixel = view.pixel(p);
        let last = step.t == record[record.len() - 1].t;
        let most = if last { 0.6 * SPAN } else { SPAN };
        if drawn.iter().any(|&there| near(pixel, there, most)) {
            continue;
        }
        drawn.push(pixel);
        if raised {
            view.line(text, [p, on_ground(p)].into_iter(), "shadow dotted");
        }
        view.vehicle(text, &step.truth, p);
        if drawn.len() % 4 == 1 || last {
            view.text(text, p, [0.0, -0.55 * SPAN], &format!("{:.0} s", step.t));
        }
    }

    let [left, top, _, high] = frame;
    let words = format!("squares of {} m", extent.grid);
    label(text, [left + 12.0, top + high - 10.0], &words, "start");
    arrow(
        text,
        &view,
        [left + 40.0, top + 30.0],
        V3::x(),
        "line black",
        "north",
    );
    let wind: V3 = record.iter().map(|s| s.wind).sum::<V3>() / record.len() as f64;
    let level = V3::new(wind.x, wind.y, 0.0);
    if level.norm() > 0.5 {
        let words = format!("mean wind {:.1} m/s", level.norm());
        arrow(
            text,
            &view,
            [left + 40.0, top + 80.0],
            level.normalize(),
            "line green",
            &words,
        );
    }
}

/// Attitudes at equal times, seen as in the view from the side.
fn strip(text: &mut String, record: &[Step]) {
    let view = View {
        scale: 1.0,
        ..View::along(COURSE, ELEVATION)
    };
    let count = 18;
    for i in 0..count {
        let step = &record[i * (record.len() - 1) / (count - 1)];
        let x = 50.0 + i as f64 * (WIDE - 100.0) / (count as f64 - 1.0);
        let y = VIEWS + 72.0;
        let view = View {
            origin: [x, y],
            ..view
        };
        view.vehicle(text, &step.truth, V3::zeros());
        label(text, [x, y + 58.0], &format!("{:.1} s", step.t), "middle");
    }
}

/// The view from the side.
const COURSE: f64 = 25.0;
const ELEVATION: f64 = 32.0;

/// The picture of a flight.
pub fn picture(record: &[Step]) -> Drawn {
    let mut text = String::new();
    let extent = Extent::of(record);
    let side = [0.0, 40.0, 790.0, VIEWS - 50.0];
    scene(
        &mut text,
        record,
        &extent,
        View::along(COURSE, ELEVATION),
        side,
        true,
    );
    let above = [800.0, 40.0, 480.0, VIEWS - 50.0];
    scene(
        &mut text,
        record,
        &extent,
        View::along(0.0, 90.0),
        above,
        false,
    );
    strip(&mut text, record);
    for (x, y, words) in [
        (12.0, 24.0, "the flight, seen to the north-north-east"),
        (812.0, 24.0, "from above"),
        (12.0, VIEWS + 18.0, "attitude over time, seen likewise"),
    ] {
        let _ = writeln!(
            text,
            "<text class=\"title\" x=\"{x}\" y=\"{y}\">{words}</text>"
        );
    }
    let mut x = 560.0;
    let y = VIEWS + 12.0;
    for (class, words) in [
        (BACK, "flown; back of the vehicle"),
        (BELLY, "its belly"),
        ("orange area", "path (dashed)"),
    ] {
        let top = y - 9.0;
        let _ = writeln!(
            text,
            "<rect class=\"{class}\" x=\"{x}\" y=\"{top}\" width=\"14\" height=\"10\"/>"
        );
        label(&mut text, [x + 20.0, y], words, "start");
        x += 40.0 + 8.0 * words.len() as f64;
    }
    Drawn {
        size: [WIDE, HIGH],
        attributes: String::new(),
        body: text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn from_above_north_is_up_and_east_is_right() {
        let view = View::along(0.0, 90.0);
        let [x, y] = view.pixel(V3::new(2.0, 3.0, 9.0));
        assert!((x - 3.0).abs() < 1e-12 && (y + 2.0).abs() < 1e-12);
        let side = View::along(0.0, 0.0).pixel(V3::new(2.0, 3.0, -9.0));
        assert!((side[0] - 3.0).abs() < 1e-12 && (side[1] + 9.0).abs() < 1e-12);
    }

    #[test]
    fn the_belly_is_seen_from_below() {
        let state = SpatialState {
            position: V3::zeros(),
            velocity: V3::zeros(),
            // Level: nose to the north, belly down.
            attitude: nalgebra::UnitQuaternion::from_axis_angle(
                &V3::y_axis(),
                -std::f64::consts::FRAC_PI_2,
            ),
            rates: V3::zeros(),
            thrust: 0.0,
        };
        for (elevation, color) in [(90.0, BACK), (-90.0, BELLY)] {
            let mut text = String::new();
            View::along(0.0, elevation).vehicle(&mut text, &state, V3::zeros());
            assert!(text.contains(&format!("craft {color}")), "{text}");
        }
    }

    #[test]
    fn grids_are_of_round_numbers() {
        assert_eq!([0.7, 2.3, 31.0].map(round_number), [1.0, 5.0, 50.0]);
    }
}
