//! What a person measures of a tail-sitter before its first flight, and what a controller believes of it then.

use std::f64::consts::FRAC_PI_4;

use nalgebra::UnitQuaternion;

use super::{GRAVITY, RHO, TailSitter, TailSitterState, V3};
use crate::experiment::AuthoritySpec;
use crate::experiment::tail_sitter::{Propeller, TailSitterSpec};
use crate::plant::Command;

/// Step of the table of the wing \[°\], short of 30° and from there on.
const STEPS: [f64; 2] = [1.0, 5.0];
/// Where the step changes \[°\].
const FINE: f64 = 30.0;
/// Step of the rate with which the lag is measured \[rad/s\], and the part of it that a lag of first order makes in its time.
const STEP: f64 = 0.2;
const PART: f64 = 0.632;
/// Time in which the integral of a rate loop has trimmed a hover \[s\].
const TRIM: f64 = 3.0;

/// The quantities of a belief: of the whole vehicle without slipstream, elevons at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Belief {
    /// k_a = ρ Σ/2 \[kg/m\].
    pub k_a_kg_m: f64,
    /// Side force coefficient.
    pub c_y: f64,
    /// Rows of α \[°\] to the thrust line, c_L and c_D, from −180° to 180°.
    pub polar: Vec<[f64; 3]>,
    /// Static thrust at full throttle, on the battery that sags \[N\].
    pub thrust_max_n: f64,
    /// Time until 63 % of a step of the pitch rate is there, in a hover that is trimmed \[s\].
    pub rate_lag_s: f64,
    /// Lag of the motors' speed \[s\].
    pub thrust_lag_s: f64,
    /// What turns it in pitch, and thrust over airspeed.
    pub authority: AuthoritySpec,
}

impl Belief {
    /// The belief about a vehicle.
    pub fn of(spec: &TailSitterSpec) -> Self {
        let vehicle = TailSitter::new(spec.clone(), None);
        let level = spec.wing.strips.iter().filter(|strip| !strip.upright);
        let area: f64 = level.map(|strip| strip.span_m * strip.chord_m).sum();
        let k_a_kg_m = 0.5 * RHO * area;
        let force = |air: V3| {
            let still = TailSitterState {
                velocity: air,
                ..TailSitterState::at_rest()
            };
            vehicle.wrench(&still, V3::zeros()).force / k_a_kg_m
        };
        let row = |degrees: f64| {
            let (sin, cos) = libm::sincos(degrees.to_radians());
            let f = force(V3::new(cos, 0.0, sin));
            let lift = f.x * sin - f.z * cos;
            let drag = -(f.x * cos + f.z * sin);
            [degrees, lift, drag]
        };
        let mut polar: Vec<[f64; 3]> = angles().map(row).collect();
        // At 180° stands what stands at −180°, to the last bit.
        let [_, lift, drag] = polar[0];
        polar.push([180.0, lift, drag]);
        let (sin, cos) = libm::sincos(SIDESLIP);
        Self {
            k_a_kg_m,
            c_y: -force(V3::new(cos, sin, 0.0)).y / sin,
            polar,
            thrust_max_n: vehicle.static_thrust() * (1.0 - spec.motors.sag).powi(2),
            rate_lag_s: rate_lag(&vehicle, STEP),
            thrust_lag_s: spec.motors.lag_s,
            authority: authority(&vehicle),
        }
    }
}

/// Sideslip at which the side force is measured \[rad\].
const SIDESLIP: f64 = 0.1;

/// Angles of the table \[°\] from −180° to before 180°.
fn angles() -> impl Iterator<Item = f64> {
    let mut next = -180.0;
    std::iter::from_fn(move || {
        let angle: f64 = next;
        let [fine, coarse] = STEPS;
        let inside = (-FINE..FINE).contains(&angle);
        next += if inside { fine } else { coarse };
        (angle < 180.0).then_some(angle)
    })
}

/// Time until 63 % of a `step` of the pitch rate [rad/s] is there, in hover, of a vehicle that is held at rest and whose loop has trimmed it \[s\]; at most 1 s.
fn rate_lag(vehicle: &TailSitter, step: f64) -> f64 {
    let dt = 1.0 / vehicle.spec().rate_loop.rate_hz;
    let held = vehicle.hover();
    let mut state = held;
    let mut rate = |pitch: f64| {
        let command = Command {
            thrust: vehicle.spec().mass_kg * GRAVITY,
            rates: V3::new(0.0, pitch, 0.0),
        };
        state = TailSitterState {
            position: held.position,
            velocity: held.velocity,
            attitude: held.attitude,
            ..vehicle.step(&state, &command, V3::zeros(), dt)
        };
        state.rates.y
    };
    let periods = |seconds: f64| (seconds / dt).round() as usize;
    let mut last = (0..periods(TRIM)).fold(0.0, |_, _| rate(0.0));
    for period in 0..periods(1.0) {
        let next = rate(step);
        if next / step >= PART {
            return dt * (period as f64 + (PART * step - last) / (next - last));
        }
        last = next;
    }
    1.0
}

/// What turns it in pitch: moments of elevons and of motors in hover and in a glide, of the wing across the flow, and the propellers' geometry.
fn authority(vehicle: &TailSitter) -> AuthoritySpec {
    let spec = vehicle.spec();
    let weight = spec.mass_kg * GRAVITY;
    let share = weight / vehicle.static_thrust();
    let inertia = spec.inertia_kg_m2[1];
    let travel = spec.servo.travel_deg.to_radians();
    let half = |one: TailSitterState, other: TailSitterState| {
        let [a, b] = [one, other].map(|state| vehicle.wrench(&state, V3::zeros()));
        let turned = 0.5 * (a.torque.y - b.torque.y) / inertia;
        (turned, 0.5 * (a.force.z - b.force.z) / spec.mass_kg)
    };
    // Trailing edges up turn the nose up.
    let elevons = |state: &TailSitterState, part: f64| TailSitterState {
        elevons: [-part * travel; 2],
        ..*state
    };
    let hover = vehicle.hover();
    let (slipstream, force) = half(elevons(&hover, 1.0), elevons(&hover, -1.0));
    let motors = |part: f64| TailSitterState {
        elevons: [0.0; 2],
        ..vehicle.settled(&hover, share, V3::new(0.0, part, 0.0))
    };
    let (difference, _) = half(motors(1.0), motors(-1.0));
    let glide = TailSitterState {
        velocity: V3::new(spec.cruise_speed_m_s, 0.0, 0.0),
        ..TailSitterState::at_rest()
    };
    let (airflow, _) = half(elevons(&glide, 1.0), elevons(&glide, -1.0));
    let across = TailSitterState {
        velocity: V3::new(0.0, 0.0, spec.cruise_speed_m_s),
        ..TailSitterState::at_rest()
    };
    let wing = -vehicle.wrench(&across, V3::zeros()).torque.y / inertia;
    let square = spec.cruise_speed_m_s * spec.cruise_speed_m_s;
    let discs: f64 = spec
        .propellers
        .iter()
        .map(|p| FRAC_PI_4 * p.diameter_m * p.diameter_m)
        .sum();
    AuthoritySpec {
        constant_rad_s2: 0.0,
        slipstream_rad_s2: slipstream,
        difference_rad_s2: difference * share / share.min(1.0 - share),
        airflow_rad_m2: airflow / square,
        wing_moment_rad_m2: (wing / square).max(0.0),
        roll_rad_m_s2: roll(vehicle) * spec.cruise_speed_m_s,
        surface_reaction_m: if slipstream > 0.0 {
            force / slipstream
        } else {
            0.0
        },
        hover_downwash_m_s: (weight / (2.0 * RHO * discs)).sqrt(),
        zero_thrust_speed_m_s: zero_thrust_speed(spec),
    }
}

/// Rate about the nose [rad/s] in level cruise at which the wings take all that turns it.
fn roll(vehicle: &TailSitter) -> f64 {
    let spec = vehicle.spec();
    let weight = spec.mass_kg * GRAVITY;
    let cruise = |degrees: f64| {
        let (sin, cos) = libm::sincos(degrees.to_radians());
        TailSitterState {
            velocity: spec.cruise_speed_m_s * V3::new(cos, 0.0, sin),
            ..TailSitterState::at_rest()
        }
    };
    let settled = |share: f64, roll: f64, degrees: f64| {
        vehicle.settled(&cruise(degrees), share, V3::new(roll, 0.0, 0.0))
    };
    // Share of the static thrust, and angle of attack, at which forces along and across the nose are those of level flight.
    let (mut share, mut degrees) = (0.3, 3.0);
    for _ in 0..100 {
        let force = vehicle
            .wrench(&settled(share, 0.0, degrees), V3::zeros())
            .force;
        let (sin, cos) = libm::sincos(degrees.to_radians());
        share = (share - 0.3 * (force.x - weight * sin) / vehicle.static_thrust()).clamp(0.0, 1.0);
        degrees += 2.0 * (force.z + weight * cos) / weight;
    }
    let torque = |roll: f64, rate: f64| {
        let state = TailSitterState {
            rates: V3::new(rate, 0.0, 0.0),
            ..settled(share, roll, degrees)
        };
        vehicle.wrench(&state, V3::zeros()).torque.x
    };
    const RATE: f64 = 0.1;
    let damping = (torque(0.0, -RATE) - torque(0.0, RATE)) / (2.0 * RATE);
    0.5 * (torque(1.0, 0.0) - torque(-1.0, 0.0)) / damping
}

/// Airspeed at which full throttle gives no thrust, in the mean of the propellers \[m/s\]; 0 if it never falls.
fn zero_thrust_speed(spec: &TailSitterSpec) -> f64 {
    let speed = |p: &Propeller| {
        let [c0, c1, c2] = p.c_t;
        let j = 2.0 * c0 / (-c1 + (c1 * c1 - 4.0 * c2 * c0).sqrt());
        j * p.speed_max_rev_s * p.diameter_m
    };
    let mean = spec.propellers.iter().map(speed).sum::<f64>() / spec.propellers.len() as f64;
    if mean.is_finite() { mean } else { 0.0 }
}

impl TailSitterState {
    /// At rest, nose to the north and level, motors and elevons at rest.
    pub fn at_rest() -> Self {
        Self {
            position: V3::zeros(),
            velocity: V3::zeros(),
            attitude: UnitQuaternion::identity(),
            rates: V3::zeros(),
            motors: [0.0; super::MOTORS],
            elevons: [0.0; 2],
            rate_loop: super::RateLoopState::default(),
            targets: super::Targets::default(),
            tick: 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::tail_sitter::VEHICLES;

    /// A loop that is trimmed answers alike up and down: one whose integral is still finding its trim makes a step one way in a third of the time that it takes the other
    /// way.
    #[test]
    fn a_trimmed_loop_answers_alike_up_and_down() {
        for (name, text) in VEHICLES {
            let vehicle = TailSitter::new(toml::from_str(text).unwrap(), None);
            let [up, down] = [STEP, -STEP].map(|step| rate_lag(&vehicle, step));
            assert!((up / down - 1.0).abs() < 0.02, "{name}: {up}, {down}");
        }
    }
}
