//! The figure of a set of equilibria: F̄_2 against θ, and what thrust holds each.

use super::Figure;
use super::chart::{BLUE, Chart, Mark, ORANGE, Series};
use alula_sim::reference::{Vector, Vehicle, rotation};

/// The figure of `vehicle` at a reference velocity and acceleration in a wind, with the equilibria (θ, T) \[rad, N\].
pub fn figure(
    vehicle: &Vehicle,
    [velocity, acceleration, wind]: [Vector; 3],
    equilibria: &[(f64, f64)],
) -> Figure {
    // F in body components, over the weight.
    let body = |degrees: f64| {
        let theta = degrees.to_radians();
        let air = vehicle.air(velocity, wind, theta);
        let force = rotation(theta).transpose() * vehicle.f(&air, acceleration);
        force / (vehicle.mass * vehicle.gravity)
    };
    let angles = || (-720..=720).map(|n| f64::from(n) * 0.25);
    let chart = |title, name, of: fn(Vector) -> f64, marks| {
        let points = angles().map(|theta| (theta, of(body(theta)))).collect();
        let zero = vec![(-180.0, 0.0), (180.0, 0.0)];
        let series = vec![
            Series::line(name, BLUE, points),
            Series::dashed("zero", ORANGE, zero),
        ];
        Chart {
            marks,
            ..Chart::over(title, "orientation θ [°]", series)
        }
    };
    let weight = vehicle.mass * vehicle.gravity;
    // The label of one among neighbours goes above that of the one before.
    let shift = |theta: f64| {
        let ahead = |e: &&(f64, f64)| (1e-9..0.4).contains(&(theta - e.0));
        -16 * equilibria.iter().filter(ahead).count() as i32
    };
    let mark = |theta: f64, y: f64, shift: i32| Mark {
        at: (theta.to_degrees(), y),
        label: format!("{:.1}°", theta.to_degrees()),
        shift,
    };
    let across = equilibria.iter().map(|e| mark(e.0, 0.0, shift(e.0) - 10));
    let along = equilibria.iter().map(|e| mark(e.0, e.1 / weight, 0));
    Figure::new(
        &[
            chart(
                "force across the thrust line F·j/(m g): zero at an equilibrium",
                "F·j/(m g)",
                |f| f.y,
                across.collect(),
            ),
            chart(
                "force along it F·i/(m g): the thrust at an equilibrium",
                "F·i/(m g)",
                |f| f.x,
                along.collect(),
            ),
        ],
        310.0,
    )
}
