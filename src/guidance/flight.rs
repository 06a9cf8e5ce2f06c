//! The virtual flight: the vehicle as it is believed to be, flown ahead of the real one.
//!
//! Its attitude follows a target within the limits of rate and slew, its thrust stays within its limits, and its velocity
//! follows from the believed forces. So whatever it does can be flown, as far as the belief is right.

use super::memory::memory;
use super::parameters::GuidanceParameters;
use crate::aero::Aerodynamics;
use crate::air::AirData;
use crate::equivalency::lambda;
use crate::frame::{Attitude, Body, Inertial};
use crate::math;
use crate::reference::Reference;
use crate::vehicle::Vehicle;

/// Part of the actuators' limits that the virtual flight uses. The rest is left for corrections.
const SHARE_OF_RATE: f32 = 0.965;
const SHARE_OF_SLEW: f32 = 0.83;
/// Rate [1/s] with which the attitude goes to its target.
const ATTITUDE_GAIN: f32 = 8.0;
/// Greatest step of the servo \[rad\]: beyond it the linearisation says nothing.
const MAX_CORRECTION: f32 = 0.3;
/// Vertical servo: acceleration per velocity error [1/s] and per altitude error [1/s²].
const VERTICAL_GAIN: f32 = 4.0;
const ALTITUDE_GAIN: f32 = 4.0;
/// Forward servo: acceleration per velocity error [1/s].
const FORWARD_GAIN: f32 = 1.0;
/// Greatest accelerations that the servo asks for, in g.
const MAX_VERTICAL: f32 = 0.8;
const MAX_FORWARD: f32 = 1.5;
/// Weight of forward accelerations against vertical ones.
const FORWARD_WEIGHT: f32 = 0.1;
/// Damping of the servo's step, as a force in multiples of the weight, with [`FORWARD_WEIGHT`].
const DAMPING: f32 = 0.3;
/// Acceleration downwards of a push-over, in g.
const PUSH_OVER: f32 = 0.8;
/// Altitude errors beyond this, in altitude bands, ask for no more acceleration.
const MAX_BANDS: f32 = 7.5;
/// Distance from the target \[rad\] at which a turn is over.
const ARRIVED: f32 = 0.1;
/// Gains are lowered in steps longer than these products of gain and step, which would overshoot.
const ATTITUDE_STEP: f32 = 0.8;
const VERTICAL_STEP: f32 = 0.6;
/// Steps \[s\] shorter than this are the virtual flight's own. In longer ones, those of a prediction, the servo is not
/// limited in slew: it takes a part of a step only.
const OWN_STEP: f32 = 0.021;

/// Where the virtual vehicle is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Flight {
    /// Velocity [m/s].
    pub velocity: Inertial,
    /// Position less reference position \[m\].
    pub position: Inertial,
    /// Attitude θ \[rad\].
    pub theta: f32,
    /// Its rate ω [rad/s].
    pub rate: f32,
    /// Thrust \[N\].
    pub thrust: f32,
}

/// What is to be done with the attitude: perhaps a push-over, perhaps a turn, and from then on the servo.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Plan {
    /// Time of push-over left before the turn \[s\].
    pub push: f32,
    /// Attitude to turn to \[rad\].
    pub target: f32,
    /// 1 until the turn is over. A number: every bit pattern has a meaning.
    pub turn: u8,
}

memory!(Plan {
    push: f32,
    target: f32,
    turn: u8,
});

/// The virtual vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct VirtualVehicle {
    rate: f32,
    slew: f32,
    pub(super) position_gain: Inertial,
    pub(super) max_velocity: Inertial,
    max_altitude_error: f32,
}

/// The forces F of a wish for an acceleration, and how they turn with the attitude.
struct Forces {
    attitude: Attitude,
    /// F = m (g i0 − a) + F_a \[N\]. Inertial components.
    f: Inertial,
    /// λ k_a|v_a|² \[N\].
    change: f32,
    /// Derivative of F − T i along i, per radian \[N\]; along j it is −(T + λ k_a|v_a|²).
    slope: f32,
    /// Drag per velocity and mass [1/s].
    drag_rate: f32,
}

impl VirtualVehicle {
    /// The virtual vehicle with these parameters, which have been checked.
    pub fn new(p: &GuidanceParameters) -> Self {
        Self {
            rate: SHARE_OF_RATE * p.max_rate,
            slew: SHARE_OF_SLEW * p.max_slew,
            position_gain: Inertial::new(p.position_gain_down, p.position_gain_forward),
            max_velocity: Inertial::new(p.max_velocity_down, p.max_velocity_forward),
            max_altitude_error: MAX_BANDS * p.altitude_band,
        }
    }

    /// The velocity to be had at a `position` error: the reference's, and towards the reference position.
    #[inline(always)]
    pub fn velocity_wanted(&self, position: Inertial, reference: Inertial) -> Inertial {
        Inertial::new(
            reference.down()
                - limited(
                    self.position_gain.down() * position.down(),
                    self.max_velocity.down(),
                ),
            reference.forward()
                - limited(
                    self.position_gain.forward() * position.forward(),
                    self.max_velocity.forward(),
                ),
        )
    }

    /// The acceleration that the servo wants [m/s²].
    #[inline(always)]
    fn wish(&self, flight: &Flight, reference: &Reference, gravity: f32, h: f32) -> Inertial {
        let wanted = self.velocity_wanted(flight.position, reference.velocity);
        let vertical = math::min(VERTICAL_GAIN, VERTICAL_STEP / h);
        let down = reference.acceleration.down()
            + vertical * (reference.velocity.down() - flight.velocity.down())
            - ALTITUDE_GAIN * limited(flight.position.down(), self.max_altitude_error);
        let forward = reference.acceleration.forward()
            + FORWARD_GAIN * (wanted.forward() - flight.velocity.forward());
        Inertial::new(
            limited(down, MAX_VERTICAL * gravity),
            limited(forward, MAX_FORWARD * gravity),
        )
    }

    /// Lets `flight` pass for `h` \[s\] by `plan`, and gives its acceleration [m/s²].
    ///
    /// The servo's step is one Gauss–Newton step over (θ, T), damped, with T in its limits: where thrust is free it goes to
    /// F̄_2 = 0 and T = F̄_1; where thrust stands at a limit it goes to the attitude with the least weighted error. It looks
    /// at no sign of a slope, so it holds equilibria of either branch.
    #[inline(always)]
    pub fn advance<A: Aerodynamics>(
        &self,
        vehicle: &Vehicle<A>,
        flight: &mut Flight,
        plan: &mut Plan,
        reference: &Reference,
        wind: Inertial,
        h: f32,
    ) -> Inertial {
        let (mass, gravity) = (vehicle.mass(), vehicle.gravity());
        let turning = plan.turn == 1;
        let pushing = turning && plan.push > 0.0;
        let mut wish = self.wish(flight, reference, gravity, h);
        let mut weight = FORWARD_WEIGHT;
        if pushing {
            wish = Inertial::new(PUSH_OVER * gravity, wish.forward());
            weight *= 0.02;
        }
        let forces = Forces::new(vehicle, flight.theta, flight.velocity - wind, wish);
        let Forces { f, attitude, .. } = &forces;
        let (least, most) = (vehicle.thrust_min(), vehicle.thrust_max());

        // Least squares of F − T i, down and forward weighted: first over T alone,
        let ii = attitude.cos * attitude.cos + weight * attitude.sin * attitude.sin;
        let fi = f.down() * attitude.cos + weight * f.forward() * attitude.sin;
        let alone = math::clamp(fi / ii, least, most);
        // then over T and θ, where F − T i changes by d per radian.
        let d = attitude.to_inertial(Body::new(forces.slope, -(alone + forces.change)));
        let damping = DAMPING * vehicle.weight();
        let dd = d.down() * d.down() + weight * (d.forward() * d.forward() + damping * damping);
        let di = d.down() * attitude.cos + weight * d.forward() * attitude.sin;
        let fd = f.down() * d.down() + weight * f.forward() * d.forward();
        let both = math::clamp((fi * dd - di * fd) / (dd * ii - di * di), least, most);
        let (thrust, error) = if turning && !pushing {
            (alone, plan.target - flight.theta)
        } else {
            (both, limited((di * both - fd) / dd, MAX_CORRECTION))
        };

        let acceleration = wish
            + Inertial::new(
                (f.down() - thrust * attitude.cos) / mass,
                (f.forward() - thrust * attitude.sin) / mass,
            );
        // Drag is stiff where the speed is high: implicit in it.
        flight.velocity += acceleration * (h / (1.0 + h * forces.drag_rate));
        flight.position += (flight.velocity - reference.velocity) * h;
        let gain = math::min(ATTITUDE_GAIN, ATTITUDE_STEP / h);
        let wanted = limited(gain * error, self.rate);
        flight.rate = if (turning && !pushing) || h < OWN_STEP {
            let slew = self.slew * h;
            math::clamp(wanted, flight.rate - slew, flight.rate + slew)
        } else {
            wanted
        };
        flight.theta += flight.rate * h;
        flight.thrust = thrust;

        if pushing {
            plan.push -= h;
        } else if error.abs() < ARRIVED {
            plan.turn = 0;
        }
        acceleration
    }
}

impl Forces {
    #[inline(always)]
    fn new<A: Aerodynamics>(
        vehicle: &Vehicle<A>,
        theta: f32,
        air_velocity: Inertial,
        acceleration: Inertial,
    ) -> Self {
        let attitude = Attitude::from_angle(theta);
        let air = AirData::new(attitude.to_body(air_velocity), vehicle.thrust_line());
        let c = vehicle.model().coefficients(air.alpha);
        let pressure = vehicle.k_a() * air.speed * air.speed;
        let aerodynamic = attitude.to_inertial(Body::new(
            pressure * (c.c_d * air.cos - c.c_l * air.sin),
            -pressure * (c.c_l * air.cos + c.c_d * air.sin),
        ));
        let mass = vehicle.mass();
        Self {
            attitude,
            f: Inertial::new(
                mass * (vehicle.gravity() - acceleration.down()) + aerodynamic.down(),
                aerodynamic.forward() - mass * acceleration.forward(),
            ),
            change: lambda(&c, &air) * pressure,
            slope: pressure * (c.dc_d * air.cos - c.dc_l * air.sin),
            drag_rate: vehicle.k_a() * air.speed * c.c_d / mass,
        }
    }
}

/// F̄_2 \[N\] at an attitude `theta` \[rad\] for an acceleration [m/s²]: zero in equilibrium.
#[inline(always)]
pub(super) fn across<A: Aerodynamics>(
    vehicle: &Vehicle<A>,
    theta: f32,
    air_velocity: Inertial,
    acceleration: Inertial,
) -> f32 {
    let forces = Forces::new(vehicle, theta, air_velocity, acceleration);
    forces.attitude.to_body(forces.f).j()
}

/// `x` within ±`bound`.
#[inline(always)]
pub(super) fn limited(x: f32, bound: f32) -> f32 {
    math::clamp(x, -bound, bound)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{Combined, CombinedParameters};
    use crate::vehicle::VehicleParameters;
    use rand::{RngExt, SeedableRng};

    const DT: f32 = 0.01;

    fn vehicle() -> Vehicle<Combined> {
        let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        Vehicle::new(VehicleParameters::PAPER, model).unwrap()
    }

    fn still(down: f32, forward: f32) -> Reference {
        Reference {
            velocity: Inertial::new(down, forward),
            acceleration: Inertial::ZERO,
        }
    }

    /// The acceleration is that of the believed forces, thrust, rate and slew are inside their limits, whatever is asked.
    #[test]
    fn the_virtual_flight_can_be_flown() {
        let p = GuidanceParameters::default();
        let (vehicle, virtual_vehicle) = (vehicle(), VirtualVehicle::new(&p));
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(3);
        for _ in 0..200 {
            let mut draw = |x: f32| random.random_range(-x..x);
            let mut flight = Flight {
                velocity: Inertial::new(draw(25.0), draw(25.0)),
                position: Inertial::new(draw(20.0), draw(50.0)),
                theta: draw(3.1),
                rate: draw(2.0),
                thrust: 0.0,
            };
            let mut plan = Plan {
                push: draw(0.3),
                target: flight.theta + draw(3.1),
                turn: 1,
            };
            let (reference, wind) = (still(draw(10.0), draw(20.0)), Inertial::new(0.0, draw(5.0)));
            for _ in 0..200 {
                let before = flight;
                let a =
                    virtual_vehicle.advance(&vehicle, &mut flight, &mut plan, &reference, wind, DT);
                let attitude = Attitude::from_angle(before.theta);
                let body = attitude.to_body(before.velocity - wind);
                let air = AirData::new(body, vehicle.thrust_line());
                let force = attitude.to_inertial(vehicle.aerodynamic_force(&air))
                    - attitude.to_inertial(Body::new(flight.thrust, 0.0));
                let expected = force / vehicle.mass() + Inertial::new(vehicle.gravity(), 0.0);
                // 1e-2: roundings of forces of up to 5 kN, over 10 kg.
                assert!((a - expected).norm() < 1e-2);
                assert!((0.0..=196.2).contains(&flight.thrust));
                assert!((flight.rate - before.rate).abs() <= p.max_slew * DT);
                assert!(flight.rate.abs() <= p.max_rate);
                assert!(flight.velocity.norm() + flight.position.norm() < 1e5);
            }
        }
    }

    /// From hover the servo finds the equilibria of slow forward flight, of flight sideways to the wind, and of a
    /// descent tail first, which is on the other branch.
    #[test]
    fn the_servo_settles_in_equilibria_of_both_branches() {
        let (vehicle, virtual_vehicle) = (
            vehicle(),
            VirtualVehicle::new(&GuidanceParameters::default()),
        );
        for (down, forward, wind) in [(0.0, 10.0, 0.0), (0.0, 0.0, -6.0), (12.0, 0.0, 0.0)] {
            let (mut flight, mut plan) = (Flight::default(), Plan::default());
            let wind = Inertial::new(0.0, wind);
            let mut acceleration = Inertial::ZERO;
            for n in 0..3000 {
                let part = math::min(n as f32 / 1000.0, 1.0);
                let reference = still(down * part, forward * part);
                acceleration =
                    virtual_vehicle.advance(&vehicle, &mut flight, &mut plan, &reference, wind, DT);
            }
            let error = flight.velocity - Inertial::new(down, forward);
            // 1 cm/s, 1 cm/s², 0.1 N: what is left of slow decays.
            assert!(error.norm() < 0.01 && acceleration.norm() < 0.01);
            let v_a = flight.velocity - wind;
            let left = across(&vehicle, flight.theta, v_a, Inertial::ZERO);
            assert!(left.abs() < 0.1, "{left}");
            let slope = across(&vehicle, flight.theta + 0.01, v_a, Inertial::ZERO);
            // ∂_θ F̄_2 = −F̄_p1: negative on θ̃ = 0.
            assert_eq!(slope > 0.0, down > 9.0);
        }
    }
}
