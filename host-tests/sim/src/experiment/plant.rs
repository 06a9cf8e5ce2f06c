//! The actuators of a vehicle, and the state of a body with six degrees of freedom.

use nalgebra::{Quaternion, UnitQuaternion};
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer};

use super::V3;
use super::document::{FieldError, finite, positive, require};

/// How the body rates follow their commands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum RateLoop {
    /// ω = ω_c.
    #[default]
    Ideal,
    /// First order: ω̇ = (ω_c − ω)/T.
    Lag {
        /// T \[s\].
        time_constant_s: f64,
    },
    /// A rotational inertia under a proportional inner loop with limited torque:
    /// J ω̇ = sat(J b (ω_c − ω) + ω × J ω) − ω × J ω, about each axis by itself.
    Inertia {
        /// J \[kg·m²\] about nose, right wing and belly, in the plants' axes; one number for all of them.
        #[serde(deserialize_with = "each_axis")]
        #[schemars(with = "Axes")]
        moment_of_inertia_kg_m2: V3,
        /// b \[1/s\].
        bandwidth_1_s: f64,
        /// Largest torque \[N·m\], as the inertia.
        #[serde(deserialize_with = "each_axis")]
        #[schemars(with = "Axes")]
        max_torque_n_m: V3,
    },
}

/// One number for every axis, or one for each.
#[derive(Deserialize, JsonSchema)]
#[serde(untagged, expecting = "must be a number, or [nose, right wing, belly]")]
enum Axes {
    All(f64),
    Each([f64; 3]),
}

/// The numbers of every axis.
fn each_axis<'de, D: Deserializer<'de>>(from: D) -> Result<V3, D::Error> {
    Ok(match Axes::deserialize(from)? {
        Axes::All(number) => V3::repeat(number),
        // About an axis, not along it: either way of it is the same.
        Axes::Each([nose, wing, belly]) => V3::new(belly, wing, nose),
    })
}

/// `[plant]`: the actuators. Ideal if left out: no lag, no delay, any thrust.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PlantSpec {
    /// The rate loop.
    pub rate_loop: RateLoop,
    /// First-order lag of thrust \[s\]; 0 for none.
    pub thrust_lag_s: f64,
    /// Transport delay of the command \[s\], in whole steps of the plant.
    pub delay_s: f64,
    /// Least and most thrust that the motors give \[N\], whatever is commanded.
    pub thrust_n: [f64; 2],
}

impl Default for PlantSpec {
    fn default() -> Self {
        Self {
            rate_loop: RateLoop::Ideal,
            thrust_lag_s: 0.0,
            delay_s: 0.0,
            thrust_n: [f64::NEG_INFINITY, f64::INFINITY],
        }
    }
}

/// Longest step of the plant, in time constants of an actuator. The Runge–Kutta method is stable to 2.78.
const LONGEST_STEP: f64 = 2.0;

/// A time constant of `tau` \[s\] must be one that steps of `dt` \[s\] can follow.
fn followed(field: &str, tau: f64, dt: f64) -> Result<(), FieldError> {
    let problem = format_args!(
        "a time constant of {tau} s is too short for the plant's steps of {dt} s: raise substeps or control_rate_hz, or leave it out"
    );
    require(dt <= LONGEST_STEP * tau, field, problem)
}

impl PlantSpec {
    /// Checks every field, for steps of `dt` \[s\].
    pub(crate) fn validate(&self, dt: f64) -> Result<(), FieldError> {
        match &self.rate_loop {
            RateLoop::Ideal => {}
            RateLoop::Lag { time_constant_s } => {
                let field = "plant.rate_loop.lag.time_constant_s";
                positive(field, *time_constant_s)?;
                followed(field, *time_constant_s, dt)?;
            }
            RateLoop::Inertia {
                moment_of_inertia_kg_m2,
                bandwidth_1_s,
                max_torque_n_m,
            } => {
                let field = "plant.rate_loop.inertia.bandwidth_1_s";
                positive(field, *bandwidth_1_s)?;
                followed(field, 1.0 / bandwidth_1_s, dt)?;
                let each = |field: &str, of: &V3| of.iter().try_for_each(|&x| positive(field, x));
                each(
                    "plant.rate_loop.inertia.moment_of_inertia_kg_m2",
                    moment_of_inertia_kg_m2,
                )?;
                each("plant.rate_loop.inertia.max_torque_n_m", max_torque_n_m)?;
            }
        }
        for (field, value) in [
            ("plant.thrust_lag_s", self.thrust_lag_s),
            ("plant.delay_s", self.delay_s),
        ] {
            finite(field, value)?;
            let problem = "must be from 0 to 2 s";
            require((0.0..=2.0).contains(&value), field, problem)?;
        }
        if self.thrust_lag_s > 0.0 {
            followed("plant.thrust_lag_s", self.thrust_lag_s, dt)?;
        }
        let [least, most] = self.thrust_n;
        // An infinite limit is none, and a NaN is not less than anything.
        require(least < most, "plant.thrust_n", "must be [least, most]")
    }

    /// Least and most thrust \[N\] that a controller may command: `given`, or else what the motors give; in place of infinities none, and
    /// twice the `weight` \[N\].
    pub(crate) fn thrust_limits(&self, given: Option<[f64; 2]>, weight: f64) -> [f64; 2] {
        let bounded = |value: f64, else_value| if value.is_finite() { value } else { else_value };
        let [least, most] = given.unwrap_or(self.thrust_n);
        [bounded(least, 0.0), bounded(most, 2.0 * weight)]
    }
}

/// State of a body with six degrees of freedom. World vectors are north-east-down.
///
/// The plants' axes are x = belly (j), y = right wing (w), z = tail (i), so that (p, q, r) = (ω_j, ω_w, ω_i). Files, traces and controllers
/// have forward-right-down: [`from_frd`] and [`to_frd`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// x \[m\].
    pub position: V3,
    /// v \[m/s\].
    pub velocity: V3,
    /// From the body's axes to north-east-down.
    pub attitude: UnitQuaternion<f64>,
    /// (p, q, r) \[rad/s\].
    pub rates: V3,
    /// T \[N\].
    pub thrust: f64,
}

/// A vector of the plants' axes, of its components along forward, right and down. Zero has no sign.
pub fn from_frd([forward, right, down]: [f64; 3]) -> V3 {
    V3::new(down, right, 0.0 - forward)
}

/// Components along forward, right and down of a vector of the plants' axes. Zero has no sign.
pub fn to_frd(v: V3) -> [f64; 3] {
    [0.0 - v.z, v.y, v.x]
}

/// Turns forward, right and down into the plants' axes.
pub(crate) fn nose_forward() -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&V3::y_axis(), std::f64::consts::FRAC_PI_2)
}

/// The attitude of forward, right and down, of one of the plants' axes.
pub fn attitude_to_frd(attitude: &UnitQuaternion<f64>) -> Quaternion<f64> {
    attitude.quaternion() * nose_forward().quaternion()
}

impl State {
    /// (i, j, w): tail, belly and right wing in world components.
    pub fn axes(&self) -> [V3; 3] {
        [V3::z(), V3::x(), V3::y()].map(|axis| self.attitude * axis)
    }

    /// θ \[rad\] in [−π, π): from down to the tail, about the east. 0 is nose up, −π/2 nose to the north.
    pub fn theta(&self) -> f64 {
        let [tail, ..] = self.axes();
        libm::atan2(tail.x, tail.z)
    }

    /// Whether it is one of an aircraft: finite, slower than any fall, and turning slower than any airframe can.
    pub fn is_sound(&self) -> bool {
        /// Speed \[m/s\] from which a simulation has diverged: ten minutes of free fall do not reach it.
        const DIVERGED: f64 = 1e4;
        /// Body rate [rad/s] from which on it has, too: no airframe holds together at a hundred turns a second.
        const DIVERGED_RATE: f64 = 630.0;
        let parts = [self.position, self.rates, self.attitude.imag()];
        let finite = parts.iter().flatten().all(|x| x.is_finite()) && self.thrust.is_finite();
        finite && self.velocity.norm() < DIVERGED && self.rates.norm() < DIVERGED_RATE
    }
}
