//! What the guidance remembers between steps.

use super::accelerometer::AccelerometerState;
use super::air_estimate::AirEstimateState;
use super::lateral_guidance::ReferenceModelState;
use super::limits::LimitState;
use super::memory::{self, Memory, memory};
use super::planner::PlannerState;
use super::status::Status;
use super::supervision::{Mode, SupervisionState};
use crate::ned::Ned;

/// What the guidance remembers between steps. The default is power-on. Equal are those whose [bytes](Self::to_bytes) are.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct GuidanceState {
    pub(super) supervision: SupervisionState,
    /// The reference model.
    pub(super) flight: ReferenceModelState,
    /// The plan it flies by.
    pub(super) planner: PlannerState,
    /// Integral I [m/s], as it is in hover.
    pub(super) integral: Ned,
    /// Angle \[rad\] by which the vehicle is known to lean beyond the reference model.
    pub(super) lean: f32,
    /// The wind that is planned with: without gusts [m/s].
    pub(super) wind: Ned,
    /// Position less reference position \[m\], reckoned from the velocity where it is not measured.
    pub(super) reckoned: Ned,
    pub(super) accelerometer: AccelerometerState,
    pub(super) air: AirEstimateState,
    pub(super) limits: LimitState,
    /// 1 once the reference model has begun, 2 while the vehicle falls, 3 while it gathers speed to stop.
    pub(super) started: u8,
    /// Time \[s\] for which it has flown on its wing, asked to hover.
    pub(super) flown_on: f32,
    /// Last good reference velocity [m/s].
    pub(super) held: Ned,
    /// 1 if there has been a good reference. A number, not `Option`: every bit pattern has a meaning.
    pub(super) held_known: u8,
    /// What of the last command saturated.
    pub(super) saturated: Status,
}

memory!(GuidanceState {
    supervision: SupervisionState,
    flight: ReferenceModelState,
    planner: PlannerState,
    integral: Ned,
    lean: f32,
    wind: Ned,
    reckoned: Ned,
    accelerometer: AccelerometerState,
    air: AirEstimateState,
    limits: LimitState,
    started: u8,
    flown_on: f32,
    held: Ned,
    held_known: u8,
    saturated: Status,
});

impl PartialEq for GuidanceState {
    fn eq(&self, other: &Self) -> bool {
        self.to_bytes() == other.to_bytes()
    }
}

impl GuidanceState {
    /// Length of [`to_bytes`](Self::to_bytes).
    pub const BYTES: usize = 4 * Self::WORDS;

    /// The state as little-endian words of 32 bits: to log it, or to go on with it after a restart. The order belongs to
    /// this version of the library.
    pub fn to_bytes(&self) -> [u8; Self::BYTES] {
        memory::to_bytes(self)
    }

    /// The state of these bytes. Any will do: a state outside its bounds is reset at the next step.
    pub fn from_bytes(bytes: &[u8; Self::BYTES]) -> Self {
        memory::from_bytes(bytes)
    }

    /// Mode of the last step.
    pub fn mode(&self) -> Mode {
        self.supervision.mode()
    }

    /// The integral I [m/s], which stands in for what is not known of the vehicle.
    pub fn integral(&self) -> Ned {
        self.integral
    }

    /// Velocity [m/s] of the reference model, and its attitude θ \[rad\] in the plane of flight.
    pub fn reference_model(&self) -> (Ned, f32) {
        (self.flight.velocity, self.flight.theta)
    }
}
