//! Faults of what the controller is told, of its clock, and of its memory.

use std::ops::{Add, Mul, Sub};

use alula::guidance::Air;
use rand::{Rng, RngExt};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use super::document::{FieldError, finite, require, sensor_error};

/// What is wrong while a fault lasts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
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
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
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
pub(crate) struct Clock {
    /// The time steps \[s\] with which it is asked, one after the other; none if it is not asked.
    pub steps: [Option<f64>; 2],
    /// A bit of its memory that flips before.
    pub flips: Option<u64>,
}

/// What sensors tell, and faults of sensors change.
pub(crate) trait Told: Copy {
    /// What is told under `fault`.
    fn distort(&mut self, fault: &Lasting<Self>);
}

/// A fault that lasts.
pub(crate) struct Lasting<M> {
    pub kind: FaultKind,
    /// What was measured when it began.
    pub first: M,
    /// Its size, or 0.
    pub size: f64,
    /// Its size times the seconds since it began.
    pub drift: f64,
}

impl<M> Lasting<M> {
    /// What is told of the `air` under this fault. When the fault began, it was `first`, and the ground velocity `velocity`; a drift has
    /// come to `off` \[m/s\].
    pub fn air<V>(&self, air: Air<V>, first: Air<V>, velocity: V, off: V) -> Air<V>
    where
        V: Add<Output = V> + Sub<Output = V> + Mul<f32, Output = V>,
    {
        match (self.kind, air, first) {
            (FaultKind::AirFrozen, _, first) => first,
            (FaultKind::WindStuck, _, Air::Velocity(first)) => Air::Wind(velocity - first),
            (FaultKind::AirDrift, Air::Velocity(air), _) => Air::Velocity(air + off),
            (FaultKind::AirScale, Air::Velocity(air), _) => {
                Air::Velocity(air * (1.0 + self.size) as f32)
            }
            (_, air, _) => air,
        }
    }

    /// What is told of the specific `force` under this fault. When the fault began, it was `first`; a drift has come to `off` \[m/s²\].
    pub fn force<F>(&self, force: Option<F>, first: Option<F>, off: F) -> Option<F>
    where
        F: Default + Add<Output = F>,
    {
        match self.kind {
            FaultKind::Accelerometer => None,
            FaultKind::AccelerometerDead => force.map(|_| F::default()),
            FaultKind::AccelerometerFrozen => first,
            FaultKind::AccelerometerDrift => force.map(|f| f + off),
            _ => force,
        }
    }
}

/// The faults of a flight, as far as it has come.
pub(crate) struct Faults<'a, M> {
    specs: &'a [FaultSpec],
    /// What was measured when each began.
    begun: Vec<Option<M>>,
    /// Time \[s\] since the controller was asked last, before this step.
    waited: f64,
    random: ChaCha8Rng,
}

impl<'a, M: Told> Faults<'a, M> {
    /// None has begun. `seed` is the experiment's; no other part of the flight draws from this `stream` of it.
    pub fn new(specs: &'a [FaultSpec], seed: u64, stream: u64) -> Self {
        Self {
            specs,
            begun: vec![None; specs.len()],
            waited: 0.0,
            random: super::stream(seed, stream),
        }
    }

    /// Whether a fault of this kind lasts at `t` \[s\].
    pub fn lasts(&self, kind: FaultKind, t: f64) -> bool {
        self.specs.iter().any(|f| f.kind == kind && f.lasts(t))
    }

    /// What the sensors say at `t` \[s\] of what was `measured`.
    pub fn distort(&mut self, t: f64, measured: M) -> M {
        let mut told = measured;
        for (fault, begun) in self.specs.iter().zip(&mut self.begun) {
            if !fault.lasts(t) {
                continue;
            }
            let size = fault.size.unwrap_or(0.0);
            told.distort(&Lasting {
                kind: fault.kind,
                first: *begun.get_or_insert(measured),
                size,
                drift: size * (t - fault.from_s),
            });
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
    use super::super::sensors::Measured;
    use super::*;
    use crate::reference::Vector;
    use alula::Inertial;

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
        let faults = Faults::<Measured>::new(&specs, 0, 2);
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

    /// Measured at `t` on a flight along the sum of all axes.
    fn measured(t: f64) -> Measured {
        Measured {
            velocity: Vector::new(t, 10.0 + t),
            position: Vector::new(0.0, 10.0 * t),
            theta: 0.1 * t,
            air: Air::Velocity(Inertial::new(t as f32, 8.0 + t as f32)),
            specific_force: None,
        }
    }

    #[test]
    fn sensors_freeze_drift_and_jump() {
        let told = |kind, size| {
            let specs = [spec(kind, size)];
            let mut faults = Faults::new(&specs, 0, 2);
            let at = |t, faults: &mut Faults<Measured>| faults.distort(t, measured(t));
            // As it is before, and again afterwards.
            assert_eq!(at(0.5, &mut faults), measured(0.5), "{kind:?}");
            at(1.0, &mut faults);
            let during = at(1.5, &mut faults);
            assert_eq!(at(2.0, &mut faults), measured(2.0), "{kind:?}");
            during
        };
        let (first, fresh) = (measured(1.0), measured(1.5));
        assert_eq!(told(FaultKind::AirFrozen, None).air, first.air);
        // The wind is 2 m/s; that it is told is what differs.
        let wind = Air::Wind(Inertial::new(0.0, 2.0));
        assert_eq!(told(FaultKind::WindStuck, None).air, wind);
        let frozen = told(FaultKind::VelocityFrozen, None);
        assert_eq!(
            (frozen.velocity, frozen.theta),
            (first.velocity, fresh.theta)
        );
        assert_eq!(told(FaultKind::AttitudeFrozen, None).theta, first.theta);
        let off = told(FaultKind::AttitudeOffset, Some(10.0)).theta - fresh.theta;
        assert!((off.to_degrees() - 10.0).abs() < 1e-9);
        let off = told(FaultKind::AttitudeDrift, Some(10.0)).theta - fresh.theta;
        assert!((off.to_degrees() - 5.0).abs() < 1e-9);
        let off = told(FaultKind::PositionJump, Some(4.0)).position - fresh.position;
        assert_eq!(off, Vector::new(4.0, 4.0));
        let off = told(FaultKind::PositionDrift, Some(4.0)).position - fresh.position;
        assert_eq!(off, Vector::new(2.0, 2.0));
        let off = told(FaultKind::VelocityDrift, Some(-2.0)).velocity - fresh.velocity;
        assert_eq!(off, Vector::new(-1.0, -1.0));
        let scaled = Air::Velocity(Inertial::new(0.75, 4.75));
        assert_eq!(told(FaultKind::AirScale, Some(-0.5)).air, scaled);
        let drifted = Air::Velocity(Inertial::new(2.5, 10.5));
        assert_eq!(told(FaultKind::AirDrift, Some(2.0)).air, drifted);
    }

    #[test]
    fn clocks_stand_still_run_backwards_jump_and_jitter() {
        let run = |kind, size| {
            let specs = [spec(kind, size)];
            let mut faults = Faults::<Measured>::new(&specs, 0, 2);
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
        let mut faults = Faults::<Measured>::new(&specs, 0, 2);
        let mut flips = |t| faults.clock(t, 0.25).flips;
        assert_eq!(flips(0.5), None);
        let (a, b) = (flips(1.0), flips(1.25));
        assert!(a.is_some() && b.is_some() && a != b);
        assert_eq!(flips(2.0), None);
    }
}
