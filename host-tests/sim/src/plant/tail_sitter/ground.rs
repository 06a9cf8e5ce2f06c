//! The ground under a tail-sitter: springs with dampers and friction at its trailing edges, its hubs and its feet.

use super::{GRAVITY, V3};
use crate::experiment::tail_sitter::{Strip, TailSitterSpec};

/// How far one point gives way under the whole weight \[m\].
const GIVES: f64 = 0.02;
/// Damping over stiffness \[s\].
const DAMPING: f64 = 0.02;
/// Coefficient of friction.
const FRICTION: f64 = 0.5;
/// Speed below which friction fades \[m/s\].
const CREEP: f64 = 0.1;

/// Where a vehicle touches the ground, and how hard it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Ground {
    /// Forward, right, down from the centre of mass \[m\].
    pub points: Vec<V3>,
    /// Stiffness of each \[N/m\].
    stiffness: f64,
}

impl Ground {
    /// Its points: the trailing edge's ends of the outermost strips, those of fins, the hubs, and feet.
    pub fn new(spec: &TailSitterSpec) -> Self {
        let strips = &spec.wing.strips;
        let level = || strips.iter().filter(|strip| !strip.upright);
        let reach = |strip: &Strip| strip.position_m[1].abs() + 0.5 * strip.span_m;
        let outermost = level().map(reach).fold(0.0, f64::max);
        let mut points = Vec::new();
        for strip in strips {
            let [forward, right, down] = strip.position_m;
            let rear = forward - 0.75 * strip.chord_m;
            let half = 0.5 * strip.span_m;
            if strip.upright {
                points.push(V3::new(rear, right, down - half));
                points.push(V3::new(rear, right, down + half));
            } else if reach(strip) > 0.999 * outermost {
                points.push(V3::new(rear, right + half.copysign(right), down));
            }
        }
        points.extend(spec.propellers.iter().map(|p| V3::from(p.position_m)));
        points.extend(spec.feet_m.iter().map(|&foot| V3::from(foot)));
        Self {
            points,
            stiffness: spec.mass_kg * GRAVITY / GIVES,
        }
    }

    /// Height of the centre of mass where it stands nose up \[m\].
    pub fn stance(&self) -> f64 {
        self.points.iter().map(|p| -p.x).fold(0.0, f64::max)
    }

    /// Force \[N\] on a point `depth` \[m\] in the ground that moves at `velocity` \[m/s\]; both in north, east, down.
    pub fn force(&self, depth: f64, velocity: V3) -> V3 {
        if depth <= 0.0 {
            return V3::zeros();
        }
        // It pushes and never pulls.
        let up = (self.stiffness * (depth + DAMPING * velocity.z)).max(0.0);
        let along = V3::new(velocity.x, velocity.y, 0.0);
        let friction = -FRICTION * up / along.norm().max(CREEP) * along;
        friction - V3::new(0.0, 0.0, up)
    }
}
