//! What a vehicle can do: where it stalls, how tightly it turns, how steeply it descends, how soon it stops.

use serde::Serialize;

use crate::envelope::{Curve, jump_down, jump_up};
use crate::experiment::{Document, VehicleSpec};
use crate::figures::Figures;
use crate::reference::Vehicle;
use crate::simulate::fly;

/// Where level flight jumps: between these speeds there is no equilibrium to be followed slowly.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Stall {
    /// Airspeed \[m/s\] at which a vehicle that slows down falls off its wing.
    pub slow_m_s: f64,
    /// Airspeed \[m/s\] up to which one that speeds up slowly stays behind the stall.
    pub fast_m_s: f64,
    /// Angles of attack \[°\] at which it does the one and the other.
    pub alpha_deg: [f64; 2],
}

/// What a vehicle can do.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Performance {
    /// The stall band of level flight; none where nothing jumps.
    pub stall: Option<Stall>,
    /// Airspeed \[m/s\] from which on the wing carries the weight, at its greatest lift: the speed of transition.
    pub carried_m_s: f64,
    /// Angle of attack \[°\] and thrust over weight of level cruise; none if there is no cruise on the wing.
    pub cruise: Option<[f64; 2]>,
    /// Greatest load factor in cruise, and the radius of the turn with it \[m\]; none if it cannot turn.
    pub turn: Option<[f64; 2]>,
    /// Steepest glide on the wing in cruise: angle below the horizon \[°\], and sink \[m/s\].
    pub glide: Option<[f64; 2]>,
    /// Distance \[m\] in which it stops when hover is asked at once in cruise, and the least and greatest altitude meanwhile \[m\]: flown.
    pub stop_m: [f64; 3],
}

/// Angles of attack on the wing \[rad\]: from a little below zero lift to the first stall.
fn attached(vehicle: &Vehicle) -> impl Iterator<Item = f64> + '_ {
    const STEP: f64 = 0.05;
    let at = |degrees: f64| vehicle.aerodynamics.at(degrees.to_radians());
    let angles = (0..900).map(|n| -5.0 + f64::from(n) * STEP);
    let rising = angles.take_while(move |degrees| *degrees < 3.0 || at(*degrees).dc_l > 0.0);
    rising.map(f64::to_radians)
}

impl Performance {
    /// Of the vehicle in `document`, which flies its reference, with `thrust` \[N\] (least, most) and at a `cruise` speed [m/s]; `max_turn`
    /// \[g\] is the guidance's limit to the side.
    pub fn of(
        document: &Document,
        spec: &VehicleSpec,
        thrust: [f64; 2],
        cruise: f64,
        max_turn: f64,
    ) -> anyhow::Result<Self> {
        let vehicle = &spec.reference();
        let weight = spec.weight();
        let pressure = vehicle.k_a * cruise * cruise;
        let speed = |a: f64| (a * weight / vehicle.k_a).sqrt();
        let most_lift = attached(vehicle).map(|alpha| vehicle.aerodynamics.at(alpha).c_l);
        let carried = speed(1.0 / most_lift.fold(f64::MIN_POSITIVE, f64::max));

        // Level at the cruise speed at α: thrust balances drag, and lift with its part carries n times the weight.
        let level = |alpha: f64| {
            let c = vehicle.aerodynamics.at(alpha);
            let (sin, cos) = (alpha + vehicle.delta).sin_cos();
            let needed = pressure * c.c_d / cos;
            (needed, (pressure * c.c_l + needed * sin) / weight)
        };
        let trim = attached(vehicle).find(|alpha| level(*alpha).1 >= 1.0);
        let cruises = trim.map(|alpha| [alpha.to_degrees(), level(alpha).0 / weight]);
        let within = attached(vehicle).filter(|alpha| level(*alpha).0 <= thrust[1]);
        let load = within.map(|alpha| level(alpha).1).fold(0.0, f64::max);
        let load = load.min(f64::hypot(1.0, max_turn));
        let turn = (load > 1.0).then(|| {
            let side = vehicle.gravity * (load * load - 1.0).sqrt();
            [load, cruise * cruise / side]
        });

        // A glide at the cruise speed: along the path W sin γ = D − T cos, across it W cos γ = L + T sin.
        let glide = trim.and_then(|trim| {
            let idle = thrust[0];
            let angle = |alpha: f64| {
                let c = vehicle.aerodynamics.at(alpha);
                let (sin, cos) = (alpha + vehicle.delta).sin_cos();
                let along = pressure * c.c_d - idle * cos;
                let across = pressure * c.c_l + idle * sin;
                (along.atan2(across), along.hypot(across) / weight)
            };
            let carries =
                |alpha: &f64| *alpha <= trim + 0.1 && vehicle.aerodynamics.at(*alpha).c_l > 0.0;
            let below = attached(vehicle).filter(carries);
            let off = |alpha: &f64| (angle(*alpha).1 - 1.0).abs();
            let best = below.min_by(|a, b| off(a).total_cmp(&off(b)))?;
            let (gamma, _) = angle(best);
            (gamma > 0.0).then(|| [gamma.to_degrees(), cruise * gamma.sin()])
        });
        Ok(Self {
            stall: stall(vehicle, speed),
            carried_m_s: carried,
            cruise: cruises,
            turn,
            glide,
            stop_m: stop(document, cruise)?,
        })
    }
}

fn stall(vehicle: &Vehicle, speed: impl Fn(f64) -> f64) -> Option<Stall> {
    let curve = Curve::new(vehicle, 0.0)?;
    let folds = curve.folds();
    let (up, down) = (jump_up(&curve, &folds)?, jump_down(&curve, &folds)?);
    Some(Stall {
        slow_m_s: speed(down.a),
        fast_m_s: speed(up.a),
        alpha_deg: [down.from_alpha, up.from_alpha].map(f64::to_degrees),
    })
}

/// Flies `document` with a reference that goes from `cruise` [m/s] to hover at once: how far ahead of that the vehicle comes, and how low and
/// high.
fn stop(document: &Document, cruise: f64) -> anyhow::Result<[f64; 3]> {
    let mut document = document.clone();
    let knot = |time: f64, speed: f64| {
        format!("{{ t_s = {time:?}, down_m_s = 0.0, forward_m_s = {speed:?} }}")
    };
    let start = 2.0 + 0.5 * cruise;
    let knots = [
        knot(2.0, 0.0),
        knot(start, cruise),
        knot(start + 15.0, cruise),
        knot(start + 15.01, 0.0),
    ];
    document.assign(&format!("reference.knots=[{}]", knots.join(",")))?;
    document.assign(&format!("duration_s={:?}", start + 45.0))?;
    let experiment = document.checked()?;
    let figures = Figures::of(&experiment, &fly(&experiment)?);
    Ok(["ahead_m", "loss_back_m", "gain_back_m"].map(|name| figures.get(name)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::{Design, Known, vehicle_text};
    use crate::named::Named;

    /// A flat plate has its numbers in closed form: c_L = c_1 sin 2α, c_D = c_0 + 2 c_1 sin²α.
    #[test]
    fn a_flat_plate_is_what_theory_says() {
        let known = Known {
            mass_kg: Some(2.0),
            wing_m2: Some(0.4),
            section: Some("flat-plate".to_owned()),
            thrust_to_weight: Some(1.8),
            thrust_lag_s: Some(0.05),
            rate_lag_s: Some(0.05),
            cruise_m_s: Some(15.0),
            ..Known::default()
        };
        let design = Design::new(known.facts().unwrap()).unwrap();
        let document = Document::new(&Named {
            name: "plate".to_owned(),
            origin: "plate".to_owned(),
            text: vehicle_text("plate", &design),
            file: None,
        });
        let vehicle = design.vehicle();
        let thrust = design.facts.thrust();
        let p = Performance::of(&document.unwrap(), &vehicle, thrust, 15.0, 2.0).unwrap();
        assert_eq!(p.stall, None);
        // Greatest lift is c_1 = (2.01 − 0.02)/2 at 45°; angles are looked at to 40°, where sin 2α is 0.985.
        let want = (vehicle.weight() / (vehicle.k_a_kg_m * 0.995 * 0.985)).sqrt();
        assert!((p.carried_m_s / want - 1.0).abs() < 2e-3, "{p:?}");
        // Level: q (c_L + c_D tan α) = W, and c_L + c_D tan α is (2 c_1 + c_0) tan α; angles are in steps of 0.05°.
        let pressure = vehicle.k_a_kg_m * 225.0;
        let trim = (vehicle.weight() / (pressure * (1.99 + 0.02)))
            .atan()
            .to_degrees();
        assert!((p.cruise.unwrap()[0] - trim).abs() < 0.06, "{p:?} {trim}");
        // Without thrust the glide is not steeper than drag over lift at small angles, and sinks by its angle.
        let [glide, sink] = p.glide.unwrap();
        assert!(glide > 5.0 && glide < 30.0);
        assert!((sink - 15.0 * glide.to_radians().sin()).abs() < 1e-9);
        // The load factor is bound by 2 g to the side.
        let [load, radius] = p.turn.unwrap();
        assert!(load <= 5f64.sqrt() + 1e-9 && radius > 225.0 / (2.0 * 9.82));
        // It stops, and neither falls nor climbs far.
        let [stop, loss, gain] = p.stop_m;
        assert!(stop > 5.0 && stop < 60.0, "{stop}");
        assert!(loss < 5.0 && gain < 10.0, "{loss} {gain}");
    }
}
