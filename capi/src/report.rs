//! What a flight log needs of a step.

use alula::GuidanceOutput;
use alula::guidance::{AirUse, Mode, Phase, Unreachable};
use alula::spatial::{Command, Ned, Reference};

use crate::boundary::Layout;

/// The guidance gives the safe command.
pub const ALULA_MODE_SAFE: u32 = 0;
/// The guidance repeats the last command.
pub const ALULA_MODE_HOLDING: u32 = 1;
/// The law is flown.
pub const ALULA_MODE_FLYING: u32 = 2;

/// Flown without air data: with the last wind known, or calm; without a specific force slowly, and by plain thrust vectoring.
pub const ALULA_AIR_USE_NONE: u32 = 0;
/// Flown with the measured air velocity.
pub const ALULA_AIR_USE_VELOCITY: u32 = 1;
/// Flown with the wind given.
pub const ALULA_AIR_USE_WIND: u32 = 2;
/// Flown with the last wind known.
pub const ALULA_AIR_USE_HELD_WIND: u32 = 3;
/// Of the air: the airspeed along the nose, beside the wind given.
pub const ALULA_AIR_USE_PITOT: u32 = 4;

/// The reference is followed.
pub const ALULA_PHASE_TRACKING: u32 = 0;
/// A turn to an attitude far away, as across a fold.
pub const ALULA_PHASE_CROSSING: u32 = 1;
/// On the way to the reference with the thrust at a limit.
pub const ALULA_PHASE_COASTING: u32 = 2;
/// On the way back from far off the reference.
pub const ALULA_PHASE_RECOVERING: u32 = 3;

/// As far as the prediction shows, the reference can be had.
pub const ALULA_UNREACHABLE_NOTHING: u32 = 0;
/// The reference sinks more steeply than the vehicle can at that speed.
pub const ALULA_UNREACHABLE_SINK: u32 = 1;
/// The reference is slower than the vehicle can fly at that sink rate.
pub const ALULA_UNREACHABLE_SPEED: u32 = 2;
/// The reference asks for more thrust than there is.
pub const ALULA_UNREACHABLE_THRUST: u32 = 3;

// The core's numbers are these.
const _: () = {
    assert!(AirUse::None as u32 == ALULA_AIR_USE_NONE);
    assert!(AirUse::Velocity as u32 == ALULA_AIR_USE_VELOCITY);
    assert!(AirUse::Wind as u32 == ALULA_AIR_USE_WIND);
    assert!(AirUse::HeldWind as u32 == ALULA_AIR_USE_HELD_WIND);
    assert!(AirUse::Pitot as u32 == ALULA_AIR_USE_PITOT);
    assert!(Phase::Tracking as u32 == ALULA_PHASE_TRACKING);
    assert!(Phase::Crossing as u32 == ALULA_PHASE_CROSSING);
    assert!(Phase::Coasting as u32 == ALULA_PHASE_COASTING);
    assert!(Phase::Recovering as u32 == ALULA_PHASE_RECOVERING);
    assert!(Mode::Safe as u32 == ALULA_MODE_SAFE);
    assert!(Mode::Holding as u32 == ALULA_MODE_HOLDING);
    assert!(Mode::Flying as u32 == ALULA_MODE_FLYING);
    assert!(Unreachable::Sink as u32 == ALULA_UNREACHABLE_SINK);
    assert!(Unreachable::Speed as u32 == ALULA_UNREACHABLE_SPEED);
    assert!(Unreachable::Thrust as u32 == ALULA_UNREACHABLE_THRUST);
};

/// The quantities that a command is made of. What is not known is zero.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Report {
    /// `ALULA_HEADER(alula_report)`.
    pub header: u32,
    /// `ALULA_MODE_…`.
    pub mode: u32,
    /// `ALULA_AIR_USE_…`; of `alula_guide`.
    pub air_use: u32,
    /// `ALULA_PHASE_…`; of `alula_guide`.
    pub phase: u32,
    /// `ALULA_UNREACHABLE_…`; of `alula_guide`.
    pub unreachable: u32,
    /// Angle of attack \[rad\], in [−π, π].
    pub alpha: f32,
    /// Sideslip \[rad\], in [−π/2, π/2]: positive where the air velocity points to the right wing.
    pub sideslip: f32,
    /// Angle by which the wing is off the balance of lateral forces \[rad\], in (−π/2, π/2): positive where the force asked
    /// for leans to the right wing. The commanded rates bring it to zero.
    pub tilt: f32,
    /// Angle from the tail to the apparent external force in the plane of symmetry \[rad\], in (−π, π]: the angle by which
    /// the attitude still has to pitch.
    pub theta_tilde: f32,
    /// |F_p| \[N\]: how far the law is from losing its equilibrium.
    pub f_p_norm: f32,
    /// Thrust of the equivalent sphere \[N\].
    pub t_p: f32,
    /// Weight of the alignment term, 0 to 1.
    pub guard_alignment: f32,
    /// Weight of the feed-forward, 0 to 1.
    pub guard_feed_forward: f32,
    /// Velocity that the law was given to follow [m/s]: north, east, down.
    pub velocity: [f32; 3],
    /// Acceleration that the law was given to follow [m/s²]: north, east, down.
    pub acceleration: [f32; 3],
    /// |F_p| over tau: below 1 the guard acts, at 0 no attitude is an equilibrium. Of `alula_guide`.
    pub margin_force: f32,
    /// Gain k of the full law here: 1 on a sphere, large or negative where F_p turns with the attitude. Of `alula_guide`.
    pub margin_k: f32,
    /// Angle from the present attitude to the nearest fold \[rad\], to first order. Of `alula_guide`.
    pub margin_fold: f32,
}

// SAFETY: `repr(C)`, its first word is the header, and it holds nothing but u32 and f32.
unsafe impl Layout for Report {}

const fn array(Ned { north, east, down }: Ned) -> [f32; 3] {
    [north, east, down]
}

impl Report {
    /// Of a step of the bare law.
    #[inline(never)]
    pub(crate) fn of_law(reference: &Reference, command: &Command) -> Self {
        let d = &command.diagnostics;
        Self {
            header: Self::HEADER,
            mode: ALULA_MODE_FLYING,
            air_use: ALULA_AIR_USE_NONE,
            phase: ALULA_PHASE_TRACKING,
            unreachable: ALULA_UNREACHABLE_NOTHING,
            alpha: d.plane.alpha,
            sideslip: d.sideslip(),
            tilt: d.tilt(),
            theta_tilde: d.plane.theta_tilde(),
            f_p_norm: d.plane.f_p_norm,
            t_p: d.plane.t_p,
            guard_alignment: d.plane.guard_alignment,
            guard_feed_forward: d.plane.guard_feed_forward,
            velocity: array(reference.velocity),
            acceleration: array(reference.acceleration),
            margin_force: 0.0,
            margin_k: 0.0,
            margin_fold: 0.0,
        }
    }

    /// Of a step of the guidance.
    pub(crate) fn of_guidance(guided: &GuidanceOutput) -> Self {
        Self {
            mode: guided.mode as u32,
            air_use: guided.air as u32,
            phase: guided.progress.phase as u32,
            unreachable: guided
                .progress
                .unreachable
                .map_or(ALULA_UNREACHABLE_NOTHING, |reason| reason as u32),
            margin_force: guided.margin.force,
            margin_k: guided.margin.k,
            margin_fold: guided.margin.fold,
            ..Self::of_law(&guided.reference, &guided.command)
        }
    }
}
