//! Faults of what the controller is told, of its clock, and of its memory.

use alula::Frd;
use alula::guidance::Air;
use alula::ned::Ned;
use nalgebra::UnitQuaternion;
use rand::{Rng, RngExt};
use rand_chacha::ChaCha8Rng;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::V3;
use super::document::{FieldError, finite, require, sensor_error};
use super::sensors::Measured;
use super::vector::ned;

/// What is wrong while a fault lasts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FaultKind {
    /// No air data.
    Air,
    /// The velocity is NaN.
    VelocityNan,
    /// The attitude is NaN.
    AttitudeNan,
    /// The state ages: the last one measured comes again and again.
    StateStale,
    /// The reference ages.
    ReferenceStale,
    /// The position error is NaN.
    PositionNan,
    /// The air velocity stands still, as with a blocked pitot.
    AirFrozen,
    /// A wind is told in place of the air velocity, and stands still.
    WindStuck,
    /// The velocity stands still, and does not age.
    VelocityFrozen,
    /// The attitude stands still, and does not age.
    AttitudeFrozen,
    /// The air velocity is off by `size` [m/s] per second.
    AirDrift,
    /// The velocity is off by `size` [m/s] per second.
    VelocityDrift,
    /// The attitude is off by `size` \[°\] per second.
    AttitudeDrift,
    /// The position is off by `size` \[m\] per second.
    PositionDrift,
    /// The attitude is off by `size` \[°\].
    AttitudeOffset,
    /// The position is off by `size` \[m\].
    PositionJump,
    /// The air velocity told is `1 + size` times the true one, as with a pitot that leaks.
    AirScale,
    /// The specific force is not told.
    Accelerometer,
    /// The specific force told is zero.
    AccelerometerDead,
    /// The specific force stands still.
    AccelerometerFrozen,
    /// The specific force is off by `size` [m/s²] per second.
    AccelerometerDrift,
    /// Every frame comes twice, the second time with a step of no time.
    TimeDuplicate,
    /// Time runs backwards.
    TimeBackward,
    /// No step is made: the last command stays, and the next step is as long as the gap.
    TimeMissing,
    /// The time step told is off by up to `size` times its length, at random.
    TimeJitter,
    /// At every control step one random bit of the controller's memory flips.
    MemoryBit,
}

impl FaultKind {
    /// Whether it has a size.
    pub fn has_size(self) -> bool {
        use FaultKind::*;
        matches!(
            self,
            AirDrift
                | VelocityDrift
                | AttitudeDrift
                | PositionDrift
                | AttitudeOffset
                | PositionJump
                | AirScale
                | AccelerometerDrift
                | TimeJitter
        )
    }
}

/// A fault.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FaultSpec {
    /// What fails.
    pub kind: FaultKind,
    /// From when \[s\].
    pub from_s: f64,
    /// Until when \[s\].
    pub to_s: f64,
    /// How much, of the kinds that say so. Of vectors the same in every component, of an attitude in space the same about every body axis.
    pub size: Option<f64>,
}

impl FaultSpec {
    pub(crate) fn validate(&self, field: &str) -> Result<(), FieldError> {
        finite(field, self.from_s)?;
        finite(field, self.to_s)?;
        let problem = "from_s must be before to_s";
        require(self.from_s < self.to_s, field, problem)?;
        let field = format!("{field}.size");
        let not = if self.kind.has_size() { "a" } else { "no" };
        let given = self.kind.has_size() == self.size.is_some();
        require(given, &field, format_args!("this kind has {not} size"))?;
        sensor_error(&field, self.size.unwrap_or(0.0))
    }

    /// Whether it lasts at `t` \[s\].
    fn lasts(&self, t: f64) -> bool {
        (self.from_s..self.to_s).contains(&t)
    }
}

/// When the controller is asked at a control step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// The time steps \[s\] with which it is asked, one after the other; none if it is not asked.
    pub steps: [Option<f64>; 2],
    /// A bit of its memory that flips before.
    pub flips: Option<u64>,
}

/// A fault that lasts.
struct Lasting {
    kind: FaultKind,
    /// What was measured when it began.
    first: Measured,
    /// Its size, or 0.
    size: f64,
    /// Its size times the seconds since it began.
    drift: f64,
    /// Whether it stays in the vertical plane to the north.
    in_plane: bool,
}

impl Lasting {
    /// `x` on every component of a world vector.
    fn every(&self, x: f64) -> V3 {
        V3::new(x, if self.in_plane { 0.0 } else { x }, x)
    }

    /// A turn by `angle` \[°\] about every body axis.
    fn turn(&self, angle: f64) -> UnitQuaternion<f64> {
        let angle = angle.to_radians();
        let across = if self.in_plane { 0.0 } else { angle };
        UnitQuaternion::from_scaled_axis(V3::new(across, angle, across))
    }

    /// Changes what is told.
    fn distort(&self, told: &mut Measured) {
        let first = &self.first;
        match self.kind {
            FaultKind::VelocityFrozen => told.velocity = first.velocity,
            FaultKind::VelocityDrift => told.velocity += self.every(self.drift),
            FaultKind::AttitudeFrozen => told.attitude = first.attitude,
            FaultKind::AttitudeDrift => told.attitude *= self.turn(self.drift),
            FaultKind::AttitudeOffset => told.attitude *= self.turn(self.size),
            FaultKind::PositionDrift => told.position += self.every(self.drift),
            FaultKind::PositionJump => told.position += self.every(self.size),
            _ => {}
        }
        told.air = self.air(told.air);
        told.specific_force = self.force(told.specific_force);
    }

    fn air(&self, air: Air<Ned>) -> Air<Ned> {
        match (self.kind, air, self.first.air) {
            (FaultKind::AirFrozen, _, first) => first,
            (FaultKind::WindStuck, _, Air::Velocity(first)) => {
                Air::Wind(ned(self.first.velocity) - first)
            }
            (FaultKind::AirDrift, Air::Velocity(air), _) => {
                Air::Velocity(air + ned(self.every(self.drift)))
            }
            (FaultKind::AirScale, Air::Velocity(air), _) => {
                Air::Velocity(air * (1.0 + self.size) as f32)
            }
            (_, air, _) => air,
        }
    }

    fn force(&self, force: Option<Frd>) -> Option<Frd> {
        let by = self.drift as f32;
        let across = if self.in_plane { 0.0 } else { by };
        let off = |f: Frd| Frd::new(f.forward - by, f.right + across, f.down + by);
        match self.kind {
            FaultKind::Accelerometer => None,
            FaultKind::AccelerometerDead => force.map(|_| Frd::default()),
            FaultKind::AccelerometerFrozen => self.first.specific_force,
            FaultKind::AccelerometerDrift => force.map(off),
            _ => force,
        }
    }
}

/// The faults of a flight, as far as it has come.
pub struct Faults {
    specs: Vec<FaultSpec>,
    /// What was measured when each began.
    begun: Vec<Option<Measured>>,
    in_plane: bool,
    /// Time \[s\] since the controller was asked last, before this step.
    waited: f64,
    random: ChaCha8Rng,
}

impl Faults {
    /// None has begun. `seed` is the experiment's; no other part of the flight draws from this `stream` of it.
    pub fn new(specs: Vec<FaultSpec>, seed: u64, in_plane: bool) -> Self {
        Self {
            begun: vec![None; specs.len()],
            specs,
            waited: 0.0,
            in_plane,
            random: super::stream(seed, 3),
        }
    }

    /// Whether a fault of this kind lasts at `t` \[s\].
    pub fn lasts(&self, kind: FaultKind, t: f64) -> bool {
        self.specs.iter().any(|f| f.kind == kind && f.lasts(t))
    }

    /// What the sensors say at `t` \[s\] of what was `measured`.
    pub fn distort(&mut self, t: f64, measured: Measured) -> Measured {
        let mut told = measured;
        for (fault, begun) in self.specs.iter().zip(&mut self.begun) {
            if !fault.lasts(t) {
                continue;
            }
            let size = fault.size.unwrap_or(0.0);
            let lasting = Lasting {
                in_plane: self.in_plane,
                kind: fault.kind,
                first: *begun.get_or_insert(measured),
                size,
                drift: size * (t - fault.from_s),
            };
            lasting.distort(&mut told);
        }
        told
    }

    /// How the controller is asked at `t` \[s\], a `period` \[s\] after the step before.
    pub fn clock(&mut self, t: f64, period: f64) -> Clock {
        let flips = self.lasts(FaultKind::MemoryBit, t);
        let mut clock = Clock {
            steps: [Some(self.waited + period), None],
            flips: flips.then(|| self.random.next_u64()),
        };
        self.waited = 0.0;
        if self.lasts(FaultKind::TimeBackward, t) {
            clock.steps[0] = Some(-period);
        }
        if self.lasts(FaultKind::TimeDuplicate, t) {
            clock.steps[1] = Some(0.0);
        }
        let jitters = |f: &&FaultSpec| f.kind == FaultKind::TimeJitter && f.lasts(t);
        if let Some(jitter) = self.specs.iter().find(jitters) {
            let off = self.random.random_range(-1.0..1.0) * jitter.size.unwrap_or(0.0);
            clock.steps[0] = Some(period * (1.0 + off));
        }
        // At power-on there is no command that could stay.
        if t > 0.0 && self.lasts(FaultKind::TimeMissing, t) {
            self.waited = clock.steps[0].unwrap_or(0.0);
            clock.steps = [None; 2];
        }
        clock
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spec(kind: FaultKind, size: Option<f64>) -> FaultSpec {
        FaultSpec {
            kind,
            from_s: 1.0,
            to_s: 2.0,
            size,
        }
    }

    #[test]
    fn a_fault_lasts_from_its_beginning_to_before_its_end() {
        let specs = [spec(FaultKind::Air, None)];
        let faults = Faults::new(specs.to_vec(), 0, false);
        let lasts = |t| faults.lasts(FaultKind::Air, t);
        assert!(!lasts(0.99) && lasts(1.0) && lasts(1.99) && !lasts(2.0));
        assert!(!faults.lasts(FaultKind::StateStale, 1.5));
    }

    #[test]
    fn a_size_is_given_where_there_is_one() {
        let refused = |kind, size| spec(kind, size).validate("f").map_err(|e| e.problem);
        assert!(refused(FaultKind::PositionJump, Some(2.0)).is_ok());
        let missing = refused(FaultKind::PositionJump, None).unwrap_err();
        assert_eq!(missing, "this kind has a size");
        let needless = refused(FaultKind::AirFrozen, Some(1.0)).unwrap_err();
        assert_eq!(needless, "this kind has no size");
        assert!(refused(FaultKind::AirDrift, Some(f64::NAN)).is_err());
    }

    /// Measured at `t` \[s\] of a climbing turn.
    fn measured(t: f64) -> Measured {
        Measured {
            velocity: V3::new(10.0 + t, t, -1.0),
            position: V3::new(10.0 * t, 0.0, -t),
            attitude: UnitQuaternion::from_scaled_axis(V3::new(0.1 * t, 0.2, 0.3)),
            air: Air::Velocity(Ned::new(8.0 + t as f32, t as f32, -1.0)),
            specific_force: Some(Frd::new(-9.0, 0.5, t as f32)),
        }
    }

    /// What is told of `measured(1.5)` under a fault that begins at 1 s and ends at 2 s; before and after nothing is changed.
    fn told(kind: FaultKind, size: Option<f64>, in_plane: bool) -> Measured {
        let specs = [FaultSpec {
            kind,
            from_s: 1.0,
            to_s: 2.0,
            size,
        }];
        let mut faults = Faults::new(specs.to_vec(), 0, in_plane);
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
        let told = |kind, size| told(kind, size, false);
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
            Some(Frd::default())
        );
        assert_eq!(
            told(AccelerometerFrozen, None).specific_force,
            first.specific_force
        );
        let drifted = Some(Frd::new(-10.0, 1.5, 2.5));
        assert_eq!(told(AccelerometerDrift, Some(2.0)).specific_force, drifted);
    }

    #[test]
    fn clocks_stand_still_run_backwards_jump_and_jitter() {
        let run = |kind, size| {
            let specs = [spec(kind, size)];
            let mut faults = Faults::new(specs.to_vec(), 0, false);
            [0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.25].map(|t| faults.clock(t, 0.25).steps)
        };
        let (one, two) = ([Some(0.25), None], [Some(0.25), Some(0.0)]);
        assert_eq!(
            run(FaultKind::TimeDuplicate, None),
            [one, two, two, two, two, one, one]
        );
        let back = [Some(-0.25), None];
        assert_eq!(
            run(FaultKind::TimeBackward, None),
            [one, back, back, back, back, one, one]
        );
        let (none, gap) = ([None; 2], [Some(1.25), None]);
        assert_eq!(
            run(FaultKind::TimeMissing, None),
            [one, none, none, none, none, gap, one]
        );
        let jittered = run(FaultKind::TimeJitter, Some(0.5));
        assert_eq!((jittered[0], jittered[5]), (one, one));
        let steps = jittered[1..5].iter().map(|s| s[0].unwrap());
        let steps: Vec<f64> = steps.collect();
        assert!(
            steps
                .iter()
                .all(|s| (0.125..=0.375).contains(s) && *s != 0.25)
        );
        assert!(steps[0] != steps[1]);
    }

    #[test]
    fn a_bit_flips_at_every_step() {
        let specs = [spec(FaultKind::MemoryBit, None)];
        let mut faults = Faults::new(specs.to_vec(), 0, false);
        let mut flips = |t| faults.clock(t, 0.25).flips;
        assert_eq!(flips(0.5), None);
        let (a, b) = (flips(1.0), flips(1.25));
        assert!(a.is_some() && b.is_some() && a != b);
        assert_eq!(flips(2.0), None);
    }

    #[test]
    fn in_a_plane_faults_stay_in_it() {
        let fresh = measured(1.5);
        let jump = told(FaultKind::PositionJump, Some(4.0), true).position - fresh.position;
        assert_eq!(jump, V3::new(4.0, 0.0, 4.0));
        let told_attitude = told(FaultKind::AttitudeOffset, Some(3.0), true).attitude;
        let turned = (fresh.attitude.inverse() * told_attitude).scaled_axis();
        assert!((turned - V3::new(0.0, 3.0_f64.to_radians(), 0.0)).norm() < 1e-12);
        let force = told(FaultKind::AccelerometerDrift, Some(2.0), true).specific_force;
        assert_eq!(force, Some(Frd::new(-10.0, 0.5, 2.5)));
    }
}
