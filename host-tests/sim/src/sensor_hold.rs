//! What a controller is told at a step: what was measured, as faults of the transmission let it through.

use alula::GuidanceInput;
use alula::guidance::Air;
use alula::planar::Attitude;
use alula::spatial::{Heading, Reference};

use crate::experiment::{FaultKind, Faults, Measured, SensorSpec, Target, ned};

/// What the controller was told last, which a fault may repeat.
#[derive(Default)]
pub struct SensorHold {
    measured: Option<(f64, Measured)>,
    /// The target, and when it was sent \[s\].
    target: Option<(f64, Target)>,
}

impl SensorHold {
    /// What was measured at `t` \[s\], as far as it comes through.
    pub fn state(&mut self, faults: &mut Faults, t: f64, fresh: Measured) -> Measured {
        let fresh = faults.distort(t, fresh);
        let told = match self.measured {
            Some(old) if faults.lasts(FaultKind::StateStale, t) => old,
            _ => (t, fresh),
        };
        self.measured = Some(told);
        told.1
    }

    /// The input at `t` \[s\], after [`state`](Self::state), where `target` is to be flown.
    pub fn input(
        &mut self,
        sensors: &SensorSpec,
        faults: &Faults,
        t: f64,
        target: &Target,
    ) -> GuidanceInput {
        let fails = |kind| faults.lasts(kind, t);
        let (measured_at, measured) = self.measured.expect("measured before");
        let (sent_at, sent) = match self.target {
            Some(old) if fails(FaultKind::ReferenceStale) => old,
            _ => (t, *target),
        };
        self.target = Some((sent_at, sent));
        let mut velocity = ned(measured.velocity);
        if fails(FaultKind::VelocityNan) {
            velocity.north = f32::NAN;
        }
        let mut orientation = measured.orientation();
        if fails(FaultKind::AttitudeNan) {
            orientation = orientation.pitched(Attitude::from_angle(f32::NAN));
        }
        // The position is told against the path of now.
        let mut error = ned(measured.position - target.position);
        if fails(FaultKind::PositionNan) {
            error.north = f32::NAN;
        }
        let heading = sent.heading.map_or(f32::NAN, |h| h as f32);
        GuidanceInput::default()
            .velocity(velocity)
            .orientation(orientation)
            .state_age((t - measured_at) as f32)
            .air(match fails(FaultKind::Air) {
                true => Air::Unknown,
                false => measured.air,
            })
            .specific_force(measured.specific_force)
            .position_error(sensors.position.told(error))
            .reference(Reference {
                velocity: ned(sent.velocity),
                acceleration: ned(sent.acceleration),
                heading: Heading::from_angle(heading),
            })
            .reference_age((t - sent_at) as f32)
    }
}
