//! The velocity laws: robust (`eq:inputsVCeR`) and full (`lawsVGen`).

use super::command::{
    Command, Diagnostics, Fault, FeedForward, Reference, State, check_feed_forward, check_input,
    check_output,
};
use super::feed_forward::f_delta;
use super::gains::Gains;
use crate::aero::Aerodynamics;
use crate::equivalency::{ApparentForces, condition_residual};
use crate::frame::Body;
use crate::vehicle::Vehicle;

/// Velocity control of a vehicle: stateless, immutable, total.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct VelocityControl<A> {
    vehicle: Vehicle<A>,
    gains: Gains,
}

/// What both laws start from.
struct Step {
    forces: ApparentForces,
    /// Velocity error ṽ = Rᵀ(v − v_r) [m/s].
    error: Body,
    /// |F_p| \[N\].
    norm: f32,
    /// (|F_p| + F̄_p1)² [N²].
    alignment_squared: f32,
}

impl<A: Aerodynamics> VelocityControl<A> {
    /// Control of what `vehicle` is believed to be, with these gains.
    pub fn new(vehicle: Vehicle<A>, gains: Gains) -> Self {
        Self { vehicle, gains }
    }

    /// The vehicle as the controller believes it to be.
    pub fn vehicle(&self) -> &Vehicle<A> {
        &self.vehicle
    }

    /// The gains.
    pub fn gains(&self) -> &Gains {
        &self.gains
    }

    /// The robust law (`eq:inputsVCeR`): defined everywhere, also at F_p = 0 and at θ̃ = π.
    ///
    /// Without feed-forward F_δ = 0, as in the paper's simulation.
    ///
    /// # Errors
    /// A [`Fault`] that names the input that is not finite or absurd. The safe command is `Command::default()`.
    #[inline]
    pub fn robust(
        &self,
        state: &State,
        reference: &Reference,
        feed_forward: Option<&FeedForward>,
    ) -> Result<Command, Fault> {
        let step = self.step(state, reference)?;
        let Step { forces, norm, .. } = &step;
        let alignment = self.gains.guard.over_square(step.alignment_squared);
        let mut rate = norm * (self.gains.k2 * step.error.j())
            + (self.gains.k3 * norm) * (forces.f_p.j() * alignment);
        let mut guard_feed_forward = 0.0;
        if let Some(ff) = feed_forward {
            check_feed_forward(ff)?;
            let norm_squared = norm * norm;
            let over = self.gains.guard.over_square(norm_squared);
            rate -= over * self.cross_f_delta(forces, state, ff);
            guard_feed_forward = over * norm_squared;
        }
        let guard_alignment = alignment * step.alignment_squared;
        check_output(self.command(&step, rate, guard_alignment, guard_feed_forward, 1.0))
    }

    /// The full law (`lawsVGen`), with the gain k (`eq:kv`).
    ///
    /// Without feed-forward F_δ = 0.
    ///
    /// # Errors
    /// As [`robust`](Self::robust); and [`Fault::Undefined`] where the law divides by zero: at F_p = 0, at θ̃ = π
    /// and where 1/k = 0.
    #[inline]
    pub fn full(
        &self,
        state: &State,
        reference: &Reference,
        feed_forward: Option<&FeedForward>,
    ) -> Result<Command, Fault> {
        let step = self.step(state, reference)?;
        let Step { forces, norm, .. } = &step;
        let norm_squared = norm * norm;
        // c̄_D' cos(α+δ) − c̄_L' sin(α+δ) is the residual of eq:condition.
        let h = condition_residual(&forces.coefficients, &forces.air);
        let k = norm_squared / (norm_squared + forces.pressure * (forces.f.j() * h));
        let mut rate = norm * (self.gains.k2 * step.error.j())
            + (self.gains.k3 * norm) * (forces.f_p.j() / step.alignment_squared);
        if let Some(ff) = feed_forward {
            check_feed_forward(ff)?;
            rate -= self.cross_f_delta(forces, state, ff) / norm_squared;
        }
        check_output(self.command(&step, k * rate, 1.0, 1.0, k))
    }

    #[inline(always)]
    fn step(&self, state: &State, reference: &Reference) -> Result<Step, Fault> {
        check_input(state, reference)?;
        let forces = ApparentForces::new(
            &self.vehicle,
            state.attitude,
            state.velocity - state.wind,
            reference.acceleration,
        );
        let norm = forces.f_p.norm();
        let (along, across) = (forces.f_p.i(), forces.f_p.j());
        // |F_p| + F̄_p1, which cancels near θ̃ = π, is F̄_p2²/(|F_p| − F̄_p1).
        let sum = norm + along.abs();
        let alignment = if along < 0.0 {
            across * across / sum
        } else {
            sum
        };
        Ok(Step {
            forces,
            error: state.attitude.to_body(state.velocity - reference.velocity),
            norm,
            alignment_squared: alignment * alignment,
        })
    }

    /// F̄_pᵀ S Rᵀ F_δ [N²/s].
    #[inline(always)]
    fn cross_f_delta(&self, forces: &ApparentForces, state: &State, ff: &FeedForward) -> f32 {
        let (mass, k_a) = (self.vehicle.mass(), self.vehicle.k_a());
        let f = f_delta(forces, mass, k_a, state.attitude, ff);
        forces.f_p.j() * f.i() - forces.f_p.i() * f.j()
    }

    #[inline(always)]
    fn command(
        &self,
        step: &Step,
        rate: f32,
        guard_alignment: f32,
        guard_feed_forward: f32,
        k: f32,
    ) -> Command {
        let forces = &step.forces;
        let push = (self.gains.k1 * step.norm) * step.error.i();
        Command {
            thrust: forces.f.i() + push,
            rate,
            diagnostics: Diagnostics {
                alpha: forces.air.alpha.rad,
                f_p: forces.f_p,
                f_p_norm: step.norm,
                t_p: forces.f_p.i() + push,
                guard_alignment,
                guard_feed_forward,
                k,
            },
        }
    }
}
