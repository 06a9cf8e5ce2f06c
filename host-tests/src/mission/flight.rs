//! The loop of a mission.

use std::collections::VecDeque;

use alula::control::Air;
use alula::{Attitude, GuidanceInput, Inertial, Reference};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::sensors::{FaultKind, Measured};
use super::{Answer, Mission, State, Weather};
use crate::flight::inertial;
use crate::reference::{Vector, wrap};

/// One control step of a mission.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Time \[s\].
    pub t: f64,
    /// The plant's state when the controller was asked.
    pub truth: State,
    /// The wind there \[m/s\].
    pub wind: Vector,
    /// Reference velocity \[m/s\].
    pub reference_velocity: Vector,
    /// Reference acceleration \[m/s²\].
    pub reference_acceleration: Vector,
    /// Reference position \[m\]: the reference velocity's integral.
    pub reference_position: Vector,
    /// What the controller was told.
    pub input: GuidanceInput,
    /// What it answered.
    pub answer: Answer,
}

impl Row {
    /// v − v_r \[m/s\].
    pub fn velocity_error(&self) -> Vector {
        self.truth.velocity - self.reference_velocity
    }

    /// x − x_r \[m\]. Its first component is the loss of altitude.
    pub fn position_error(&self) -> Vector {
        self.truth.position - self.reference_position
    }
}

/// Flies `mission`: `visit` is given one row per control step, the last at the end of the flight, and
/// says whether to go on.
pub fn fly(mission: &Mission, mut visit: impl FnMut(&Row) -> bool) {
    let plant = mission.plant();
    let mut pilot = mission
        .controller
        .pilot(&mission.vehicle)
        .expect("validated when loaded");
    // Noise and turbulence are separate streams: a change of one leaves the other as it was.
    let mut noise = ChaCha8Rng::seed_from_u64(mission.seed);
    let mut gusts = ChaCha8Rng::seed_from_u64(mission.seed);
    gusts.set_stream(1);
    let mut weather = Weather::new(mission.weather, &mut gusts);
    let steady = Vector::from(mission.weather.steady_m_s);

    let period = 1.0 / mission.control_rate_hz;
    let dt = period / f64::from(mission.substeps);
    // Commands on their way: the number of the plant's step from which each acts.
    let delay = (mission.plant.delay_s / dt).round() as usize;
    let mut pending: VecDeque<(usize, f64, f64)> = VecDeque::new();
    let (mut thrust, mut rate) = (mission.initial.thrust_n, 0.0);

    let mut truth = mission.initial_state();
    let mut last: Option<(f64, Measured)> = None;
    let mut reference_time = 0.0;
    let mut stale = Reference::default();
    let mut plant_step = 0;
    for step in 0..=mission.steps() {
        let t = step as f64 * period;
        let wind = weather.wind(t);
        let (velocity, acceleration) = mission.reference.at(t);
        let reference_position = mission.reference.position(t);
        let sensors = &mission.sensors;
        let fails = |kind| sensors.fails(kind, t);

        let fresh = sensors.measure(&truth, wind, steady, &mut noise);
        let (measured_at, mut measured) = match last {
            Some(old) if fails(FaultKind::StateStale) => old,
            _ => (t, fresh),
        };
        last = Some((measured_at, measured));
        if fails(FaultKind::Air) {
            measured.air = Air::Unknown;
        }
        if !fails(FaultKind::ReferenceStale) {
            reference_time = t;
            stale = Reference {
                velocity: inertial(velocity),
                acceleration: inertial(acceleration),
            };
        }
        let nan = |value: f32, kind| if fails(kind) { f32::NAN } else { value };
        let error = inertial(measured.position - reference_position);
        let input = GuidanceInput {
            velocity: Inertial::new(
                nan(measured.velocity.x as f32, FaultKind::VelocityNan),
                measured.velocity.y as f32,
            ),
            attitude: Attitude::from_angle(nan(
                wrap(measured.theta) as f32,
                FaultKind::AttitudeNan,
            )),
            state_age: (t - measured_at) as f32,
            air: measured.air,
            position_error: Some(Inertial::new(
                nan(error.down(), FaultKind::PositionNan),
                error.forward(),
            )),
            reference: stale,
            reference_age: (t - reference_time) as f32,
        };
        let answer = pilot.answer(&input, period as f32);
        let go_on = visit(&Row {
            t,
            truth,
            wind,
            reference_velocity: velocity,
            reference_acceleration: acceleration,
            reference_position,
            input,
            answer,
        });
        if !go_on {
            return;
        }

        pending.push_back((plant_step + delay, answer.thrust, answer.rate));
        for _ in 0..mission.substeps {
            while let Some(&(_, t, r)) = pending.front().filter(|c| c.0 <= plant_step) {
                (thrust, rate) = (t, r);
                pending.pop_front();
            }
            truth = plant.step(&truth, thrust, rate, wind, dt);
            plant_step += 1;
        }
        weather.advance((truth.velocity - wind).norm(), period, &mut gusts);
    }
}
