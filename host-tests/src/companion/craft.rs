//! An experiment's vehicle, with its rate loop and its weather, as a body under an autopilot.

use std::collections::VecDeque;

use alula_bridges::companion::{Body, BodyState, Parameters, preflight::hover_scale};
use rand_chacha::ChaCha8Rng;

use alula_sim::experiment::tail_sitter::{Mixer, RateLaw};
use alula_sim::experiment::{Experiment, State, V3, Weather, stream};
use alula_sim::plant::{Command, Dynamics, IdealPlant, Plant, Rotation};

/// The vehicle, where its experiment begins.
pub struct Craft {
    plant: Box<dyn Plant>,
    /// Thrust of full throttle, and the weight \[N\].
    most: f64,
    weight: f64,
    weather: Weather,
    gusts: ChaCha8Rng,
    time: f64,
    delay: f64,
    pending: VecDeque<Command>,
}

/// Lag \[s\] of what an experiment has no lag of.
const LEAST_LAG: f64 = 0.005;

impl Craft {
    /// The vehicle of `experiment`, at its start.
    pub fn new(experiment: &Experiment) -> anyhow::Result<Self> {
        let [mut gusts, mut start] = [1, 2].map(|n| stream(experiment.seed, n));
        let path = experiment.path.path()?;
        let state = experiment.initial.state(&path.start(), &mut start);
        let weather = Weather::new(experiment.weather, experiment.in_plane(), &mut gusts);
        let of_plant = |plant, most, weight, delay| Self {
            plant,
            most,
            weight,
            weather,
            gusts,
            time: 0.0,
            delay,
            pending: VecDeque::new(),
        };
        Ok(match &experiment.tail_sitter {
            Some(spec) => {
                let vehicle = spec.true_vehicle();
                let weight = vehicle.mass_kg * experiment.vehicle.gravity_m_s2;
                let most = alula_sim::plant::tail_sitter::TailSitter::new(vehicle, None);
                let plant = experiment.plant(state);
                of_plant(plant, most.static_thrust(), weight, spec.delay_s)
            }
            None => {
                let mut dynamics = Dynamics::of(experiment);
                let weight = experiment.weight();
                let [least, most] = experiment.thrust_limits(None, weight);
                dynamics.thrust = [least.max(0.0), most];
                if dynamics.thrust_lag == 0.0 {
                    dynamics.thrust_lag = LEAST_LAG;
                }
                if dynamics.rotation == Rotation::Ideal {
                    dynamics.rotation = Rotation::Lag(LEAST_LAG);
                }
                let plant = Box::new(IdealPlant { dynamics, state });
                of_plant(plant, most, weight, experiment.plant.delay_s)
            }
        })
    }

    fn wind(&self) -> V3 {
        self.weather.wind(self.time)
    }

    /// Its state.
    pub fn spatial(&self) -> &State {
        self.plant.state()
    }
}

/// The rate loop of PX4 with these parameters, of a tail-sitter in the multicopter state: elevons by FW_PR_* and FW_RR_*, times what hover makes of them, and
/// motors by MC_*RATE_*, whose axes are those of hover. Torques are shares of full ones, as PX4's are. FW_PR_I and FW_RR_I have no effect in that state:
/// `FixedwingRateControl` of 1.17 resets its integrals wherever it is not in forward flight.
#[must_use]
pub fn px4_rate_law(parameters: &Parameters, mixer: Mixer) -> RateLaw {
    let get = |name: &str, shipped| parameters.get(name).unwrap_or(shipped);
    let scale = hover_scale(parameters);
    let square = scale * scale;
    // About the nose and the wing; about the belly motors turn every one.
    let (p, i, d, feed_forward) = match mixer {
        Mixer::Elevons | Mixer::Both => (
            [get("FW_RR_P", 0.05), get("FW_PR_P", 0.08)].map(|gain| square * gain),
            [0.0; 2],
            [0.0; 2],
            [get("FW_RR_FF", 0.5), get("FW_PR_FF", 0.5)].map(|gain| scale * gain),
        ),
        Mixer::DifferentialThrust => (
            [get("MC_YAWRATE_P", 0.2), get("MC_PITCHRATE_P", 0.15)],
            [get("MC_YAWRATE_I", 0.1), get("MC_PITCHRATE_I", 0.2)],
            [get("MC_YAWRATE_D", 0.0), get("MC_PITCHRATE_D", 0.003)],
            [0.0; 2],
        ),
    };
    let with = |[nose, wing]: [f64; 2], belly: f64| [nose, wing, belly];
    RateLaw::Pid {
        p: with(p, get("MC_ROLLRATE_P", 0.15)),
        i: with(i, get("MC_ROLLRATE_I", 0.2)),
        d: with(d, get("MC_ROLLRATE_D", 0.003)),
        feed_forward: with(feed_forward, 0.0),
    }
}

/// PX4's parameters as shipped for a tail-sitter, of those that the simulated one follows and says: v1.17, `fw_rate_control_params.c` and others.
pub const PX4_SHIPPED: &str = "
FW_RR_P 0.05
FW_RR_I 0.1
FW_RR_FF 0.5
FW_PR_P 0.08
FW_PR_I 0.1
FW_PR_FF 0.5
FW_ARSP_SCALE_EN 1
FW_AIRSPD_TRIM 15
FW_AIRSPD_STALL 7
MC_ROLLRATE_P 0.15
MC_ROLLRATE_I 0.2
MC_ROLLRATE_D 0.003
MC_PITCHRATE_P 0.15
MC_PITCHRATE_I 0.2
MC_PITCHRATE_D 0.003
MC_YAWRATE_P 0.2
MC_YAWRATE_I 0.1
MC_YAWRATE_D 0
FD_FAIL_P 60
FD_FAIL_P_TTRI 0.3
FD_FAIL_R 60
FD_FAIL_R_TTRI 0.3
CBRK_FLIGHTTERM 121212
THR_MDL_FAC 0
COM_OF_LOSS_T 1
VT_TYPE 0
VT_ELEV_MC_LOCK 1
MPC_THR_HOVER 0.5
";

/// ArduPlane's as shipped for a tail-sitter, likewise: 4.7, `tailsitter.cpp` and others.
pub const ARDUPLANE_SHIPPED: &str = "
Q_A_ACCEL_R_MAX 30000
Q_A_ACCEL_P_MAX 30000
Q_A_ACCEL_Y_MAX 10000
Q_M_SPIN_ARM 0.1
Q_M_SPIN_MIN 0.15
Q_M_SPIN_MAX 0.95
Q_M_THST_EXPO 0.65
Q_M_THST_HOVER 0.35
Q_THROTTLE_EXPO 0.2
Q_ACRO_RLL_RATE 360
Q_ACRO_PIT_RATE 180
Q_ACRO_YAW_RATE 90
ACRO_LOCKING 0
MAV_GCS_SYSID 255
RC_OVERRIDE_TIME 3
";

impl Body for Craft {
    fn step(&mut self, thrust: f64, rates: [f64; 3], dt: f64) {
        let delay = (self.delay / dt).round() as usize;
        self.pending.push_back(Command {
            thrust: thrust * self.most,
            rates: rates.into(),
        });
        let arrived = self.pending.len() > delay;
        let hover = Command {
            thrust: self.weight,
            rates: V3::zeros(),
        };
        let command = arrived.then(|| self.pending.pop_front()).flatten();
        let command = command.unwrap_or(hover);
        let wind = self.wind();
        self.plant.step(&command, wind, dt);
        self.time += dt;
        let airspeed = (self.plant.state().velocity - wind).norm();
        self.weather.advance(airspeed, dt, &mut self.gusts);
    }

    fn state(&self) -> BodyState {
        let state = self.plant.state();
        let q = state.attitude.into_inner();
        let force = self.plant.specific_force(self.wind());
        BodyState {
            position: state.position.into(),
            velocity: state.velocity.into(),
            quaternion: [q.w, q.i, q.j, q.k],
            rates: state.rates.into(),
            specific_force: [force.y, force.z, force.x],
            wind: self.wind().into(),
        }
    }

    fn hover(&self) -> f64 {
        self.weight / self.most
    }
}
