//! How the world is seen, and what is drawn in it: lines, the vehicle, words that do not lie on each other.

use std::fmt::Write as _;

use crate::chart::ends;
use crate::svg::width;
use alula_sim::experiment::{State, V3};

/// Span of a drawn vehicle \[px\].
pub const SPAN: f64 = 46.0;
/// Least half extent of a view \[m\].
const LEAST: f64 = 3.0;
/// Height of letters \[px\].
const LETTERS: f64 = 14.0;

/// Classes of the vehicle's sides.
pub const BACK: &str = "back";
/// As [`BACK`].
pub const BELLY: &str = "belly";

/// How the world is seen.
#[derive(Clone, Copy)]
pub struct View {
    pub right: V3,
    pub up: V3,
    /// Towards the eye.
    pub toward: V3,
    /// \[px/m\].
    pub scale: f64,
    /// Pixel of the world's origin.
    pub origin: [f64; 2],
}

impl View {
    /// Seen along a course \[°\] from an elevation \[°\].
    pub fn along(course: f64, elevation: f64) -> Self {
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
    pub fn fitted(mut self, points: &[V3], [left, top, width, height]: [f64; 4]) -> Self {
        let range = |axis: V3| {
            let (low, high) = ends(points.iter().map(|p| p.dot(&axis)));
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

    pub fn pixel(&self, p: V3) -> [f64; 2] {
        [
            self.origin[0] + self.scale * p.dot(&self.right),
            self.origin[1] - self.scale * p.dot(&self.up),
        ]
    }

    fn points(&self, line: impl Iterator<Item = V3>) -> String {
        let pixel = |p| self.pixel(p).map(|x| format!("{x:.1}")).join(",");
        line.map(pixel).collect::<Vec<_>>().join(" ")
    }

    pub fn line(&self, text: &mut String, line: impl Iterator<Item = V3>, class: &str) {
        let points = self.points(line);
        let _ = writeln!(text, "<polyline class=\"{class}\" points=\"{points}\"/>");
    }

    /// The vehicle at `p`: a delta with the nose in front, its belly in another colour than its back.
    pub fn vehicle(&self, text: &mut String, state: &State, p: V3) {
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
}

/// A length in words.
pub fn metres(length: f64) -> String {
    // Not -0, nor the rounding's digits.
    let length = (length * 1e6).round() / 1e6 + 0.0;
    format!("{length} m").replace('-', "\u{2212}")
}

/// Words at a pixel.
pub fn label(text: &mut String, [x, y]: [f64; 2], words: &str, anchor: &str) {
    let _ = writeln!(
        text,
        "<text class=\"halo\" x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{words}</text>"
    );
}

/// A box: left, top, right, bottom \[px\].
type Bounds = [f64; 4];

/// What is taken of a drawing: words go where nothing else is.
pub struct Taken {
    frame: Bounds,
    boxes: Vec<Bounds>,
}

impl Taken {
    /// Nothing is, in the frame (left, top, width, height).
    pub fn new([left, top, width, height]: [f64; 4]) -> Self {
        Self {
            frame: [left, top, left + width, top + height],
            boxes: Vec::new(),
        }
    }

    /// A box about `at`.
    pub fn take(&mut self, [x, y]: [f64; 2], [width, height]: [f64; 2]) {
        let (w, h) = (0.5 * width, 0.5 * height);
        self.boxes.push([x - w, y - h, x + w, y + h]);
    }

    fn is_free(&self, [left, top, right, bottom]: Bounds) -> bool {
        let [l, t, r, b] = self.frame;
        let inside = left >= l && top >= t && right <= r && bottom <= b;
        let meets = |o: &Bounds| left < o[2] && right > o[0] && top < o[3] && bottom > o[1];
        inside && !self.boxes.iter().any(meets)
    }

    /// How much of a box is taken \[px²\].
    fn covered(&self, [left, top, right, bottom]: Bounds) -> f64 {
        let shared = |o: &Bounds| {
            let (wide, high) = (
                right.min(o[2]) - left.max(o[0]),
                bottom.min(o[3]) - top.max(o[1]),
            );
            wide.max(0.0) * high.max(0.0)
        };
        self.boxes.iter().map(shared).sum()
    }

    /// The left upper end of a box in the first corner of the frame that is free, or else in the one that is most so; it is taken.
    pub fn corner(&mut self, [width, height]: [f64; 2]) -> [f64; 2] {
        let [l, t, r, b] = self.frame;
        let corners = [
            [l, t],
            [r - width, t],
            [l, b - height],
            [r - width, b - height],
        ];
        let covered = |at: &&[f64; 2]| self.covered([at[0], at[1], at[0] + width, at[1] + height]);
        let first = corners
            .iter()
            .min_by(|a, b| covered(a).total_cmp(&covered(b)));
        let at = *first.expect("four corners");
        self.take([at[0] + 0.5 * width, at[1] + 0.5 * height], [width, height]);
        at
    }

    /// Words beside the pixel `at`, on the first of its sides that is free: above, right, left, below, each `off` from it. None of
    /// them is, and they are left out.
    pub fn words(&mut self, text: &mut String, [x, y]: [f64; 2], off: f64, words: &str) {
        let (w, h) = (width(words, LETTERS) + 6.0, LETTERS + 4.0);
        let side = off + 0.5 * w;
        for (x, y) in [(x, y - off), (x + side, y), (x - side, y), (x, y + off)] {
            if self.is_free([x - 0.5 * w, y - 0.5 * h, x + 0.5 * w, y + 0.5 * h]) {
                self.take([x, y], [w, h]);
                label(text, [x, y + 5.0], words, "middle");
                return;
            }
        }
    }
}

/// An arrow that lies on the ground about the pixel `at`, with words beyond its head.
pub fn arrow(
    text: &mut String,
    view: &View,
    at: [f64; 2],
    direction: V3,
    class: &str,
    words: &str,
) {
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
    match words.chars().count() {
        1 => {
            let [x, y] = view.pixel(0.75 * direction);
            label(text, [x, y + 5.0], words, "middle");
        }
        _ => label(text, [at[0] + 36.0, at[1] + 5.0], words, "start"),
    }
}

/// 1, 2 or 5 times a power of ten, about `x`.
pub fn round_number(x: f64) -> f64 {
    let power = 10.0_f64.powf(x.log10().floor());
    let factor = [1.0, 2.0, 5.0, 10.0].into_iter().find(|f| f * power >= x);
    factor.unwrap_or(10.0) * power
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::refusals::says;

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
        let state = State {
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
    fn words_lie_on_nothing() {
        let mut taken = Taken::new([0.0, 0.0, 200.0, 100.0]);
        let mut text = String::new();
        let place = |text: &str| text.matches("<text").count();
        taken.words(&mut text, [100.0, 50.0], 20.0, "12 s");
        taken.words(&mut text, [100.0, 50.0], 20.0, "12 s");
        assert_eq!(place(&text), 2);
        says(&text, &["y=\"35.0\"", "y=\"55.0\""]);
        // Right, left and below are taken one after the other; then there is no room.
        for _ in 0..3 {
            taken.words(&mut text, [100.0, 50.0], 20.0, "12 s");
        }
        assert_eq!(place(&text), 4);
        // Outside of the frame.
        taken.words(&mut text, [-500.0, 50.0], 20.0, "12 s");
        assert_eq!(place(&text), 4);
    }

    #[test]
    fn grids_are_of_round_numbers() {
        assert_eq!([0.7, 2.3, 31.0].map(round_number), [1.0, 5.0, 50.0]);
    }
}
