//! Flight as a multicopter: position P, velocity PID, acceleration, thrust vector with a limited tilt.
//!
//! | field | PX4, stock | ArduPilot, stock for tail-sitters |
//! |---|---|---|
//! | `thrust_n` | `MPC_THR_HOVER`, to be set | `Q_M_THST_HOVER`, learned |
//! | `position_1_s` | `MPC_Z_P` 1.0, `MPC_XY_P` 0.95 | `Q_P_POSZ_P` 1.0, `Q_P_POSXY_P` 0.5 |
//! | `velocity_1_s` | `MPC_Z_VEL_P_ACC` 4.0, `MPC_XY_VEL_P_ACC` 1.8 | `Q_P_VELZ_P` 5.0, `Q_P_VELXY_P` 1.0 |
//! | `integral_1_s2` | `MPC_Z_VEL_I_ACC` 2.0, `MPC_XY_VEL_I_ACC` 0.4 | `Q_P_ACCZ_I` 1.0, `Q_P_VELXY_I` 0.5 |
//! | `derivative` | `MPC_Z_VEL_D_ACC` 0, `MPC_XY_VEL_D_ACC` 0.2 | –, `Q_P_VELXY_D` 0.25 |
//! | `climb_m_s`, `sink_m_s` | `MPC_Z_VEL_MAX_UP` 3.0, `MPC_Z_VEL_MAX_DN` 1.5 | `Q_PILOT_SPD_UP` 2.5 (`Q_VELZ_MAX`), the same down |
//! | `speed_m_s` | `MPC_XY_VEL_MAX` 12.0 | `Q_WP_SPEED` 5.0 |
//! | `tilt_deg` | `MPC_TILTMAX_AIR` 45 | `Q_ANGLE_MAX` 30 |
//! | `attitude_1_s` | `MC_PITCH_P` 6.5 | `Q_A_ANG_PIT_P` 4.5 |
//!
//! Read in PX4's `mc_pos_control_params.c` and `mc_att_control_params.c`, and in ArduPilot's `quadplane.cpp`,
//! `tailsitter.cpp` (parameter tables), `AC_PosControl.cpp` and `AC_AttitudeControl.h`. ArduPilot closes the vertical loop over a measured acceleration; here it is the
//! same PID as PX4's, with an integral of that size. The tilt follows from the horizontal acceleration alone, and the
//! thrust is the vertical demand over the cosine of the tilt asked for, as in PX4 (`MPC_ACC_DECOUPLE` 1).

use super::{Measured, Setpoint};
use crate::experiment::table::{
    Range::{NotNegative, Positive, Within},
    table,
};
use crate::reference::Vector;

table! {
    /// `[….hover]`. Pairs are (down, forward).
    pub struct HoverSpec {
        thrust_n: f64, Positive, "Thrust that hovers \\[N\\].";
        position_1_s: [f64; 2], NotNegative, "Velocity per position error \\[1/s\\].";
        velocity_1_s: [f64; 2], NotNegative, "Acceleration per velocity error \\[1/s\\].";
        integral_1_s2: [f64; 2], NotNegative, "Its integral \\[1/s²\\].";
        derivative: [f64; 2], NotNegative, "Acceleration per acceleration.";
        climb_m_s: f64, Positive, "Fastest climb asked for \\[m/s\\].";
        sink_m_s: f64, Positive, "Fastest sink asked for \\[m/s\\].";
        speed_m_s: f64, Positive, "Fastest forward speed asked for \\[m/s\\].";
        tilt_deg: f64, Within(1.0, 85.0), "Largest tilt \\[°\\].";
        attitude_1_s: f64, Positive, "Rate per attitude error \\[1/s\\].";
    }
}

const GRAVITY: f64 = 9.81;
/// Time constant of the derivative's filter \[s\]: 5 Hz, `MPC_VELD_LP`.
const DERIVATIVE: f64 = 0.032;

/// The multicopter's loops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hover {
    spec: HoverSpec,
    /// Thrust \[N\]: least and most.
    thrust: [f64; 2],
    integral: Vector,
    velocity: Option<Vector>,
    derivative: Vector,
    /// The last acceleration asked for was beyond what tilt or thrust give: its sign, per axis.
    saturated: Vector,
    /// Where it stops, if it does not follow the reference.
    stop: Option<Stop>,
}

/// A point that comes to rest, as ArduPilot's QLOITER takes it: it begins where the vehicle is, at its velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stop {
    /// Its position less the reference's \[m\], and its velocity \[m/s\].
    offset: Vector,
    velocity: Vector,
}

/// Deceleration to a stop \[m/s²\]: `Q_PILOT_ACCEL_Z` and `Q_LOIT_BRK_ACCEL` 2.5; beyond a fastest speed asked for it is this many
/// times greater per multiple of that speed.
const BRAKING: f64 = 2.5;
const HURRY: f64 = 2.0;

impl Hover {
    /// The loops on a vehicle with `thrust` \[N\] (least, most).
    pub fn new(spec: HoverSpec, thrust: [f64; 2]) -> Self {
        Self {
            spec,
            thrust,
            integral: Vector::zeros(),
            velocity: None,
            derivative: Vector::zeros(),
            saturated: Vector::zeros(),
            stop: None,
        }
    }

    /// Forgets what was before, as on entering the multicopter's flight.
    pub fn reset(&mut self) {
        *self = Self::new(self.spec, self.thrust);
    }

    /// From here on the reference is not followed: the vehicle stops where it is.
    pub fn stop(&mut self, measured: &Measured) {
        self.stop = Some(Stop {
            offset: measured.position_error,
            velocity: measured.velocity,
        });
    }

    /// Whether it does.
    #[cfg(test)]
    pub(crate) fn stops(&self) -> bool {
        self.stop.is_some()
    }

    /// What is followed: velocity, position error and acceleration.
    fn followed(&mut self, measured: &Measured, dt: f64) -> [Vector; 3] {
        let spec = &self.spec;
        let Some(stop) = &mut self.stop else {
            return [
                measured.reference,
                measured.position_error,
                measured.acceleration,
            ];
        };
        let vertical = match stop.velocity.x < 0.0 {
            true => spec.climb_m_s,
            false => spec.sink_m_s,
        };
        let mut acceleration = Vector::zeros();
        for (axis, fastest) in [vertical, spec.speed_m_s].into_iter().enumerate() {
            let speed = stop.velocity[axis].abs();
            let hurry = match speed > fastest {
                true => HURRY * speed / fastest,
                false => 1.0,
            };
            let slower = (BRAKING * hurry * dt).min(speed);
            acceleration[axis] = -slower.copysign(stop.velocity[axis]) / dt;
        }
        stop.velocity += acceleration * dt;
        stop.offset += (stop.velocity - measured.reference) * dt;
        [
            stop.velocity,
            measured.position_error - stop.offset,
            acceleration,
        ]
    }

    /// Largest tilt \[rad\].
    fn tilt(&self) -> f64 {
        self.spec.tilt_deg.to_radians()
    }

    /// Rate per attitude error \[1/s\].
    pub fn gain(&self) -> f64 {
        self.spec.attitude_1_s
    }

    /// Thrust that hovers \[N\].
    pub fn thrust(&self) -> f64 {
        self.spec.thrust_n
    }

    /// Acceleration asked for \[m/s²\], `dt` \[s\] after the last.
    fn acceleration(&mut self, measured: &Measured, dt: f64) -> Vector {
        let [velocity, position_error, mut acceleration] = self.followed(measured, dt);
        let spec = &self.spec;
        let mut wanted = Vector::zeros();
        let limits = [
            (-spec.climb_m_s, spec.sink_m_s),
            (-spec.speed_m_s, spec.speed_m_s),
        ];
        for (axis, (low, high)) in limits.into_iter().enumerate() {
            let back = -spec.position_1_s[axis] * position_error[axis];
            // What it stops from may be faster than what is ever asked for.
            wanted[axis] = match self.stop {
                Some(_) => velocity[axis] + back.clamp(low, high),
                None => (velocity[axis] + back).clamp(low, high),
            };
        }
        let error = wanted - measured.velocity;
        let slope = self
            .velocity
            .map_or(Vector::zeros(), |last| (measured.velocity - last) / dt);
        self.velocity = Some(measured.velocity);
        self.derivative += (slope - self.derivative) * (dt / (DERIVATIVE + dt));
        for axis in 0..2 {
            // Not further into saturation.
            if error[axis] * self.saturated[axis] <= 0.0 {
                self.integral[axis] += spec.integral_1_s2[axis] * error[axis] * dt;
            }
            acceleration[axis] += spec.velocity_1_s[axis] * error[axis] + self.integral[axis]
                - spec.derivative[axis] * self.derivative[axis];
        }
        // No more than the weight is ever carried by something else.
        self.integral.x = self.integral.x.clamp(-GRAVITY, GRAVITY);
        acceleration
    }

    /// The multicopter's setpoint.
    pub fn setpoint(&mut self, measured: &Measured, dt: f64) -> Setpoint {
        let acceleration = self.acceleration(measured, dt);
        let limit = self.tilt();
        let asked = acceleration.y.atan2(GRAVITY);
        let tilt = asked.clamp(-limit, limit);
        let up = self.spec.thrust_n * (1.0 - acceleration.x / GRAVITY);
        let asked_thrust = up / tilt.cos();
        let thrust = asked_thrust.clamp(self.thrust[0], self.thrust[1]);
        // Height before forward motion: what thrust there is goes into carrying the vehicle.
        let tilt = if asked_thrust > thrust {
            let most = (up / thrust).clamp(-1.0, 1.0).acos();
            tilt.clamp(-most, most)
        } else {
            tilt
        };
        self.saturated = Vector::new(thrust - asked_thrust, asked - tilt);
        Setpoint {
            theta: -tilt,
            gain: self.gain(),
            thrust,
        }
    }

    /// Thrust \[N\] of the vertical loop alone, while the attitude is another's: the vertical demand over the cosine of the
    /// tilt, of no more than the largest tilt.
    pub fn vertical(&mut self, measured: &Measured, dt: f64) -> f64 {
        let acceleration = self.acceleration(measured, dt);
        // The forward loop is idle.
        self.integral.y = 0.0;
        let up = self.spec.thrust_n * (1.0 - acceleration.x / GRAVITY);
        let asked = up / measured.theta.cos().max(self.tilt().cos());
        let thrust = asked.clamp(self.thrust[0], self.thrust[1]);
        self.saturated = Vector::new(thrust - asked, 0.0);
        thrust
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::super::measured::tests::steady;
    use super::*;

    /// PX4's stock gains at a weight of 98.1 N.
    pub(crate) const SPEC: HoverSpec = HoverSpec {
        thrust_n: 98.1,
        position_1_s: [1.0, 0.95],
        velocity_1_s: [4.0, 1.8],
        integral_1_s2: [2.0, 0.4],
        derivative: [0.0, 0.2],
        climb_m_s: 3.0,
        sink_m_s: 1.5,
        speed_m_s: 12.0,
        tilt_deg: 45.0,
        attitude_1_s: 6.5,
    };

    fn hover() -> Hover {
        Hover::new(SPEC, [0.0, 196.2])
    }

    #[test]
    fn hover_is_an_equilibrium() {
        let mut hover = hover();
        for _ in 0..1000 {
            let setpoint = hover.setpoint(&steady([0.0, 0.0], 0.0), 0.01);
            assert!(setpoint.theta.abs() < 1e-12 && (setpoint.thrust - 98.1).abs() < 1e-9);
        }
    }

    #[test]
    fn too_low_is_more_thrust_and_behind_is_nose_forward() {
        let mut low = steady([0.0, 0.0], 0.0);
        low.position_error = Vector::new(0.5, 0.0);
        // 1 1/s · 0.5 m, 4 1/s: 2 m/s² up, and 0.01 of the integral.
        let setpoint = hover().setpoint(&low, 0.01);
        assert!((setpoint.thrust - 98.1 * (1.0 + 2.01 / GRAVITY)).abs() < 1e-6);
        let mut behind = steady([0.0, 0.0], 0.0);
        behind.position_error = Vector::new(0.0, -1.0);
        let setpoint = hover().setpoint(&behind, 0.01);
        let acceleration = 0.95 * (1.8 + 0.004);
        assert!((setpoint.theta + (acceleration / GRAVITY).atan()).abs() < 1e-9);
        assert!((setpoint.thrust * setpoint.theta.cos() - 98.1).abs() < 1e-9);
    }

    #[test]
    fn speed_tilt_and_thrust_are_limited_and_height_comes_first() {
        let mut far = steady([0.0, 0.0], 0.0);
        far.position_error = Vector::new(0.0, -1000.0);
        let setpoint = hover().setpoint(&far, 0.01);
        assert!((setpoint.theta + 45_f64.to_radians()).abs() < 1e-12);
        // Asked for 12 m/s at most: at 12 m/s nothing is left to be done.
        let mut fast = far;
        fast.velocity = Vector::new(0.0, 12.0);
        fast.reference = Vector::new(0.0, 20.0);
        assert!(hover().setpoint(&fast, 0.01).theta.abs() < 1e-9);
        // 3 m/s of climb from a sink of 2 m/s asks for all the thrust: none is left for the tilt.
        far.position_error = Vector::new(100.0, -1000.0);
        far.velocity = Vector::new(2.0, 0.0);
        let setpoint = hover().setpoint(&far, 0.01);
        assert_eq!((setpoint.theta, setpoint.thrust), (-0.0, 196.2));
    }

    #[test]
    fn the_integral_carries_what_is_not_known_and_does_not_wind_up() {
        let mut hover = hover();
        let mut sinking = steady([0.2, 0.0], 0.0);
        sinking.reference = Vector::zeros();
        hover.setpoint(&sinking, 0.01);
        let first = hover.setpoint(&sinking, 0.01).thrust;
        for _ in 0..100 {
            hover.setpoint(&sinking, 0.01);
        }
        // 2 1/s² · 0.2 m/s for 1 s: 0.4 m/s².
        let second = hover.setpoint(&sinking, 0.01).thrust;
        assert!((second - first - 98.1 * 0.404 / GRAVITY).abs() < 0.01);
        // At the tilt limit the forward integral stands still.
        let mut far = steady([0.0, 0.0], 0.0);
        far.position_error = Vector::new(0.0, -1000.0);
        for _ in 0..1000 {
            hover.setpoint(&far, 0.01);
        }
        assert!(hover.integral.y < 0.1, "{}", hover.integral.y);
    }

    /// From 2.5 m/s up and 6 m/s ahead: 1.25 m, and at 2.5 m/s² 7.2 m, wherever the reference goes meanwhile.
    #[test]
    fn it_stops_where_it_is_and_does_not_return() {
        let spec = HoverSpec {
            climb_m_s: 2.5,
            speed_m_s: 12.0,
            ..SPEC
        };
        let mut hover = Hover::new(spec, [0.0, 196.2]);
        let mut measured = steady([-2.5, 6.0], 0.0);
        measured.position_error = Vector::new(-30.0, 20.0);
        measured.reference = Vector::new(0.0, 1.0);
        hover.stop(&measured);
        for _ in 0..1000 {
            hover.setpoint(&measured, 0.01);
        }
        // The reference moved on by 10 m.
        let stop = hover.stop.unwrap();
        assert!(
            (stop.offset - Vector::new(-31.25, 17.2)).norm() < 0.1,
            "{stop:?}"
        );
        assert_eq!(stop.velocity, Vector::zeros());
        let mut hover = Hover {
            stop: Some(stop),
            ..Hover::new(spec, [0.0, 196.2])
        };
        let mut there = steady([0.0, 0.0], 0.0);
        there.position_error = stop.offset;
        let setpoint = hover.setpoint(&there, 0.01);
        assert!(setpoint.theta.abs() < 1e-9 && (setpoint.thrust - 98.1).abs() < 1e-9);
    }

    #[test]
    fn the_vertical_loop_makes_up_for_the_tilt_it_has_up_to_its_limit() {
        let at = |theta: f64| hover().vertical(&steady([0.0, 0.0], theta), 0.01);
        assert!((at(0.0) - 98.1).abs() < 1e-9);
        assert!((at(-0.5) - 98.1 / 0.5_f64.cos()).abs() < 1e-9);
        assert!((at(-1.3) - 98.1 * 2.0_f64.sqrt()).abs() < 1e-9);
    }
}
