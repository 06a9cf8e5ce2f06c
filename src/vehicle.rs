//! The vehicle: mass, aerodynamic constant, thrust line, gravity and coefficient model. Immutable, validated.

use crate::aero::{Aerodynamics, Stall};
use crate::air::{AirData, ThrustLine};
use crate::authority::{Airflow, Authority, GONE, IN_ROLL, IN_SLIPSTREAM, SHARE};
use crate::error::{ParameterError, in_range};
use crate::frame::Body;
use crate::math;
use crate::parameters::Parameters;
use crate::propeller::Propeller;

/// The aerodynamic constant k_a = ρΣ/2 [kg/m] of an air density ρ [kg/m³] and a reference area Σ \[m²\].
///
/// # Errors
/// `density` or `area` not finite, not positive, or above 1e4.
pub fn aerodynamic_constant(density: f32, area: f32) -> Result<f32, ParameterError> {
    let density = in_range("density", density, [1e-6, 1e4], "kg/m^3")?;
    let area = in_range("area", area, [1e-6, 1e4], "m^2")?;
    Ok(0.5 * density * area)
}

crate::parameters! {
    /// Parameters of a vehicle: what can be weighed and measured of it.
    ///
    /// They are begun from [`DEFAULT`](Parameters::DEFAULT), and given by name. `mass`, `k_a` and `thrust_max` have no default: a
    /// vehicle without one of them is refused.
    ///
    /// ```
    /// use alula::prelude::*;
    ///
    /// let aircraft = VehicleParameters::DEFAULT.mass(3.0).k_a(0.21);
    /// assert_eq!(aircraft.check().unwrap_err().parameter, "thrust_max");
    /// assert!(aircraft.thrust_max(47.0).check().is_ok());
    /// ```
    #[non_exhaustive]
    pub struct VehicleParameters, "Vehicle" {
        mass: "kg", 1e-3, 1e6, f32::NAN, "ALU_MASS",
            "Mass m.";
        k_a: "kg/m", 1e-9, 1e4, f32::NAN, "ALU_KA",
            "Aerodynamic constant k_a: half the air density times the reference area.";
        delta: "rad", -math::PI, math::PI, 0.0, "ALU_DELTA",
            "Angle δ from the zero-lift line to the thrust line.";
        c_y: "", 0.0, 1e3, 0.0, "ALU_CY",
            "Side force coefficient c_Y, of the same reference area. In a vertical plane it is not used.";
        gravity: "m/s^2", 1e-3, 1e3, 9.81, "ALU_GRAVITY",
            "Gravity g.";
        thrust_min: "N", -1e6, 1e6, 0.0, "ALU_THR_MIN",
            "Least thrust. The guidance keeps to it; the laws alone do not.";
        thrust_max: "N", 1e-3, 1e6, f32::NAN, "ALU_THR_MAX",
            "Greatest thrust, above the least. The guidance keeps to it; the laws alone do not.";
        authority: "rad/s^2", 0.0, 1e6, 1e6, "ALU_AUTH",
            "Greatest angular acceleration in pitch at no thrust and no airflow. The default is full authority.";
        authority_slipstream: "rad/s^2", 0.0, 1e6, 0.0, "ALU_AUTH_SLIP",
            "What a thrust of the weight adds to it: surfaces in the slipstream, at full deflection, in hover. Flights count on 0.7 of it.";
        authority_difference: "rad/s^2", 0.0, 1e6, 0.0, "ALU_AUTH_DIFF",
            "What differences of thrust would add to it that are as large as the weight. They are at most the thrust, and what is left of the greatest thrust. Flights count on 0.8 of it.";
        authority_airflow: "rad/m^2", 0.0, 1e6, 0.0, "ALU_AUTH_AIR",
            "What the airflow along the nose adds to it, per squared speed: surfaces at full deflection without thrust. Flights count on 0.8 of it.";
        wing_moment: "rad/m^2", 0.0, 1e6, 0.0, "ALU_WING_MOM",
            "Angular acceleration by which the wing across the flow turns the nose to the air velocity, per squared airspeed: its centre of pressure moves aft behind stall.";
        roll_authority: "rad m/s^2", 1e-3, 1e6, 1e6, "ALU_AUTH_ROLL",
            "Greatest rate about the nose times the airspeed, in cruise: what turns the vehicle about its nose, against the damping of its wing. The default is full authority. Flights count on 0.4 of it.";
        surface_reaction: "m", 0.0, 10.0, 0.0, "ALU_SURF_REACT",
            "Acceleration towards the belly by the surfaces that turn the nose up, per angular acceleration: the squared radius of gyration in pitch over their distance behind the centre of mass.";
        hover_downwash: "m/s", 0.0, 1e3, 0.0, "ALU_DOWNWASH",
            "Speed that the propellers give the air in hover, at their discs. Tail first at 0.6 of it the surfaces in the slipstream have no effect; at 0 they always have.";
        zero_thrust_speed: "m/s", 0.0, 1e4, 0.0, "ALU_THR_SPEED",
            "Airspeed along the nose at which full throttle gives no thrust: pitch of the propeller times its speed. At 0 thrust does not fall with speed.";
    }
}

impl VehicleParameters {
    /// Authority in pitch of a vehicle with these parameters, which have been checked.
    pub(crate) fn pitch_authority(&self) -> Authority {
        let weight = self.mass * self.gravity;
        let gone = GONE * self.hover_downwash;
        Authority {
            constant: self.authority,
            slipstream: IN_SLIPSTREAM * self.authority_slipstream / weight,
            difference: SHARE * self.authority_difference / weight,
            airflow: SHARE * self.authority_airflow,
            wing: self.wing_moment,
            stall: 0.0,
            reversed: if gone > 0.0 {
                weight / (gone * gone)
            } else {
                0.0
            },
        }
    }

    /// Thrust over airspeed of a vehicle with these parameters, which have been checked.
    pub(crate) fn propeller(&self) -> Propeller {
        Propeller {
            per_speed: if self.zero_thrust_speed > 0.0 {
                1.0 / self.zero_thrust_speed
            } else {
                0.0
            },
            most: self.thrust_max,
        }
    }

    /// The vehicle of the paper's simulation (§VII).
    pub const PAPER: Self = Self {
        mass: 10.0,
        k_a: 0.6460,
        delta: 0.0,
        c_y: 0.0,
        gravity: 9.81,
        thrust_min: 0.0,
        thrust_max: 196.2,
        ..Self::DEFAULT
    };

    /// What the paper's controller believes of it: wrong on purpose (§VII).
    pub const PAPER_BELIEF: Self = Self {
        mass: 9.0,
        k_a: 0.51,
        ..Self::PAPER
    };
}

/// A vehicle with the coefficient model `A`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Vehicle<A> {
    mass: f32,
    k_a: f32,
    c_y: f32,
    gravity: f32,
    thrust_min: f32,
    thrust_max: f32,
    authority: Authority,
    propeller: Propeller,
    roll: f32,
    surface_reaction: f32,
    thrust_line: ThrustLine,
    model: A,
}

impl<A: Aerodynamics> Vehicle<A> {
    /// The vehicle with these parameters and coefficients.
    ///
    /// # Errors
    /// A parameter outside its range, or `thrust_max` not above `thrust_min`.
    pub fn new(p: VehicleParameters, model: A) -> Result<Self, ParameterError> {
        p.check()?;
        if p.thrust_max <= p.thrust_min {
            return Err(ParameterError::contradiction(
                "thrust_max",
                "above thrust_min",
            ));
        }
        let mut authority = p.pitch_authority();
        if authority.wing > 0.0 {
            authority.stall = Stall::of(&model).sin;
        }
        Ok(Self {
            mass: p.mass,
            k_a: p.k_a,
            c_y: p.c_y,
            gravity: p.gravity,
            thrust_min: p.thrust_min,
            thrust_max: p.thrust_max,
            authority,
            propeller: p.propeller(),
            roll: IN_ROLL * p.roll_authority,
            surface_reaction: p.surface_reaction,
            thrust_line: ThrustLine::of_checked(p.delta),
            model,
        })
    }

    /// Least thrust \[N\].
    #[inline]
    pub fn thrust_min(&self) -> f32 {
        self.thrust_min
    }

    /// Greatest thrust \[N\].
    #[inline]
    pub fn thrust_max(&self) -> f32 {
        self.thrust_max
    }

    /// Authority in pitch.
    #[inline]
    pub(crate) fn authority(&self) -> &Authority {
        &self.authority
    }

    /// Rate about the nose that a flight may count on, times the airspeed [rad m/s²].
    #[inline(always)]
    pub(crate) fn roll(&self) -> f32 {
        self.roll
    }

    /// Acceleration by the surfaces, per angular acceleration in pitch \[m\].
    #[inline]
    pub(crate) fn surface_reaction(&self) -> f32 {
        self.surface_reaction
    }

    /// Thrust over airspeed.
    #[inline]
    pub(crate) fn propeller(&self) -> &Propeller {
        &self.propeller
    }

    /// Weight m g \[N\].
    #[inline]
    pub fn weight(&self) -> f32 {
        self.mass * self.gravity
    }

    /// Speed [m/s] at which the greatest lift short of stall carries the weight.
    pub(crate) fn stall_speed(&self) -> f32 {
        let most_lift = math::max(Stall::of(&self.model).c_l, 1e-3);
        math::sqrt((self.weight() / (self.k_a * most_lift)).abs())
    }

    /// Mass m \[kg\].
    #[inline]
    pub fn mass(&self) -> f32 {
        self.mass
    }

    /// Aerodynamic constant k_a [kg/m].
    #[inline]
    pub fn k_a(&self) -> f32 {
        self.k_a
    }

    /// Side force coefficient c_Y.
    #[inline]
    pub fn c_y(&self) -> f32 {
        self.c_y
    }

    /// k_a c_Y [kg/m].
    #[inline(always)]
    pub(crate) fn side(&self) -> f32 {
        self.k_a * self.c_y
    }

    /// The same vehicle where gravity is `gravity` [m/s²], that of the plane of flight in a turn, and with the air's force
    /// `air` times as large. Of the greatest thrust `missing` \[N\] is not there.
    #[inline(always)]
    pub(crate) fn as_flown(&self, gravity: f32, air: f32, missing: f32) -> Vehicle<&A> {
        Vehicle {
            mass: self.mass,
            k_a: air * self.k_a,
            c_y: self.c_y,
            gravity,
            thrust_min: self.thrust_min,
            thrust_max: self.thrust_max - missing,
            authority: self.authority,
            propeller: self.propeller,
            roll: self.roll,
            surface_reaction: self.surface_reaction,
            thrust_line: self.thrust_line,
            model: &self.model,
        }
    }

    /// Least and greatest angular acceleration in pitch [rad/s²], positive nose up, with a `thrust` \[N\]. The air comes at `along` [m/s] along
    /// the nose and at `across` [m/s] from below, as at positive angles of attack. It is what turns the vehicle, less what the wing does. Of
    /// what is measured at rest it counts on the parts that the guidance counts on.
    pub fn pitch_acceleration(&self, along: f32, across: f32, thrust: f32) -> [f32; 2] {
        let flow = Airflow {
            along,
            across,
            speed: math::sqrt(along * along + across * across),
        };
        let allowed = self.authority.at(flow, thrust, self.thrust_max);
        [allowed.wing - allowed.given, allowed.wing + allowed.given]
    }

    /// Gravity g [m/s²].
    #[inline]
    pub fn gravity(&self) -> f32 {
        self.gravity
    }

    /// Thrust line, at δ from the zero-lift line.
    #[inline]
    pub fn thrust_line(&self) -> &ThrustLine {
        &self.thrust_line
    }

    /// Coefficient model.
    #[inline]
    pub fn model(&self) -> &A {
        &self.model
    }

    /// Aerodynamic force F_a \[N\] in body components at these air data (`aerodynamicForce2D`).
    pub fn aerodynamic_force(&self, air: &AirData) -> Body {
        let c = self.model.coefficients(air.alpha);
        let pressure = self.k_a * air.speed * air.speed;
        Body::new(
            pressure * (c.c_d * air.cos - c.c_l * air.sin),
            -pressure * (c.c_l * air.cos + c.c_d * air.sin),
        )
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{LargeAngle, LargeAngleParameters};
    use crate::error::Problem;
    use crate::frame::{Attitude, Inertial};

    fn model() -> LargeAngle {
        LargeAngle::new(LargeAngleParameters::NACA_0021_RE_160E3).unwrap()
    }

    #[test]
    fn lift_and_drag_point_where_the_paper_says() {
        let vehicle = Vehicle::new(VehicleParameters::PAPER, model()).unwrap();
        // Cruise at 10 m/s, pitched 5° nose up: θ = −85°, α = 5°.
        let attitude = Attitude::from_angle(-85f32.to_radians());
        let v_a = Inertial::new(0.0, 10.0);
        let air = AirData::new(attitude.to_body(v_a), vehicle.thrust_line());
        assert!((air.alpha.rad.to_degrees() - 5.0).abs() < 1e-4);
        let force = attitude.to_inertial(vehicle.aerodynamic_force(&air));
        let (c_l, c_d) = (
            0.943 * 10f64.to_radians().sin(),
            0.0139 + 2.0 * 0.943 * 5f64.to_radians().sin().powi(2),
        );
        // Lift is up, that is −i0; drag is backward. 1e-4 of 10 N: an ulp of the angle, times the lift slope.
        assert!((f64::from(force.down()) + 64.6 * c_l).abs() < 1e-4);
        assert!((f64::from(force.forward()) + 64.6 * c_d).abs() < 1e-4);
    }

    #[test]
    fn a_vehicle_says_what_it_was_made_of() {
        let p = VehicleParameters {
            delta: 0.3,
            thrust_min: 2.0,
            ..VehicleParameters::PAPER_BELIEF
        };
        // §VII: wrong on purpose.
        assert_eq!((p.mass, p.k_a, p.gravity), (9.0, 0.51, 9.81));
        let vehicle = Vehicle::new(p, model()).unwrap();
        assert_eq!((vehicle.mass(), vehicle.k_a()), (9.0, 0.51));
        assert_eq!(vehicle.side(), 0.0);
        // A fence of c_Y = 0.5: its side force at 1 m/s of side velocity in 2 m/s of air is half of 0.51 times 2 N.
        let fenced = VehicleParameters { c_y: 0.5, ..p };
        assert_eq!(Vehicle::new(fenced, model()).unwrap().side() * 2.0, 0.51);
        assert_eq!((vehicle.gravity(), vehicle.weight()), (9.81, 9.0 * 9.81));
        assert_eq!((vehicle.thrust_min(), vehicle.thrust_max()), (2.0, 196.2));
        assert_eq!(vehicle.thrust_line().delta(), 0.3);
        assert_eq!(*vehicle.model(), model());
    }

    #[test]
    fn bad_parameters_are_named() {
        let error = |p| {
            let e = Vehicle::new(p, model()).unwrap_err();
            (e.parameter, e.problem)
        };
        let good = VehicleParameters::PAPER;
        assert_eq!(
            error(VehicleParameters { mass: 0.0, ..good }),
            ("mass", Problem::NotPositive)
        );
        assert_eq!(
            error(VehicleParameters {
                k_a: f32::NAN,
                ..good
            }),
            ("k_a", Problem::NotFinite)
        );
        assert_eq!(
            error(VehicleParameters { delta: 4.0, ..good }),
            ("delta", Problem::OutOfRange)
        );
        assert_eq!(
            error(VehicleParameters {
                gravity: -9.81,
                ..good
            }),
            ("gravity", Problem::NotPositive)
        );
        assert_eq!(aerodynamic_constant(1.292, 2.0), Ok(1.292));
        assert_eq!(
            aerodynamic_constant(1.292, -1.0).unwrap_err().parameter,
            "area"
        );
    }
}
