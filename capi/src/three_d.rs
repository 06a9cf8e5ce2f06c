//! The step in the axes of the field: north-east-down world, forward-right-down body, in the vertical plane through a
//! heading.

use core::f32::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI, TAU};

use alula::control::{Air, AirUse, MAX_ACCELERATION, MAX_SPEED, Mode};
use alula::ned::{BodyAxes, Ned, Projection, Quaternion, VerticalPlane};
use alula::{Attitude, FeedForward, GuidanceInput, Guided, Inertial, Reference, State};

use crate::boundary::{self, Layout};
use crate::code;
use crate::controller::{Controller, Ready, ready, ready_mut};
use crate::plane::ALULA_FEED_FORWARD;

/// Body axes of a fixed wing: x along the nose, z to the belly. Hover is pitch 90°.
pub const ALULA_BODY_NOSE_FORWARD: u32 = 0;
/// Body axes of a multicopter: z along the tail, x to the belly. Hover is pitch 0, cruise is pitch −90°.
pub const ALULA_BODY_NOSE_UP: u32 = 1;

/// The attitude is given by `quaternion`.
pub const ALULA_ATTITUDE_QUATERNION: u32 = 0;
/// The attitude is given by `pitch`, without tilt and bank.
pub const ALULA_ATTITUDE_PITCH: u32 = 1;

/// Angles beyond this \[rad\] are refused: their sines would lose digits.
const MAX_ANGLE: f32 = 100.0;
/// Most that the attitude set-point leads the attitude by \[rad\].
const MAX_LEAD: f32 = FRAC_PI_2;

/// Flag of an input: `position_error` is to be used.
pub const ALULA_POSITION: u32 = 1 << 1;
/// Flag of an input: `air` is the velocity relative to the air, and not the wind.
pub const ALULA_AIR_VELOCITY: u32 = 1 << 2;
/// Flag of an input: nothing is known of the air, and `air` is not read.
pub const ALULA_AIR_UNKNOWN: u32 = 1 << 3;

/// State and reference in north-east-down world and forward-right-down body axes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct NedInput {
    /// `ALULA_HEADER(alula_ned_input)`.
    pub header: u32,
    /// Sum of `ALULA_FEED_FORWARD`, `ALULA_POSITION` and one of `ALULA_AIR_VELOCITY` and `ALULA_AIR_UNKNOWN`, or 0.
    pub flags: u32,
    /// Which body axes `quaternion` and `pitch` are of: `ALULA_BODY_NOSE_FORWARD` or `ALULA_BODY_NOSE_UP`.
    pub body_axes: u32,
    /// `ALULA_ATTITUDE_QUATERNION` or `ALULA_ATTITUDE_PITCH`. The other field is not read.
    pub attitude: u32,
    /// Heading of the vertical plane in which to fly \[rad\], from north towards east.
    pub heading: f32,
    /// Pitch \[rad\] of the body axes' x above the horizon, over the whole turn.
    pub pitch: f32,
    /// Attitude quaternion (w, x, y, z), from body to world.
    pub quaternion: [f32; 4],
    /// Velocity over ground [m/s]: north, east, down.
    pub velocity: [f32; 3],
    /// Wind [m/s], the velocity of the air over ground: north, east, down. With `ALULA_AIR_VELOCITY`: velocity relative to
    /// the air.
    pub air: [f32; 3],
    /// Reference velocity over ground [m/s]: north, east, down.
    pub reference_velocity: [f32; 3],
    /// Derivative of the reference velocity [m/s²]: north, east, down.
    pub reference_acceleration: [f32; 3],
    /// With `ALULA_FEED_FORWARD`, for the pure law: derivative of the air velocity [m/s²]: north, east, down.
    pub air_acceleration: [f32; 3],
    /// With `ALULA_FEED_FORWARD`, for the pure law: derivative of the reference acceleration [m/s³]: north, east, down.
    pub reference_jerk: [f32; 3],
    /// With `ALULA_POSITION`, for `alula_guide`: position less reference position \[m\]: north, east, down.
    pub position_error: [f32; 3],
    /// For `alula_guide`: age of velocity and attitude \[s\].
    pub state_age: f32,
    /// For `alula_guide`: age of the reference \[s\].
    pub reference_age: f32,
}

/// Command of one step as rate and thrust and as attitude and thrust, what the plane has lost, and how the command came
/// about.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct NedCommand {
    /// `ALULA_HEADER(alula_ned_command)`.
    pub header: u32,
    /// `ALULA_STATUS_…` bits.
    pub status: u32,
    /// Thrust along the nose \[N\]. From the pure law it is as the law asks for it: it may be negative, or above
    /// `thrust_max`.
    pub thrust: f32,
    /// Thrust over `thrust_max`, limited to [0, 1].
    pub thrust_normalised: f32,
    /// Body rate set-point [rad/s]: forward, right, down, in the input's body axes. It turns the aircraft in the plane;
    /// tilt and bank are the caller's to hold at zero.
    pub body_rate: [f32; 3],
    /// The same rate about the plane's normal, to the right [rad/s]: pitch rate, positive nose up.
    pub pitch_rate: f32,
    /// Attitude set-point \[rad\]: pitch of the input's body axes, in (−π, π], without tilt and bank.
    pub pitch: f32,
    /// The same set-point, with the heading, as a quaternion (w, x, y, z) from body to world.
    pub quaternion: [f32; 4],
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
    /// Angle from the tail to the apparent external force \[rad\], in (−π, π]: what the attitude has yet to turn.
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
}

/// The guidance gives the safe command.
pub const ALULA_MODE_SAFE: u32 = 0;
/// The guidance repeats the last command.
pub const ALULA_MODE_HOLDING: u32 = 1;
/// The guidance flies the law.
pub const ALULA_MODE_FLYING: u32 = 2;

/// Flown without air data: plain thrust vectoring.
pub const ALULA_AIR_USE_NONE: u32 = 0;
/// Flown with the measured air velocity.
pub const ALULA_AIR_USE_VELOCITY: u32 = 1;
/// Flown with the wind given.
pub const ALULA_AIR_USE_WIND: u32 = 2;
/// Flown with the last wind known.
pub const ALULA_AIR_USE_HELD_WIND: u32 = 3;

/// What a flight log wants to know of a step of the guidance.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct GuidanceReport {
    /// `ALULA_HEADER(alula_guidance_report)`.
    pub header: u32,
    /// `ALULA_MODE_…`.
    pub mode: u32,
    /// `ALULA_AIR_USE_…`.
    pub air_use: u32,
    /// Velocity that the law was given to follow [m/s]: north, east, down, in the plane.
    pub velocity: [f32; 3],
    /// Acceleration that the law was given to follow [m/s²]: north, east, down, in the plane.
    pub acceleration: [f32; 3],
    /// |F_p| over tau: below 1 the guard acts, at 0 no attitude is an equilibrium.
    pub margin_force: f32,
    /// Gain k of the full law here: 1 on a sphere, large or negative where F_p turns with the attitude.
    pub margin_k: f32,
    /// Angle from the present attitude to the nearest fold \[rad\], to first order.
    pub margin_fold: f32,
}

impl GuidanceReport {
    fn new(guided: &Guided, plane: &VerticalPlane) -> Self {
        let lift = |v| {
            let Ned { north, east, down } = plane.lift(v, 0.0);
            [north, east, down].map(known)
        };
        Self {
            header: Self::HEADER,
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
            velocity: lift(guided.reference.velocity),
            acceleration: lift(guided.reference.acceleration),
            margin_force: guided.margin.force,
            margin_k: guided.margin.k,
            margin_fold: guided.margin.fold,
        }
    }
}

// SAFETY: `repr(C)`, header first, numbers only.
unsafe impl Layout for GuidanceReport {}

impl NedInput {
    /// Hovering still in still air, nose up by pitch 90° of fixed-wing axes, heading north, asked to stay.
    pub const DEFAULT: Self = Self {
        header: Self::HEADER,
        flags: 0,
        body_axes: ALULA_BODY_NOSE_FORWARD,
        attitude: ALULA_ATTITUDE_QUATERNION,
        heading: 0.0,
        pitch: FRAC_PI_2,
        quaternion: [FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2, 0.0],
        velocity: [0.0; 3],
        air: [0.0; 3],
        reference_velocity: [0.0; 3],
        reference_acceleration: [0.0; 3],
        air_acceleration: [0.0; 3],
        reference_jerk: [0.0; 3],
        position_error: [0.0; 3],
        state_age: 0.0,
        reference_age: 0.0,
    };
}

impl NedCommand {
    /// The safe command: no thrust, no rotation, and body axes aligned with north, east and down.
    pub const SAFE: Self = Self {
        header: Self::HEADER,
        status: code::ALULA_STATUS_SAFE,
        thrust: 0.0,
        thrust_normalised: 0.0,
        body_rate: [0.0; 3],
        pitch_rate: 0.0,
        pitch: 0.0,
        quaternion: [1.0, 0.0, 0.0, 0.0],
        lateral_velocity: 0.0,
        lateral_air: 0.0,
        lateral_reference_velocity: 0.0,
        lateral_reference_acceleration: 0.0,
        tilt: 0.0,
        bank: 0.0,
        alpha: 0.0,
        theta_tilde: 0.0,
        f_p_norm: 0.0,
        t_p: 0.0,
        guard_alignment: 0.0,
        guard_feed_forward: 0.0,
        k: 0.0,
    };
}

// SAFETY: `repr(C)`, header first, numbers only.
unsafe impl Layout for NedInput {}
// SAFETY: as above.
unsafe impl Layout for NedCommand {}

fn ned(v: [f32; 3]) -> Ned {
    Ned::new(v[0], v[1], v[2])
}

/// Whether `angle` is a number, and of a size that is meant.
fn in_range(angle: f32) -> bool {
    angle.abs() <= MAX_ANGLE
}

/// An input's state and reference, seen in its plane; what has no number there is not a number.
pub(crate) struct Seen {
    axes: BodyAxes,
    pub plane: VerticalPlane,
    projection: Projection,
    velocity: Inertial,
    air: Inertial,
    pub reference: Reference,
    lateral_velocity: f32,
    lateral_air: f32,
    lateral_reference_velocity: f32,
    lateral_reference_acceleration: f32,
}

impl Seen {
    /// # Errors
    /// A selector that has no such value. Numbers are not checked here.
    pub fn new(input: &NedInput) -> Result<Self, i32> {
        const FLAGS: u32 =
            ALULA_FEED_FORWARD | ALULA_POSITION | ALULA_AIR_VELOCITY | ALULA_AIR_UNKNOWN;
        const AIR: u32 = ALULA_AIR_VELOCITY | ALULA_AIR_UNKNOWN;
        if input.flags & !FLAGS != 0 || input.flags & AIR == AIR {
            return Err(code::ALULA_ERROR_SELECTOR);
        }
        let axes = match input.body_axes {
            ALULA_BODY_NOSE_FORWARD => BodyAxes::NoseForward,
            ALULA_BODY_NOSE_UP => BodyAxes::NoseUp,
            _ => return Err(code::ALULA_ERROR_SELECTOR),
        };
        let heading = if in_range(input.heading) {
            input.heading
        } else {
            f32::NAN
        };
        let plane = VerticalPlane::from_heading(heading);
        let pitched = |attitude| Projection {
            attitude,
            tilt: 0.0,
            bank: 0.0,
            normal: [0.0, 1.0, 0.0],
        };
        const NO_ATTITUDE: Attitude = Attitude {
            cos: f32::NAN,
            sin: f32::NAN,
        };
        let projection = match input.attitude {
            ALULA_ATTITUDE_QUATERNION => {
                let [w, x, y, z] = input.quaternion;
                let projection = plane.attitude(&Quaternion { w, x, y, z }, axes);
                projection.unwrap_or(pitched(NO_ATTITUDE))
            }
            ALULA_ATTITUDE_PITCH if in_range(input.pitch) => pitched(axes.attitude(input.pitch)),
            ALULA_ATTITUDE_PITCH => pitched(NO_ATTITUDE),
            _ => return Err(code::ALULA_ERROR_SELECTOR),
        };
        let project = |v| plane.project(ned(v));
        let (velocity, lateral_velocity) = project(input.velocity);
        let (air, lateral_air) = project(input.air);
        let (reference_velocity, lateral_reference_velocity) = project(input.reference_velocity);
        let (acceleration, lateral_reference_acceleration) = project(input.reference_acceleration);
        Ok(Self {
            axes,
            plane,
            projection,
            velocity,
            air,
            reference: Reference {
                velocity: reference_velocity,
                acceleration,
            },
            lateral_velocity,
            lateral_air,
            lateral_reference_velocity,
            lateral_reference_acceleration,
        })
    }

    /// The state, with the wind known.
    ///
    /// # Errors
    /// The code of whatever the law will not see: a heading that is none, or a component across the plane that is none
    /// or absurd; and of an unknown wind.
    pub fn state(&self, input: &NedInput) -> Result<State, i32> {
        if !in_range(input.heading) {
            return Err(code::ALULA_ERROR_HEADING);
        }
        let (wind, lateral_wind) = match input.flags & (ALULA_AIR_VELOCITY | ALULA_AIR_UNKNOWN) {
            0 => (self.air, self.lateral_air),
            ALULA_AIR_VELOCITY => (
                self.velocity - self.air,
                self.lateral_velocity - self.lateral_air,
            ),
            _ => return Err(code::ALULA_ERROR_WIND),
        };
        let ok = |v: f32, max, code| if v.abs() <= max { Ok(()) } else { Err(code) };
        ok(self.lateral_velocity, MAX_SPEED, code::ALULA_ERROR_VELOCITY)?;
        ok(lateral_wind, MAX_SPEED, code::ALULA_ERROR_WIND)?;
        ok(
            self.lateral_reference_velocity,
            MAX_SPEED,
            code::ALULA_ERROR_REFERENCE_VELOCITY,
        )?;
        ok(
            self.lateral_reference_acceleration,
            MAX_ACCELERATION,
            code::ALULA_ERROR_REFERENCE_ACCELERATION,
        )?;
        Ok(State {
            velocity: self.velocity,
            attitude: self.projection.attitude,
            wind,
        })
    }
}

/// `value`, or 0 if it is not a number.
fn known(value: f32) -> f32 {
    if value.is_finite() { value } else { 0.0 }
}

impl Ready {
    /// One step of the pure law.
    fn step_ned(&self, input: &NedInput, dt: f32) -> Result<NedCommand, i32> {
        let seen = Seen::new(input)?;
        let state = seen.state(input)?;
        let feed_forward = (input.flags & ALULA_FEED_FORWARD != 0).then(|| FeedForward {
            air_acceleration: seen.plane.project(ned(input.air_acceleration)).0,
            jerk: seen.plane.project(ned(input.reference_jerk)).0,
        });
        let command = self.law(&state, &seen.reference, feed_forward.as_ref(), dt)?;
        Ok(self.command(&seen, &command))
    }

    /// A step of the guidance, which always gives a command, and why it refused the input, if it did.
    fn guide(
        &mut self,
        input: &NedInput,
        dt: f32,
    ) -> Result<(NedCommand, GuidanceReport, i32), i32> {
        let seen = Seen::new(input)?;
        let air = match input.flags & (ALULA_AIR_VELOCITY | ALULA_AIR_UNKNOWN) {
            0 => Air::Wind(seen.air),
            ALULA_AIR_VELOCITY => Air::Velocity(seen.air),
            _ => Air::Unknown,
        };
        let position = seen.plane.project(ned(input.position_error)).0;
        let guided = self.guidance.update(
            &mut self.state,
            &GuidanceInput {
                velocity: seen.velocity,
                attitude: seen.projection.attitude,
                state_age: input.state_age,
                air,
                position_error: (input.flags & ALULA_POSITION != 0).then_some(position),
                reference: seen.reference,
                reference_age: input.reference_age,
            },
            dt,
        );
        let code = match guided.refusal {
            None => code::ALULA_OK,
            Some(_) if !in_range(input.heading) => code::ALULA_ERROR_HEADING,
            Some(refusal) => code::of_refusal(refusal),
        };
        let mut command = self.command(&seen, &guided.command);
        // The limits that were met, and not those that would have been.
        command.status &= code::ALULA_STATUS_LEAD_LIMITED;
        command.status |= u32::from(guided.status.bits())
            | match guided.mode {
                Mode::Flying => 0,
                Mode::Holding => code::ALULA_STATUS_HOLDING,
                Mode::Safe => code::ALULA_STATUS_SAFE,
            };
        Ok((command, GuidanceReport::new(&guided, &seen.plane), code))
    }

    /// Normalised thrust of a command, and the status bit of what is cut off.
    fn normalise(&self, command: &alula::Command) -> (f32, u32) {
        let share = command.thrust * self.inverse_thrust_max;
        if share < 0.0 {
            (0.0, code::ALULA_STATUS_THRUST_LOW)
        } else if share > 1.0 {
            (1.0, code::ALULA_STATUS_THRUST_HIGH)
        } else {
            (share, 0)
        }
    }

    /// A command in the axes of what was seen. What was not a number is given as no angle and no velocity.
    fn command(&self, seen: &Seen, command: &alula::Command) -> NedCommand {
        let (thrust_normalised, status) = self.normalise(command);
        let d = &command.diagnostics;
        let present = known(seen.axes.pitch(seen.projection.attitude));
        let (pitch, limited) = self.lead(present, command.rate);
        let Quaternion { w, x, y, z } = seen.plane.quaternion(pitch);
        let quaternion = if w.is_finite() {
            [w, x, y, z]
        } else {
            NedCommand::SAFE.quaternion
        };
        NedCommand {
            header: NedCommand::HEADER,
            status: status | limited,
            thrust: command.thrust,
            thrust_normalised,
            body_rate: seen.projection.normal.map(|n| n * command.rate),
            pitch_rate: command.rate,
            pitch,
            quaternion,
            lateral_velocity: known(seen.lateral_velocity),
            lateral_air: known(seen.lateral_air),
            lateral_reference_velocity: known(seen.lateral_reference_velocity),
            lateral_reference_acceleration: known(seen.lateral_reference_acceleration),
            tilt: seen.projection.tilt,
            bank: seen.projection.bank,
            alpha: d.alpha,
            theta_tilde: d.theta_tilde(),
            f_p_norm: d.f_p_norm,
            t_p: d.t_p,
            guard_alignment: d.guard_alignment,
            guard_feed_forward: d.guard_feed_forward,
            k: d.k,
        }
    }

    /// The pitch set-point at which an attitude loop at `pitch` asks for `rate`, and its status bit.
    fn lead(&self, pitch: f32, rate: f32) -> (f32, u32) {
        let lead = rate * self.inverse_attitude_gain;
        let (lead, limited) = if lead.abs() > MAX_LEAD {
            (MAX_LEAD.copysign(lead), code::ALULA_STATUS_LEAD_LIMITED)
        } else {
            (lead, 0)
        };
        let pitch = pitch + lead;
        let pitch = if pitch > PI {
            pitch - TAU
        } else if pitch <= -PI {
            pitch + TAU
        } else {
            pitch
        };
        (pitch, limited)
    }
}

/// One step of the pure law in the vertical plane through the input's heading: from `input` to `command`, `dt` seconds
/// after the last. The law has no memory and no limits: `dt` is only checked. Whatever is returned but `ALULA_OK`, the
/// command is the safe one; unless it is `command` itself that is at fault, which is then left alone.
///
/// # Safety
/// As `alula_step`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_step_ned(
    controller: *const Controller,
    input: *const NedInput,
    dt: f32,
    command: *mut NedCommand,
) -> i32 {
    // SAFETY: the caller's word.
    unsafe {
        boundary::answer(command, NedCommand::SAFE, || {
            ready(controller)?.step_ned(boundary::read(input)?, dt)
        })
    }
}

/// One step of the guidance: supervision, reference limit, outer loop, law and actuator limits. It always gives a
/// command. If the return code says that the input was refused, the command is the last one flown, for as long as
/// `hold` (`ALULA_STATUS_HOLDING`), and then the safe one: `safe_thrust`, no rotation (`ALULA_STATUS_SAFE`). If it is a
/// pointer, a header, the controller or a selector that is at fault, there was no step, and the command is that of
/// `alula_ned_command_default`. `report` may be null.
///
/// # Safety
/// As `alula_step`, and no other call reads the controller meanwhile either.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_guide(
    controller: *mut Controller,
    input: *const NedInput,
    dt: f32,
    command: *mut NedCommand,
    report: *mut GuidanceReport,
) -> i32 {
    let mut refusal = code::ALULA_OK;
    // SAFETY: the caller's word.
    let code = unsafe {
        boundary::answer(command, NedCommand::SAFE, || {
            if !report.is_null() {
                boundary::check(report)?;
            }
            let (command, value, code) =
                ready_mut(controller)?.guide(boundary::read(input)?, dt)?;
            refusal = code;
            if !report.is_null() {
                report.write(value);
            }
            Ok(command)
        })
    };
    if code == code::ALULA_OK {
        refusal
    } else {
        code
    }
}

/// Fills in an input that hovers still in still air, heading north, and is asked to stay.
///
/// # Safety
/// As `alula_input_default`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_ned_input_default(input: *mut NedInput) -> i32 {
    // SAFETY: the caller's word.
    unsafe { boundary::write(input, NedInput::DEFAULT) }
}

/// Fills in the safe command.
///
/// # Safety
/// As `alula_input_default`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_ned_command_default(command: *mut NedCommand) -> i32 {
    // SAFETY: the caller's word.
    unsafe { boundary::write(command, NedCommand::SAFE) }
}
