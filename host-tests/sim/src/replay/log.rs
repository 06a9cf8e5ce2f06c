//! The states of an autopilot's log, as a controller is told them.
//!
//! The controllers work in a vertical plane. Here it is the one that the right wing is square to, row by row: it holds the nose of an
//! unbanked vehicle at any pitch. What is across it is left out, and its size told.

use std::io::Write;

use alula::{Attitude, Body, FeedForward, Inertial, PlanarGuidanceInput, Reference};
use alula_logs::states::States;
use anyhow::bail;
use nalgebra::{Quaternion, UnitQuaternion};

use super::Commands;
use super::states::{self, Row};
use crate::controllers::Input;
use crate::experiment::Experiment;
use crate::simulate::Step;
use crate::space::V3;

/// A vertical plane by its horizontal unit vector, north-east-down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    forward: V3,
}

impl Plane {
    /// The plane through `heading` \[rad\], from north towards east.
    pub fn through(heading: f64) -> Self {
        Self {
            forward: V3::new(heading.cos(), heading.sin(), 0.0),
        }
    }

    /// The plane that the right wing is square to, of a body with x along the nose; none if the wing points up or down, or the
    /// attitude is not known.
    pub fn of(attitude: [f64; 4]) -> Option<Self> {
        let wing = unit(attitude)? * V3::y();
        let forward = V3::new(wing.y, -wing.x, 0.0);
        let length = forward.norm();
        (length > 0.1).then(|| Self {
            forward: forward / length,
        })
    }

    fn within(&self, v: [f64; 3]) -> Inertial {
        let v = V3::from(v);
        Inertial::new(v.z as f32, v.dot(&self.forward) as f32)
    }

    fn across(&self, v: [f64; 3]) -> f64 {
        V3::from(v).dot(&V3::z().cross(&self.forward))
    }

    /// θ of the nose's projection \[rad\]; NaN if the attitude is not known.
    pub fn theta(&self, attitude: [f64; 4]) -> f64 {
        let Some(q) = unit(attitude) else {
            return f64::NAN;
        };
        let tail = q * -V3::x();
        tail.dot(&self.forward).atan2(tail.z)
    }
}

fn unit([w, x, y, z]: [f64; 4]) -> Option<UnitQuaternion<f64>> {
    UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-6)
}

/// Runs the controller of `experiment` over `states` and writes its commands `to`; `visit` is given every step. `plane` is the vertical
/// plane of the flight; if there is none, that of the wing. What had to be assumed is said in the words returned.
pub fn replay(
    states: &States,
    plane: Option<Plane>,
    to: impl Write,
    experiment: &Experiment,
    mut visit: impl FnMut(Step),
) -> anyhow::Result<Vec<String>> {
    if experiment.spec()?.feed_forward() {
        bail!(
            "the controller wants the air acceleration and the reference's jerk, which a log does not hold"
        );
    }
    states::check(states)?;
    let mut commands = Commands::new(experiment, to)?;
    let mut current = plane.unwrap_or(Plane::through(0.0));
    let mut across = (0.0, 0usize);
    let mut followed = states::Followed::default();
    for (row, &t) in states.time.iter().enumerate() {
        let attitude = states.attitude.values[row];
        if plane.is_none() {
            current = Plane::of(attitude).unwrap_or(current);
        }
        let theta = current.theta(attitude) as f32;
        let told = Row::of(states, row);
        if told.velocity_age.is_finite() {
            across = (
                across.0 + current.across(told.velocity).powi(2),
                across.1 + 1,
            );
        }
        followed.count(&told);
        let input = Input {
            theta,
            sample: PlanarGuidanceInput {
                velocity: current.within(told.velocity),
                attitude: Attitude::from_angle(theta),
                state_age: told.velocity_age.max(states::age(&states.attitude, row)) as f32,
                air: told.air(|v| current.within(v)),
                specific_force: told.force().map(|f| Body::new(f.i, f.j)),
                position_error: told.position_error().map(|e| current.within(e.into())),
                reference: Reference {
                    velocity: current.within(told.reference),
                    acceleration: current.within(told.acceleration),
                },
                reference_age: told.reference_age as f32,
                ..PlanarGuidanceInput::default()
            },
            feed_forward: None::<FeedForward>,
        };
        visit(commands.row(&t.to_string(), t, input)?);
    }
    commands.end()?;
    let mut notes = states::notes(states, followed);
    if across.1 > 0 {
        let rms = (across.0 / across.1 as f64).sqrt();
        notes.push(format!(
            "velocity across the vertical plane, left out: {rms:.2} m/s (root mean square)"
        ));
    }
    Ok(notes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nose up, nose level and nose level but rolled onto the left wing's side by 30°, each on heading east.
    #[test]
    fn the_plane_is_that_of_the_wing_at_any_pitch() {
        let east = UnitQuaternion::from_axis_angle(&V3::z_axis(), 90.0_f64.to_radians());
        let of = |pitch: f64, roll: f64| {
            let turned = east
                * UnitQuaternion::from_axis_angle(&V3::y_axis(), pitch.to_radians())
                * UnitQuaternion::from_axis_angle(&V3::x_axis(), roll.to_radians());
            let q = turned.quaternion();
            [q.w, q.i, q.j, q.k]
        };
        // 1e-12: roundings.
        for (pitch, roll, theta) in [
            (90.0, 0.0, 0.0),
            (0.0, 0.0, -90.0),
            (0.0, -30.0, -90.0),
            (120.0, 0.0, 30.0),
        ] {
            let plane = Plane::of(of(pitch, roll)).unwrap();
            assert!((plane.forward - V3::y()).norm() < 1e-12, "{plane:?}");
            let found = plane.theta(of(pitch, roll)).to_degrees();
            assert!((found - theta).abs() < 1e-10, "{found}");
        }
        assert_eq!(Plane::of(of(0.0, 90.0)), None);
        assert_eq!(Plane::of([f64::NAN; 4]), None);
        let plane = Plane::through(90.0_f64.to_radians());
        assert!((plane.across([-3.0, 5.0, 1.0]) - 3.0).abs() < 1e-12);
        assert_eq!(plane.within([0.0, 5.0, 1.0]), Inertial::new(1.0, 5.0));
    }
}
