//! What a flight log needs of a step, in the axes of autopilots.

use alula::guidance::{AirUse, Mode};
use alula::ned::{Ned, VerticalPlane};
use alula::{Command, Guided, Inertial};

use crate::boundary::Layout;
use crate::ned_input::PlanarInput;

/// The guidance gives the safe command.
pub const ALULA_MODE_SAFE: u32 = 0;
/// The guidance repeats the last command.
pub const ALULA_MODE_HOLDING: u32 = 1;
/// The law is flown.
pub const ALULA_MODE_FLYING: u32 = 2;

/// Flown without air data: plain thrust vectoring.
pub const ALULA_AIR_USE_NONE: u32 = 0;
/// Flown with the measured air velocity.
pub const ALULA_AIR_USE_VELOCITY: u32 = 1;
/// Flown with the wind given.
pub const ALULA_AIR_USE_WIND: u32 = 2;
/// Flown with the last wind known.
pub const ALULA_AIR_USE_HELD_WIND: u32 = 3;

/// The quantities that a command is made of, and what the projection on the vertical plane has lost of the input. What is
/// not known is zero.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct NedReport {
    /// `ALULA_HEADER(alula_ned_report)`.
    pub header: u32,
    /// `ALULA_MODE_…`.
    pub mode: u32,
    /// `ALULA_AIR_USE_…`; of `alula_guide`.
    pub air_use: u32,
    /// Lost by the plane: velocity across it, to the right [m/s].
    pub lateral_velocity: f32,
    /// Lost by the plane: the input's `air` across it, to the right [m/s].
    pub lateral_air: f32,
    /// Lost by the plane: reference velocity across it, to the right [m/s].
    pub lateral_reference_velocity: f32,
    /// Lost by the plane: reference acceleration across it, to the right [m/s²].
    pub lateral_reference_acceleration: f32,
    /// Lost by the plane: angle of the nose out of it \[rad\], to the right.
    pub tilt: f32,
    /// Lost by the plane: angle about the nose \[rad\], right wing towards the belly side.
    pub bank: f32,
    /// Angle of attack \[rad\], in [−π, π].
    pub alpha: f32,
    /// Angle from the tail to the apparent external force \[rad\], in (−π, π]: the angle by which the attitude still has to turn.
    pub theta_tilde: f32,
    /// |F_p| \[N\]: how far the law is from losing its equilibrium.
    pub f_p_norm: f32,
    /// Thrust of the equivalent sphere \[N\].
    pub t_p: f32,
    /// Weight of the alignment term, 0 to 1.
    pub guard_alignment: f32,
    /// Weight of the feed-forward, 0 to 1.
    pub guard_feed_forward: f32,
    /// Gain k of the full law; 1 in the robust law.
    pub k: f32,
    /// Velocity that the law was given to follow [m/s]: north, east, down, in the plane.
    pub velocity: [f32; 3],
    /// Acceleration that the law was given to follow [m/s²]: north, east, down, in the plane.
    pub acceleration: [f32; 3],
    /// |F_p| over tau: below 1 the guard acts, at 0 no attitude is an equilibrium. Of `alula_guide`.
    pub margin_force: f32,
    /// Gain k of the full law here: 1 on a sphere, large or negative where F_p turns with the attitude. Of `alula_guide`.
    pub margin_k: f32,
    /// Angle from the present attitude to the nearest fold \[rad\], to first order. Of `alula_guide`.
    pub margin_fold: f32,
}

// SAFETY: `repr(C)`, its first word is the header, and it holds nothing but u32 and f32.
unsafe impl Layout for NedReport {}

/// `value`, or 0 if it is not finite.
fn known(value: f32) -> f32 {
    if value.is_finite() { value } else { 0.0 }
}

/// The vector in the plane, by its components north, east and down.
fn lifted(plane: &VerticalPlane, v: Inertial) -> [f32; 3] {
    let Ned { north, east, down } = plane.lift(v, 0.0);
    [north, east, down].map(known)
}

impl NedReport {
    /// Of a step of the pure law.
    #[inline(never)]
    pub(crate) fn of_law(planar: &PlanarInput, command: &Command) -> Self {
        let d = &command.diagnostics;
        let (tilt, bank) = planar.projection.tilt_and_bank(planar.axes);
        Self {
            header: Self::HEADER,
            mode: ALULA_MODE_FLYING,
            air_use: ALULA_AIR_USE_NONE,
            lateral_velocity: known(planar.lateral_velocity),
            lateral_air: known(planar.lateral_air),
            lateral_reference_velocity: known(planar.lateral_reference_velocity),
            lateral_reference_acceleration: known(planar.lateral_reference_acceleration),
            tilt,
            bank,
            alpha: d.alpha,
            theta_tilde: d.theta_tilde(),
            f_p_norm: d.f_p_norm,
            t_p: d.t_p,
            guard_alignment: d.guard_alignment,
            guard_feed_forward: d.guard_feed_forward,
            k: d.k,
            velocity: lifted(&planar.plane, planar.reference.velocity),
            acceleration: lifted(&planar.plane, planar.reference.acceleration),
            margin_force: 0.0,
            margin_k: 0.0,
            margin_fold: 0.0,
        }
    }

    /// Of a step of the guidance.
    pub(crate) fn of_guidance(planar: &PlanarInput, guided: &Guided) -> Self {
        Self {
            mode: match guided.mode {
                Mode::Safe => ALULA_MODE_SAFE,
                Mode::Holding => ALULA_MODE_HOLDING,
                Mode::Flying => ALULA_MODE_FLYING,
            },
            air_use: match guided.air {
                AirUse::None => ALULA_AIR_USE_NONE,
                AirUse::Velocity => ALULA_AIR_USE_VELOCITY,
                AirUse::Wind => ALULA_AIR_USE_WIND,
                AirUse::HeldWind => ALULA_AIR_USE_HELD_WIND,
            },
            velocity: lifted(&planar.plane, guided.reference.velocity),
            acceleration: lifted(&planar.plane, guided.reference.acceleration),
            margin_force: guided.margin.force,
            margin_k: guided.margin.k,
            margin_fold: guided.margin.fold,
            ..Self::of_law(planar, &guided.command)
        }
    }
}
