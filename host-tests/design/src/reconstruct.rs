//! The attitude that goes with how the vehicle moved: an estimator's is off by a degree or two, and drifts.
//!
//! What the accelerometer tells, turned by the true attitude, is the change of the velocity less gravity (flight-path reconstruction; Klein and Morelli,
//! *Aircraft System Identification*, chapter 10). Over windows of a few seconds
//!
//! Δv − g Δt = ∫ R (f + d × f − β) dt,
//!
//! with the told attitude R, the turn d from the told body axes to the true ones, which wanders, and the accelerometer's constant β. A Kalman filter
//! and its smoother give d; about the vertical it stays as told.

use alula_logs::states::States;
use nalgebra::{Matrix3, Quaternion, SMatrix, SVector, UnitQuaternion, Vector3};

/// Length of a window \[s\].
const WINDOW: f64 = 2.0;
/// Standard deviations: of the turn at the start \[rad\], of its walk [rad/√s], of β [m/s²], and of what a window's change of velocity is off by [m/s].
const TURN: f64 = 0.05;
const WALK: f64 = 0.005;
const CONSTANT: f64 = 0.2;
const VELOCITY: f64 = 0.1;
/// Standard gravity [m/s²].
pub(super) const GRAVITY: f64 = 9.81;

type Vector6 = SVector<f64, 6>;
type Matrix6 = SMatrix<f64, 6, 6>;

/// A window: its middle \[s\], what its change of velocity is by the turn and by β, and what is left of it.
struct Window {
    t: f64,
    by: SMatrix<f64, 3, 6>,
    left: Vector3<f64>,
}

fn windows(states: &States, attitudes: &[UnitQuaternion<f64>]) -> Vec<Window> {
    let (Some(velocity), Some(force)) = (&states.velocity, &states.specific_force) else {
        return Vec::new();
    };
    let mut windows = Vec::new();
    let mut first = 0;
    while first < states.time.len() {
        let end = states.time[first] + WINDOW;
        let after = first + states.time[first..].partition_point(|t| *t < end);
        if after >= states.time.len() {
            break;
        }
        let mut by = SMatrix::<f64, 3, 6>::zeros();
        let mut left =
            Vector3::from(velocity.values[after]) - Vector3::from(velocity.values[first]);
        let times = states.time[first..=after].windows(2);
        let told = force.values[first..after]
            .iter()
            .zip(&attitudes[first..after]);
        for (times, (f, attitude)) in times.zip(told) {
            let dt = times[1] - times[0];
            let turn: Matrix3<f64> = attitude.to_rotation_matrix().into_inner();
            let f = Vector3::from(*f);
            left -= dt * (turn * f + Vector3::new(0.0, 0.0, GRAVITY));
            let mut of = by.fixed_columns_mut::<3>(0);
            of -= dt * turn * f.cross_matrix();
            let mut of = by.fixed_columns_mut::<3>(3);
            of -= dt * turn;
        }
        if left.iter().chain(by.iter()).all(|x| x.is_finite()) {
            let t = 0.5 * (states.time[first] + states.time[after]);
            windows.push(Window { t, by, left });
        }
        first = after;
    }
    windows
}

/// The attitudes of `states`, turned to what goes with the velocity and the specific force.
pub fn attitudes(states: &States) -> Vec<UnitQuaternion<f64>> {
    let told = states
        .attitude
        .values
        .iter()
        .map(|[w, x, y, z]| UnitQuaternion::from_quaternion(Quaternion::new(*w, *x, *y, *z)));
    let told: Vec<_> = told.collect();
    let windows = windows(states, &told);
    // Forward; what was predicted is kept for the way back.
    let mut state = Vector6::zeros();
    let variances = [TURN, TURN, TURN, CONSTANT, CONSTANT, CONSTANT].map(|s| s * s);
    let mut covariance = Matrix6::from_diagonal(&Vector6::from(variances));
    let mut kept: Vec<[(Vector6, Matrix6); 2]> = Vec::new();
    let mut then = windows.first().map_or(0.0, |window| window.t);
    for window in &windows {
        for axis in 0..3 {
            covariance[(axis, axis)] += WALK * WALK * (window.t - then);
        }
        then = window.t;
        let predicted = (state, covariance);
        let innovation = window.by * covariance * window.by.transpose()
            + Matrix3::identity() * (VELOCITY * VELOCITY);
        if let Some(inverse) = innovation.try_inverse() {
            let gain = covariance * window.by.transpose() * inverse;
            state += gain * (window.left - window.by * state);
            covariance = (Matrix6::identity() - gain * window.by) * covariance;
        }
        kept.push([predicted, (state, covariance)]);
    }
    let mut turns: Vec<(f64, Vector3<f64>)> = Vec::new();
    let mut smoothed = state;
    for n in (0..kept.len()).rev() {
        let [_, (state, covariance)] = &kept[n];
        smoothed = match kept.get(n + 1) {
            Some([(next, spread), _]) => {
                let inverse = spread.try_inverse().unwrap_or_default();
                state + covariance * inverse * (smoothed - next)
            }
            None => *state,
        };
        turns.push((windows[n].t, smoothed.fixed_rows::<3>(0).into_owned()));
    }
    turns.reverse();
    let at = |t: f64| {
        let after = turns.partition_point(|(of, _)| *of < t);
        match (after.checked_sub(1).map(|n| turns[n]), turns.get(after)) {
            (Some((a, before)), Some((b, next))) => before.lerp(next, (t - a) / (b - a)),
            (Some((_, turn)), None) | (None, Some(&(_, turn))) => turn,
            (None, None) => Vector3::zeros(),
        }
    };
    let turned = states.time.iter().zip(told);
    turned
        .map(|(t, told)| told * UnitQuaternion::from_scaled_axis(at(*t)))
        .collect()
}
