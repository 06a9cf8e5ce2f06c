//! Stability margins of the velocity loop in level flight: eigenvalues, the largest stable lag of the rate loop and the
//! largest stable delay of the command, in double precision.
//!
//! The loop is the law alone, without position hold, limits or sampling: the state is (v, θ) with θ̇ = ω, and the states of the actuators' lags.
//! The largest lag is that of the rate loop, in place of its own, with the own thrust lag and delay. The largest delay is that of thrust
//! and rate alike, in place of the own, with both own lags. Ideal actuators give the bare loop.

use alula::GuidanceParameters;
use alula::planar::GainParameters;
use nalgebra::{Complex, DMatrix, Matrix2x3, Matrix3, Matrix3x2, Vector3};
use serde::Serialize;

use crate::experiment::{PlantSpec, RateLoop};
use crate::reference::{Gains, Inputs, Vector, Vehicle, robust, rotation};

/// Lags and delays beyond this \[s\] are not looked for.
pub const LONGEST: f64 = 5.0;

/// Gains of the law, in double precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LoopGains {
    /// Constant.
    Constant(Gains),
    /// By bandwidth.
    Bandwidth(Bandwidth),
}

/// Gains by bandwidth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bandwidth {
    /// ω_n \[rad/s\].
    pub natural_frequency: f64,
    /// ζ.
    pub damping: f64,
    /// ω_v \[1/s\].
    pub thrust_rate: f64,
    /// Floor of |F_p| \[N\].
    pub gain_schedule_floor: f64,
    /// τ \[N\].
    pub tau: f64,
}

impl LoopGains {
    /// Constant gains of the core.
    pub fn of(p: &GainParameters) -> Self {
        Self::Constant(Gains {
            k1: p.k1.into(),
            k2: p.k2.into(),
            k3: p.k3.into(),
            tau: p.tau.into(),
        })
    }

    /// The core's gains by bandwidth, of a vehicle believed to weigh `weight` \[N\].
    pub fn by_bandwidth(p: &GuidanceParameters, weight: f64) -> Self {
        Self::Bandwidth(Bandwidth {
            natural_frequency: p.natural_frequency.into(),
            damping: p.damping.into(),
            thrust_rate: p.thrust_rate.into(),
            gain_schedule_floor: f64::from(p.gain_schedule_floor) * weight,
            tau: f64::from(p.tau) * weight,
        })
    }

    /// τ of the guard \[N\].
    pub fn tau(&self) -> f64 {
        match self {
            Self::Constant(gains) => gains.tau,
            Self::Bandwidth(gains) => gains.tau,
        }
    }

    /// The gains at |F_p| = `norm` \[N\] of a vehicle of `mass` \[kg\].
    fn at(&self, norm: f64, mass: f64) -> Gains {
        match self {
            Self::Constant(gains) => *gains,
            Self::Bandwidth(p) => {
                let force = norm.max(p.gain_schedule_floor);
                Gains {
                    k1: mass * p.thrust_rate / force,
                    k2: mass * (p.natural_frequency / force).powi(2),
                    k3: 8.0 * p.damping * p.natural_frequency,
                    tau: p.tau,
                }
            }
        }
    }
}

/// A vehicle in level flight under the law.
#[derive(Clone, Debug)]
pub struct Loop {
    /// The true vehicle.
    pub vehicle: Vehicle,
    /// What the controller believes it to be.
    pub belief: Vehicle,
    /// Its gains.
    pub gains: LoopGains,
    /// The actuators.
    pub actuators: PlantSpec,
}

/// The loop at one equilibrium.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// Reference speed \[m/s\].
    pub speed_m_s: f64,
    /// θ of the equilibrium \[°\].
    pub theta_deg: f64,
    /// Its angle of attack \[°\]; none in hover, where no air comes.
    pub alpha_deg: Option<f64>,
    /// |F_p| by the controller's belief \[N\].
    pub fp_n: f64,
    /// Eigenvalues without delay, (real, imaginary) \[rad/s\]: three, and one for each own lag.
    pub eigenvalues: Vec<(f64, f64)>,
    /// Largest stable lag of the rate loop \[s\]; none if none up to [`LONGEST`] is too large, 0 if the loop is unstable without.
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
        let gains = self.gains.at(norm, self.belief.mass);
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
        let mut equilibria = Vec::new();
        for n in 0..STEPS {
            let (low, high) = (angle(n), angle(n + 1));
            let start = force(low).0.y;
            // A zero on the grid belongs to the interval that ends there.
            if start == 0.0 || start * force(high).0.y > 0.0 {
                continue;
            }
            let low = last(low, high, 60, |theta| start * force(theta).0.y > 0.0);
            if force(low).1.x > 0.0 {
                equilibria.push(low);
            }
        }
        equilibria
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

    /// The rate loop's own lag \[s\]; of an inertia, for small errors, the inverse of its bandwidth.
    fn rate_lag(&self) -> f64 {
        match self.actuators.rate_loop {
            RateLoop::Ideal => 0.0,
            RateLoop::Lag { time_constant_s } => time_constant_s,
            RateLoop::Inertia { bandwidth_1_s, .. } => 1.0 / bandwidth_1_s,
        }
    }

    /// The loop at every equilibrium of level flight at `speed` \[m/s\].
    pub fn at(&self, speed: f64) -> Vec<Point> {
        let point = |theta: f64| {
            let x = self.rest(speed, theta)?;
            let linear = self.linear(&x, speed);
            let velocity = Vector::new(x[0], x[1]);
            let (rate, thrust) = (self.rate_lag(), self.actuators.thrust_lag_s);
            let lagged = linear.lagged(rate, thrust);
            let eigenvalues = lagged.eigenvalues(0.0);
            Some(Point {
                speed_m_s: speed,
                theta_deg: x[2].to_degrees(),
                alpha_deg: (speed != 0.0)
                    .then(|| self.vehicle.angle_of_attack(velocity, x[2]).to_degrees()),
                fp_n: self.command(&x, speed).1,
                eigenvalues: eigenvalues.iter().map(|e| (e.re, e.im)).collect(),
                lag_s: linear.largest_lag(thrust, self.actuators.delay_s),
                delay_s: lagged.largest_delay(),
            })
        };
        self.trims(speed).into_iter().filter_map(point).collect()
    }
}

/// The last place from `low` to before `high` at which something `holds`, by halving so many `times`.
fn last(mut low: f64, mut high: f64, times: u32, holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..times {
        let middle = 0.5 * (low + high);
        match holds(middle) {
            true => low = middle,
            false => high = middle,
        }
    }
    low
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

/// A linear loop with its lags, ẋ = A x + D x(t − τ): what acts at once, and what acts through the delayed command.
struct Lagged {
    at_once: DMatrix<f64>,
    delayed: DMatrix<f64>,
}

impl Linear {
    /// The loop behind lags of rate and thrust \[s\], 0 for none.
    fn lagged(&self, rate: f64, thrust: f64) -> Lagged {
        let lags = [thrust, rate];
        let size = 3 + lags.iter().filter(|&&lag| lag > 0.0).count();
        let mut at_once = DMatrix::zeros(size, size);
        let mut delayed = DMatrix::zeros(size, size);
        at_once.view_mut((0, 0), (3, 3)).copy_from(&self.a);
        let mut next = 3;
        for (i, lag) in lags.into_iter().enumerate() {
            let (input, feedback) = (self.b.column(i), self.k.row(i));
            if lag > 0.0 {
                at_once.view_mut((0, next), (3, 1)).copy_from(&input);
                at_once[(next, next)] = -1.0 / lag;
                let row = feedback / lag;
                delayed.view_mut((next, 0), (1, 3)).copy_from(&row);
                next += 1;
            } else {
                let mut all = delayed.view_mut((0, 0), (3, 3));
                all += input * feedback;
            }
        }
        Lagged { at_once, delayed }
    }

    /// The largest lag of the rate loop, behind a thrust lag and a delay \[s\]; 0 for a loop that is unstable without.
    fn largest_lag(&self, thrust: f64, delay: f64) -> Option<f64> {
        const FACTOR: f64 = 1.05;
        let stable = |lag: f64| {
            let lagged = self.lagged(lag, thrust);
            lagged.is_stable()
                && (delay == 0.0 || lagged.largest_delay().is_none_or(|most| most > delay))
        };
        if !stable(0.0) {
            return Some(0.0);
        }
        let mut high = 1e-5;
        while stable(high) {
            high *= FACTOR;
            if high > LONGEST {
                return None;
            }
        }
        Some(last(high / FACTOR, high, 40, stable))
    }
}

impl Lagged {
    /// Eigenvalues of A + D e^{−iφ}.
    fn eigenvalues(&self, phase: f64) -> Vec<Complex<f64>> {
        if phase == 0.0 {
            let all = (&self.at_once + &self.delayed).complex_eigenvalues();
            return all.iter().copied().collect();
        }
        let z = Complex::from_polar(1.0, -phase);
        let turned = |a, d| Complex::new(a, 0.0) + z * d;
        let schur = self.at_once.zip_map(&self.delayed, turned).schur();
        let all = schur.eigenvalues();
        all.map_or(Vec::new(), |all| all.iter().copied().collect())
    }

    fn is_stable(&self) -> bool {
        self.eigenvalues(0.0).iter().all(|e| e.re < 0.0)
    }

    /// The largest delay; 0 for a loop that is unstable without.
    ///
    /// At the limit iω is an eigenvalue of A + D e^{−iφ} with φ = ωτ: the shortest delay of all such φ in (0, 2π).
    fn largest_delay(&self) -> Option<f64> {
        const STEPS: i32 = 2000;
        if !self.is_stable() {
            return Some(0.0);
        }
        let step = std::f64::consts::TAU / f64::from(STEPS);
        let unstable = |phase: f64| {
            let all = self.eigenvalues(phase);
            all.iter().filter(|e| e.re > 0.0 && e.im > 0.0).count()
        };
        let mut shortest = f64::INFINITY;
        let mut before = 0;
        for n in 0..STEPS {
            let (low, high) = (f64::from(n) * step, f64::from(n + 1) * step);
            let after = unstable(high);
            if after != before {
                let low = last(low, high, 40, |phase| unstable(phase) == before);
                let all = self.eigenvalues(low);
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
    use crate::experiment::Document;

    fn hover_loop(actuators: PlantSpec) -> Loop {
        let experiment = Document::load("round-trip").unwrap().checked().unwrap();
        let vehicle = experiment.vehicle.reference();
        let spec = experiment.spec().unwrap();
        Loop {
            vehicle,
            belief: vehicle,
            gains: spec.gains(&experiment.vehicle).unwrap(),
            actuators,
        }
    }

    /// In hover F_p is the weight, whatever the attitude: across the thrust line s² + 2ζω_n s + ω_n², along it s + ω_v;
    /// with a lag T s³ + s² + 2ζω_n s + ω_n², stable up to T = 2ζ/ω_n; and with a delay of rate and thrust the crossing
    /// frequencies are in closed form.
    #[test]
    fn hover_is_the_textbook_loop() {
        let points = hover_loop(PlantSpec::default()).at(0.0);
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

    /// With the own lags of hover, 100 and 50 ms, the loop is that of the textbook again: along the thrust line ω_v/(T s² + s + ω_v), and
    /// across it a lag of 100 ms of the 400 ms that it bears.
    #[test]
    fn own_lags_are_counted() {
        let actuators = PlantSpec {
            rate_loop: RateLoop::Lag {
                time_constant_s: 0.1,
            },
            thrust_lag_s: 0.05,
            ..PlantSpec::default()
        };
        let bare = hover_loop(PlantSpec::default()).at(0.0).remove(0);
        let point = hover_loop(actuators).at(0.0).remove(0);
        assert_eq!(point.eigenvalues.len(), 5);
        let root = (1.0 - 4.0 * 0.05 * 3.0_f64).sqrt();
        for expected in [(-1.0 + root) / 0.1, (-1.0 - root) / 0.1] {
            let near = |e: &&(f64, f64)| (e.0 - expected).hypot(e.1) < 1e-3;
            assert_eq!(point.eigenvalues.iter().filter(near).count(), 1);
        }
        assert!((point.lag_s.unwrap() - 0.4).abs() < 1e-4);
        assert!(point.delay_s.unwrap() < bare.delay_s.unwrap() - 0.05);
        // A delay takes from the lag that is borne.
        let delayed = PlantSpec {
            delay_s: 0.05,
            ..actuators
        };
        let less = hover_loop(delayed).at(0.0).remove(0).lag_s.unwrap();
        assert!(less < 0.35 && less > 0.1, "{less}");
    }
}
