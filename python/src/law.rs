//! The paper's laws: one step, and arrays of steps.

use ::alula::Fault;
use ::alula::planar::Diagnostics;
use ::alula::planar::{Attitude, FeedForward, Reference, State};
use alula_sim::controllers::{Form, LawSpec};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use toml::{Table, Value};

use crate::arguments::{
    Numbers, Rows, TURN, all_in_plane, angle, angles, given, in_plane, in_plane_or_zero, inertial,
    rows, table,
};
use crate::error;
use crate::frame::{Data, Frame};
use crate::vehicle::Vehicle;

/// One of the paper's velocity laws in the vertical plane: without memory, bounds or supervision.
///
/// `form` is "robust" (defined everywhere) or "full". The gains are `gains`, `alula.parameters()["Constant gains"]`, the
/// paper's where left out; or, by `bandwidth`, follow from the parameters of that name in `alula.parameters()["Guidance"]`.
#[pyclass(frozen, module = "alula")]
pub struct Law(alula_sim::controllers::Law);

/// Command of one step of a law.
#[pyclass(frozen, get_all, module = "alula")]
pub struct Command {
    /// Thrust along the nose [N]. Not limited: it may be negative.
    thrust_n: f32,
    /// Angular rate of theta [rad/s]; negative from hover towards cruise.
    rate_rad_s: f32,
    /// Angle of attack [rad].
    alpha_rad: f32,
    /// |F_p| [N]: how far the law is from losing its equilibrium.
    fp_n: f32,
    /// Angle from the thrust line to F_p [rad]; 0 at the equilibria that the law stabilises.
    theta_tilde_rad: f32,
    /// T_p [N].
    t_p_n: f32,
    /// The guard of the alignment, from 0 to 1.
    guard_alignment: f32,
    /// The guard of the feed-forward, from 0 to 1.
    guard_feed_forward: f32,
    /// The gain k of the full law; 1 in the robust law.
    k: f32,
}

impl From<::alula::planar::Command> for Command {
    fn from(command: ::alula::planar::Command) -> Self {
        let d: Diagnostics = command.diagnostics;
        Self {
            thrust_n: command.thrust,
            rate_rad_s: command.rate,
            alpha_rad: d.alpha,
            fp_n: d.f_p_norm,
            theta_tilde_rad: d.theta_tilde(),
            t_p_n: d.t_p,
            guard_alignment: d.guard_alignment,
            guard_feed_forward: d.guard_feed_forward,
            k: d.k,
        }
    }
}

/// A number of a command, by name.
type Read = (&'static str, fn(&Command) -> f32);

/// The numbers of a command, in the order of the columns of many.
const COLUMNS: [Read; 9] = [
    ("thrust_n", |c| c.thrust_n),
    ("rate_rad_s", |c| c.rate_rad_s),
    ("alpha_rad", |c| c.alpha_rad),
    ("fp_n", |c| c.fp_n),
    ("theta_tilde_rad", |c| c.theta_tilde_rad),
    ("t_p_n", |c| c.t_p_n),
    ("guard_alignment", |c| c.guard_alignment),
    ("guard_feed_forward", |c| c.guard_feed_forward),
    ("k", |c| c.k),
];

#[pymethods]
impl Command {
    fn __repr__(&self) -> String {
        let numbers = COLUMNS.map(|(name, read)| format!("{name}={}", read(self)));
        format!("Command({})", numbers.join(", "))
    }
}

impl Law {
    fn answer(
        &self,
        state: &State,
        reference: &Reference,
        feed_forward: Option<&FeedForward>,
    ) -> Result<::alula::planar::Command, Fault> {
        match self.0.form {
            Form::Robust => self.0.control.robust(state, reference, feed_forward),
            Form::Full => self.0.control.full(state, reference, feed_forward),
        }
    }
}

#[pymethods]
impl Law {
    #[new]
    #[pyo3(signature = (vehicle, form="robust", *, gains=None, bandwidth=None))]
    fn new(
        vehicle: &Vehicle,
        form: &str,
        gains: Option<&Bound<'_, PyDict>>,
        bandwidth: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        if gains.is_some() && bandwidth.is_some() {
            return Err(error::field("bandwidth", "cannot go with gains"));
        }
        let mut fields = Table::new();
        fields.insert("form".to_owned(), form.into());
        for (name, given) in [("gains", gains), ("bandwidth", bandwidth)] {
            if let Some(given) = given {
                fields.insert(name.to_owned(), table(given)?.into());
            }
        }
        let law = LawSpec::read(Value::Table(fields));
        let law = law.and_then(|spec| spec.build(vehicle.spec.core()?));
        law.map(Self).map_err(error::of_field)
    }

    fn __repr__(&self) -> String {
        let form = match self.0.form {
            Form::Robust => "robust",
            Form::Full => "full",
        };
        format!("<alula.Law {form}>")
    }

    /// The command at one state.
    ///
    /// Vectors are (north, east, down); east is 0. velocity: over ground [m/s]. theta: attitude [rad], 0 in hover with the nose up, -pi/2 with the nose
    /// forward. reference_velocity, reference_acceleration: what is asked for [m/s, m/s²]. wind: over ground [m/s].
    /// air_acceleration and jerk: what the feed-forward wants, the derivatives of air velocity [m/s²] and reference acceleration
    /// [m/s³]; without them there is none.
    ///
    /// Raises `alula.Fault` if an input is not finite or absurd, or the law is undefined there.
    #[pyo3(signature = (
        velocity, theta, reference_velocity, reference_acceleration=None, wind=None, *, air_acceleration=None, jerk=None
    ))]
    #[expect(clippy::too_many_arguments, reason = "by keyword in Python")]
    fn command(
        &self,
        velocity: Numbers<'_>,
        theta: f32,
        reference_velocity: Numbers<'_>,
        reference_acceleration: Option<Numbers<'_>>,
        wind: Option<Numbers<'_>>,
        air_acceleration: Option<Numbers<'_>>,
        jerk: Option<Numbers<'_>>,
    ) -> PyResult<Command> {
        let or_zero =
            |field, value: &Option<Numbers>| in_plane_or_zero(field, value.as_ref()).map(inertial);
        let state = State {
            velocity: inertial(in_plane("velocity", &velocity)?),
            attitude: Attitude::from_angle(angle("theta", theta, TURN)?),
            wind: or_zero("wind", &wind)?,
        };
        let reference = Reference {
            velocity: inertial(in_plane("reference_velocity", &reference_velocity)?),
            acceleration: or_zero("reference_acceleration", &reference_acceleration)?,
        };
        let feed_forward = match (&air_acceleration, &jerk) {
            (None, None) => None,
            _ => Some(FeedForward {
                air_acceleration: or_zero("air_acceleration", &air_acceleration)?,
                jerk: or_zero("jerk", &jerk)?,
            }),
        };
        let answer = self.answer(&state, &reference, feed_forward.as_ref());
        answer.map(Command::from).map_err(error::of_fault)
    }

    /// The commands at n states, without feed-forward: as `command`, with arrays of shape (n, 3) for the vectors and (n,) for
    /// theta. One vector or number stands for all states.
    ///
    /// The columns are those of `Command`, in single precision, and `status`: "ok", or the fault, for which the row has the safe
    /// command of no thrust and no rotation. Python's lock is released meanwhile.
    #[pyo3(signature = (velocity, theta, reference_velocity, reference_acceleration=None, wind=None))]
    fn commands(
        &self,
        py: Python<'_>,
        velocity: Numbers<'_>,
        theta: Numbers<'_>,
        reference_velocity: Numbers<'_>,
        reference_acceleration: Option<Numbers<'_>>,
        wind: Option<Numbers<'_>>,
    ) -> PyResult<Frame> {
        let mut arguments = vec![
            given("velocity", &velocity, 3),
            given("theta", &theta, 1),
            given("reference_velocity", &reference_velocity, 3),
        ];
        let acceleration = reference_acceleration.as_ref();
        arguments.extend(acceleration.map(|value| given("reference_acceleration", value, 3)));
        arguments.extend(wind.as_ref().map(|value| given("wind", value, 3)));
        let mut vectors = arguments.iter().filter(|argument| argument.width() == 3);
        vectors.try_for_each(all_in_plane)?;
        let n = rows(&arguments)?;
        angles("theta", &theta, TURN)?;
        let (velocity, theta) = (Rows::new(&velocity, 3), Rows::new(&theta, 1));
        let reference_velocity = Rows::new(&reference_velocity, 3);
        let acceleration = acceleration.map(|value| Rows::new(value, 3));
        let wind = wind.as_ref().map(|value| Rows::new(value, 3));
        let row = |rows: Option<Rows>, k| inertial(rows.map_or([0.0; 3], |rows| rows.get(k)));

        let mut columns = [const { Vec::new() }; COLUMNS.len()];
        columns
            .iter_mut()
            .for_each(|column| column.reserve_exact(n));
        let (mut codes, mut names) = (Vec::with_capacity(n), vec!["ok".to_owned()]);
        py.detach(|| {
            for k in 0..n {
                let [theta] = theta.get(k);
                let state = State {
                    velocity: row(Some(velocity), k),
                    attitude: Attitude::from_angle(theta),
                    wind: row(wind, k),
                };
                let reference = Reference {
                    velocity: row(Some(reference_velocity), k),
                    acceleration: row(acceleration, k),
                };
                let answer = self.answer(&state, &reference, None);
                codes.push(
                    answer
                        .as_ref()
                        .map_or_else(|f| code(&mut names, f.name()), |_| 0),
                );
                let command = Command::from(answer.unwrap_or_default());
                for (column, (_, read)) in columns.iter_mut().zip(COLUMNS) {
                    column.push(read(&command));
                }
            }
        });
        let names_of = COLUMNS.map(|(name, _)| name.to_owned());
        let columns = names_of.into_iter().zip(columns.map(Data::Single));
        let status = ("status".to_owned(), Data::Words(codes, names));
        Ok(Frame::new(py, columns.chain([status])))
    }
}

/// The place of `name` in `names`.
fn code(names: &mut Vec<String>, name: &str) -> i32 {
    let place = names.iter().position(|known| known == name);
    place.unwrap_or_else(|| {
        names.push(name.to_owned());
        names.len() - 1
    }) as i32
}
