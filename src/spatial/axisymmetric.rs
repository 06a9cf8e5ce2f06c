//! The law of the axisymmetric vehicle: theory, as the paper's, which no guidance flies.

use super::command::{
    Command, Diagnostics, FeedForward, Reference, State, check_feed_forward, check_input,
    check_output,
};
use super::vector::Body;
use crate::aero::{Aerodynamics, Coefficients};
use crate::air::AngleOfAttack;
use crate::control::{self, Fault, GainLaw, Gains, Guard};
use crate::equivalency::{lambda_parallel, parallel_condition_residual};
use crate::error::{ParameterError, in_range};
use crate::math;
use crate::ned::Ned;
use crate::vehicle::Vehicle;

/// Air velocities shorter than this [m/s] have no direction.
const STILL: f32 = 1e-12;

/// Velocity control of a body of revolution in space: stateless, immutable, total.
///
/// With cos α = −v_a1/|v_a|, α in [0, π], λ = c_L/sin α (`eq:pPC`) and b = c_D + c_L cot α the aerodynamic force is
/// exactly `−k_a|v_a|² λ i − k_a b |v_a| v_a`, so that F_p = W − k_a b |v_a| v_a. In its plane of symmetry the lift
/// coefficient is odd and the drag coefficient even. Not a law for a wing: it asks for forces across the wing that a
/// wing has not.
///
/// About the axis the vehicle is free: it turns j towards the heading.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct AxisymmetricControl<A, G = Gains> {
    vehicle: Vehicle<A>,
    gains: G,
    /// 2 k_ψ [1/s].
    twice_twist: f32,
    heading: Guard,
}

/// What both laws start from, in body components.
struct Step {
    v_a: Body,
    speed: f32,
    alpha: AngleOfAttack,
    coefficients: Coefficients,
    /// b = c_D + c_L cot α.
    drag: f32,
    /// λ k_a |v_a|² \[N\].
    lift: f32,
    f_p: Body,
    error: Body,
    weight: Body,
}

impl<A: Aerodynamics, G: GainLaw> AxisymmetricControl<A, G> {
    /// Control of what `vehicle` is believed to be, its model that of any plane through its axis; `twist` is k_ψ
    /// [1/s], `heading` the sine η below which the heading fades.
    ///
    /// # Errors
    /// `delta` of the vehicle not zero; `twist` outside [1e-3, 1e3], `heading` outside [1e-3, 1]; or any not finite.
    pub fn new(
        vehicle: Vehicle<A>,
        gains: G,
        twist: f32,
        heading: f32,
    ) -> Result<Self, ParameterError> {
        if vehicle.thrust_line().delta() != 0.0 {
            return Err(ParameterError::contradiction(
                "delta",
                "zero for a body of revolution",
            ));
        }
        Ok(Self {
            vehicle,
            gains,
            twice_twist: 2.0 * in_range("twist", twist, [1e-3, 1e3], "1/s")?,
            heading: Guard::new(in_range("heading", heading, [1e-3, 1.0], "")?)?,
        })
    }

    /// The robust law: defined everywhere. Its feed-forward leaves ∂_α f_p α̇ out of F_δ, as the winged vehicle's does.
    ///
    /// # Errors
    /// A [`Fault`] that names the input that is not finite or absurd.
    #[inline(never)]
    pub fn robust(
        &self,
        state: &State,
        reference: &Reference,
        feed_forward: Option<&FeedForward>,
    ) -> Result<Command, Fault> {
        check_input(state, reference)?;
        let step = self.step(state, reference);
        let norm = math::sqrt(step.f_p.norm_squared());
        let guard = self.gains.guard();
        let f_delta = match feed_forward {
            Some(ff) => Some(self.f_delta(&step, state, ff)?),
            None => None,
        };
        let alignment = alignment_squared(&step.f_p, norm);
        let over = guard.over_square(norm * norm);
        let m = self.turn(&step, norm, guard.over_square(alignment), over, f_delta);
        let guards = [
            guard.over_square(alignment) * alignment,
            f_delta.map_or(0.0, |_| over * norm * norm),
        ];
        self.command(&step, state, reference, norm, m, guards)
    }

    /// The full law: with it, true accelerations and `V = (m/2)|ṽ|² + (1 − F̄_p1/|F_p|)/k2`, constant gains give
    /// `V̇ = −k1|F_p|ṽ_1² − (k3/k2) tan²(θ̃/2)`.
    ///
    /// F_p follows the attitude only along v_a, so that 1/k is a matrix of rank one off the identity. It needs
    /// b'(α)/sin α, which single precision knows to 1e-7/sin³ α only. Below sin α = 0.02 the law is no better than the
    /// robust one.
    ///
    /// # Errors
    /// As [`robust`](Self::robust); and [`Fault::Undefined`] at F_p = 0, at θ̃ = π and where the matrix is singular.
    #[inline(never)]
    pub fn full(
        &self,
        state: &State,
        reference: &Reference,
        feed_forward: Option<&FeedForward>,
    ) -> Result<Command, Fault> {
        check_input(state, reference)?;
        let step = self.step(state, reference);
        let norm = math::sqrt(step.f_p.norm_squared());
        let v = step.v_a;
        // B = −k_a b'/sin α, b' = residual/sin² α.
        let sin = step.alpha.sin;
        let residual = parallel_condition_residual(&step.coefficients, step.alpha);
        let cube = sin * sin * sin;
        let slope = if cube > 8e-6 {
            -self.vehicle.k_a() * (residual / cube)
        } else {
            0.0
        };
        let f_delta = match feed_forward {
            Some(ff) => {
                let bare = self.f_delta(&step, state, ff)?;
                // ∂_α f_p α̇ = −k_a b' α̇ |v_a| v_a, with −sin α α̇ = d/dt(−v_a1/|v_a|) at fixed i.
                let a = state.orientation.to_axes(ff.air_acceleration);
                let inverse = 1.0 / (step.speed + STILL);
                let turning = a.i * step.speed - v.i * (v.dot(a) * inverse);
                Some(bare + v * (slope * turning * inverse))
            }
            None => None,
        };
        let over_alignment = 1.0 / alignment_squared(&step.f_p, norm);
        let over = 1.0 / (norm * norm);
        let (m_2, m_3) = self.turn(&step, norm, over_alignment, over, f_delta);
        // m + g (p·m)/(1 − p·g), p the part of v_a across i.
        let f_p = step.f_p;
        let g_2 = slope * over * (f_p.i * v.j - f_p.j * v.i);
        let g_3 = slope * over * (f_p.i * v.w - f_p.w * v.i);
        let factor = (v.j * m_2 + v.w * m_3) / (1.0 - (v.j * g_2 + v.w * g_3));
        let m = (m_2 + g_2 * factor, m_3 + g_3 * factor);
        self.command(&step, state, reference, norm, m, [1.0, 1.0])
    }

    #[inline(always)]
    fn step(&self, state: &State, reference: &Reference) -> Step {
        let o = &state.orientation;
        let v_a = o.to_axes(state.velocity - state.wind);
        let speed = math::sqrt(v_a.norm_squared());
        let alpha = if speed > STILL {
            let inverse = 1.0 / speed;
            let across = math::sqrt(v_a.j * v_a.j + v_a.w * v_a.w);
            AngleOfAttack::from_sin_cos(across * inverse, -v_a.i * inverse)
        } else {
            AngleOfAttack::from_sin_cos(0.0, 1.0)
        };
        let coefficients = self.vehicle.model().coefficients(alpha);
        let lambda = lambda_parallel(&coefficients, alpha);
        let drag = coefficients.c_d + lambda * alpha.cos;
        let a_r = reference.acceleration;
        let gravity = self.vehicle.gravity();
        let pull = Ned::new(-a_r.north, -a_r.east, gravity - a_r.down) * self.vehicle.mass();
        let weight = o.to_axes(pull + state.correction.force());
        let scale = self.vehicle.k_a() * speed;
        Step {
            v_a,
            speed,
            alpha,
            coefficients,
            drag,
            lift: lambda * (scale * speed),
            f_p: weight - v_a * (scale * drag),
            error: o.to_axes(state.velocity - reference.velocity),
            weight,
        }
    }

    /// F_δ without its part by α.
    #[inline(always)]
    fn f_delta(&self, step: &Step, state: &State, ff: &FeedForward) -> Result<Body, Fault> {
        check_feed_forward(ff)?;
        let a = state.orientation.to_axes(ff.air_acceleration);
        let jerk = state.orientation.to_axes(ff.jerk);
        let v = step.v_a;
        let along = v.dot(a) / (step.speed + STILL);
        let by_velocity = (a * step.speed + v * along) * (self.vehicle.k_a() * step.drag);
        Ok(Body::default() - by_velocity - jerk * self.vehicle.mass())
    }

    /// (m_2, m_3).
    #[inline(always)]
    fn turn(
        &self,
        step: &Step,
        norm: f32,
        over_alignment: f32,
        over: f32,
        f_delta: Option<Body>,
    ) -> (f32, f32) {
        let gains = self.gains.at(norm);
        let (error, f_p) = (step.error, step.f_p);
        let (velocity, align) = (norm * gains.k2, norm * gains.k3 * over_alignment);
        let mut m_2 = velocity * error.j + align * f_p.j;
        let mut m_3 = velocity * error.w + align * f_p.w;
        if let Some(f) = f_delta {
            m_2 += over * (f_p.i * f.j - f_p.j * f.i);
            m_3 += over * (f_p.i * f.w - f_p.w * f.i);
        }
        (m_2, m_3)
    }

    #[inline(always)]
    fn command(
        &self,
        step: &Step,
        state: &State,
        reference: &Reference,
        norm: f32,
        (m_2, m_3): (f32, f32),
        [guard_alignment, guard_feed_forward]: [f32; 2],
    ) -> Result<Command, Fault> {
        let push = (self.gains.at(norm).k1 * norm) * step.error.i;
        let f_p = step.f_p;
        // As in hover of the winged vehicle, about i.
        let h = state.orientation.to_axes(reference.heading.vector());
        let square = h.j * h.j + h.w * h.w;
        let share = math::sqrt(square) * self.heading.over_square(square);
        let (y, c) = (share * h.w, share * h.j);
        let twist = self.twice_twist * y / (1.0 + if c > 0.0 { c } else { 0.0 });
        let force = f_p - step.weight;
        check_output(Command {
            thrust: f_p.i - step.lift + push,
            rates: Body::new(twist, -m_3, m_2).into(),
            diagnostics: Diagnostics {
                plane: control::Diagnostics {
                    alpha: step.alpha.rad,
                    f_p: crate::frame::Body::new(f_p.i, math::sqrt(f_p.j * f_p.j + f_p.w * f_p.w)),
                    f_p_norm: norm,
                    t_p: f_p.i + push,
                    guard_alignment,
                    guard_feed_forward,
                    k: 1.0,
                },
                v_a: step.v_a.into(),
                aerodynamic: Body::new(force.i - step.lift, force.j, force.w).into(),
                f_y: f_p.into(),
            },
        })
    }
}

/// (|F_p| + F̄_p1)² \[N²\], by the form that does not cancel near θ̃ = π.
#[inline(always)]
fn alignment_squared(f_p: &Body, norm: f32) -> f32 {
    let sum = norm + f_p.i.abs();
    let alignment = if f_p.i < 0.0 {
        (f_p.j * f_p.j + f_p.w * f_p.w) / sum
    } else {
        sum
    };
    alignment * alignment
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{Combined, CombinedParameters};
    use crate::control::GainParameters;
    use crate::ned::{BodyAxes, Quaternion};
    use crate::spatial::{Heading, Orientation};
    use crate::vehicle::VehicleParameters;
    use rand::{RngExt, SeedableRng};

    fn vehicle(delta: f32) -> Vehicle<Combined> {
        let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        let p = VehicleParameters {
            delta,
            ..VehicleParameters::PAPER
        };
        Vehicle::new(p, model).unwrap()
    }

    fn control() -> AxisymmetricControl<Combined> {
        let gains = Gains::new(GainParameters::PAPER).unwrap();
        AxisymmetricControl::new(vehicle(0.0), gains, 5.0, 0.2).unwrap()
    }

    /// In the plane of i and v_a the force is the planar one, whichever way the plane is turned about the axis.
    #[test]
    fn the_force_is_the_planar_one_in_every_plane_through_the_axis() {
        let (control, planar) = (control(), vehicle(0.0));
        for n in 0..2000 {
            let x = n as f32;
            let (v_i, v_out) = ((x * 0.7) % 41.0 - 20.0, (x * 1.3) % 19.0 + 0.1);
            let (sin, cos) = (x * 0.37).sin_cos();
            let state = State {
                velocity: Orientation::NOSE_UP.of_axes(Body::new(v_i, v_out * cos, v_out * sin)),
                ..State::default()
            };
            let got = control
                .robust(&state, &Reference::default(), None)
                .unwrap()
                .diagnostics
                .aerodynamic;
            let v = crate::frame::Body::new(v_i, v_out);
            let air = crate::air::AirData::new(v, planar.thrust_line());
            let want = planar.aerodynamic_force(&air);
            let error = Body::from(got) - Body::new(want.i(), want.j() * cos, want.j() * sin);
            // 5e-3 N: c_L/sin α times sin α, and weight taken off again, of forces up to 500 N.
            assert!(math::sqrt(error.norm_squared()) < 5e-3, "{v_i} {v_out}");
        }
    }

    #[test]
    fn hover_is_held_by_the_weight_and_turns_to_the_heading() {
        let reference = Reference {
            heading: Heading::from_angle(0.3),
            ..Reference::default()
        };
        let command = control()
            .robust(&State::default(), &reference, None)
            .unwrap();
        assert_eq!((command.thrust, command.rates.yaw), (10.0 * 9.81, 0.0));
        // 2 k_ψ sin/(1 + cos).
        let want = 10.0 * 0.3f32.sin() / (1.0 + 0.3f32.cos());
        assert!((-command.rates.roll - want).abs() < 1e-5);
        assert_eq!(
            control().full(
                &State {
                    orientation: Orientation::from_quaternion(
                        &Quaternion {
                            w: 0.0,
                            x: 1.0,
                            y: 0.0,
                            z: 0.0
                        },
                        BodyAxes::NoseUp
                    )
                    .unwrap(),
                    ..State::default()
                },
                &reference,
                None
            ),
            Err(Fault::Undefined)
        );
    }

    #[test]
    fn bad_parameters_are_named() {
        let gains = Gains::new(GainParameters::PAPER).unwrap();
        let name = |delta, twist, heading| {
            AxisymmetricControl::new(vehicle(delta), gains, twist, heading)
                .unwrap_err()
                .parameter
        };
        assert_eq!(name(0.1, 5.0, 0.2), "delta");
        assert_eq!(name(0.0, 0.0, 0.2), "twist");
        assert_eq!(name(0.0, 5.0, f32::NAN), "heading");
    }

    #[test]
    fn no_input_makes_a_command_that_is_not_a_number() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(6);
        let control = control();
        let (mut commands, mut refused) = (0, 0);
        for round in 0..200_000 {
            let mut x: [f32; 18] = core::array::from_fn(|_| rng.random_range(-30.0..30.0));
            for _ in 0..round % 5 {
                x[rng.random_range(0..18)] = match rng.random_range(0..3) {
                    0 => f32::from_bits(rng.random()),
                    1 => 0.0,
                    _ => f32::from_bits(1),
                };
            }
            let ned = |n: usize| Ned::new(x[n], x[n + 1], x[n + 2]);
            let state = State {
                velocity: ned(0),
                wind: ned(3),
                ..State::default()
            };
            let reference = Reference {
                velocity: ned(6),
                acceleration: ned(9),
                heading: Heading::FREE,
            };
            let ff = FeedForward {
                air_acceleration: ned(12),
                jerk: ned(15),
            };
            for law in [AxisymmetricControl::robust, AxisymmetricControl::full] {
                match law(&control, &state, &reference, Some(&ff)) {
                    Ok(c) => {
                        let sum = c.thrust + c.rates.roll + c.rates.yaw + c.rates.pitch;
                        assert!(sum.is_finite(), "{x:?}");
                        commands += 1;
                    }
                    Err(_) => refused += 1,
                }
            }
        }
        assert!(
            commands > 200_000 && refused > 20_000,
            "{commands} {refused}"
        );
    }
}
