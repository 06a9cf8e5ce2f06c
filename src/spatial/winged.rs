//! The law of the winged vehicle: the planar law in the plane of symmetry, tilt and twist across it.

use super::command::{
    Command, Diagnostics, FeedForward, Reference, State, check_feed_forward, check_input,
    check_output,
};
use super::lateral::{LateralGains, LateralInput};
use super::vector::Body;
use super::vehicle::WingedVehicle;
use crate::aero::Aerodynamics;
use crate::air::AirData;
use crate::branch::Branch;
use crate::control::feed_forward::f_delta_in_plane;
use crate::control::{Fault, GainLaw, Gains, Margin, VelocityControl};
use crate::equivalency::{ApparentForces, condition_residual};
use crate::math;
use crate::ned::Ned;

/// Velocity control of a winged vehicle in space: stateless, immutable, total.
///
/// In the plane of symmetry it is [`VelocityControl`], unchanged; see [`LateralParameters`](super::LateralParameters)
/// for the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct WingedControl<A, G = Gains> {
    plane: VelocityControl<A, G>,
    /// k_a c_Y [kg/m].
    side: f32,
    lateral: LateralGains,
}

/// A step's vectors in body components.
struct Seen {
    /// Air velocity.
    v_a: Body,
    /// |v_a|.
    airspeed: f32,
    /// Apparent weight, corrected.
    weight: Body,
    /// Velocity error.
    error: Body,
    /// What the planar law sees.
    forces: ApparentForces,
}

/// Which planar law.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Law {
    Robust,
    Full,
}

impl<A: Aerodynamics, G: GainLaw> WingedControl<A, G> {
    /// Control of what `vehicle` is believed to be, with these gains in the plane of symmetry and across it.
    pub fn new(vehicle: WingedVehicle<A>, gains: G, lateral: LateralGains) -> Self {
        let side = vehicle.side();
        Self {
            plane: VelocityControl::new(vehicle.into_plane(), gains),
            side,
            lateral,
        }
    }

    /// The law in the plane of symmetry.
    pub fn plane(&self) -> &VelocityControl<A, G> {
        &self.plane
    }

    /// The law with the robust law (`eq:inputsVCeR`) in the plane of symmetry: defined everywhere.
    ///
    /// Its feed-forward leaves ∂_α f_p γ̇ out of F_δ. Attitude changes F_p by ∂_α f_p (θ̇ − γ̇), and in a steady turn
    /// θ̇ = γ̇: the two halves cancel. The robust law, with k ≡ 1, has not the one. Keeping the other, it has a limit cycle in
    /// turns near the stall where accelerations are measured (those of the reference hardly excite it). The planar
    /// [`VelocityControl::robust`] keeps the paper's form.
    ///
    /// # Errors
    /// A [`Fault`] that names the input that is not finite or absurd. The safe command is `Command::default()`.
    #[inline(never)]
    pub fn robust(
        &self,
        state: &State,
        reference: &Reference,
        feed_forward: Option<&FeedForward>,
    ) -> Result<Command, Fault> {
        self.step(Law::Robust, state, reference, feed_forward)
    }

    /// The law with the full law (`lawsVGen`) in the plane of symmetry, ∂_α f_p γ̇ included.
    ///
    /// # Errors
    /// As [`robust`](Self::robust); and [`Fault::Undefined`] where the planar law divides by zero.
    #[inline(never)]
    pub fn full(
        &self,
        state: &State,
        reference: &Reference,
        feed_forward: Option<&FeedForward>,
    ) -> Result<Command, Fault> {
        self.step(Law::Full, state, reference, feed_forward)
    }

    /// Forces in the plane of symmetry: what [`FoldMap::margin`](crate::FoldMap::margin) is asked with. With W in place
    /// of weight its folds are those of the turn flown: a turn of load factor n has every fold airspeed √n higher.
    ///
    /// # Errors
    /// As [`robust`](Self::robust).
    pub fn forces(&self, state: &State, reference: &Reference) -> Result<ApparentForces, Fault> {
        check_input(state, reference)?;
        Ok(self.see(state, reference).forces)
    }

    /// The margins of well-posedness at these [`forces`](Self::forces).
    pub fn margin(&self, forces: &ApparentForces) -> Margin {
        let tau = self.plane.gains().guard().tau();
        Margin::new(forces, forces.f_p.norm(), tau, 1.0)
    }

    #[inline(always)]
    fn see(&self, state: &State, reference: &Reference) -> Seen {
        let plane = self.plane.vehicle();
        let o = &state.orientation;
        let v_a = o.to_body(state.velocity - state.wind);
        let a_r = reference.acceleration;
        let pull = Ned::new(-a_r.north, -a_r.east, plane.gravity() - a_r.down) * plane.mass();
        let weight = o.to_body(pull + state.correction.force());
        let airspeed = math::sqrt(v_a.norm_squared());
        let air = AirData::new(v_a.in_plane(), plane.thrust_line());
        Seen {
            v_a,
            airspeed,
            weight,
            error: o.to_body(state.velocity - reference.velocity),
            forces: ApparentForces::in_plane(plane, air, airspeed, weight.in_plane()),
        }
    }

    #[inline(always)]
    fn step(
        &self,
        law: Law,
        state: &State,
        reference: &Reference,
        feed_forward: Option<&FeedForward>,
    ) -> Result<Command, Fault> {
        check_input(state, reference)?;
        let (mass, k_a) = (self.plane.vehicle().mass(), self.plane.vehicle().k_a());
        let o = &state.orientation;
        let Seen {
            v_a,
            airspeed,
            weight,
            error,
            forces,
        } = self.see(state, reference);

        let (mut in_plane, mut across) = (None, None);
        if let Some(ff) = feed_forward {
            check_feed_forward(ff)?;
            let (a, jerk) = (o.to_body(ff.air_acceleration), o.to_body(ff.jerk));
            let h = match law {
                Law::Robust => 0.0,
                Law::Full => condition_residual(&forces.coefficients, &forces.air),
            };
            let (a_s, jerk_s) = (a.in_plane(), jerk.in_plane());
            let f_delta = f_delta_in_plane(&forces, mass, k_a * airspeed, h, a_s, jerk_s);
            in_plane = Some(f_delta);
            across = Some((a, jerk.w));
        }
        let lateral = self.lateral.rates(&LateralInput {
            mass,
            side: self.side,
            v_a: v_a + Body::new(0.0, 0.0, state.correction.sideslip()),
            weight,
            error: error.w,
            heading: o.to_body(reference.heading.vector()),
            feed_forward: across,
        });
        let step = self
            .plane
            .step_in_plane(Branch::Aligned, forces, error.in_plane());
        let command = match law {
            Law::Robust => self.plane.robust_in_plane(&step, Branch::Aligned, in_plane),
            Law::Full => self.plane.full_in_plane(&step, in_plane),
        }?;
        let force = step.forces.f;
        check_output(Command {
            thrust: command.thrust,
            rates: Body::new(lateral.i, lateral.j, command.rate),
            diagnostics: Diagnostics {
                plane: command.diagnostics,
                v_a,
                aerodynamic: Body::new(
                    force.i() - weight.i,
                    force.j() - weight.j,
                    -self.side * airspeed * v_a.w,
                ),
                f_y: lateral.f_y,
            },
        })
    }
}
