//! Many vehicles under the guidance, a step of all of them at once.

use ::alula::guidance::Air;
use ::alula::ned::{Ned, Quaternion};
use ::alula::spatial::{Heading, Orientation, Reference};
use ::alula::{GainChoice, GuidanceInput, GuidanceState};
use alula_sim::experiment::Model;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments::{Numbers, Rows, TURN, angles, given, rows_of_each};
use crate::error;
use crate::frame::{Data, Frame};
use crate::guidance::{GuidanceOutput, body_axes, guided, made, ned};
use crate::vehicle::Vehicle;

/// `n` vehicles of one kind, each under a `Guidance` of its own with the same parameters: they are stepped side by side, arrays in
/// and columns out. Each remembers what the guidance alone would; `reset` is power-on of all.
#[pyclass(module = "alula")]
pub struct Fleet {
    guidance: ::alula::Guidance<Model, GainChoice>,
    states: Vec<GuidanceState>,
}

/// A name, and how what it names is read.
type Named<T> = (&'static str, fn(&GuidanceOutput) -> T);

/// The numbers of a step, in the order of the columns.
const COLUMNS: [Named<f32>; 8] = [
    ("thrust_n", |g| g.thrust_n),
    ("rate_x_rad_s", |g| g.rates_rad_s[0]),
    ("rate_y_rad_s", |g| g.rates_rad_s[1]),
    ("rate_z_rad_s", |g| g.rates_rad_s[2]),
    ("rate_rad_s", |g| g.rate_rad_s),
    ("margin_force", |g| g.margin_force),
    ("margin_k", |g| g.margin_k),
    ("margin_fold_rad", |g| g.margin_fold_rad),
];

/// The words of a step.
const WORDS: [Named<String>; 5] = [
    ("mode", |g| g.mode.to_owned()),
    ("air", |g| g.air.to_owned()),
    ("phase", |g| g.phase.to_owned()),
    ("unreachable", |g| {
        g.unreachable.unwrap_or_default().to_owned()
    }),
    ("status", |g| g.status.join("|")),
];

#[pymethods]
impl Fleet {
    #[new]
    #[pyo3(signature = (vehicle, n, **parameters))]
    fn new(vehicle: &Vehicle, n: i64, parameters: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        // A GiB of memories and more is a mistake.
        if !(1..=1_000_000).contains(&n) {
            return Err(error::field("n", "must be from 1 to 1000000"));
        }
        Ok(Self {
            guidance: made(vehicle, parameters)?.0,
            states: vec![GuidanceState::default(); n as usize],
        })
    }

    fn __repr__(&self) -> String {
        format!("<alula.Fleet of {} vehicles>", self.states.len())
    }

    fn __len__(&self) -> usize {
        self.states.len()
    }

    /// Forgets everything: power-on.
    fn reset(&mut self) {
        self.states.fill(GuidanceState::default());
    }

    /// One step of every vehicle, `dt` [s] after the last: as `Guidance.update`, with arrays of shape (n, 3), (n, 4) for the
    /// quaternion and (n,) for the heading. One vector or number stands for all; a heading that is NaN is free.
    ///
    /// The columns are `thrust_n`, `rate_x_rad_s`, `rate_y_rad_s`, `rate_z_rad_s` about `axes`, `rate_rad_s` about the right wing,
    /// the margins, and `mode`, `air`, `phase`, `unreachable`, `status` as in `GuidanceOutput`, flags with | between. Python's lock is
    /// released meanwhile.
    #[pyo3(signature = (
        dt, *, velocity, quaternion, reference_velocity, reference_acceleration=None, heading=None, air_velocity=None, wind=None,
        specific_force=None, position_error=None, axes="nose-forward"
    ))]
    #[expect(clippy::too_many_arguments, reason = "by keyword in Python")]
    fn update(
        &mut self,
        py: Python<'_>,
        dt: f32,
        velocity: Numbers<'_>,
        quaternion: Numbers<'_>,
        reference_velocity: Numbers<'_>,
        reference_acceleration: Option<Numbers<'_>>,
        heading: Option<Numbers<'_>>,
        air_velocity: Option<Numbers<'_>>,
        wind: Option<Numbers<'_>>,
        specific_force: Option<Numbers<'_>>,
        position_error: Option<Numbers<'_>>,
        axes: &str,
    ) -> PyResult<Frame> {
        let axes = body_axes(axes)?;
        if let Some(heading) = &heading {
            angles("heading", heading, TURN)?;
        }
        if air_velocity.is_some() && wind.is_some() {
            return Err(error::field("wind", "cannot go with air_velocity"));
        }
        let mut arguments = vec![
            given("velocity", &velocity, 3),
            given("quaternion", &quaternion, 4),
            given("reference_velocity", &reference_velocity, 3),
        ];
        let optional = [
            ("reference_acceleration", &reference_acceleration),
            ("air_velocity", &air_velocity),
            ("wind", &wind),
            ("specific_force", &specific_force),
            ("position_error", &position_error),
        ];
        for (name, value) in optional {
            arguments.extend(value.as_ref().map(|value| given(name, value, 3)));
        }
        arguments.extend(heading.as_ref().map(|value| given("heading", value, 1)));
        let n = self.states.len();
        rows_of_each(n, &arguments)?;
        let fixed = [Rows::new(&velocity, 3), Rows::new(&reference_velocity, 3)];
        let quaternion = Rows::new(&quaternion, 4);
        let acceleration = optional_rows(reference_acceleration.as_ref(), 3);
        let heading = optional_rows(heading.as_ref(), 1);
        let air_velocity = optional_rows(air_velocity.as_ref(), 3);
        let wind = optional_rows(wind.as_ref(), 3);
        let force = optional_rows(specific_force.as_ref(), 3);
        let error = optional_rows(position_error.as_ref(), 3);
        let at = |rows: Option<Rows>, k| rows.map(|rows| ned(rows.get(k)));

        let Self { guidance, states } = self;
        let steps: Vec<GuidanceOutput> = py.detach(|| {
            let step = |(k, state): (usize, &mut GuidanceState)| {
                let [w, x, y, z] = quaternion.get(k);
                let orientation = Orientation::from_quaternion(&Quaternion { w, x, y, z }, axes);
                let free = f32::NAN;
                let [heading] = heading.map_or([free], |heading| heading.get(k));
                let input = GuidanceInput::default()
                    .velocity(ned(fixed[0].get(k)))
                    .orientation(orientation.unwrap_or(Orientation::UNKNOWN))
                    .state_age(0.0)
                    .air(match (at(air_velocity, k), at(wind, k)) {
                        (Some(v), _) => Air::Velocity(v),
                        (None, Some(wind)) => Air::Wind(wind),
                        (None, None) => Air::Unknown,
                    })
                    .specific_force(force.map(|force| axes.vector(force.get(k))))
                    .position_error(at(error, k))
                    .reference(Reference {
                        velocity: ned(fixed[1].get(k)),
                        acceleration: at(acceleration, k).unwrap_or(Ned::ZERO),
                        heading: Heading::from_angle(heading),
                    })
                    .reference_age(0.0);
                let output = guidance.update(state, &input, dt);
                if output.plan_due {
                    guidance.plan(state);
                }
                guided(output, axes)
            };
            states.iter_mut().enumerate().map(step).collect()
        });
        let numbers = COLUMNS.iter().map(|(name, read)| {
            (
                (*name).to_owned(),
                Data::Single(steps.iter().map(read).collect()),
            )
        });
        let words = WORDS
            .iter()
            .map(|(name, read)| ((*name).to_owned(), Data::words(steps.iter().map(read))));
        Ok(Frame::new(py, numbers.chain(words)))
    }
}

/// The rows of an argument that may be left out.
fn optional_rows<'a>(value: Option<&'a Numbers<'_>>, width: usize) -> Option<Rows<'a>> {
    value.map(|value| Rows::new(value, width))
}
