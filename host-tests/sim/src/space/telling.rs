//! What the guidance is told at a step: what was measured, with the faults that last.

use alula::guidance::Air;
use alula::spatial::{Body, Heading, Reference};
use alula::{Attitude, GuidanceInput};
use nalgebra::UnitQuaternion;

use super::path::Target;
use super::sensors::Measured;
use super::{SensorSpec, V3, ned};
use crate::experiment::{FaultKind, Faults, Lasting, Told};

impl Told for Measured {
    fn distort(&mut self, fault: &Lasting<Self>) {
        let (first, every) = (fault.first, V3::from_element);
        let turn = |angle: f64| UnitQuaternion::from_scaled_axis(every(angle.to_radians()));
        match fault.kind {
            FaultKind::VelocityFrozen => self.velocity = first.velocity,
            FaultKind::VelocityDrift => self.velocity += every(fault.drift),
            FaultKind::AttitudeFrozen => self.attitude = first.attitude,
            FaultKind::AttitudeDrift => self.attitude *= turn(fault.drift),
            FaultKind::AttitudeOffset => self.attitude *= turn(fault.size),
            FaultKind::PositionDrift => self.position += every(fault.drift),
            FaultKind::PositionJump => self.position += every(fault.size),
            _ => {}
        }
        let off = ned(every(fault.drift));
        self.air = fault.air(self.air, first.air, ned(first.velocity), off);
        let by = fault.drift as f32;
        let off = Body::new(by, by, by);
        self.specific_force = fault.force(self.specific_force, first.specific_force, off);
    }
}

/// What the guidance was told last, which a fault may repeat.
#[derive(Default)]
pub struct Telling {
    measured: Option<(f64, Measured)>,
    /// The target, and when it was sent \[s\].
    target: Option<(f64, Target)>,
}

impl Telling {
    /// What was measured at `t` \[s\], as far as it comes through.
    pub fn state(&mut self, faults: &mut Faults<Measured>, t: f64, fresh: Measured) -> Measured {
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
        faults: &Faults<Measured>,
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
        GuidanceInput {
            velocity,
            orientation,
            state_age: (t - measured_at) as f32,
            air: match fails(FaultKind::Air) {
                true => Air::Unknown,
                false => measured.air,
            },
            specific_force: measured.specific_force,
            position_error: sensors.position.told(error),
            reference: Reference {
                velocity: ned(sent.velocity),
                acceleration: ned(sent.acceleration),
                heading: Heading::from_angle(heading),
            },
            reference_age: (t - sent_at) as f32,
            ..GuidanceInput::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::FaultSpec;
    use alula::spatial::Ned;

    /// Measured at `t` \[s\] of a climbing turn.
    fn measured(t: f64) -> Measured {
        Measured {
            velocity: V3::new(10.0 + t, t, -1.0),
            position: V3::new(10.0 * t, 0.0, -t),
            attitude: UnitQuaternion::from_scaled_axis(V3::new(0.1 * t, 0.2, 0.3)),
            air: Air::Velocity(Ned::new(8.0 + t as f32, t as f32, -1.0)),
            specific_force: Some(Body::new(9.0, t as f32, 0.5)),
        }
    }

    /// What is told of `measured(1.5)` under a fault that begins at 1 s and ends at 2 s; before and after nothing is changed.
    fn told(kind: FaultKind, size: Option<f64>) -> Measured {
        let specs = [FaultSpec {
            kind,
            from_s: 1.0,
            to_s: 2.0,
            size,
        }];
        let mut faults = Faults::new(&specs, 0, 3);
        assert_eq!(
            faults.distort(0.5, measured(0.5)),
            measured(0.5),
            "{kind:?}"
        );
        faults.distort(1.0, measured(1.0));
        let during = faults.distort(1.5, measured(1.5));
        assert_eq!(
            faults.distort(2.0, measured(2.0)),
            measured(2.0),
            "{kind:?}"
        );
        during
    }

    #[test]
    fn sensors_in_space_freeze_drift_and_jump() {
        use FaultKind::{
            Accelerometer, AccelerometerDead, AccelerometerDrift, AccelerometerFrozen, AirDrift,
            AirFrozen, AirScale, AttitudeDrift, AttitudeFrozen, AttitudeOffset, PositionDrift,
            PositionJump, VelocityDrift, VelocityFrozen, WindStuck,
        };
        let (first, fresh) = (measured(1.0), measured(1.5));
        assert_eq!(told(AirFrozen, None).air, first.air);
        assert_eq!(
            told(WindStuck, None).air,
            Air::Wind(Ned::new(2.0, 0.0, 0.0))
        );
        let half = Air::Velocity(Ned::new(4.75, 0.75, -0.5));
        assert_eq!(told(AirScale, Some(-0.5)).air, half);
        let off = Air::Velocity(Ned::new(10.5, 2.5, 0.0));
        assert_eq!(told(AirDrift, Some(2.0)).air, off);
        assert_eq!(told(VelocityFrozen, None).velocity, first.velocity);
        let drifted = told(VelocityDrift, Some(-2.0)).velocity - fresh.velocity;
        assert_eq!(drifted, V3::repeat(-1.0));
        assert_eq!(
            told(PositionJump, Some(4.0)).position - fresh.position,
            V3::repeat(4.0)
        );
        assert_eq!(
            told(PositionDrift, Some(4.0)).position - fresh.position,
            V3::repeat(2.0)
        );
        assert_eq!(told(AttitudeFrozen, None).attitude, first.attitude);
        // About each of three body axes.
        for (kind, size) in [(AttitudeOffset, 3.0), (AttitudeDrift, 6.0)] {
            let turned = fresh.attitude.inverse() * told(kind, Some(size)).attitude;
            let degrees = turned.scaled_axis().map(f64::to_degrees);
            assert!((degrees - V3::repeat(3.0)).norm() < 1e-9, "{degrees}");
        }
        assert_eq!(told(Accelerometer, None).specific_force, None);
        assert_eq!(
            told(AccelerometerDead, None).specific_force,
            Some(Body::default())
        );
        assert_eq!(
            told(AccelerometerFrozen, None).specific_force,
            first.specific_force
        );
        let drifted = Some(Body::new(10.0, 2.5, 1.5));
        assert_eq!(told(AccelerometerDrift, Some(2.0)).specific_force, drifted);
    }
}
