//! `[controller.guidance]` of a mission: the core's guidance and every parameter of it.

use alula::control::{
    BranchParameters, BranchSwitch, GainChoice, LimitParameters, Limits, OuterLoop,
    OuterLoopParameters, ReferenceLimit, ReferenceLimitParameters, SupervisionParameters,
    Supervisor,
};
use alula::{
    BandwidthGains, BandwidthParameters, Guidance, Inertial, Model, ParameterError, Vehicle,
    VelocityControl,
};
use serde::Deserialize;

use crate::scenario::{FieldError, GainsSpec, VehicleSpec};

/// The guidance that missions fly: model and gains are data.
pub type MissionGuidance = Guidance<Model, GainChoice>;

/// `[controller.guidance]`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GuidanceSpec {
    /// What the controller believes about the vehicle; the truth if left out.
    pub vehicle: Option<VehicleSpec>,
    /// Gains of the law.
    pub gains: GainChoiceSpec,
    /// Acceleration limit on the reference.
    pub reference: ReferenceLimitSpec,
    /// Position hold and integral action.
    pub position: PositionSpec,
    /// Limits of the command.
    pub limits: LimitSpec,
    /// The branch θ̃ = π.
    pub branch: BranchSpec,
    /// What happens when inputs fail.
    pub supervision: SupervisionSpec,
}

/// `[controller.guidance.gains.…]`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum GainChoiceSpec {
    /// The paper's.
    Constant(GainsSpec),
    /// By bandwidth.
    Bandwidth(BandwidthSpec),
}

/// `[controller.guidance.gains.bandwidth]`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BandwidthSpec {
    /// ω_n \[rad/s\].
    pub natural_frequency_rad_s: f64,
    /// ζ.
    pub damping: f64,
    /// ω_v \[1/s\].
    pub thrust_rate_1_s: f64,
    /// Floor of |F_p| \[N\].
    pub force_floor_n: f64,
    /// τ \[N\].
    pub tau_n: f64,
}

/// `[controller.guidance.reference]`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReferenceLimitSpec {
    /// Largest acceleration \[m/s²\].
    pub acceleration_m_s2: f64,
    /// Rate of the return to the reference asked for \[1/s\].
    pub return_1_s: f64,
}

/// `[controller.guidance.position]`, each (down, forward).
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PositionSpec {
    /// Whether the position error is measured.
    pub measured: bool,
    /// k_p \[1/s\].
    pub gain_1_s: [f64; 2],
    /// Largest pull \[m/s\].
    pub pull_m_s: [f64; 2],
    /// k_i \[1/s\].
    pub integral_gain_1_s: [f64; 2],
    /// Largest integral \[m/s\].
    pub integral_m_s: [f64; 2],
    /// Largest forward velocity error that the law is given \[m/s\].
    pub forward_error_m_s: f64,
}

/// `[controller.guidance.limits]`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LimitSpec {
    /// Least and most thrust \[N\].
    pub thrust_n: [f64; 2],
    /// Largest rate \[rad/s\].
    pub rate_rad_s: f64,
    /// Largest change of the rate \[rad/s²\].
    pub slew_rad_s2: f64,
}

/// `[controller.guidance.branch]`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BranchSpec {
    /// Whether branches are switched.
    pub switch: bool,
    /// Hysteresis \[N\].
    pub hysteresis_n: f64,
    /// Fading time of a switch's jump \[s\].
    pub fade_s: f64,
}

/// `[controller.guidance.supervision]`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SupervisionSpec {
    /// How long bad frames are bridged \[s\].
    pub hold_s: f64,
    /// How long frames must be good to leave the safe command \[s\].
    pub recovery_s: f64,
    /// Oldest state \[s\].
    pub state_age_s: f64,
    /// Oldest reference \[s\].
    pub reference_age_s: f64,
    /// How long the last wind stands in \[s\].
    pub air_hold_s: f64,
    /// Thrust of the safe command \[N\].
    pub safe_thrust_n: f64,
}

fn pair([down, forward]: [f64; 2]) -> Inertial {
    Inertial::new(down as f32, forward as f32)
}

/// The core's refusal under the table's name.
fn under<T>(table: &str, result: Result<T, ParameterError>) -> Result<T, FieldError> {
    result.map_err(|e| FieldError::new(table, e.to_string()))
}

impl GainChoiceSpec {
    /// The gains for what the controller believes to be `vehicle`.
    pub fn gains(&self, vehicle: &Vehicle<Model>) -> Result<GainChoice, FieldError> {
        Ok(match self {
            Self::Constant(spec) => {
                GainChoice::Constant(spec.control_gains("controller.guidance.gains.constant")?)
            }
            Self::Bandwidth(spec) => {
                let p = BandwidthParameters {
                    natural_frequency: spec.natural_frequency_rad_s as f32,
                    damping: spec.damping as f32,
                    thrust_rate: spec.thrust_rate_1_s as f32,
                    force_floor: spec.force_floor_n as f32,
                    tau: spec.tau_n as f32,
                };
                let table = "controller.guidance.gains.bandwidth";
                GainChoice::Bandwidth(under(table, BandwidthGains::new(p, vehicle))?)
            }
        })
    }
}

impl GuidanceSpec {
    /// The guidance of a vehicle that is `truth` unless the controller believes otherwise.
    pub fn guidance(&self, truth: &VehicleSpec) -> Result<MissionGuidance, FieldError> {
        let vehicle = match &self.vehicle {
            Some(belief) => belief.control_vehicle("controller.guidance.vehicle")?,
            None => truth.control_vehicle("vehicle")?,
        };
        let gains = self.gains.gains(&vehicle)?;
        let reference = ReferenceLimitParameters {
            acceleration: self.reference.acceleration_m_s2 as f32,
            rate: self.reference.return_1_s as f32,
        };
        let position = OuterLoopParameters {
            position_gain: pair(self.position.gain_1_s),
            pull: pair(self.position.pull_m_s),
            integral_gain: pair(self.position.integral_gain_1_s),
            integral: pair(self.position.integral_m_s),
            forward_error: self.position.forward_error_m_s as f32,
        };
        let limits = LimitParameters {
            thrust_min: self.limits.thrust_n[0] as f32,
            thrust_max: self.limits.thrust_n[1] as f32,
            rate: self.limits.rate_rad_s as f32,
            slew: self.limits.slew_rad_s2 as f32,
        };
        let branch = BranchParameters {
            switch: self.branch.switch,
            hysteresis: self.branch.hysteresis_n as f32,
            fade: self.branch.fade_s as f32,
        };
        let s = &self.supervision;
        let supervision = SupervisionParameters {
            hold: s.hold_s as f32,
            recovery: s.recovery_s as f32,
            state_age: s.state_age_s as f32,
            reference_age: s.reference_age_s as f32,
            air_hold: s.air_hold_s as f32,
            safe_thrust: s.safe_thrust_n as f32,
        };
        Ok(Guidance {
            control: VelocityControl::new(vehicle, gains),
            reference_limit: under(
                "controller.guidance.reference",
                ReferenceLimit::new(reference),
            )?,
            outer_loop: under("controller.guidance.position", OuterLoop::new(position))?,
            branch: under("controller.guidance.branch", BranchSwitch::new(branch))?,
            limits: under("controller.guidance.limits", Limits::new(limits))?,
            supervisor: under(
                "controller.guidance.supervision",
                Supervisor::new(supervision),
            )?,
        })
    }
}
