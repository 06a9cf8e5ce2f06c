//! Where a flight starts.

use nalgebra::{Quaternion, UnitQuaternion};
use rand::{Rng, RngExt};
use schemars::JsonSchema;
use serde::Deserialize;

use super::V3;
use super::document::{FieldError, angle, finite, rate, require, speed};
use super::normal::normal;
use super::path::Target;
use super::plant::{State, from_frd};
use super::vector::{optional_vector, velocity};

/// `[initial]`. The flight starts on the path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct InitialSpec {
    /// Velocity \[m/s\], north-east-down; the path's if left out.
    #[serde(deserialize_with = "optional_vector")]
    #[schemars(with = "Option<[f64; 3]>")]
    pub velocity_m_s: Option<V3>,
    /// A speed that is added in the vertical plane to the north \[m/s\].
    pub speed_m_s: f64,
    /// The direction of that speed \[°\]: 0 down, 90 north.
    pub path_deg: f64,
    /// Course of that velocity, clockwise from north \[°\]; its own if left out.
    pub course_deg: Option<f64>,
    /// θ in the vertical plane of the heading \[°\]: 0 nose up, −90 nose forward.
    pub theta_deg: f64,
    /// Heading of the belly, clockwise from north \[°\]; if left out the path's heading, or else the course.
    pub heading_deg: Option<f64>,
    /// Roll, pitch and yaw rate \[rad/s\]. Without a lag of the rate loop they are what is commanded at once.
    pub body_rates_rad_s: [f64; 3],
    /// Thrust before the first command acts \[N\].
    pub thrust_n: f64,
    /// Random departures from that.
    pub scatter: Option<Scatter>,
}

/// Random departures, drawn from the experiment's seed: any attitude, uniform over the rotations.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scatter {
    /// Radius of the ball that a velocity is added from \[m/s\].
    pub velocity_m_s: f64,
    /// Greatest body rate about each axis \[rad/s\].
    pub rate_rad_s: f64,
}

impl InitialSpec {
    pub(super) fn validate(&self) -> Result<(), FieldError> {
        velocity(
            "initial.velocity_m_s",
            &self.velocity_m_s.unwrap_or_default(),
        )?;
        speed("initial.speed_m_s", self.speed_m_s)?;
        angle("initial.path_deg", self.path_deg)?;
        angle("initial.course_deg", self.course_deg.unwrap_or(0.0))?;
        angle("initial.theta_deg", self.theta_deg)?;
        angle("initial.heading_deg", self.heading_deg.unwrap_or(0.0))?;
        let rates = self.body_rates_rad_s.iter();
        rates
            .copied()
            .try_for_each(|x| rate("initial.body_rates_rad_s", x))?;
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

    /// Whether nothing points out of the vertical plane to the north.
    pub(super) fn in_plane(&self) -> bool {
        let Self {
            velocity_m_s,
            body_rates_rad_s: [roll, _, yaw],
            ..
        } = self;
        let level = velocity_m_s.is_none_or(|v| v.y == 0.0) && *roll == 0.0 && *yaw == 0.0;
        level && self.course_deg.is_none() && self.heading_deg.is_none() && self.scatter.is_none()
    }

    /// The state at the start, for a path that begins at `target`.
    pub fn state(&self, target: &Target, random: &mut impl Rng) -> State {
        let mut velocity = self.velocity_m_s.unwrap_or(target.velocity);
        let mut along = libm::atan2(target.velocity.y, target.velocity.x);
        if let Some(course) = self.course_deg {
            along = course.to_radians();
            let level = velocity.xy().norm();
            velocity = V3::new(
                level * libm::cos(along),
                level * libm::sin(along),
                velocity.z,
            );
        }
        let (north, down) = libm::sincos(self.path_deg.to_radians());
        velocity += self.speed_m_s * V3::new(north, 0.0, down);
        let heading = self.heading_deg.map(f64::to_radians);
        let heading = heading.or(target.heading).unwrap_or(along);
        let turn = UnitQuaternion::from_axis_angle(&V3::z_axis(), heading);
        let pitch = UnitQuaternion::from_axis_angle(&V3::y_axis(), self.theta_deg.to_radians());
        let state = State {
            position: target.position,
            velocity,
            attitude: turn * pitch,
            rates: from_frd(self.body_rates_rad_s),
            thrust: self.thrust_n,
        };
        match &self.scatter {
            Some(scatter) => scatter.of(state, random),
            None => state,
        }
    }
}

impl Scatter {
    fn of(&self, state: State, random: &mut impl Rng) -> State {
        let mut drawn = || normal(random);
        let q = Quaternion::new(drawn(), drawn(), drawn(), drawn());
        let direction = V3::new(drawn(), drawn(), drawn()).normalize();
        // Uniform over the ball.
        let length = self.velocity_m_s * libm::cbrt(random.random());
        let mut rate = || self.rate_rad_s * (2.0 * random.random::<f64>() - 1.0);
        State {
            velocity: state.velocity + length * direction,
            attitude: UnitQuaternion::from_quaternion(q),
            rates: V3::new(rate(), rate(), rate()),
            ..state
        }
    }
}
