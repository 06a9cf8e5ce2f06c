//! Stability margins of the velocity loop in level flight: eigenvalues, the largest stable lag of the rate loop and the
//! largest stable delay of the command, in double precision.
//!
//! The loop is the law alone, without position hold, limits or sampling: (v, θ) with θ̇ = ω_c for the eigenvalues, with
//! ω̇ = (ω_c − ω)/T for the lag, and with thrust and rate both delayed by τ, and no lag, for the delay.

use nalgebra::{Complex, Matrix2x3, Matrix3, Matrix3x2, Matrix4, Vector3};
use serde::Serialize;

use crate::mission::GainChoiceSpec;
use crate::reference::{Gains, Inputs, Vector, Vehicle, robust, rotation};

/// Lags and delays beyond this \[s\] are not looked for.
pub const LONGEST: f64 = 5.0;

/// A vehicle in level flight under the law.
#[derive(Clone, Debug)]
pub struct Loop {
    /// The true vehicle.
    pub vehicle: Vehicle,
    /// What the controller believes it to be.
    pub belief: Vehicle,
    /// Its gains.
    pub gains: GainChoiceSpec,
}

/// The loop at one equilibrium.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// Reference speed \[m/s\].
    pub speed_m_s: f64,
    /// θ of the equilibrium \[°\].
    pub theta_deg: f64,
    /// Its angle of attack \[°\].
    pub alpha_deg: f64,
    /// |F_p| by the controller's belief \[N\].
    pub fp_n: f64,
    /// Eigenvalues without lag and delay, (real, imaginary) \[rad/s\].
    pub eigenvalues: [(f64, f64); 3],
    /// Largest stable lag of the rate loop \[s\]; none if none up to [`LONGEST`] is too large.
    pub lag_s: Option<f64>,
    /// Largest stable delay of the command \[s\]; none if none up to [`LONGEST`] is too large.
    pub delay_s: Option<f64>,
}

/// v̇ and θ̇ by the state (v, θ) and the command: ẋ = A x + B u, u = K x.
struct Linear {
    a: Matrix3<f64>,
    b: Matrix3x2<f64>,
    k: Matrix2x3<f64>,
}

impl Loop {
    /// The command (thrust, rate) at (v, θ), and |F_p|.
    fn command(&self, x: &Vector3<f64>, speed: f64) -> (nalgebra::Vector2<f64>, f64) {
        let inputs = Inputs {
            velocity: Vector::new(x[0], x[1]),
            theta: x[2],
            wind: Vector::zeros(),
            reference_velocity: Vector::new(0.0, speed),
            reference_acceleration: Vector::zeros(),
            feed_forward: None,
        };
        let air = self.belief.air(inputs.velocity, inputs.wind, inputs.theta);
        let norm = self.belief.f_p(&air, inputs.reference_acceleration).norm();
        let gains = match &self.gains {
            GainChoiceSpec::Constant(spec) => spec.reference_gains(),
            GainChoiceSpec::Bandwidth(spec) => {
                let force = norm.max(spec.force_floor_n);
                let frequency = spec.natural_frequency_rad_s;
                Gains {
                    k1: self.belief.mass * spec.thrust_rate_1_s / force,
                    k2: self.belief.mass * (frequency / force).powi(2),
                    k3: 8.0 * spec.damping * frequency,
                    tau: spec.tau_n,
                }
            }
        };
        let answer = robust(&self.belief, &gains, &inputs);
        (nalgebra::Vector2::new(answer.thrust, answer.rate), norm)
    }

    /// ẋ under a constant command.
    fn slope(&self, x: &Vector3<f64>, u: &nalgebra::Vector2<f64>) -> Vector3<f64> {
        let v = Vector::new(x[0], x[1]);
        let acceleration = self.vehicle.acceleration(v, Vector::zeros(), x[2], u[0]);
        Vector3::new(acceleration.x, acceleration.y, u[1])
    }

    /// Orientations of level flight at `speed` on the branch θ̃ = 0, by increasing θ.
    fn trims(&self, speed: f64) -> Vec<f64> {
        const STEPS: i32 = 3600;
        let v = Vector::new(0.0, speed);
        let force = |theta: f64| {
            let air = self.vehicle.air(v, Vector::zeros(), theta);
            let to_body = rotation(theta).transpose();
            (
                to_body * self.vehicle.f(&air, Vector::zeros()),
                to_body * self.vehicle.f_p(&air, Vector::zeros()),
            )
        };
        let angle = |n: i32| std::f64::consts::PI * f64::from(2 * n - STEPS) / f64::from(STEPS);
        let mut found = Vec::new();
        for n in 0..STEPS {
            let (mut low, mut high) = (angle(n), angle(n + 1));
            let start = force(low).0.y;
            // A zero on the grid belongs to the interval that ends there.
            if start == 0.0 || start * force(high).0.y > 0.0 {
                continue;
            }
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if start * force(middle).0.y > 0.0 {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            if force(low).1.x > 0.0 {
                found.push(low);
            }
        }
        found
    }

    /// Where the closed loop rests: Newton's method from a trim of the true vehicle.
    fn rest(&self, speed: f64, theta: f64) -> Option<Vector3<f64>> {
        let mut x = Vector3::new(0.0, speed, theta);
        let residual = |x: &Vector3<f64>| self.slope(x, &self.command(x, speed).0);
        for _ in 0..50 {
            let r = residual(&x);
            if r.norm() < 1e-9 {
                return Some(x);
            }
            x -= jacobian(&x, &residual).try_inverse()? * r;
        }
        None
    }

    fn linear(&self, x: &Vector3<f64>, speed: f64) -> Linear {
        let u = self.command(x, speed).0;
        let a = jacobian(x, &|x| self.slope(x, &u));
        let thrust = self.slope(x, &(u + nalgebra::Vector2::x())) - self.slope(x, &u);
        let k = jacobian(x, &|x| {
            let u = self.command(x, speed).0;
            Vector3::new(u.x, u.y, 0.0)
        });
        Linear {
            a,
            b: Matrix3x2::from_columns(&[thrust, Vector3::z()]),
            k: k.fixed_rows::<2>(0).into_owned(),
        }
    }

    /// The loop at every equilibrium of level flight at `speed` \[m/s\].
    pub fn at(&self, speed: f64) -> Vec<Point> {
        let point = |theta: f64| {
            let x = self.rest(speed, theta)?;
            let linear = self.linear(&x, speed);
            let eigenvalues = (linear.a + linear.b * linear.k).complex_eigenvalues();
            let velocity = Vector::new(x[0], x[1]);
            let stable = eigenvalues.iter().all(|e| e.re < 0.0);
            let some = |find: &dyn Fn() -> Option<f64>| if stable { find() } else { Some(0.0) };
            Some(Point {
                speed_m_s: speed,
                theta_deg: x[2].to_degrees(),
                alpha_deg: self.vehicle.angle_of_attack(velocity, x[2]).to_degrees(),
                fp_n: self.command(&x, speed).1,
                eigenvalues: [0, 1, 2].map(|i| (eigenvalues[i].re, eigenvalues[i].im)),
                lag_s: some(&|| linear.largest_lag()),
                delay_s: some(&|| linear.largest_delay()),
            })
        };
        self.trims(speed).into_iter().filter_map(point).collect()
    }
}

/// Central differences, of functions of size up to 1e4 whose third derivatives are up to 1e6: good to 1e-4.
fn jacobian(x: &Vector3<f64>, f: &dyn Fn(&Vector3<f64>) -> Vector3<f64>) -> Matrix3<f64> {
    const H: f64 = 1e-6;
    let column = |axis: usize| {
        let step = H * Vector3::ith(axis, 1.0);
        (f(&(x + step)) - f(&(x - step))) / (2.0 * H)
    };
    Matrix3::from_columns(&[column(0), column(1), column(2)])
}

impl Linear {
    /// The largest lag, for a loop that is stable without.
    fn largest_lag(&self) -> Option<f64> {
        const FACTOR: f64 = 1.05;
        let stable = |lag: f64| {
            let mut m = Matrix4::zeros();
            let driven = self.a + self.b.column(0) * self.k.row(0);
            m.fixed_view_mut::<3, 3>(0, 0).copy_from(&driven);
            m[(2, 3)] = 1.0;
            let rate = self.k.row(1) / lag;
            m.fixed_view_mut::<1, 3>(3, 0).copy_from(&rate);
            m[(3, 3)] = -1.0 / lag;
            m.complex_eigenvalues().iter().all(|e| e.re < 0.0)
        };
        let mut high = 1e-5;
        while stable(high) {
            high *= FACTOR;
            if high > LONGEST {
                return None;
            }
        }
        let mut low = high / FACTOR;
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if stable(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        Some(low)
    }

    /// The largest delay, for a loop that is stable without.
    ///
    /// At the limit iω is an eigenvalue of A + B K e^{−iφ} with φ = ωτ: the shortest delay of all such φ in (0, 2π).
    fn largest_delay(&self) -> Option<f64> {
        const STEPS: i32 = 2000;
        let step = std::f64::consts::TAU / f64::from(STEPS);
        let bk = self.b * self.k;
        let eigenvalues = |phase: f64| {
            let z = Complex::from_polar(1.0, -phase);
            let m = self.a.zip_map(&bk, |a, b| Complex::new(a, 0.0) + z * b);
            m.schur().eigenvalues()
        };
        let unstable = |phase: f64| {
            let all = eigenvalues(phase)?;
            Some(all.iter().filter(|e| e.re > 0.0 && e.im > 0.0).count())
        };
        let mut shortest = f64::INFINITY;
        let mut before = unstable(0.0)?;
        for n in 0..STEPS {
            let (mut low, mut high) = (f64::from(n) * step, f64::from(n + 1) * step);
            let after = unstable(high)?;
            if after != before {
                for _ in 0..40 {
                    let middle = 0.5 * (low + high);
                    if unstable(middle)? == before {
                        low = middle;
                    } else {
                        high = middle;
                    }
                }
                let all = eigenvalues(low)?;
                let crossing = all
                    .iter()
                    .filter(|e| e.im > 1e-6 && e.re.abs() < 1e-6 * e.im.max(1.0))
                    .map(|e| low / e.im);
                shortest = crossing.fold(shortest, f64::min);
            }
            before = after;
        }
        (shortest <= LONGEST).then_some(shortest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mission::MissionSource;

    fn hover_loop() -> Loop {
        let mission = MissionSource::load("round-trip").unwrap().mission;
        let vehicle = mission.vehicle.plant_vehicle();
        Loop {
            vehicle,
            belief: vehicle,
            gains: mission.controller.guidance().unwrap().gains,
        }
    }

    /// In hover F_p is the weight, whatever the attitude: across the thrust line s² + 2ζω_n s + ω_n², along it s + ω_v;
    /// with a lag T s³ + s² + 2ζω_n s + ω_n², stable up to T = 2ζ/ω_n; and with a delay of rate and thrust the crossing
    /// frequencies are in closed form.
    #[test]
    fn hover_is_the_textbook_loop() {
        let points = hover_loop().at(0.0);
        assert_eq!(points.len(), 1);
        let point = &points[0];
        let (frequency, damping, along) = (4.0_f64, 0.8_f64, 3.0_f64);
        let (re, im) = (
            -damping * frequency,
            frequency * (1.0 - damping * damping).sqrt(),
        );
        for (expected_re, expected_im) in [(re, im), (re, -im), (-along, 0.0)] {
            let near = |e: &&(f64, f64)| (e.0 - expected_re).hypot(e.1 - expected_im) < 1e-4;
            assert_eq!(point.eigenvalues.iter().filter(near).count(), 1);
        }
        assert!((point.lag_s.unwrap() - 2.0 * damping / frequency).abs() < 1e-4);
        // |2ζω_n iω + ω_n²| = ω²: the phase there over the frequency.
        let c = 2.0 * damping * damping;
        let omega = frequency * (c + (c * c + 1.0).sqrt()).sqrt();
        let phase = (2.0 * damping * omega / frequency).atan();
        let across = phase / omega;
        let thrust = std::f64::consts::FRAC_PI_2 / along;
        assert!((point.delay_s.unwrap() - across.min(thrust)).abs() < 1e-4);
    }
}
