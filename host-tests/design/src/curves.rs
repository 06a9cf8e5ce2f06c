//! What there is to understand of a vehicle, as curves for a viewer: coefficients and λ over α, equilibria over airspeed.

use serde::Serialize;

use crate::envelope::Curve;
use alula_sim::reference::{Vehicle, wrap};

/// Level accelerations of the cuts \[m/s²\].
const ACCELERATIONS: [f64; 7] = [-6.0, -4.0, -2.0, 0.0, 2.0, 4.0, 6.0];
/// Degrees between two angles of attack of the coefficients.
const STEP_DEG: f64 = 1.0;
/// Points of a cut.
const POINTS: usize = 360;

/// Curves of a vehicle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Curves {
    /// Weight \[N\].
    pub weight_n: f64,
    /// k_a \[kg/m\].
    pub k_a_kg_m: f64,
    /// δ \[°\]: from the zero-lift line to the thrust line.
    pub delta_deg: f64,
    /// α of the zero-lift line \[°\], c_L, c_D, λ.
    pub coefficients: Vec<[f64; 4]>,
    /// Equilibria with aligned thrust, a cut per acceleration.
    pub cuts: Vec<Cut>,
}

/// The equilibria of level flight in one acceleration.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cut {
    /// The acceleration \[m/s²\].
    pub acceleration_m_s2: f64,
    /// By decreasing α: α \[°\], airspeed \[m/s\], |F_p| over the weight, thrust over the weight.
    pub points: Vec<[f64; 4]>,
    /// The folds: α \[°\] and airspeed \[m/s\].
    pub folds: Vec<[f64; 2]>,
}

impl Curves {
    /// The curves of `vehicle`, up to this airspeed \[m/s\].
    pub fn of(vehicle: &Vehicle, fastest: f64) -> Self {
        let weight = vehicle.mass * vehicle.gravity;
        let steps = (180.0 / STEP_DEG) as i32;
        let coefficients = (-steps..=steps).map(|i| {
            let deg = f64::from(i) * STEP_DEG;
            let alpha = deg.to_radians();
            let c = vehicle.aerodynamics.at(wrap(alpha));
            [deg, c.c_l, c.c_d, lambda(vehicle, alpha)]
        });
        Self {
            weight_n: weight,
            k_a_kg_m: vehicle.k_a,
            delta_deg: vehicle.delta.to_degrees(),
            coefficients: coefficients.collect(),
            cuts: ACCELERATIONS
                .iter()
                .filter_map(|&acceleration| Cut::of(vehicle, acceleration, fastest))
                .collect(),
        }
    }
}

/// λ(α), the lift slope of the change of variable: c_L' cos(α+δ) + c_D' sin(α+δ).
fn lambda(vehicle: &Vehicle, alpha: f64) -> f64 {
    let c = vehicle.aerodynamics.at(wrap(alpha));
    let (sin, cos) = (alpha + vehicle.delta).sin_cos();
    c.dc_l * cos + c.dc_d * sin
}

impl Cut {
    /// The cut at this level acceleration \[m/s²\], if there is one.
    fn of(vehicle: &Vehicle, acceleration: f64, fastest: f64) -> Option<Self> {
        let epsilon = (acceleration / vehicle.gravity).atan();
        let curve = Curve::new(vehicle, epsilon)?;
        // The apparent weight, m |g − a|.
        let weight = vehicle.mass * vehicle.gravity;
        let apparent = weight / epsilon.cos();
        let speed = |a: f64| (a * apparent / vehicle.k_a).sqrt();
        let (from, to) = curve.range();
        let point = |i: usize| {
            let alpha = to - (to - from) * (i as f64 + 0.5) / POINTS as f64;
            let airspeed = speed(curve.a(alpha));
            let c = vehicle.aerodynamics.at(wrap(alpha));
            let (sin, cos) = (alpha + vehicle.delta).sin_cos();
            let pressure = vehicle.k_a * airspeed * airspeed;
            // Along the nose: thrust and the air's force carry the apparent weight, whose direction is ε from straight up.
            let ahead = apparent * (alpha + vehicle.delta + epsilon).sin();
            let thrust = ahead + pressure * (c.c_d * cos - c.c_l * sin);
            let f_p = thrust + lambda(vehicle, alpha) * pressure;
            [
                alpha.to_degrees(),
                airspeed,
                f_p.abs() / weight,
                thrust / weight,
            ]
        };
        let points = (0..POINTS).map(point).filter(|p| p[1] <= fastest).collect();
        let folds = curve.folds().into_iter();
        Some(Self {
            acceleration_m_s2: acceleration,
            points,
            folds: folds
                .map(|fold| [fold.alpha.to_degrees(), speed(fold.a)])
                .collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alula_sim::airframe::Airframe;

    /// Hover stands on the thrust alone; level flight and level acceleration balance along and across the flight path.
    #[test]
    fn equilibria_of_the_cuts_balance() {
        let vehicle = Airframe::load("paper").unwrap().reference();
        let curves = Curves::of(&vehicle, 30.0);
        assert_eq!(curves.cuts.len(), ACCELERATIONS.len());
        for cut in &curves.cuts {
            assert!(cut.points.len() > 100);
            for [alpha, speed, _, thrust] in &cut.points {
                let alpha = alpha.to_radians();
                let c = vehicle.aerodynamics.at(wrap(alpha));
                let pressure = vehicle.k_a * speed * speed;
                let thrust = thrust * curves.weight_n;
                let (sin, cos) = (alpha + vehicle.delta).sin_cos();
                let lift = thrust * sin + pressure * c.c_l;
                let ahead = thrust * cos - pressure * c.c_d;
                // 1e-6: of sums of hundreds of newtons.
                assert!(
                    (lift - curves.weight_n).abs() < 1e-6,
                    "{lift} {}",
                    curves.weight_n
                );
                assert!((ahead - vehicle.mass * cut.acceleration_m_s2).abs() < 1e-6);
            }
        }
        // The paper's vehicle has folds in level flight, and F_p is least near the second one.
        let level = curves.cuts.iter().find(|cut| cut.acceleration_m_s2 == 0.0);
        assert_eq!(level.unwrap().folds.len(), 2);
    }
}
