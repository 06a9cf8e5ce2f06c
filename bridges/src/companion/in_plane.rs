//! A pilot whose controller flies in a vertical plane: the controller has pitch and thrust, and the hold what is left open.

use alula::planar::{Body, Inertial, PlanarGuidanceInput, Reference};

use super::plane::VerticalPlane;
use super::stage::{Command, End, Pilot, Told};
use super::{Hold, HoldParameters};

/// Whoever controls the flight in its vertical plane.
pub trait Planar {
    /// Thrust \[N\] and θ̇ [rad/s], `dt` \[s\] after the last answer; none if it cannot be reached.
    fn answer(&mut self, input: &PlanarGuidanceInput, dt: f32) -> Option<(f32, f32)>;
}

/// What is to be flown in a plane.
pub enum Wanted<'a> {
    /// At each time \[s\] since the start: velocity, acceleration, and position from the start, (down, forward).
    Plan(&'a dyn Fn(f64) -> [Inertial; 3]),
    /// What comes as `SET_POSITION_TARGET_LOCAL_NED`.
    Link,
}

/// What is to be flown at one step.
struct Asked {
    reference: Reference,
    /// Its position \[m\], if one is asked for.
    position: Option<Inertial>,
    /// Its age \[s\].
    age: f32,
}

/// What the controller was told and answered at one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarStep {
    /// Time since the start \[s\].
    pub t: f64,
    /// What it was told.
    pub input: PlanarGuidanceInput,
    /// Position from the start \[m\], (down, forward).
    pub position: Inertial,
    /// Wind as used [m/s], zero if it is not known.
    pub wind: Inertial,
}

/// The pilot.
pub struct InPlane<'a, P> {
    controller: P,
    wanted: Wanted<'a>,
    parameters: HoldParameters,
    /// Heading of the plane \[rad\]; that of the vehicle at the start if none.
    heading: Option<f32>,
    hold: Option<Hold>,
    last: Option<PlanarStep>,
}

impl<'a, P: Planar> InPlane<'a, P> {
    /// `controller` along what is `wanted`, in the plane of `heading` \[rad\], or of the vehicle's heading at the start.
    pub fn new(
        controller: P,
        wanted: Wanted<'a>,
        parameters: HoldParameters,
        heading: Option<f32>,
    ) -> Self {
        Self {
            controller,
            wanted,
            parameters,
            heading,
            hold: None,
            last: None,
        }
    }

    /// The controller.
    pub fn controller(&self) -> &P {
        &self.controller
    }

    /// The last step.
    pub fn last(&self) -> Option<&PlanarStep> {
        self.last.as_ref()
    }

    /// What is to be flown now.
    fn asked(&self, told: &Told, plane: &VerticalPlane) -> Asked {
        match (&self.wanted, &told.asked) {
            (Wanted::Plan(at), _) => {
                let [velocity, acceleration, position] = at(told.t);
                let reference = Reference {
                    velocity,
                    acceleration,
                };
                Asked {
                    reference,
                    position: Some(position),
                    age: 0.0,
                }
            }
            // Until something is asked for: stay.
            (Wanted::Link, None) => Asked {
                reference: Reference::default(),
                position: Some(Inertial::ZERO),
                age: 0.0,
            },
            (Wanted::Link, Some((asked, age))) => {
                let reference = Reference {
                    velocity: plane.project(asked.velocity).0,
                    acceleration: plane.project(asked.acceleration).0,
                };
                Asked {
                    reference,
                    position: asked.position.map(|x| plane.project(x).0),
                    age: *age,
                }
            }
        }
    }
}

impl<P: Planar> Pilot for InPlane<'_, P> {
    fn begin(&mut self, heading: f32) {
        let plane = VerticalPlane::from_heading(self.heading.unwrap_or(heading));
        self.hold = Some(Hold::new(self.parameters, plane));
    }

    fn answer(&mut self, told: &Told, dt: f32) -> Result<Command, End> {
        let hold = self.hold.ok_or(End::Pilot)?;
        let plane = hold.plane();
        let projected = plane.attitude(&told.orientation).ok_or(End::Attitude)?;
        let position = plane.project(told.position).0;
        let Asked {
            reference,
            position: wanted,
            age: reference_age,
        } = self.asked(told, plane);
        let air = told.air.map(|v| plane.project(v).0);
        let velocity = plane.project(told.velocity).0;
        let input = PlanarGuidanceInput {
            velocity,
            attitude: projected.attitude,
            state_age: told.age,
            air,
            specific_force: told.specific_force.map(|f| Body::new(f.i, f.j)),
            position_error: wanted.map(|wanted| position - wanted),
            reference,
            reference_age,
            ..PlanarGuidanceInput::default()
        };
        self.last = Some(PlanarStep {
            t: told.t,
            input,
            position,
            wind: air.wind(velocity).unwrap_or(Inertial::ZERO),
        });
        let (thrust, rate) = self.controller.answer(&input, dt).ok_or(End::Pilot)?;
        Ok(Command {
            thrust,
            rates: hold.rates(&projected, rate, told.position, told.velocity),
        })
    }
}
