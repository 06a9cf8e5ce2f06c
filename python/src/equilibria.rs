//! Equilibria of a reference, and the envelope of a vehicle.

use ::alula::planar::Reference;
use ::alula::planar::equilibrium::Branch;
use ::alula::planar::equilibrium::{Equilibria, EquilibriumError, FoldMap};
use ::alula::planar::equivalency::ApparentForces;
use alula_design::envelope::{self as theory, Ray};
use pyo3::prelude::*;

use crate::arguments::{Numbers, in_plane, in_plane_or_zero, inertial};
use crate::error;
use crate::frame::{Data, Frame, json};
use crate::vehicle::VehicleArgument;

/// An orientation that holds a reference.
#[pyclass(frozen, get_all, module = "alula")]
pub struct Equilibrium {
    /// Attitude theta [rad]: 0 is hover, nose up, -pi/2 nose forward.
    theta_rad: f32,
    /// Angle of attack [rad].
    alpha_rad: f32,
    /// Thrust along the nose [N]; the vehicle's limits are not asked.
    thrust_n: f32,
    /// T_p [N].
    t_p_n: f32,
    /// |F_p| [N]: 0 at a fold.
    fp_n: f32,
    /// "0" or "pi": whether F_p is along the thrust line or against it.
    branch: &'static str,
    /// Whether it is well apart from others.
    isolated: bool,
    /// Angle of attack at the nearest fold less the present one [rad]; None if there is none within 11 degrees.
    fold_alpha_rad: Option<f32>,
    /// Airspeed at that fold over the present one.
    fold_speed_ratio: Option<f32>,
}

#[pymethods]
impl Equilibrium {
    fn __repr__(&self) -> String {
        let Self {
            theta_rad,
            alpha_rad,
            thrust_n,
            ..
        } = self;
        format!("Equilibrium(theta_rad={theta_rad}, alpha_rad={alpha_rad}, thrust_n={thrust_n}, …)")
    }
}

fn refused(error: EquilibriumError) -> PyErr {
    let field = match error {
        EquilibriumError::ReferenceVelocity => "velocity",
        EquilibriumError::ReferenceAcceleration => "acceleration",
        EquilibriumError::Wind => "wind",
        _ => "vehicle",
    };
    error::field(field, error.to_string())
}

/// The orientations at which thrust holds `velocity` [m/s] while it changes by `acceleration` [m/s²], in `wind` [m/s], by
/// increasing angle of attack. Vectors are (north, east, down) over ground; east is 0. `vehicle` is a `Vehicle`, or what `Vehicle.load` takes.
#[pyfunction]
#[pyo3(signature = (vehicle, velocity, acceleration=None, wind=None))]
pub fn equilibria(
    vehicle: VehicleArgument<'_>,
    velocity: Numbers<'_>,
    acceleration: Option<Numbers<'_>>,
    wind: Option<Numbers<'_>>,
) -> PyResult<Vec<Equilibrium>> {
    let vehicle = vehicle.vehicle()?.core()?;
    let reference = Reference {
        velocity: inertial(in_plane("velocity", &velocity)?),
        acceleration: inertial(in_plane_or_zero("acceleration", acceleration.as_ref())?),
    };
    let wind = inertial(in_plane_or_zero("wind", wind.as_ref())?);
    let set = Equilibria::find(&vehicle, &reference, wind).map_err(refused)?;
    let map = FoldMap::new(&vehicle);
    let air_velocity = reference.velocity - wind;
    let equilibria = set.as_slice().iter().map(|e| {
        let forces =
            ApparentForces::new(&vehicle, e.attitude, air_velocity, reference.acceleration);
        let fold = map.margin(&forces);
        Equilibrium {
            theta_rad: e.attitude.angle(),
            alpha_rad: e.alpha,
            thrust_n: e.thrust,
            t_p_n: e.t_p,
            fp_n: e.f_p_norm(),
            branch: match e.branch() {
                Branch::Aligned => "0",
                Branch::Opposed => "pi",
            },
            isolated: e.isolated,
            fold_alpha_rad: fold.map(|fold| fold.alpha),
            fold_speed_ratio: fold.map(|fold| fold.a.sqrt()),
        }
    });
    Ok(equilibria.collect())
}

/// Equilibria over the airspeed, in double precision.
#[pyclass(frozen, get_all, module = "alula")]
pub struct Envelope {
    /// Folds, the numbers of equilibria between them, jumps and cusps, as `alula-sil envelope --json` prints them.
    summary: Py<PyAny>,
    /// The equilibria from infinite airspeed to hover: `alpha_deg`, `a` = k_a|v_a|²/|W| and `speed_m_s`.
    curve: Py<Frame>,
}

#[pymethods]
impl Envelope {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let folds = self.summary.bind(py).get_item("folds")?.len()?;
        let points = self.curve.borrow(py).rows();
        Ok(format!(
            "<alula.Envelope: {folds} folds, {points} points of its curve>"
        ))
    }
}

/// The equilibria of a vehicle over the airspeed in steady level flight; in a steady climb at `climb_deg`, from -90 to 90; or in
/// level flight that gains `accel` [m/s²]. `vehicle` is a `Vehicle`, or what `Vehicle.load` takes.
#[pyfunction]
#[pyo3(signature = (vehicle, *, climb_deg=None, accel=None))]
pub fn envelope(
    py: Python<'_>,
    vehicle: VehicleArgument<'_>,
    climb_deg: Option<f64>,
    accel: Option<f64>,
) -> PyResult<Envelope> {
    let vehicle = vehicle.vehicle()?;
    let reference = vehicle.spec.reference();
    let ray = Ray::new(&reference, climb_deg, accel);
    let ray = ray.map_err(|e| error::field(e.field, e.problem))?;
    let (summary, points) = py
        .detach(|| {
            let envelope = theory::Envelope::new(&reference, ray)?;
            Ok((envelope.summary(&vehicle.name), envelope.curve.points()))
        })
        .map_err(error::of)?;
    let column = |of: &dyn Fn(&(f64, f64)) -> f64| Data::Real(points.iter().map(of).collect());
    let curve = [
        ("alpha_deg", column(&|(alpha, _)| alpha.to_degrees())),
        ("a", column(&|(_, a)| *a)),
        ("speed_m_s", column(&|(_, a)| ray.speed(*a))),
    ];
    let curve = curve.map(|(name, data)| (name.to_owned(), data));
    Ok(Envelope {
        summary: json(py, &summary)?,
        curve: Py::new(py, Frame::new(py, curve))?,
    })
}
