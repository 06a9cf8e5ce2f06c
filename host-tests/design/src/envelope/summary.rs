//! The envelope along one steady flight, in the units of its reports.

use anyhow::anyhow;
use serde::Serialize;

use super::{Curve, Cusp, Fold, FoldCurve, Interval, Jump, jump_down, jump_up};
use alula_sim::reference::Vehicle;

/// The flight along which the airspeed varies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// ε \[rad\]: the climb angle, or the angle whose tangent is the level acceleration over g.
    pub epsilon: f64,
    /// |W| \[N\].
    weight: f64,
    k_a: f64,
}

/// Why there is no such flight: the argument, and what is wrong with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Refused {
    /// `climb_deg` or `accel`.
    pub field: &'static str,
    /// What is wrong.
    pub problem: &'static str,
}

/// A fold.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FoldSummary {
    /// Angle of attack \[°\].
    pub alpha_deg: f64,
    /// a = k_a|v_a|²/|W|.
    pub a: f64,
    /// Airspeed \[m/s\].
    pub speed_m_s: f64,
}

/// A jump.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct JumpSummary {
    /// Angle of attack before it \[°\].
    pub from_alpha_deg: f64,
    /// Angle of attack after it \[°\].
    pub to_alpha_deg: f64,
    /// a at which it happens.
    pub a: f64,
    /// Airspeed \[m/s\].
    pub speed_m_s: f64,
}

impl JumpSummary {
    /// Of a jump at this airspeed \[m/s\].
    pub fn new(jump: &Jump, speed_m_s: f64) -> Self {
        Self {
            from_alpha_deg: jump.from_alpha.to_degrees(),
            to_alpha_deg: jump.to_alpha.to_degrees(),
            a: jump.a,
            speed_m_s,
        }
    }
}

/// A cusp, where two folds meet and vanish.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CuspSummary {
    /// ε \[°\].
    pub epsilon_deg: f64,
    /// a.
    pub a: f64,
    /// Angle of attack \[°\].
    pub alpha_deg: f64,
}

/// What there is to say of an envelope.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// The vehicle's name.
    pub vehicle: String,
    /// ε \[°\].
    pub epsilon_deg: f64,
    /// By increasing angle of attack.
    pub folds: Vec<FoldSummary>,
    /// Equilibria between the folds.
    pub counts: Vec<Interval>,
    /// The widest jump while the airspeed grows.
    pub jump_up: Option<JumpSummary>,
    /// The widest jump while it falls.
    pub jump_down: Option<JumpSummary>,
    /// Of all climb angles.
    pub cusps: Vec<CuspSummary>,
}

impl Ray {
    /// Steady climb at `climb_deg` \[°\], or level flight that gains `accel` \[m/s²\]; steady level flight without either.
    ///
    /// # Errors
    /// Both given, a number that is not finite, or an angle beyond 90°.
    pub fn new(
        vehicle: &Vehicle,
        climb_deg: Option<f64>,
        accel: Option<f64>,
    ) -> Result<Self, Refused> {
        let refused = |field, problem| Refused { field, problem };
        let finite = |field, value: Option<f64>| match value.unwrap_or(0.0) {
            value if value.is_finite() => Ok(value),
            _ => Err(refused(field, "must be a finite number")),
        };
        let climb = finite("climb_deg", climb_deg)?;
        let acceleration = finite("accel", accel)?;
        if climb.abs() > 90.0 {
            return Err(refused("climb_deg", "must be from -90 to 90"));
        }
        if climb_deg.is_some() && accel.is_some() {
            return Err(refused("accel", "cannot go with climb_deg"));
        }
        let epsilon = match accel {
            Some(_) => (acceleration / vehicle.gravity).atan(),
            None => climb.to_radians(),
        };
        Ok(Self {
            epsilon,
            weight: vehicle.mass * vehicle.gravity.hypot(acceleration),
            k_a: vehicle.k_a,
        })
    }

    /// Airspeed at `a` \[m/s\].
    pub fn speed(&self, a: f64) -> f64 {
        (a * self.weight / self.k_a).sqrt()
    }
}

/// The envelope of a vehicle along a ray.
pub struct Envelope<'a> {
    /// The flight.
    pub ray: Ray,
    /// Its equilibria.
    pub curve: Curve<'a>,
    /// Its folds.
    pub folds: Vec<Fold>,
    /// The folds of every ray.
    pub fold_curve: FoldCurve<'a>,
    /// Where these meet.
    pub cusps: Vec<Cusp>,
}

impl<'a> Envelope<'a> {
    /// The envelope of `vehicle` along `ray`.
    ///
    /// # Errors
    /// There is no equilibrium curve that begins at hover.
    pub fn new(vehicle: &'a Vehicle, ray: Ray) -> anyhow::Result<Self> {
        let curve = Curve::new(vehicle, ray.epsilon).ok_or_else(|| {
            let delta = vehicle.delta.to_degrees();
            anyhow!("no equilibrium curve begins at hover at δ = {delta:.1}°")
        })?;
        let fold_curve = FoldCurve::new(vehicle);
        Ok(Self {
            ray,
            curve,
            folds: curve.folds(),
            cusps: fold_curve.cusps(),
            fold_curve,
        })
    }

    /// What there is to say of it; `vehicle` is the vehicle's name.
    pub fn summary(&self, vehicle: &str) -> Summary {
        let jump = |jump: Jump| JumpSummary::new(&jump, self.ray.speed(jump.a));
        let fold = |fold: &Fold| FoldSummary {
            alpha_deg: fold.alpha.to_degrees(),
            a: fold.a,
            speed_m_s: self.ray.speed(fold.a),
        };
        let cusp = |cusp: &Cusp| CuspSummary {
            epsilon_deg: cusp.epsilon.to_degrees(),
            a: cusp.a,
            alpha_deg: cusp.alpha.to_degrees(),
        };
        Summary {
            vehicle: vehicle.to_owned(),
            epsilon_deg: self.ray.epsilon.to_degrees(),
            folds: self.folds.iter().map(fold).collect(),
            counts: self.curve.counts(&self.folds),
            jump_up: jump_up(&self.curve, &self.folds).map(jump),
            jump_down: jump_down(&self.curve, &self.folds).map(jump),
            cusps: self.cusps.iter().map(cusp).collect(),
        }
    }
}
