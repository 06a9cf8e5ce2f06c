//! The law of the winged vehicle: the planar law in the plane of symmetry, tilt and twist across it.

use super::command::{
    Command, Diagnostics, FeedForward, Reference, State, check_feed_forward, check_input,
    check_output,
};
use super::heading::Heading;
use super::lateral::{Lateral, LateralGains, LateralInput};
use super::vector::Body;
use crate::aero::Aerodynamics;
use crate::air::AirData;
use crate::branch::Branch;
use crate::control::feed_forward::f_delta_in_plane;
use crate::control::{self, Fault, GainLaw, Gains, Margin, VelocityControl};
use crate::equivalency::{ApparentForces, condition_residual};
use crate::math;
use crate::ned::Ned;
use crate::vehicle::Vehicle;

/// Velocity control of a winged vehicle in space: stateless, immutable, total.
///
/// In the plane of symmetry it is [`VelocityControl`], unchanged; see [`LateralParameters`](super::LateralParameters)
/// for the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct WingedControl<A, G = Gains> {
    plane: VelocityControl<A, G>,
    lateral: LateralGains,
}

/// A step's vectors in body components.
pub(crate) struct Observation {
    /// Air velocity.
    v_a: Body,
    /// |v_a|.
    airspeed: f32,
    /// Apparent weight, corrected.
    weight: Body,
    /// Velocity error.
    pub error: Body,
    /// What the planar law sees.
    pub forces: ApparentForces,
}

/// Which planar law.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Law {
    Robust,
    Full,
}

impl<A: Aerodynamics, G: GainLaw> WingedControl<A, G> {
    /// Control of what `vehicle` is believed to be, with these gains in the plane of symmetry and across it.
    pub fn new(vehicle: Vehicle<A>, gains: G, lateral: LateralGains) -> Self {
        Self {
            plane: VelocityControl::new(vehicle, gains),
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

    /// Forces in the plane of symmetry: what [`FoldMap::margin`](crate::planar::equilibrium::FoldMap::margin) is asked with. With W in place
    /// of weight its folds are those of the turn flown: a turn of load factor n has every fold airspeed √n higher.
    ///
    /// # Errors
    /// As [`robust`](Self::robust).
    pub fn forces(&self, state: &State, reference: &Reference) -> Result<ApparentForces, Fault> {
        check_input(state, reference)?;
        Ok(self.observe(state, reference).forces)
    }

    /// The margins of well-posedness at these [`forces`](Self::forces).
    pub fn margin(&self, forces: &ApparentForces) -> Margin {
        let tau = self.plane.gains().guard().tau();
        Margin::new(forces, forces.f_p.norm(), tau, 1.0)
    }

    /// What a step looks at. The inputs are to have been checked.
    #[inline(always)]
    pub(crate) fn observe(&self, state: &State, reference: &Reference) -> Observation {
        let plane = self.plane.vehicle();
        let o = &state.orientation;
        let v_a = o.to_axes(state.velocity - state.wind);
        let a_r = reference.acceleration;
        let pull = Ned::new(-a_r.north, -a_r.east, plane.gravity() - a_r.down) * plane.mass();
        let weight = o.to_axes(pull + state.correction.force());
        let airspeed = math::sqrt(v_a.norm_squared());
        let air = AirData::new(v_a.in_plane(), plane.thrust_line());
        Observation {
            v_a,
            airspeed,
            weight,
            error: o.to_axes(state.velocity - reference.velocity),
            forces: ApparentForces::in_plane(
                plane,
                air,
                airspeed * state.correction.air(),
                weight.in_plane(),
            ),
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
        let (mass, k_a) = (
            self.plane.vehicle().mass(),
            self.plane.vehicle().k_a() * state.correction.air(),
        );
        let o = &state.orientation;
        let observed = self.observe(state, reference);
        let forces = &observed.forces;

        let (mut in_plane, mut across) = (None, None);
        if let Some(ff) = feed_forward {
            check_feed_forward(ff)?;
            let (a, jerk) = (o.to_axes(ff.air_acceleration), o.to_axes(ff.jerk));
            let h = match law {
                Law::Robust => 0.0,
                Law::Full => condition_residual(&forces.coefficients, &forces.air),
            };
            let (a_s, jerk_s) = (a.in_plane(), jerk.in_plane());
            let f_delta = f_delta_in_plane(forces, mass, k_a * observed.airspeed, h, a_s, jerk_s);
            in_plane = Some(f_delta);
            across = Some((a, jerk.w));
        }
        let lateral = self.across(
            &observed,
            observed.error.w,
            state,
            reference.heading,
            across,
        );
        let step =
            self.plane
                .step_in_plane(Branch::Aligned, observed.forces, observed.error.in_plane());
        let command = match law {
            Law::Robust => self.plane.robust_in_plane(&step, Branch::Aligned, in_plane),
            Law::Full => self.plane.full_in_plane(&step, in_plane),
        }?;
        check_output(self.assemble(&observed, command, &lateral))
    }

    /// Tilt and twist for a lateral velocity error [m/s]. The feed-forward is the derivative of the air velocity [m/s²], and
    /// the reference jerk along w [m/s³].
    #[inline(always)]
    pub(crate) fn across(
        &self,
        observed: &Observation,
        error: f32,
        state: &State,
        heading: Heading,
        feed_forward: Option<(Body, f32)>,
    ) -> Lateral {
        self.lateral.rates(&LateralInput {
            mass: self.plane.vehicle().mass(),
            side: self.plane.vehicle().side(),
            roll: self.plane.vehicle().roll() * self.plane.vehicle().weight(),
            v_a: observed.v_a + Body::new(0.0, 0.0, state.correction.sideslip()),
            weight: observed.weight,
            error,
            heading: state.orientation.to_axes(heading.vector()),
            feed_forward,
        })
    }

    /// The command of a planar one and a lateral one.
    #[inline(always)]
    pub(crate) fn assemble(
        &self,
        observed: &Observation,
        in_plane: control::Command,
        lateral: &Lateral,
    ) -> Command {
        let Observation { v_a, weight, .. } = *observed;
        let force = observed.forces.f;
        Command {
            thrust: in_plane.thrust,
            rates: Body::new(lateral.i, lateral.j, in_plane.rate).into(),
            diagnostics: Diagnostics {
                plane: in_plane.diagnostics,
                v_a: v_a.into(),
                aerodynamic: Body::new(
                    force.i() - weight.i,
                    force.j() - weight.j,
                    -self.plane.vehicle().side() * observed.airspeed * v_a.w,
                )
                .into(),
                f_y: lateral.f_y.into(),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{Combined, CombinedParameters};
    use crate::control::GainParameters;
    use crate::equilibrium::FoldMap;
    use crate::ned::{BodyAxes, BodyRates, Quaternion};
    use crate::spatial::{Correction, LateralParameters, Orientation};
    use crate::vehicle::VehicleParameters;
    use rand::{RngExt, SeedableRng};

    fn control() -> WingedControl<Combined> {
        let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        let p = VehicleParameters {
            c_y: 0.5,
            ..VehicleParameters::PAPER
        };
        WingedControl::new(
            Vehicle::new(p, model).unwrap(),
            Gains::new(GainParameters::PAPER).unwrap(),
            LateralGains::new(LateralParameters::PAPER_VEHICLE).unwrap(),
        )
    }

    fn orientation(q: [f32; 4]) -> Orientation {
        let [w, x, y, z] = q;
        Orientation::from_quaternion(&Quaternion { w, x, y, z }, BodyAxes::NoseUp).unwrap()
    }

    #[test]
    fn hover_is_held_by_the_weight() {
        let command = control()
            .robust(&State::default(), &Reference::default(), None)
            .unwrap();
        assert_eq!(command.thrust, 10.0 * 9.81);
        assert_eq!(command.rates, BodyRates::default());
        assert_eq!(command.diagnostics.tilt(), 0.0);
    }

    /// A force that pushes to the right is leant against, with the thrust that carries both.
    #[test]
    fn a_corrected_force_takes_the_place_of_weight() {
        let state = State {
            correction: Correction::new(Ned::new(0.0, 20.0, 10.0), 0.0),
            ..State::default()
        };
        let command = control()
            .robust(&state, &Reference::default(), None)
            .unwrap();
        assert!((command.thrust - 108.1).abs() < 1e-3);
        assert!((command.diagnostics.tilt() - (20f32 / 108.1).atan()).abs() < 1e-6);
        // The tail, i, turns to where the sum of weight and force points.
        assert!(command.rates.yaw < 0.0);
        // The true aerodynamic force is none the less zero here.
        assert_eq!(
            Body::from(command.diagnostics.aerodynamic).norm_squared(),
            0.0
        );
    }

    /// The folds of a level turn of load factor n lie at √n times the airspeeds of level flight: the margin on the
    /// turn's own ray says so.
    #[test]
    fn folds_move_with_the_root_of_the_load_factor() {
        let control = control();
        let map = FoldMap::new(control.plane().vehicle());
        // Level at 20 m/s northward, nose forward, α = 5°; banked by the load factor about the air velocity.
        let at = |load: f32, speed: f32| {
            let bank = (1.0 / load).acos();
            let (s, c) = (0.5 * bank).sin_cos();
            let (sp, cp) = (0.5 * -85f32.to_radians()).sin_cos();
            let state = State {
                velocity: Ned::new(speed, 0.0, 0.0),
                orientation: orientation([c * cp, s * cp, c * sp, s * sp]),
                ..State::default()
            };
            let reference = Reference {
                velocity: state.velocity,
                acceleration: Ned::new(0.0, 9.81 * (load * load - 1.0).sqrt(), 0.0),
                ..Reference::default()
            };
            let forces = control.forces(&state, &reference).unwrap();
            assert!(control.margin(&forces).force > 1.0);
            let tilt = control
                .robust(&state, &reference, None)
                .unwrap()
                .diagnostics
                .tilt();
            assert!(tilt.abs() < 1e-5, "{tilt}");
            map.margin(&forces).unwrap().a
        };
        for load in [1.5, 2.0, 2.9] {
            let (turn, level) = (at(load, 20.0), at(1.0, 20.0));
            // 1e-4: roundings of the bank.
            assert!(
                (turn / level / load - 1.0).abs() < 1e-4,
                "{load} {turn} {level}"
            );
        }
    }

    /// Everything that a step reads but the attitude, one number each.
    fn inputs(x: &[f32; 18]) -> (Ned, Ned, Reference, FeedForward) {
        let ned = |n: usize| Ned::new(x[n], x[n + 1], x[n + 2]);
        (
            ned(0),
            ned(3),
            Reference {
                velocity: ned(6),
                acceleration: ned(9),
                heading: Heading::from_angle(x[0]),
            },
            FeedForward {
                air_acceleration: ned(12),
                jerk: ned(15),
            },
        )
    }

    #[test]
    fn each_bad_input_is_named() {
        use Fault::*;
        let faults = [
            Velocity,
            Wind,
            ReferenceVelocity,
            ReferenceAcceleration,
            AirAcceleration,
            Jerk,
        ];
        let control = control();
        for law in [WingedControl::robust, WingedControl::full] {
            for n in 0..18 {
                for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1.1e3, 3e38] {
                    let mut x: [f32; 18] = core::array::from_fn(|n| n as f32 * 0.3);
                    x[n] = bad;
                    let (velocity, wind, reference, ff) = inputs(&x);
                    let state = State {
                        velocity,
                        wind,
                        ..State::default()
                    };
                    let got = law(&control, &state, &reference, Some(&ff));
                    assert_eq!(got, Err(faults[n / 3]), "{n} {bad}");
                }
            }
        }
    }

    #[test]
    fn no_input_makes_a_command_that_is_not_a_number() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(5);
        let control = control();
        let (mut commands, mut refused) = (0, 0);
        for round in 0..300_000 {
            let q: [f32; 4] = core::array::from_fn(|_| rng.random_range(-1.0..1.0));
            let length = q.iter().map(|x| x * x).sum::<f32>().sqrt();
            let mut x: [f32; 18] = core::array::from_fn(|_| rng.random_range(-30.0..30.0));
            // None, one or several numbers replaced by arbitrary bits or by a value on an edge.
            for _ in 0..round % 5 {
                x[rng.random_range(0..18)] = match rng.random_range(0..4) {
                    0 => f32::from_bits(rng.random()),
                    1 => 0.0,
                    2 => f32::from_bits(1),
                    _ => rng.random_range(-2.0..2.0f32) * 1e3,
                };
            }
            let (velocity, wind, reference, ff) = inputs(&x);
            let force = Ned::new(f32::from_bits(rng.random()), 0.0, x[3]);
            let state = State {
                velocity,
                wind,
                orientation: orientation(q.map(|c| c / length)),
                correction: Correction::new(force, f32::from_bits(rng.random())),
            };
            for law in [WingedControl::robust, WingedControl::full] {
                match law(&control, &state, &reference, Some(&ff)) {
                    Ok(c) => {
                        let d = c.diagnostics;
                        let sum = c.thrust + c.rates.roll + c.rates.yaw + c.rates.pitch;
                        assert!(sum.is_finite(), "{x:?}");
                        assert!(!d.tilt().is_nan() && !d.sideslip().is_nan());
                        assert!(Body::from(d.aerodynamic).norm_squared().is_finite());
                        commands += 1;
                    }
                    Err(_) => refused += 1,
                }
            }
        }
        assert!(
            commands > 300_000 && refused > 50_000,
            "{commands} {refused}"
        );
    }
}
