//! The ground that a flight is drawn over: a level plane at a stated altitude, in squares, with a ruler for the altitude.

use super::view::{Taken, View, label, metres, round_number};
use alula_sim::experiment::V3;
use alula_sim::simulate::Step;

/// Between two marks of the ruler, at least \[px\].
const APART: f64 = 18.0;

/// A plane under the flight. Altitudes are over the start of the path.
pub struct Ground {
    /// Its corners of least and greatest north and east.
    low: V3,
    high: V3,
    /// Down of the plane.
    down: f64,
    /// Down of the highest point.
    top: f64,
    /// Side of its squares \[m\].
    pub grid: f64,
}

impl Ground {
    /// The plane one to two squares under the lowest point of the flight, at a whole number of squares.
    pub fn of(record: &[Step]) -> Self {
        let points = record
            .iter()
            .flat_map(|s| [s.truth.position, s.target.position]);
        let (low, high) = points.fold(
            (V3::repeat(f64::INFINITY), V3::repeat(f64::NEG_INFINITY)),
            |(low, high), p| (low.inf(&p), high.sup(&p)),
        );
        let size = (high - low).amax().max(6.0);
        let grid = round_number(size / 10.0);
        let floor = |x: f64| (x / grid).floor() * grid;
        let ceil = |x: f64| (x / grid).ceil() * grid;
        Self {
            low: V3::new(floor(low.x - 0.5 * grid), floor(low.y - 0.5 * grid), low.z),
            high: V3::new(ceil(high.x + 0.5 * grid), ceil(high.y + 0.5 * grid), high.z),
            down: ceil(high.z + 0.8 * grid),
            top: low.z,
            grid,
        }
    }

    /// Its altitude over the start \[m\].
    pub fn altitude(&self) -> f64 {
        // Not -0.
        0.0 - self.down
    }

    /// The point under `p`.
    pub fn under(&self, p: V3) -> V3 {
        V3::new(p.x, p.y, self.down)
    }

    /// Its corners, one after the other around it.
    pub fn corners(&self) -> [V3; 4] {
        let (l, h) = (self.low, self.high);
        [(l.x, l.y), (l.x, h.y), (h.x, h.y), (h.x, l.y)].map(|(x, y)| V3::new(x, y, self.down))
    }

    /// The corners, and the top of the ruler where there is one.
    pub fn extent(&self, view: &View, raised: bool) -> Vec<V3> {
        let mut points = self.corners().to_vec();
        if raised {
            let foot = self.foot(view);
            points.push(V3::new(foot.x, foot.y, self.top));
        }
        points
    }

    /// The squares, and the length of one as a scale.
    pub fn draw(&self, text: &mut String, view: &View, taken: &mut Taken) {
        let lines = |low: f64, high: f64| {
            let n = ((high - low) / self.grid).round() as usize;
            (0..=n).map(move |i| low + i as f64 * self.grid)
        };
        let (l, h, z) = (self.low, self.high, self.down);
        for x in lines(l.x, h.x) {
            let ends = [V3::new(x, l.y, z), V3::new(x, h.y, z)];
            view.line(text, ends.into_iter(), "ground");
        }
        for y in lines(l.y, h.y) {
            let ends = [V3::new(l.x, y, z), V3::new(h.x, y, z)];
            view.line(text, ends.into_iter(), "ground");
        }
        // Along the edge in front, from its middle on.
        let middle = l.y + (0.5 * (h.y - l.y) / self.grid).floor() * self.grid;
        let bar = [middle, middle + self.grid].map(|y| V3::new(l.x, y, z));
        view.line(text, bar.into_iter(), "line black");
        let [x, y] = view.pixel(0.5 * (bar[0] + bar[1]));
        label(text, [x, y + 18.0], &metres(self.grid), "middle");
        taken.take([x, y + 13.0], [60.0, 20.0]);
    }

    /// The corner that is farthest left, where the ruler stands.
    fn foot(&self, view: &View) -> V3 {
        let left = |p: &V3| p.dot(&view.right);
        let corners = self.corners().into_iter();
        let foot = corners.min_by(|a, b| left(a).total_cmp(&left(b)));
        foot.expect("four corners")
    }

    /// The altitude over the start along a ruler that stands on the ground, up to the highest point.
    pub fn draw_ruler(&self, text: &mut String, view: &View, taken: &mut Taken) {
        let (foot, plane, top) = (self.foot(view), self.altitude(), 0.0 - self.top);
        let at = |altitude: f64| V3::new(foot.x, foot.y, -altitude);
        view.line(text, [foot, at(top)].into_iter(), "line grey");
        // Round numbers, as close as their words can stand.
        let step = round_number(APART / (view.scale * -view.up.z));
        let first = (plane / step + 1e-9).ceil();
        let marks = (0..).map(|i| (first + f64::from(i)) * step);
        let marks = marks.take_while(|&mark| mark <= top + 1e-9 * step);
        let mut last = f64::INFINITY;
        for altitude in std::iter::once(plane).chain(marks) {
            let [x, y] = view.pixel(at(altitude));
            // The first may be near the plane.
            if last - y < 0.9 * APART {
                continue;
            }
            last = y;
            let tick = format!("{:.1},{y:.1} {x:.1},{y:.1}", x - 6.0);
            *text += &format!("<polyline class=\"line grey\" points=\"{tick}\"/>\n");
            label(text, [x - 10.0, y + 5.0], &metres(altitude), "end");
            taken.take([x - 35.0, y], [60.0, 18.0]);
        }
    }
}
