//! The core's law in single precision at 100 Hz, with an outer loop and estimators of force and sideslip, as a controller of the one loop.
//!
//! The vehicle is that of the built-in `space`. Unless said otherwise the controller keeps rates within ±3.5 rad/s and believes m = 9 of 10 kg, k_a = 0.51 of 0.646 kg/m, c_Y = 0.35 of 0.5 and the paper's wrong coefficients.

use alula::BodyRates;
use alula::spatial::{
    Correction, FeedForward, ForceError, ForceErrorParameters, ForceErrorState, ForceSample,
    Heading, LateralGains, LateralParameters, Reference, Sideslip, SideslipParameters,
    SideslipState, State, WingedControl,
};
use alula::{
    BandwidthGains, Combined, CombinedParameters, GuidanceParameters, Vehicle, VehicleParameters,
};
use alula_sim::controllers::{Answer, Controller, Input, Report};
use alula_sim::experiment::{Document, State as Truth};
use alula_sim::simulate::fly_by;

use super::support::{ned, triple};

pub use alula_sim::experiment::V3;

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
pub trait Task: Send {
    fn target(&mut self, t: f64, position: V3) -> Target;
}

impl<F: FnMut(f64) -> Target + Send> Task for F {
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
    /// Cosine of the angle between nose and up.
    pub nose_up: f64,
    /// Cosine of the angle between belly and down.
    pub belly_down: f64,
    /// Angle of the belly's horizontal part from north \[rad\].
    pub heading: f64,
}

impl Sample {
    pub fn new(t: f64, state: &Truth, target: &Target, wind: V3, start: &Truth) -> Self {
        let [tail, belly, right] = state.axes();
        let v_a = state.velocity - wind;
        Self {
            t,
            velocity_error: (state.velocity - target.velocity).norm(),
            position_error: (state.position - target.position).norm(),
            sideslip: (v_a.dot(&right) / v_a.norm().max(1.0)).asin(),
            altitude: start.position.z - state.position.z,
            nose_up: tail.z,
            belly_down: belly.z,
            heading: belly.y.atan2(belly.x),
        }
    }
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
        let p = vehicle.c_y(c_y);
        let vehicle = Vehicle::new(p, Combined::new(model).unwrap()).unwrap();
        let gains = BandwidthGains::new(&GuidanceParameters::default(), &vehicle).unwrap();
        let force = ForceErrorParameters {
            time: 0.2,
            thrust_lag: 0.05,
            most: 60.0,
        };
        Self {
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

    /// Flies `task` for `duration` \[s\] in the built-in `space`, changed by `settings`.
    pub fn fly(&self, task: &mut dyn Task, duration: f64, settings: &[String]) -> Vec<Sample> {
        let mut document = Document::load("space").unwrap();
        let fixed = [
            "path.hover={}".to_owned(),
            "substeps=1".to_owned(),
            format!("duration_s={duration:?}"),
        ];
        for setting in fixed.iter().chain(settings) {
            document.assign(setting).unwrap();
        }
        let experiment = document.checked().unwrap();
        let mut controller = Bare {
            setup: self,
            task,
            t: 0.0,
            integral: V3::zeros(),
            force: ForceErrorState {
                thrust: experiment.initial.thrust_n as f32,
                ..ForceErrorState::default()
            },
            sideslip: SideslipState::default(),
            last_wind: None,
            targets: Vec::new(),
        };
        let record = fly_by(&experiment, &mut controller).unwrap();
        let start = record[0].truth;
        let pairs = record.iter().zip(&controller.targets);
        pairs
            .map(|(step, target)| Sample::new(step.t, &step.truth, target, step.wind, &start))
            .collect()
    }
}

/// The law with its outer loop and its estimators, on a flight.
struct Bare<'a> {
    setup: &'a Setup,
    task: &'a mut dyn Task,
    t: f64,
    integral: V3,
    force: ForceErrorState,
    sideslip: SideslipState,
    last_wind: Option<V3>,
    targets: Vec<Target>,
}

/// Largest body rate \[rad/s\], and thrust \[N\], commanded.
const MOST: (f32, f32) = (3.5, 2.0 * 98.1);

impl Controller for Bare<'_> {
    fn answer(&mut self, input: &Input, dt: f32) -> anyhow::Result<Answer> {
        let (setup, sample) = (self.setup, &input.sample);
        // The experiment's path stays at the origin.
        let position = V3::from(triple(sample.position_error.unwrap()));
        let measured = V3::from(triple(sample.velocity));
        let target = self.task.target(self.t, position);
        self.t += PERIOD;
        self.targets.push(target);
        let (velocity, acceleration) = outer_loop(&mut self.integral, &target, position, measured);
        let known = match setup.wind_known {
            Wind::All => V3::from(triple(input.wind())),
            Wind::Only(wind) => wind,
        };
        let wind_rate = (known - self.last_wind.unwrap_or(known)) / PERIOD;
        self.last_wind = Some(known);

        let orientation = sample.orientation;
        let law_state = State {
            velocity: sample.velocity,
            orientation,
            wind: ned(known.into()),
            correction: Correction::new(self.force.force, self.sideslip.velocity),
        };
        let heading = target.heading.map_or(f32::NAN, |h| h as f32);
        let reference = Reference {
            velocity: ned(velocity.into()),
            acceleration: ned(acceleration.into()),
            heading: Heading::from_angle(heading),
        };
        let specific_force = sample.specific_force.unwrap();
        let a = if setup.measured_acceleration {
            V3::from(triple(orientation.to_world(specific_force))) + V3::new(0.0, 0.0, 9.81)
        } else {
            acceleration
        };
        let feed_forward = FeedForward {
            air_acceleration: ned((a - wind_rate).into()),
            jerk: ned(target.jerk.into()),
        };
        let command = setup
            .control
            .robust(&law_state, &reference, Some(&feed_forward))
            .unwrap();
        let (rate, most) = MOST;
        let thrust = command.thrust.clamp(0.0, most);
        let sample = ForceSample {
            specific_force,
            orientation,
            aerodynamic: command.diagnostics.aerodynamic,
            thrust,
        };
        setup.force.update(&mut self.force, &sample, dt);
        if setup.wind_known != Wind::All {
            let v_a = command.diagnostics.v_a;
            let side = specific_force.right;
            setup.sideslip.update(&mut self.sideslip, v_a, side, dt);
        }
        let BodyRates { roll, pitch, yaw } = command.rates;
        let [roll, pitch, yaw] = [roll, pitch, yaw].map(|x| x.clamp(-rate, rate));
        Ok(Answer {
            thrust,
            rates: BodyRates { roll, pitch, yaw },
            report: Report::Outside,
        })
    }
}

/// Horizontal and vertical gains \[1/s\], pull \[m/s\], and the integral's gain \[1/s\].
const GAIN: [f64; 2] = [0.8, 1.0];
const PULL: [f64; 2] = [6.0, 3.0];
const INTEGRAL: f64 = 0.2;

/// v_cmd = v_s − sat(K_p x̃) − I, İ = K_i sat(K_p x̃) where it is not saturated, and a_r = a_s − d/dt(sat + I); saturated
/// on the horizontal length and on the vertical.
fn outer_loop(integral: &mut V3, target: &Target, position: V3, velocity: V3) -> (V3, V3) {
    let x = position - target.position;
    let v = velocity - target.velocity;
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

/// Settings of a start in hover at the origin, nose up, the belly to `heading` \[rad\].
pub fn hover(heading: f64) -> Vec<String> {
    vec![
        format!("initial.heading_deg={:?}", heading.to_degrees()),
        "initial.thrust_n=98.1".to_owned(),
    ]
}

/// Settings of a start in level cruise to the north at this speed, 4° nose up.
pub fn cruise(speed: f64) -> Vec<String> {
    vec![
        format!("initial.velocity_m_s=[{speed:?}, 0.0, 0.0]"),
        "initial.theta_deg=-86.0".to_owned(),
        "initial.thrust_n=5.0".to_owned(),
    ]
}

/// A start, with more settings.
pub fn with<const N: usize>(mut start: Vec<String>, more: [&str; N]) -> Vec<String> {
    start.extend(more.map(str::to_owned));
    start
}
