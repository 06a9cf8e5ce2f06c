//! The velocity laws: robust (`eq:inputsVCeR`) and full (`lawsVGen`).

use super::command::{
    Command, Diagnostics, Fault, FeedForward, State, check_feed_forward, check_input, check_output,
};
use super::feed_forward::f_delta;
use super::gains::{GainLaw, GainValues, Gains};
use crate::aero::Aerodynamics;
use crate::branch::Branch;
use crate::equivalency::{ApparentForces, condition_residual};
use crate::frame::Body;
use crate::reference::Reference;
use crate::vehicle::Vehicle;

/// Velocity control of a vehicle: stateless, immutable, total.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct VelocityControl<A, G = Gains> {
    vehicle: Vehicle<A>,
    gains: G,
}

/// Which of the two laws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// [`VelocityControl::robust`].
    Robust,
    /// [`VelocityControl::full`].
    Full,
}

/// What both laws start from.
pub(crate) struct Step {
    pub(crate) forces: ApparentForces,
    pub(crate) gains: GainValues,
    /// Velocity error ṽ = Rᵀ(v − v_r) [m/s].
    pub(crate) error: Body,
    /// |F_p| \[N\].
    pub(crate) norm: f32,
    /// (|F_p| + F̄_p1)² \[N²\].
    alignment_squared: f32,
}

impl<A: Aerodynamics, G: GainLaw> VelocityControl<A, G> {
    /// Control of what `vehicle` is believed to be, with these gains.
    pub fn new(vehicle: Vehicle<A>, gains: G) -> Self {
        Self { vehicle, gains }
    }

    /// The vehicle as the controller believes it to be.
    pub fn vehicle(&self) -> &Vehicle<A> {
        &self.vehicle
    }

    /// The gains.
    pub fn gains(&self) -> &G {
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
        match feed_forward {
            None => self.robust_alone(state, reference),
            Some(ff) => self.robust_fed(state, reference, ff),
        }
    }

    /// A copy of its own, out of line: merged with the feed-forward, or into its caller, the step runs out of
    /// registers and costs a fifth more.
    #[inline(never)]
    fn robust_alone(&self, state: &State, reference: &Reference) -> Result<Command, Fault> {
        self.robust_in_place(state, reference)
    }

    /// [`robust`](Self::robust) without feed-forward, compiled into its caller: for one that does little else, and would
    /// otherwise copy the command.
    ///
    /// # Errors
    /// As [`robust`](Self::robust).
    #[inline(always)]
    pub fn robust_in_place(&self, state: &State, reference: &Reference) -> Result<Command, Fault> {
        check_input(state, reference)?;
        let step = self.step(Branch::Aligned, state, reference);
        self.robust_from(&step, Branch::Aligned, state, None)
    }

    #[inline(never)]
    fn robust_fed(
        &self,
        state: &State,
        reference: &Reference,
        feed_forward: &FeedForward,
    ) -> Result<Command, Fault> {
        check_input(state, reference)?;
        let step = self.step(Branch::Aligned, state, reference);
        self.robust_from(&step, Branch::Aligned, state, Some(feed_forward))
    }

    /// The robust law from `step`, on either branch.
    ///
    /// On θ̃ = π the law is that of θ̃ = 0 for −F_p: what it stabilises is F_p against the thrust line.
    #[inline(always)]
    pub(crate) fn robust_from(
        &self,
        step: &Step,
        branch: Branch,
        state: &State,
        feed_forward: Option<&FeedForward>,
    ) -> Result<Command, Fault> {
        let f_delta = self.f_delta(&step.forces, state, feed_forward)?;
        self.robust_in_plane(step, branch, f_delta)
    }

    /// The robust law from `step` and F_δ [N/s] in body components.
    ///
    /// # Errors
    /// [`Fault::Undefined`] where the arithmetic overflows.
    #[inline(always)]
    pub(crate) fn robust_in_plane(
        &self,
        step: &Step,
        branch: Branch,
        f_delta: Option<Body>,
    ) -> Result<Command, Fault> {
        let Step {
            forces,
            gains,
            norm,
            ..
        } = step;
        let guard = self.gains.guard();
        let alignment = guard.over_square(step.alignment_squared);
        let mut rate = branch.sign()
            * (norm * (gains.k2 * step.error.j())
                + (gains.k3 * norm) * (forces.f_p.j() * alignment));
        let mut guard_feed_forward = 0.0;
        if let Some(f_delta) = f_delta {
            let norm_squared = norm * norm;
            let over = guard.over_square(norm_squared);
            rate -= over * cross(forces, f_delta);
            guard_feed_forward = over * norm_squared;
        }
        let guard_alignment = alignment * step.alignment_squared;
        check_output(self.command(step, rate, guard_alignment, guard_feed_forward, 1.0))
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
        check_input(state, reference)?;
        let step = self.step(Branch::Aligned, state, reference);
        let f_delta = self.f_delta(&step.forces, state, feed_forward)?;
        self.full_in_plane(&step, f_delta)
    }

    /// The full law from `step` and F_δ [N/s] in body components.
    ///
    /// # Errors
    /// [`Fault::Undefined`] where the law divides by zero or the arithmetic overflows.
    #[inline(always)]
    pub(crate) fn full_in_plane(
        &self,
        step: &Step,
        f_delta: Option<Body>,
    ) -> Result<Command, Fault> {
        let Step {
            forces,
            gains,
            norm,
            ..
        } = step;
        let norm_squared = norm * norm;
        // c̄_D' cos(α+δ) − c̄_L' sin(α+δ) is the residual of eq:condition.
        let h = condition_residual(&forces.coefficients, &forces.air);
        let k = norm_squared / (norm_squared + forces.pressure * (forces.f.j() * h));
        let mut rate = norm * (gains.k2 * step.error.j())
            + (gains.k3 * norm) * (forces.f_p.j() / step.alignment_squared);
        if let Some(f_delta) = f_delta {
            rate -= cross(forces, f_delta) / norm_squared;
        }
        check_output(self.command(step, k * rate, 1.0, 1.0, k))
    }

    /// [`robust`](Self::robust) or [`full`](Self::full), as `law` says, with or without feed-forward. It is slower than
    /// these, and takes the room of one: the code of the forces is there once.
    ///
    /// # Errors
    /// As the law's.
    #[inline(never)]
    pub fn either(
        &self,
        law: Law,
        state: &State,
        reference: &Reference,
        feed_forward: Option<&FeedForward>,
    ) -> Result<Command, Fault> {
        check_input(state, reference)?;
        let step = self.step(Branch::Aligned, state, reference);
        let f_delta = self.f_delta(&step.forces, state, feed_forward)?;
        match law {
            Law::Robust => self.robust_in_plane(&step, Branch::Aligned, f_delta),
            Law::Full => self.full_in_plane(&step, f_delta),
        }
    }

    /// What the law on `branch` starts from. The inputs are to have been checked.
    #[inline(always)]
    pub(crate) fn step(&self, branch: Branch, state: &State, reference: &Reference) -> Step {
        // First, so that the velocities need not be kept while the forces are made.
        let error = state.attitude.to_body(state.velocity - reference.velocity);
        let forces = ApparentForces::new(
            &self.vehicle,
            state.attitude,
            state.velocity - state.wind,
            reference.acceleration,
        );
        self.step_in_plane(branch, forces, error)
    }

    /// What the law on `branch` starts from, given the forces and the velocity error [m/s] in body components.
    #[inline(always)]
    pub(crate) fn step_in_plane(
        &self,
        branch: Branch,
        forces: ApparentForces,
        error: Body,
    ) -> Step {
        let norm = forces.f_p.norm();
        let sign = branch.sign();
        let (along, across) = (sign * forces.f_p.i(), sign * forces.f_p.j());
        // |F_p| + F̄_p1, which cancels near θ̃ = π, is F̄_p2²/(|F_p| − F̄_p1).
        let sum = norm + along.abs();
        let alignment = if along < 0.0 {
            // Rare in flight: the division is not to be made ahead of the choice.
            core::hint::cold_path();
            across * across / sum
        } else {
            sum
        };
        Step {
            forces,
            gains: self.gains.at(norm),
            error,
            norm,
            alignment_squared: alignment * alignment,
        }
    }

    /// F_δ [N/s] in body components, if there is feed-forward.
    #[inline(always)]
    fn f_delta(
        &self,
        forces: &ApparentForces,
        state: &State,
        feed_forward: Option<&FeedForward>,
    ) -> Result<Option<Body>, Fault> {
        let Some(ff) = feed_forward else {
            return Ok(None);
        };
        check_feed_forward(ff)?;
        let (mass, k_a) = (self.vehicle.mass(), self.vehicle.k_a());
        Ok(Some(f_delta(forces, mass, k_a, state.attitude, ff)))
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
        let push = (step.gains.k1 * step.norm) * step.error.i();
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

/// F̄_pᵀ S F̄_δ [N²/s].
#[inline(always)]
fn cross(forces: &ApparentForces, f_delta: Body) -> f32 {
    forces.f_p.j() * f_delta.i() - forces.f_p.i() * f_delta.j()
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{Combined, CombinedParameters};
    use crate::control::{GainParameters, MAX_SPEED};
    use crate::frame::{Attitude, Inertial};
    use crate::vehicle::VehicleParameters;
    use rand::{RngExt, SeedableRng};

    /// m g of the vehicle under test \[N\].
    const WEIGHT: f32 = 10.0 * 9.81;
    const HOVER: State = State {
        velocity: Inertial::ZERO,
        attitude: Attitude::NOSE_UP,
        wind: Inertial::ZERO,
    };
    const STAY: Reference = Reference {
        velocity: Inertial::ZERO,
        acceleration: Inertial::ZERO,
    };

    fn control() -> VelocityControl<Combined> {
        VelocityControl::new(
            Vehicle::new(
                VehicleParameters::PAPER,
                Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap(),
            )
            .unwrap(),
            Gains::new(GainParameters::PAPER).unwrap(),
        )
    }

    #[test]
    fn hover_is_held_by_the_weight() {
        for law in [VelocityControl::robust, VelocityControl::full] {
            let command = law(&control(), &HOVER, &STAY, None).unwrap();
            assert_eq!((command.thrust, command.rate), (WEIGHT, 0.0));
            assert_eq!(command.diagnostics.theta_tilde(), 0.0);
            assert_eq!(command.diagnostics.f_p_norm, WEIGHT);
        }
    }

    #[test]
    fn errors_are_corrected_in_the_right_direction() {
        let control = control();
        let at = |down, forward| {
            let state = State {
                velocity: Inertial::new(down, forward),
                ..HOVER
            };
            control.robust(&state, &STAY, None).unwrap()
        };
        // Sinking asks for more thrust; drifting forward for a nose that leans back, θ > 0.
        assert!(at(0.5, 0.0).thrust > WEIGHT && at(-0.5, 0.0).thrust < WEIGHT);
        assert!(at(0.0, 0.5).rate > 0.0 && at(0.0, -0.5).rate < 0.0);
    }

    #[test]
    fn the_robust_law_is_defined_where_the_full_law_is_not() {
        let control = control();
        // F_p = 0: a reference in free fall.
        let fall = Reference {
            acceleration: Inertial::new(9.81, 0.0),
            ..STAY
        };
        let command = control.robust(&HOVER, &fall, None).unwrap();
        assert_eq!((command.thrust, command.rate), (0.0, 0.0));
        assert_eq!(control.full(&HOVER, &fall, None), Err(Fault::Undefined));
        // θ̃ = π: hovering nose down.
        let down = State {
            attitude: Attitude {
                cos: -1.0,
                sin: 0.0,
            },
            ..HOVER
        };
        let command = control.robust(&down, &STAY, None).unwrap();
        assert_eq!((command.thrust, command.rate), (-WEIGHT, 0.0));
        assert_eq!(command.diagnostics.guard_alignment, 0.0);
        assert_eq!(control.full(&down, &STAY, None), Err(Fault::Undefined));
        // Near it the guarded term is k3 |F_p| F̄_p2 π/(2τ²), and turns the nose back on either side.
        for sin in [1e-3f32, -1e-3] {
            let near = State {
                attitude: Attitude { cos: -1.0, sin },
                ..HOVER
            };
            let command = control.robust(&near, &STAY, None).unwrap();
            let want = 6.0 * WEIGHT * (-WEIGHT * sin) * core::f32::consts::FRAC_PI_2 / 6400.0;
            // 1e-5: the next term of sin x is x²/6 with x = 1e-12, so roundings only.
            assert!((command.rate / want - 1.0).abs() < 1e-5);
        }
    }

    /// Both laws from the forces, as printed, in double precision: `eq:inputsVCeR` and `lawsVGen`.
    #[test]
    fn the_laws_are_the_printed_ones() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(2);
        let (control, p) = (control(), GainParameters::PAPER);
        let [k1, k2, k3, tau] = [p.k1, p.k2, p.k3, p.tau].map(f64::from);
        let mu = |s: f64| {
            if s < tau {
                (core::f64::consts::FRAC_PI_2 * (s / tau).powi(2)).sin()
            } else {
                1.0
            }
        };
        let (mut guarded, mut free) = (0, 0);
        for _ in 0..20_000 {
            let theta = rng.random_range(-3.1..3.1f32);
            let mut x: [f32; 14] = core::array::from_fn(|_| rng.random_range(-12.0..12.0));
            [x[4], x[5]] = [theta.cos(), theta.sin()];
            let (state, reference, ff) = inputs(x);
            let v_a = state.velocity - state.wind;
            let vehicle = control.vehicle();
            let forces = ApparentForces::new(vehicle, state.attitude, v_a, reference.acceleration);
            let e = state.attitude.to_body(state.velocity - reference.velocity);
            let f_delta = f_delta(&forces, vehicle.mass(), vehicle.k_a(), state.attitude, &ff);
            let [f_i, f_j, p_i, p_j, e_i, e_j, d_i, d_j] = [
                forces.f.i(),
                forces.f.j(),
                forces.f_p.i(),
                forces.f_p.j(),
                e.i(),
                e.j(),
                f_delta.i(),
                f_delta.j(),
            ]
            .map(f64::from);
            let norm = p_i.hypot(p_j);
            let s = norm + p_i;
            // F_p against the thrust line: single precision has lost it there.
            if s < 1e-3 * norm {
                continue;
            }
            let h = f64::from(condition_residual(&forces.coefficients, &forces.air));
            let k = norm * norm / (norm * norm + f64::from(forces.pressure) * f_j * h);
            let across = p_j * d_i - p_i * d_j;
            let turn = |guard: f64| norm * k2 * e_j + k3 * norm * p_j * guard / (s * s);
            let robust = (turn(mu(s)), mu(norm) * across / (norm * norm));
            let full = (k * turn(1.0), k * across / (norm * norm));
            let t_p = p_i + k1 * norm * e_i;
            let near = |got: f32, want: f64, scale: f64| {
                // 1e-5: some twenty roundings, of terms up to `scale`.
                let off = (f64::from(got) - want).abs();
                assert!(off < 1e-5 * (1.0 + scale), "{got} {want} {x:?}");
            };
            for (law, (bare, fed), guards) in [
                (Law::Robust, robust, (mu(s), mu(norm))),
                (Law::Full, full, (1.0, 1.0)),
            ] {
                for ff in [None, Some(&ff)] {
                    let command = control.either(law, &state, &reference, ff).unwrap();
                    let d = command.diagnostics;
                    let fed = if ff.is_some() { fed } else { 0.0 };
                    let size = if law == Law::Full { k.abs() } else { 1.0 };
                    let terms =
                        size * (norm * k2 * e_j).abs() + size * (k3 * norm * p_j / (s * s)).abs();
                    // 1/k is a difference.
                    let lost = if law == Law::Full { 1.0 + k * k } else { 1.0 };
                    near(command.rate, bare - fed, lost * (terms + fed.abs()));
                    near(
                        command.thrust,
                        f_i + k1 * norm * e_i,
                        norm * (1.0 + k1 * e_i.abs()) + f_i.abs(),
                    );
                    near(d.t_p, t_p, norm * (1.0 + k1 * e_i.abs()));
                    near(d.guard_alignment, guards.0, 0.0);
                    if ff.is_some() {
                        near(d.guard_feed_forward, guards.1, 0.0);
                    }
                }
            }
            if norm < tau {
                guarded += 1;
            } else {
                free += 1;
            }
        }
        assert!(guarded > 1000 && free > 1000, "{guarded} {free}");
    }

    /// Everything that a step reads, one number each.
    fn inputs(x: [f32; 14]) -> (State, Reference, FeedForward) {
        (
            State {
                velocity: Inertial::new(x[0], x[1]),
                wind: Inertial::new(x[2], x[3]),
                attitude: Attitude {
                    cos: x[4],
                    sin: x[5],
                },
            },
            Reference {
                velocity: Inertial::new(x[6], x[7]),
                acceleration: Inertial::new(x[8], x[9]),
            },
            FeedForward {
                air_acceleration: Inertial::new(x[10], x[11]),
                jerk: Inertial::new(x[12], x[13]),
            },
        )
    }

    #[test]
    fn each_bad_input_is_named() {
        const GOOD: [f32; 14] = [
            1.0, 2.0, 0.5, 0.0, 0.8, 0.6, 0.0, 3.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6,
        ];
        use Fault::*;
        let faults = [
            Velocity,
            Velocity,
            Wind,
            Wind,
            Attitude,
            Attitude,
            ReferenceVelocity,
            ReferenceVelocity,
            ReferenceAcceleration,
            ReferenceAcceleration,
            AirAcceleration,
            AirAcceleration,
            Jerk,
            Jerk,
        ];
        let control = control();
        for law in [VelocityControl::robust, VelocityControl::full] {
            let step = |x| {
                let (state, reference, ff) = inputs(x);
                law(&control, &state, &reference, Some(&ff))
            };
            assert!(step(GOOD).is_ok());
            for (n, fault) in faults.iter().enumerate() {
                for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1.1e3, 3e38] {
                    let mut x = GOOD;
                    x[n] = bad;
                    assert_eq!(step(x), Err(*fault), "{n} {bad}");
                }
            }
        }
    }

    #[test]
    fn each_input_has_a_bound_of_its_own() {
        let (mut state, mut reference) = (HOVER, STAY);
        state.velocity = Inertial::new(0.9 * MAX_SPEED, 0.0);
        state.wind = Inertial::new(0.9 * MAX_SPEED, 0.0);
        reference.velocity = Inertial::new(0.0, -0.9 * MAX_SPEED);
        assert!(control().robust(&state, &reference, None).is_ok());
    }

    #[test]
    fn no_input_makes_a_command_that_is_not_a_number() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let control = control();
        let (mut commands, mut refused) = (0, 0);
        for round in 0..400_000 {
            let theta = rng.random_range(-3.2..3.2f32);
            let mut x: [f32; 14] = core::array::from_fn(|_| rng.random_range(-30.0..30.0));
            [x[4], x[5]] = [theta.cos(), theta.sin()];
            // None, one or several numbers replaced by arbitrary bits or by a value on an edge.
            for _ in 0..round % 4 {
                x[rng.random_range(0..14)] = match rng.random_range(0..4) {
                    0 => f32::from_bits(rng.random()),
                    1 => 0.0,
                    2 => f32::from_bits(1),
                    _ => rng.random_range(-2.0..2.0f32) * 1e3,
                };
            }
            let (state, reference, ff) = inputs(x);
            for law in [VelocityControl::robust, VelocityControl::full] {
                match law(&control, &state, &reference, Some(&ff)) {
                    Ok(c) => {
                        let d = c.diagnostics;
                        assert!(c.thrust.is_finite() && c.rate.is_finite(), "{x:?}");
                        assert!(d.f_p_norm.is_finite() && d.t_p.is_finite() && d.k.is_finite());
                        assert!(
                            d.alpha.abs() <= core::f32::consts::PI && !d.theta_tilde().is_nan()
                        );
                        assert!((0.0..=1.000_001).contains(&d.guard_alignment));
                        commands += 1;
                    }
                    Err(_) => refused += 1,
                }
            }
        }
        assert!(
            commands > 400_000 && refused > 50_000,
            "{commands} {refused}"
        );
    }
}
