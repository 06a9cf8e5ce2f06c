//! Where a flight in space starts.

use nalgebra::{Quaternion, UnitQuaternion};
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use serde::Deserialize;

use super::path::Target;
use super::plant::SpatialState;
use super::{V3, velocity};
use crate::experiment::{FieldError, angle, finite, rate, require, speed};

/// `[initial]`. The flight starts on the path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct InitialSpec {
    /// Velocity \[m/s\]; the path's if left out.
    pub velocity_m_s: Option<[f64; 3]>,
    /// Course of that velocity, clockwise from north \[°\]; its own if left out.
    pub course_deg: Option<f64>,
    /// θ in the vertical plane of the heading \[°\]: 0 nose up, −90 nose forward.
    pub theta_deg: f64,
    /// Heading of the belly, clockwise from north \[°\]; if left out the path's heading, or else the course.
    pub heading_deg: Option<f64>,
    /// Thrust before the first command acts \[N\].
    pub thrust_n: f64,
    /// Random departures from that.
    pub scatter: Option<Scatter>,
}

/// Random departures, drawn from the experiment's seed: any attitude, uniform over the rotations.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scatter {
    /// Radius of the ball that a velocity is added from \[m/s\].
    pub velocity_m_s: f64,
    /// Greatest body rate about each axis \[rad/s\].
    pub rate_rad_s: f64,
}

impl InitialSpec {
    pub(super) fn validate(&self) -> Result<(), FieldError> {
        let start = self.velocity_m_s.map_or(V3::zeros(), V3::from);
        velocity("initial.velocity_m_s", &start)?;
        angle("initial.course_deg", self.course_deg.unwrap_or(0.0))?;
        angle("initial.theta_deg", self.theta_deg)?;
        angle("initial.heading_deg", self.heading_deg.unwrap_or(0.0))?;
        finite("initial.thrust_n", self.thrust_n)?;
        let Some(scatter) = &self.scatter else {
            return Ok(());
        };
        speed("initial.scatter.velocity_m_s", scatter.velocity_m_s)?;
        rate("initial.scatter.rate_rad_s", scatter.rate_rad_s)?;
        for (field, value) in [
            ("initial.scatter.velocity_m_s", scatter.velocity_m_s),
            ("initial.scatter.rate_rad_s", scatter.rate_rad_s),
        ] {
            require(value >= 0.0, field, "must not be negative")?;
        }
        Ok(())
    }

    /// The state at the start, for a path that begins at `target`.
    pub fn state(&self, target: &Target, random: &mut impl Rng) -> SpatialState {
        let mut velocity = self.velocity_m_s.map_or(target.velocity, V3::from);
        let mut along = target.velocity.y.atan2(target.velocity.x);
        if let Some(course) = self.course_deg {
            along = course.to_radians();
            let level = velocity.xy().norm();
            velocity = V3::new(level * along.cos(), level * along.sin(), velocity.z);
        }
        let heading = self.heading_deg.map(f64::to_radians);
        let heading = heading.or(target.heading).unwrap_or(along);
        let turn = UnitQuaternion::from_axis_angle(&V3::z_axis(), heading);
        let pitch = UnitQuaternion::from_axis_angle(&V3::y_axis(), self.theta_deg.to_radians());
        let state = SpatialState {
            position: target.position,
            velocity,
            attitude: turn * pitch,
            rates: V3::zeros(),
            thrust: self.thrust_n,
        };
        match &self.scatter {
            Some(scatter) => scatter.of(state, random),
            None => state,
        }
    }
}

impl Scatter {
    fn of(&self, state: SpatialState, random: &mut impl Rng) -> SpatialState {
        let mut normal = || -> f64 { StandardNormal.sample(random) };
        let q = Quaternion::new(normal(), normal(), normal(), normal());
        let direction = V3::new(normal(), normal(), normal()).normalize();
        // Uniform over the ball.
        let length = self.velocity_m_s * random.random::<f64>().cbrt();
        let mut rate = || self.rate_rad_s * (2.0 * random.random::<f64>() - 1.0);
        SpatialState {
            velocity: state.velocity + length * direction,
            attitude: UnitQuaternion::from_quaternion(q),
            rates: V3::new(rate(), rate(), rate()),
            ..state
        }
    }
}
