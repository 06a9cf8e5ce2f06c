//! The loop: the core's law in single precision at 100 Hz, with an outer loop, on the six-degree-of-freedom plant.
//!
//! Unless said otherwise: rate lag 100 ms, thrust lag 50 ms, T in [0, 2 mg], rates within ±3.5 rad/s, and a controller that
//! believes m = 9 of 10 kg, k_a = 0.51 of 0.646 kg/m, c_Y = 0.35 of 0.5 and the paper's wrong coefficients.

use alula::ned::{BodyAxes, Quaternion};
use alula::spatial::{
    Body, Correction, FeedForward, ForceError, ForceErrorParameters, ForceErrorState, ForceSample,
    Heading, LateralGains, LateralParameters, Orientation, Reference, Sideslip, SideslipParameters,
    SideslipState, State, WingedControl,
};
use alula::{
    BandwidthGains, Combined, CombinedParameters, GuidanceParameters, Vehicle, VehicleParameters,
};
use alula_sim::space::{Rotation, SpatialPlant, SpatialState};
use nalgebra::{UnitQuaternion, Vector3};

use crate::common::{combined, vehicles};
use crate::support::ned;

pub type V3 = Vector3<f64>;

/// Control period \[s\].
pub const PERIOD: f64 = 0.01;

/// What is to be flown at one time: position, velocity, acceleration, jerk, heading \[rad\] if any.
#[derive(Clone, Copy, Debug, Default)]
pub struct Target {
    pub position: V3,
    pub velocity: V3,
    pub acceleration: V3,
    pub jerk: V3,
    pub heading: Option<f64>,
}

/// Gives the target at `t`, told the position; called once a period.
pub trait Task {
    fn target(&mut self, t: f64, position: V3) -> Target;
}

impl<F: FnMut(f64) -> Target> Task for F {
    fn target(&mut self, t: f64, _: V3) -> Target {
        self(t)
    }
}

/// What is seen of a flight every period.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    pub t: f64,
    pub velocity_error: f64,
    pub position_error: f64,
    /// \[rad\].
    pub sideslip: f64,
    /// Altitude over the start \[m\].
    pub altitude: f64,
    /// Position \[m\], and velocity over ground \[m/s\].
    pub place: V3,
    pub ground: V3,
    /// \[m/s\].
    pub airspeed: f64,
    /// How far under the target \[m\].
    pub below: f64,
    /// Cosine of the angle between nose and up.
    pub nose_up: f64,
    /// Cosine of the angle between belly and down.
    pub belly_down: f64,
    /// Angle of the belly's horizontal part from north \[rad\].
    pub heading: f64,
}

impl Sample {
    pub fn new(
        t: f64,
        state: &SpatialState,
        target: &Target,
        wind: V3,
        start: &SpatialState,
    ) -> Self {
        let [tail, belly, right] = state.axes();
        let v_a = state.velocity - wind;
        Self {
            t,
            velocity_error: (state.velocity - target.velocity).norm(),
            position_error: (state.position - target.position).norm(),
            sideslip: (v_a.dot(&right) / v_a.norm().max(1.0)).asin(),
            altitude: start.position.z - state.position.z,
            place: state.position,
            ground: state.velocity,
            airspeed: v_a.norm(),
            below: state.position.z - target.position.z,
            nose_up: tail.z,
            belly_down: belly.z,
            heading: belly.y.atan2(belly.x),
        }
    }
}

/// The attitude as the core takes it.
pub fn orientation(state: &SpatialState) -> Orientation {
    let q = state.attitude;
    let [w, x, y, z] = [q.w, q.i, q.j, q.k].map(|x| x as f32);
    Orientation::from_quaternion(&Quaternion { w, x, y, z }, BodyAxes::NoseUp).unwrap()
}

/// What is known of the wind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wind {
    /// Everything, at every moment.
    All,
    /// This; what else there is, the sideslip estimator is to find.
    Only(V3),
}

/// What is flown with.
pub struct Setup {
    pub plant: SpatialPlant,
    pub control: WingedControl<Combined, BandwidthGains>,
    pub force: ForceError,
    pub sideslip: Sideslip,
    /// What the controller is told of the wind.
    pub wind_known: Wind,
    /// Whether the feed-forward takes the measured acceleration instead of the reference's.
    pub measured_acceleration: bool,
}

impl Setup {
    /// With the wrong belief.
    pub fn new() -> Self {
        Self::believing(
            VehicleParameters::PAPER_BELIEF,
            CombinedParameters::PAPER_BELIEF,
            0.35,
        )
    }

    /// With the true vehicle believed.
    pub fn exact() -> Self {
        Self::believing(
            VehicleParameters::PAPER,
            CombinedParameters::NACA_0021_RE_160E3,
            0.5,
        )
    }

    fn believing(vehicle: VehicleParameters, model: CombinedParameters, c_y: f32) -> Self {
        let (_, truth) = vehicles(0.0, combined(CombinedParameters::NACA_0021_RE_160E3));
        let p = VehicleParameters { c_y, ..vehicle };
        let vehicle = Vehicle::new(p, Combined::new(model).unwrap()).unwrap();
        let gains = BandwidthGains::new(&GuidanceParameters::default(), &vehicle).unwrap();
        let force = ForceErrorParameters {
            time: 0.2,
            thrust_lag: 0.05,
            most: 60.0,
        };
        Self {
            plant: SpatialPlant {
                vehicle: truth,
                c_y: 0.5,
                thrust_lag: 0.05,
                thrust: [0.0, 2.0 * 98.1],
                rate: 3.5,
                rotation: Rotation::Lag(0.1),
            },
            force: ForceError::new(force, vehicle.mass()).unwrap(),
            sideslip: Sideslip::new(SideslipParameters::DEFAULT, &vehicle).unwrap(),
            control: WingedControl::new(
                vehicle,
                gains,
                LateralGains::new(LateralParameters::PAPER_VEHICLE).unwrap(),
            ),
            wind_known: Wind::All,
            measured_acceleration: false,
        }
    }

    /// Flies `task` from `start` for `duration` \[s\] in `wind`.
    pub fn fly(
        &self,
        task: &mut dyn Task,
        start: SpatialState,
        duration: f64,
        wind: &mut dyn FnMut(f64, f64) -> V3,
    ) -> Vec<Sample> {
        let mut state = start;
        let mut integral = V3::zeros();
        let (mut force, mut sideslip) = (ForceErrorState::default(), SideslipState::default());
        force.thrust = start.thrust as f32;
        let mut samples = Vec::new();
        let mut last_wind = None;
        for n in 0..(duration / PERIOD).round() as usize {
            let t = n as f64 * PERIOD;
            let air = wind(t, state.velocity.norm());
            let target = task.target(t, state.position);
            let (velocity, acceleration) = outer_loop(&mut integral, &target, &state);
            let known = match self.wind_known {
                Wind::All => air,
                Wind::Only(wind) => wind,
            };
            let wind_rate = (known - last_wind.unwrap_or(known)) / PERIOD;
            last_wind = Some(known);

            let orientation = orientation(&state);
            let law_state = State {
                velocity: ned(state.velocity.into()),
                orientation,
                wind: ned(known.into()),
                correction: Correction::new(force.force, sideslip.velocity),
            };
            let heading = target.heading.map_or(f32::NAN, |h| h as f32);
            let reference = Reference {
                velocity: ned(velocity.into()),
                acceleration: ned(acceleration.into()),
                heading: Heading::from_angle(heading),
            };
            let [tail, belly, right] = state.axes();
            let [f_i, f_j, f_w] = self.plant.specific_force(&state, air);
            let a = if self.measured_acceleration {
                f_i * tail + f_j * belly + f_w * right + V3::new(0.0, 0.0, 9.81)
            } else {
                acceleration
            };
            let feed_forward = FeedForward {
                air_acceleration: ned((a - wind_rate).into()),
                jerk: ned(target.jerk.into()),
            };
            let command = self
                .control
                .robust(&law_state, &reference, Some(&feed_forward))
                .unwrap();
            let thrust =
                f64::from(command.thrust).clamp(self.plant.thrust[0], self.plant.thrust[1]);
            let sample = ForceSample {
                specific_force: Body::new(f_i as f32, f_j as f32, f_w as f32),
                orientation,
                aerodynamic: command.diagnostics.aerodynamic,
                thrust: thrust as f32,
            };
            let dt = PERIOD as f32;
            self.force.update(&mut force, &sample, dt);
            if self.wind_known != Wind::All {
                let v_a = command.diagnostics.v_a;
                self.sideslip.update(&mut sideslip, v_a, f_w as f32, dt);
            }

            samples.push(Sample::new(t, &state, &target, air, &start));
            let r = command.rates;
            let rates = V3::new(r.j.into(), r.w.into(), r.i.into());
            state = self.plant.step(&state, thrust, rates, air, PERIOD);
            assert!(state.velocity.norm() < 1e3, "diverged at {t} s");
        }
        samples
    }
}

/// Horizontal and vertical gains \[1/s\], pull \[m/s\], and the integral's gain \[1/s\].
const GAIN: [f64; 2] = [0.8, 1.0];
const PULL: [f64; 2] = [6.0, 3.0];
const INTEGRAL: f64 = 0.2;

/// v_cmd = v_s − sat(K_p x̃) − I, İ = K_i sat(K_p x̃) where it is not saturated, and a_r = a_s − d/dt(sat + I); saturated
/// on the horizontal length and on the vertical.
fn outer_loop(integral: &mut V3, target: &Target, state: &SpatialState) -> (V3, V3) {
    let x = state.position - target.position;
    let v = state.velocity - target.velocity;
    let level = |x: V3| V3::new(x.x, x.y, 0.0) * GAIN[0];
    let (mut pull, mut rate, mut grow) = (level(x), level(v), V3::repeat(INTEGRAL));
    let length = pull.norm();
    if length > PULL[0] {
        let along = pull / length;
        pull = along * PULL[0];
        rate = (rate - along * rate.dot(&along)) * (PULL[0] / length);
        (grow.x, grow.y) = (0.0, 0.0);
    }
    let down = x.z * GAIN[1];
    pull.z = down.clamp(-PULL[1], PULL[1]);
    if pull.z == down {
        rate.z = v.z * GAIN[1];
    } else {
        grow.z = 0.0;
    }
    let growth = pull.component_mul(&grow);
    *integral += growth * PERIOD;
    (
        target.velocity - pull - *integral,
        target.acceleration - rate - growth,
    )
}

/// Root of the mean square of `f` from `after` \[s\] on.
pub fn rms(samples: &[Sample], after: f64, f: impl Fn(&Sample) -> f64) -> f64 {
    let late: Vec<_> = samples
        .iter()
        .filter(|s| s.t >= after)
        .map(|s| f(s).powi(2))
        .collect();
    (late.iter().sum::<f64>() / late.len() as f64).sqrt()
}

/// Figures of a flight from `after` \[s\] on: velocity rms \[m/s\], position rms \[m\], sideslip rms \[°\]; printed.
pub fn report(name: &str, samples: &[Sample], after: f64) -> [f64; 3] {
    let figures = [
        rms(samples, after, |s| s.velocity_error),
        rms(samples, after, |s| s.position_error),
        rms(samples, after, |s| s.sideslip).to_degrees(),
    ];
    let lowest = samples
        .iter()
        .map(|s| s.altitude)
        .fold(f64::INFINITY, f64::min);
    let peak = samples
        .iter()
        .filter(|s| s.t >= after)
        .map(|s| s.velocity_error);
    println!(
        "| {name} | {:.3} | {:.3} | {:.3} | {:.2} | {lowest:.1} |",
        figures[0],
        figures[1],
        figures[2],
        peak.fold(0.0, f64::max),
    );
    figures
}

/// Hover at the origin, nose up, the belly to `heading` \[rad\].
pub fn hover(heading: f64) -> SpatialState {
    SpatialState {
        position: V3::zeros(),
        velocity: V3::zeros(),
        attitude: UnitQuaternion::from_axis_angle(&V3::z_axis(), heading),
        rates: V3::zeros(),
        thrust: 98.1,
    }
}

/// Level cruise to the north at this speed, 4° nose up.
pub fn cruise(speed: f64) -> SpatialState {
    SpatialState {
        position: V3::zeros(),
        velocity: V3::new(speed, 0.0, 0.0),
        attitude: UnitQuaternion::from_axis_angle(&V3::y_axis(), -86.0_f64.to_radians()),
        rates: V3::zeros(),
        thrust: 5.0,
    }
}

/// No wind.
pub fn calm() -> impl FnMut(f64, f64) -> V3 {
    |_, _| V3::zeros()
}
