//! The forces on the vehicle.

use std::f64::consts::PI;

use super::{Aerodynamics, Coefficients, Matrix, S, Vector, rotation, wrap};

/// A vehicle in double precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vehicle {
    /// Mass m \[kg\].
    pub mass: f64,
    /// k_a = ρΣ/2 \[kg/m\].
    pub k_a: f64,
    /// δ, from the zero-lift line to the thrust line \[rad\].
    pub delta: f64,
    /// g \[m/s²\].
    pub gravity: f64,
    /// c_L and c_D.
    pub aerodynamics: Aerodynamics,
}

/// What the air does at one state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Air {
    /// v_a \[m/s\] in inertial coordinates.
    pub velocity: Vector,
    /// |v_a| \[m/s\].
    pub speed: f64,
    /// α in [−π, π) \[rad\].
    pub alpha: f64,
    /// c_L, c_D and derivatives at α.
    pub c: Coefficients,
    /// λ by `eq:pGC`.
    pub lambda: f64,
    /// c̄_L.
    pub c_l_bar: f64,
    /// c̄_D.
    pub c_d_bar: f64,
    /// ∂c̄_L/∂α \[1/rad\].
    pub dc_l_bar: f64,
    /// ∂c̄_D/∂α \[1/rad\].
    pub dc_d_bar: f64,
}

impl Vehicle {
    /// α = θ − γ + π − δ, wrapped to [−π, π). At zero air speed γ is taken as 0.
    pub fn angle_of_attack(&self, air_velocity: Vector, theta: f64) -> f64 {
        let gamma = libm::atan2(air_velocity.y, air_velocity.x);
        wrap(theta - gamma + PI - self.delta)
    }

    /// The air at `velocity` and `wind` \[m/s\] with orientation `theta` \[rad\].
    pub fn air(&self, velocity: Vector, wind: Vector, theta: f64) -> Air {
        let air_velocity = velocity - wind;
        let alpha = self.angle_of_attack(air_velocity, theta);
        let c = self.aerodynamics.at(alpha);
        let (sin, cos) = libm::sincos(alpha + self.delta);
        let lambda = c.dc_l * cos + c.dc_d * sin;
        let dlambda = c.ddc_l * cos - c.dc_l * sin + c.ddc_d * sin + c.dc_d * cos;
        Air {
            velocity: air_velocity,
            speed: air_velocity.norm(),
            alpha,
            c,
            lambda,
            c_l_bar: c.c_l - lambda * sin,
            c_d_bar: c.c_d + lambda * cos,
            dc_l_bar: c.dc_l - dlambda * sin - lambda * cos,
            dc_d_bar: c.dc_d + dlambda * cos - lambda * sin,
        }
    }

    /// `k_a |v_a| (c_l S − c_d I) v_a` \[N\], inertial coordinates.
    pub fn force(&self, air: &Air, c_l: f64, c_d: f64) -> Vector {
        self.k_a * air.speed * (c_l * S - c_d * Matrix::identity()) * air.velocity
    }

    /// The aerodynamic force F_a \[N\].
    pub fn aerodynamic_force(&self, air: &Air) -> Vector {
        self.force(air, air.c.c_l, air.c.c_d)
    }

    /// m g i0 − m a_r \[N\].
    pub fn apparent_weight(&self, reference_acceleration: Vector) -> Vector {
        self.mass * (Vector::new(self.gravity, 0.0) - reference_acceleration)
    }

    /// F \[N\].
    pub fn f(&self, air: &Air, reference_acceleration: Vector) -> Vector {
        self.apparent_weight(reference_acceleration) + self.aerodynamic_force(air)
    }

    /// F_p \[N\].
    pub fn f_p(&self, air: &Air, reference_acceleration: Vector) -> Vector {
        self.apparent_weight(reference_acceleration) + self.force(air, air.c_l_bar, air.c_d_bar)
    }

    /// v̇ = g i0 + (F_a − T i)/m \[m/s²\], inertial coordinates.
    pub fn acceleration(&self, velocity: Vector, wind: Vector, theta: f64, thrust: f64) -> Vector {
        let air = self.air(velocity, wind, theta);
        let i = rotation(theta).column(0).into_owned();
        Vector::new(self.gravity, 0.0) + (self.aerodynamic_force(&air) - thrust * i) / self.mass
    }
}
