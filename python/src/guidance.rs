//! The guidance, with what it remembers.

use ::alula::guidance::{Air, PlannerOptions};
use ::alula::ned::{BodyAxes, Ned, Quaternion};
use ::alula::planar::{Attitude, PlanarGuidanceInput};
use ::alula::spatial::{Heading, Orientation, Reference};
use ::alula::{GainChoice, GuidanceInput, GuidanceParameters, GuidanceState};
use alula_sim::controllers::GuidanceSpec;
use alula_sim::experiment::Model;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use toml::Value;

use crate::arguments::{
    Numbers, TURN, angle, body, in_plane, in_plane_or_zero, inertial, table, vector, vector_or_zero,
};
use crate::error;
use crate::parameters;
use crate::vehicle::Vehicle;

/// The law with everything around it that a real vehicle asks for: planning, position hold, limits, supervision.
///
/// Parameters by keyword, those left out at their defaults: `alula.parameters()["Guidance"]`; and as in the table
/// `[controller.guidance]` of an experiment `gains`, a dictionary of constant gains in place of those by bandwidth; and
/// `thrust_n`, (least, most) in place of the vehicle's. For flights in one plane `max_lateral_acceleration_g=0` keeps
/// the plane.
///
/// It remembers from step to step; `reset` is power-on.
#[pyclass(module = "alula")]
pub struct Guidance {
    guidance: ::alula::Guidance<Model, GainChoice>,
    parameters: GuidanceParameters,
    state: GuidanceState,
    /// The vehicle's name.
    vehicle: String,
}

/// What a step of the guidance gives: always a command.
///
/// Rates are about the body axes x, y, z that were asked for; y is the right wing. References are (north, east, down), the
/// vertical plane being the one to the north.
#[pyclass(frozen, get_all, module = "alula")]
pub struct GuidanceOutput {
    /// Thrust along the nose [N], inside the vehicle's limits.
    pub thrust_n: f32,
    /// Body rates about x, y and z [rad/s].
    pub rates_rad_s: [f32; 3],
    /// Body rate about the right wing [rad/s]: the rate of theta in the vertical plane.
    pub rate_rad_s: f32,
    /// "safe", "holding" or "flying".
    pub mode: &'static str,
    /// What of the air is used: "velocity", "wind", "pitot", "held-wind" or "none".
    pub air: &'static str,
    /// Flags of what limited the step.
    pub status: Vec<String>,
    /// Why the frame was refused, or None.
    reject_reason: Option<&'static str>,
    /// What is done: "tracking", "crossing", "coasting" or "recovering".
    pub phase: &'static str,
    /// Why the reference cannot be had, "sink", "speed" or "thrust", or None.
    pub unreachable: Option<&'static str>,
    /// |F_p| over tau; below 1 the guard acts.
    pub margin_force: f32,
    /// The gain k; 1 on a sphere.
    pub margin_k: f32,
    /// Angle to the nearest fold, to first order [rad].
    pub margin_fold_rad: f32,
    /// The velocity that the law was given [m/s].
    reference_velocity_m_s: [f32; 3],
    /// The acceleration that the law was given [m/s²].
    reference_acceleration_m_s2: [f32; 3],
}

#[pymethods]
impl GuidanceOutput {
    fn __repr__(&self) -> String {
        let Self {
            thrust_n,
            rates_rad_s,
            mode,
            ..
        } = self;
        format!(
            "GuidanceOutput(thrust_n={thrust_n}, rates_rad_s={rates_rad_s:?}, mode={mode:?}, …)"
        )
    }
}

/// North, east and down.
pub fn components(v: Ned) -> [f32; 3] {
    [v.north, v.east, v.down]
}

/// A vector in space.
pub fn ned([north, east, down]: [f32; 3]) -> Ned {
    Ned::new(north, east, down)
}

/// What is told of the air.
fn air<const N: usize, V>(
    velocity: Option<&Numbers>,
    wind: Option<&Numbers>,
    airspeed: Option<f32>,
    make: fn([f32; N]) -> V,
) -> PyResult<Air<V>> {
    Ok(match (velocity, wind, airspeed) {
        (Some(_), Some(_), _) => return Err(error::field("wind", "cannot go with air_velocity")),
        (Some(v), None, None) => Air::Velocity(make(vector("air_velocity", v)?)),
        (None, Some(v), None) => Air::Wind(make(vector("wind", v)?)),
        (None, Some(v), Some(airspeed)) => Air::Pitot {
            airspeed,
            wind: make(vector("wind", v)?),
        },
        (None, None, None) => Air::Unknown,
        (_, None, Some(_)) => return Err(error::field("airspeed", "goes with wind alone")),
    })
}

pub fn body_axes(name: &str) -> PyResult<BodyAxes> {
    match name {
        "nose-forward" => Ok(BodyAxes::NoseForward),
        "nose-up" => Ok(BodyAxes::NoseUp),
        _ => Err(error::field(
            "axes",
            format!("{name} is neither nose-forward nor nose-up"),
        )),
    }
}

/// The attitude of the quaternion (w, x, y, z) from `axes` to north-east-down; what is none is one that is not known.
pub fn orientation(quaternion: &Numbers, axes: BodyAxes) -> PyResult<Orientation> {
    let [w, x, y, z] = vector("quaternion", quaternion)?;
    let orientation = Orientation::from_quaternion(&Quaternion { w, x, y, z }, axes);
    Ok(orientation.unwrap_or(Orientation::UNKNOWN))
}

/// A step's answer as Python has it, with rates about `axes`.
pub fn guided(guided: ::alula::guidance::GuidanceOutput, axes: BodyAxes) -> GuidanceOutput {
    let names = guided.status.to_string();
    let flags = names.split('|').filter(|name| !name.is_empty());
    GuidanceOutput {
        thrust_n: guided.command.thrust,
        rates_rad_s: axes.components(guided.command.rates),
        rate_rad_s: guided.command.rates.pitch,
        mode: guided.mode.name(),
        air: guided.air.name(),
        status: flags.map(str::to_owned).collect(),
        reject_reason: guided.reject_reason.map(|reason| reason.name()),
        phase: guided.progress.phase.name(),
        unreachable: guided.progress.unreachable.map(|why| why.name()),
        margin_force: guided.margin.force,
        margin_k: guided.margin.k,
        margin_fold_rad: guided.margin.fold,
        reference_velocity_m_s: components(guided.reference.velocity),
        reference_acceleration_m_s2: components(guided.reference.acceleration),
    }
}

/// The guidance of `vehicle` with these parameters by keyword, and all of them, those by rule too.
pub fn made(
    vehicle: &Vehicle,
    parameters: Option<&Bound<'_, PyDict>>,
) -> PyResult<(::alula::Guidance<Model, GainChoice>, GuidanceParameters)> {
    let fields = parameters.map(table).transpose()?.unwrap_or_default();
    let made = GuidanceSpec::read(Value::Table(fields)).and_then(|spec| {
        let thrust = spec.thrust_n.unwrap_or(vehicle.thrust);
        let guidance = spec.build(&vehicle.spec, thrust, &spec.parameters)?;
        let parameters = spec.ruled(&vehicle.spec.parameters(thrust), &spec.parameters)?;
        Ok((guidance, parameters))
    });
    made.map_err(error::of_field)
}

impl Guidance {
    fn step(&mut self, input: &GuidanceInput, dt: f32, axes: BodyAxes) -> GuidanceOutput {
        let output = self.guidance.update(&mut self.state, input, dt);
        if output.plan_due {
            self.guidance.plan(&mut self.state);
        }
        guided(output, axes)
    }
}

#[pymethods]
impl Guidance {
    #[new]
    #[pyo3(signature = (vehicle, **parameters))]
    fn new(vehicle: &Vehicle, parameters: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let (guidance, parameters) = made(vehicle, parameters)?;
        Ok(Self {
            guidance,
            parameters,
            state: GuidanceState::default(),
            vehicle: vehicle.name.clone(),
        })
    }

    /// Its parameters by name.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        parameters::dict(py, &self.parameters)
    }

    fn __repr__(&self) -> String {
        let p = &self.parameters;
        format!(
            "<alula.Guidance of {}: {} rad/s, damping {}>",
            self.vehicle, p.natural_frequency, p.damping
        )
    }

    /// Forgets everything: power-on.
    fn reset(&mut self) {
        self.state = GuidanceState::default();
    }

    /// What it remembers, as bytes. They may be set to go on from there; bytes of another version of the library, or damaged
    /// ones, are found at the next step, which begins anew.
    #[getter]
    fn state<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.state.to_bytes())
    }

    #[setter]
    fn set_state(&mut self, state: &[u8]) -> PyResult<()> {
        let bytes = state.try_into().map_err(|_| {
            let problem = format!("must be {} bytes, is {}", GuidanceState::BYTES, state.len());
            error::field("state", problem)
        })?;
        self.state = GuidanceState::from_bytes(bytes);
        Ok(())
    }

    /// One step in space, `dt` [s] after the last. Bad inputs raise nothing: they are bridged, and then the safe command is given;
    /// `mode`, `status` and `reject_reason` say so. As at power-on, the command is the safe one until inputs have been good for the
    /// parameter `recovery`, 0.05 s: the first steps are of mode "safe".
    ///
    /// World vectors are (north, east, down). velocity: over ground [m/s]. quaternion: (w, x, y, z), from the body axes `axes` to
    /// north-east-down; "nose-forward" is x along the nose and z to the belly, "nose-up" x to the belly and z along the tail.
    /// heading: where the belly is to point in hover, from north towards east [rad]; None is free. air_velocity [m/s] if it is
    /// measured, or else wind [m/s] if it is known, and beside it the airspeed along the nose [m/s], NaN where the tube tells nothing.
    /// specific_force: what an accelerometer feels, along `axes` [m/s²].
    /// position_error: position less reference position [m], if position is to be held. Ages [s]. altitude_band [m]: the
    /// parameter's place is taken by it, unless it is 0. nose_below_vertical: whether the nose stays short of the vertical while
    /// the vehicle flies forward. hold_altitude_only: whether the place does not matter, as in a stop, and position_error to the north
    /// and east is that of a reference that goes along with the vehicle.
    #[pyo3(signature = (
        dt, *, velocity, quaternion, reference_velocity, reference_acceleration=None, heading=None, air_velocity=None, wind=None,
        airspeed=None, specific_force=None, position_error=None, state_age=0.0, reference_age=0.0, axes="nose-forward",
        altitude_band=0.0, nose_below_vertical=false, hold_altitude_only=false
    ))]
    #[expect(clippy::too_many_arguments, reason = "by keyword in Python")]
    fn update(
        &mut self,
        dt: f32,
        velocity: Numbers<'_>,
        quaternion: Numbers<'_>,
        reference_velocity: Numbers<'_>,
        reference_acceleration: Option<Numbers<'_>>,
        heading: Option<f32>,
        air_velocity: Option<Numbers<'_>>,
        wind: Option<Numbers<'_>>,
        airspeed: Option<f32>,
        specific_force: Option<Numbers<'_>>,
        position_error: Option<Numbers<'_>>,
        state_age: f32,
        reference_age: f32,
        axes: &str,
        altitude_band: f32,
        nose_below_vertical: bool,
        hold_altitude_only: bool,
    ) -> PyResult<GuidanceOutput> {
        let axes = body_axes(axes)?;
        let acceleration = reference_acceleration.as_ref();
        let force = specific_force.as_ref().map(|v| vector("specific_force", v));
        let error = position_error.as_ref().map(|v| vector("position_error", v));
        let input = GuidanceInput::default()
            .velocity(ned(vector("velocity", &velocity)?))
            .orientation(orientation(&quaternion, axes)?)
            .state_age(state_age)
            .air(air(air_velocity.as_ref(), wind.as_ref(), airspeed, ned)?)
            .specific_force(force.transpose()?.map(|force| axes.vector(force)))
            .position_error(error.transpose()?.map(ned))
            .reference(Reference {
                velocity: ned(vector("reference_velocity", &reference_velocity)?),
                acceleration: ned(vector_or_zero("reference_acceleration", acceleration)?),
                heading: match heading {
                    Some(heading) => Heading::from_angle(angle("heading", heading, TURN)?),
                    None => Heading::FREE,
                },
            })
            .reference_age(reference_age)
            .planner_options(
                PlannerOptions::default()
                    .altitude_band(altitude_band)
                    .nose_below_vertical(nose_below_vertical)
                    .hold_altitude_only(hold_altitude_only),
            );
        Ok(self.step(&input, dt, axes))
    }

    /// One step in the vertical plane to the north: as `update`, with vectors (north, east, down), east being 0, and the
    /// attitude theta [rad], 0 in hover with the nose up, -pi/2 with the nose forward. specific_force: along (forward, right,
    /// down) of the body, right being 0 [m/s²]. The rate of theta commanded is `rate_rad_s`.
    #[pyo3(signature = (
        dt, *, velocity, theta, reference_velocity, reference_acceleration=None, air_velocity=None, wind=None, airspeed=None,
        specific_force=None, position_error=None, state_age=0.0, reference_age=0.0, altitude_band=0.0, nose_below_vertical=false, hold_altitude_only=false
    ))]
    #[expect(clippy::too_many_arguments, reason = "by keyword in Python")]
    fn update_in_plane(
        &mut self,
        dt: f32,
        velocity: Numbers<'_>,
        theta: f32,
        reference_velocity: Numbers<'_>,
        reference_acceleration: Option<Numbers<'_>>,
        air_velocity: Option<Numbers<'_>>,
        wind: Option<Numbers<'_>>,
        airspeed: Option<f32>,
        specific_force: Option<Numbers<'_>>,
        position_error: Option<Numbers<'_>>,
        state_age: f32,
        reference_age: f32,
        altitude_band: f32,
        nose_below_vertical: bool,
        hold_altitude_only: bool,
    ) -> PyResult<GuidanceOutput> {
        let acceleration = reference_acceleration.as_ref();
        let error = position_error
            .as_ref()
            .map(|v| in_plane("position_error", v));
        let force = specific_force
            .as_ref()
            .map(|v| in_plane("specific_force", v));
        for (field, of_air) in [("air_velocity", &air_velocity), ("wind", &wind)] {
            in_plane_or_zero(field, of_air.as_ref())?;
        }
        let input = PlanarGuidanceInput::default()
            .velocity(inertial(in_plane("velocity", &velocity)?))
            .attitude(Attitude::from_angle(angle("theta", theta, TURN)?))
            .state_age(state_age)
            .air(air(
                air_velocity.as_ref(),
                wind.as_ref(),
                airspeed,
                inertial,
            )?)
            .specific_force(force.transpose()?.map(body))
            .position_error(error.transpose()?.map(inertial))
            .reference(::alula::planar::Reference {
                velocity: inertial(in_plane("reference_velocity", &reference_velocity)?),
                acceleration: inertial(in_plane_or_zero("reference_acceleration", acceleration)?),
            })
            .reference_age(reference_age)
            .planner_options(
                PlannerOptions::default()
                    .altitude_band(altitude_band)
                    .nose_below_vertical(nose_below_vertical)
                    .hold_altitude_only(hold_altitude_only),
            );
        // As the core's own step in the plane, which leaves out the other rates.
        Ok(self.step(&GuidanceInput::from(&input), dt, BodyAxes::NoseForward))
    }
}
