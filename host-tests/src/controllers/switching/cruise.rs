//! Flight as an aeroplane: a total-energy loop of speed and height in the manner of PX4's.
//!
//! Throttle controls the rate of total energy, around its trim; pitch controls the balance of potential and kinetic
//! energy. Both have a feed-forward, a damping on the rate's error and an integral.
//!
//! | field | PX4, stock |
//! |---|---|
//! | `airspeed_m_s` | `FW_AIRSPD_MIN` 10, `FW_AIRSPD_MAX` 20 |
//! | `trim_throttle` | `FW_THR_TRIM` 0.6 |
//! | `throttle` | `FW_THR_MIN` 0, `FW_THR_MAX` 1 |
//! | `pitch_deg` | `FW_P_LIM_MIN` −30, `FW_P_LIM_MAX` 30 |
//! | `level_pitch_deg` | `FW_PSP_OFF` 0 |
//! | `climb_m_s` | `FW_T_CLMB_MAX` 5 |
//! | `sink_m_s` | `FW_T_SINK_MIN` 2, `FW_T_SINK_MAX` 5 |
//! | `altitude_s`, `speed_s` | `FW_T_ALT_TC` 5, `FW_T_TAS_TC` 5 |
//! | `height_rate_feed_forward` | `FW_T_HRATE_FF` 0.3 |
//! | `speed_weight` | `FW_T_SPDWEIGHT` 1 |
//! | `throttle_damping`, `throttle_integral_1_s` | `FW_T_THR_DAMPING` 0.05, `FW_T_THR_INTEG` 0.02 |
//! | `pitch_damping`, `pitch_integral_1_s` | `FW_T_PTCH_DAMP` 0.1, `FW_T_I_GAIN_PIT` 0.1 |
//! | `vertical_acceleration_m_s2` | `FW_T_VERT_ACC` 7 |
//! | `energy_rate_s` | `FW_T_STE_R_TC` 0.4 |
//! | `attitude_1_s` | 1/`FW_P_TC`: 2.5 |
//!
//! Read in PX4's `fw_pos_control_l1_params.c`, `fw_att_control_params.c` and `performance_model_params.c`. Below the least
//! airspeed the throttle goes to its maximum, and pitch to holding speed alone, in full 15 % below it.

use super::policy::{CruiseTable, in_order};
use super::{Measured, Setpoint};
use crate::experiment::FieldError;
use crate::experiment::table::{
    Range::{Finite, Positive, Within},
    table,
};

table! {
    /// `[controller.px4-like.cruise]`.
    pub struct CruiseSpec {
        airspeed_m_s: [f64; 2], Positive, "Least and greatest airspeed asked for \\[m/s\\].";
        trim_throttle: f64, Finite, "Throttle of level cruise, of the greatest thrust.";
        throttle: [f64; 2], Finite, "Least and greatest throttle.";
        pitch_deg: [f64; 2], Finite, "Least and greatest pitch over the horizon \\[°\\].";
        level_pitch_deg: f64, Finite, "Pitch over the horizon in level cruise \\[°\\].";
        climb_m_s: f64, Positive, "Climb that the greatest throttle gives at constant speed \\[m/s\\]; no faster climb is asked for.";
        sink_m_s: [f64; 2], Positive, "Sink \\[m/s\\] that the least throttle gives at constant speed, and the fastest that is asked for.";
        altitude_s: f64, Positive, "Time constant of altitude errors \\[s\\].";
        speed_s: f64, Positive, "Time constant of airspeed errors \\[s\\].";
        height_rate_feed_forward: f64, Within(0.0, 1.0), "Part of the reference's climb that is fed forward.";
        speed_weight: f64, Within(0.0, 2.0), "Weight of speed in the energy balance, 0 to 2; height has the rest.";
        throttle_damping: f64, Within(0.0, 100.0), "Throttle per relative error of the energy rate.";
        throttle_integral_1_s: f64, Within(0.0, 100.0), "Its integral \\[1/s\\].";
        pitch_damping: f64, Within(0.0, 100.0), "Pitch per relative error of the balance rate.";
        pitch_integral_1_s: f64, Within(0.0, 100.0), "Its integral \\[1/s\\].";
        vertical_acceleration_m_s2: f64, Positive, "Vertical acceleration that limits how fast the pitch asked for changes \\[m/s²\\].";
        energy_rate_s: f64, Positive, "Time constant of the energy rate's filter \\[s\\].";
        attitude_1_s: f64, Positive, "Rate per attitude error \\[1/s\\].";
    }
}

const GRAVITY: f64 = 9.81;
/// Part of the least airspeed over which the protection against less sets in.
const UNDERSPEED: f64 = 0.15;
/// Time constant of the measured forward acceleration \[s\].
const ACCELERATION: f64 = 0.1;
/// Crossover of acceleration and airspeed in the airspeed's estimate \[rad/s\]; PX4's filter is of that kind. Without it every gust would count as a change of energy.
const CROSSOVER: f64 = 2.0;

impl CruiseTable for CruiseSpec {
    type Loops = Cruise;

    fn validate(&self, table: &str) -> Result<(), FieldError> {
        self.in_range(table)?;
        let ranges = [self.airspeed_m_s, self.throttle, self.pitch_deg];
        in_order(table, ranges, self.trim_throttle)
    }

    fn loops(self, full: f64) -> Cruise {
        Cruise::new(self, full)
    }
}

/// The aeroplane's loops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cruise {
    spec: CruiseSpec,
    /// Thrust at full throttle \[N\].
    full: f64,
    /// Integral of the throttle.
    throttle: f64,
    /// Integral of the balance rate \[m²/s³\].
    balance: f64,
    /// Pitch asked for last, over the horizon and without the level pitch \[rad\].
    pitch: Option<f64>,
    /// Airspeed, estimated \[m/s\].
    airspeed: Option<f64>,
    /// Forward velocity of the last step \[m/s\].
    forward: Option<f64>,
    /// Forward acceleration, filtered \[m/s²\].
    acceleration: f64,
    /// Error of the energy rate, filtered \[m²/s³\].
    error: f64,
}

impl Cruise {
    /// The loops on a vehicle with `full` thrust \[N\] at full throttle.
    pub fn new(spec: CruiseSpec, full: f64) -> Self {
        Self {
            spec,
            full,
            throttle: 0.0,
            balance: 0.0,
            pitch: None,
            airspeed: None,
            forward: None,
            acceleration: 0.0,
            error: 0.0,
        }
    }

    /// Forgets what was before, as on entering the aeroplane's flight.
    pub fn reset(&mut self) {
        *self = Self::new(self.spec, self.full);
    }

    /// Rate per attitude error \[1/s\].
    pub fn gain(&self) -> f64 {
        self.spec.attitude_1_s
    }

    /// θ of level cruise \[rad\].
    pub fn level(&self) -> f64 {
        (self.spec.level_pitch_deg - 90.0).to_radians()
    }

    /// The aeroplane's setpoint, `dt` \[s\] after the last.
    pub fn setpoint(&mut self, measured: &Measured, dt: f64) -> Setpoint {
        let spec = self.spec;
        let estimate = self.estimate(measured, dt);
        let airspeed = estimate.max(0.5 * spec.airspeed_m_s[0]);

        // The climb rate and the acceleration asked for.
        let climb = (measured.position_error.x / spec.altitude_s
            - spec.height_rate_feed_forward * measured.reference.x)
            .clamp(-spec.sink_m_s[1], spec.climb_m_s);
        let [least, greatest] = spec.airspeed_m_s;
        let most = GRAVITY * spec.climb_m_s;
        let fall = GRAVITY * spec.sink_m_s[0];
        let speed_error = measured.reference_airspeed.clamp(least, greatest) - estimate;
        let faster = (speed_error / spec.speed_s).clamp(-fall / airspeed, most / airspeed);

        // Rates of specific potential and kinetic energy [m²/s³]: asked for, measured.
        let potential = [GRAVITY * climb, -GRAVITY * measured.velocity.x];
        let kinetic = [airspeed * faster, airspeed * self.acceleration];
        let slow = ((least - estimate) / (UNDERSPEED * least)).clamp(0.0, 1.0);

        let wanted = (potential[0] + kinetic[0]).clamp(-fall, most);
        let error = wanted - potential[1] - kinetic[1];
        self.error += (error - self.error) * (dt / (spec.energy_rate_s + dt));
        let throttle = self.throttle_for(wanted, dt);
        let throttle = slow * spec.throttle[1] + (1.0 - slow) * throttle;

        let weight = spec.speed_weight + slow * (2.0 - spec.speed_weight);
        let balance = |i: usize| (2.0 - weight) * potential[i] - weight * kinetic[i];
        let pitch = self.pitch_for(balance(0), balance(1), airspeed, dt);
        Setpoint {
            theta: pitch + self.level(),
            gain: self.gain(),
            thrust: throttle * self.full,
        }
    }

    /// The airspeed \[m/s\]: in the short run the integral of the acceleration, in the long run as it is measured.
    fn estimate(&mut self, measured: &Measured, dt: f64) -> f64 {
        let forward = measured.velocity.y;
        let slope = self.forward.map_or(0.0, |last| (forward - last) / dt);
        self.forward = Some(forward);
        self.acceleration += (slope - self.acceleration) * (dt / (ACCELERATION + dt));
        let last = self.airspeed.unwrap_or(measured.airspeed);
        let rate = self.acceleration + CROSSOVER * (measured.airspeed - last);
        let airspeed = last + rate * dt;
        self.airspeed = Some(airspeed);
        airspeed
    }

    /// The throttle for a `wanted` rate of energy \[m²/s³\].
    fn throttle_for(&mut self, wanted: f64, dt: f64) -> f64 {
        let spec = &self.spec;
        let [low, high] = spec.throttle;
        let most = GRAVITY * spec.climb_m_s;
        let fall = GRAVITY * spec.sink_m_s[0];
        let predicted = if wanted > 0.0 {
            (high - spec.trim_throttle) / most * wanted
        } else {
            (spec.trim_throttle - low) / fall * wanted
        };
        let error = self.error / (most + fall);
        let rest = spec.trim_throttle + predicted + spec.throttle_damping * error;
        self.throttle = (self.throttle + spec.throttle_integral_1_s * error * dt)
            .clamp((low - rest).min(0.0), (high - rest).max(0.0));
        (rest + self.throttle).clamp(low, high)
    }

    /// The pitch \[rad\] for a `wanted` rate of the balance, where it `is` \[m²/s³\].
    fn pitch_for(&mut self, wanted: f64, is: f64, airspeed: f64, dt: f64) -> f64 {
        let spec = &self.spec;
        let [low, high] = spec.pitch_deg.map(f64::to_radians);
        let scale = GRAVITY * airspeed;
        let error = wanted - is;
        let rest = wanted + spec.pitch_damping * error;
        let integral = self.balance + spec.pitch_integral_1_s * error * dt;
        self.balance = integral.clamp(
            (low * scale - rest).min(0.0),
            (high * scale - rest).max(0.0),
        );
        let asked = ((rest + self.balance) / scale).clamp(low, high);
        let step = spec.vertical_acceleration_m_s2 / airspeed * dt;
        let pitch = self
            .pitch
            .map_or(asked, |last| asked.clamp(last - step, last + step));
        self.pitch = Some(pitch);
        pitch
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::super::measured::tests::steady;
    use super::*;
    use crate::reference::Vector;

    /// PX4's stock figures, but for the trim of the paper's vehicle at 20 m/s.
    pub(crate) const SPEC: CruiseSpec = CruiseSpec {
        airspeed_m_s: [10.0, 20.0],
        trim_throttle: 0.02,
        throttle: [0.0, 1.0],
        pitch_deg: [-30.0, 30.0],
        level_pitch_deg: 4.0,
        climb_m_s: 5.0,
        sink_m_s: [2.0, 5.0],
        altitude_s: 5.0,
        speed_s: 5.0,
        height_rate_feed_forward: 0.3,
        speed_weight: 1.0,
        throttle_damping: 0.05,
        throttle_integral_1_s: 0.02,
        pitch_damping: 0.1,
        pitch_integral_1_s: 0.1,
        vertical_acceleration_m_s2: 7.0,
        energy_rate_s: 0.4,
        attitude_1_s: 2.5,
    };

    fn cruise() -> Cruise {
        Cruise::new(SPEC, 196.2)
    }

    fn level(speed: f64) -> Measured {
        steady([0.0, speed], (-86_f64).to_radians())
    }

    #[test]
    fn level_trim_is_an_equilibrium() {
        let mut cruise = cruise();
        for _ in 0..1000 {
            let setpoint = cruise.setpoint(&level(20.0), 0.01);
            assert!((setpoint.theta - (-86_f64).to_radians()).abs() < 1e-9);
            assert!((setpoint.thrust - 3.924).abs() < 1e-9);
        }
    }

    /// Energy missing: throttle. Energy in the wrong place: pitch, and the throttle stays.
    #[test]
    fn throttle_holds_the_energy_and_pitch_the_balance() {
        let at = |altitude: f64, speed: f64| {
            let mut measured = level(speed);
            measured.position_error = Vector::new(-altitude, 0.0);
            measured.reference_airspeed = 15.0;
            cruise().setpoint(&measured, 0.01)
        };
        let trim = at(0.0, 15.0);
        let low = at(-2.0, 15.0);
        assert!(low.thrust > trim.thrust && low.theta > trim.theta);
        let slow = at(0.0, 13.0);
        assert!(slow.thrust > trim.thrust && slow.theta < trim.theta);
        // 2 m of altitude are 9.81·2/5 m²/s³; so is what 14 m/s · ΔV/5 gives.
        let fast = 2.0 * GRAVITY / 14.0;
        let traded = {
            let mut measured = level(14.0);
            measured.position_error = Vector::new(2.0, 0.0);
            measured.reference_airspeed = 14.0 - fast;
            cruise().setpoint(&measured, 0.01)
        };
        assert!((traded.thrust - trim.thrust).abs() < 1e-6);
        assert!(traded.theta > trim.theta + 0.02);
    }

    #[test]
    fn the_integral_of_the_throttle_finds_the_trim() {
        let mut cruise = cruise();
        let mut sinking = level(15.0);
        sinking.velocity.x = 1.0;
        sinking.reference.x = 0.0;
        let first = cruise.setpoint(&sinking, 0.01).thrust;
        for _ in 0..1000 {
            cruise.setpoint(&sinking, 0.01);
        }
        let last = cruise.setpoint(&sinking, 0.01).thrust;
        // 9.81 m²/s³ missing of 68.67, at 0.02 1/s for some 9.6 s (10 s less the filter), and 0.05 of it at once.
        let expected = 196.2 * (1.0 / 7.0) * (0.02 * 9.6 + 0.05);
        assert!((last - first - expected).abs() < 0.1, "{}", last - first);
    }

    #[test]
    fn too_slow_is_full_throttle_and_nose_down() {
        let mut slow = level(8.4);
        slow.reference_airspeed = 10.0;
        // Below, which alone would ask for the nose up.
        slow.position_error.x = 20.0;
        let setpoint = cruise().setpoint(&slow, 0.01);
        assert_eq!(setpoint.thrust, 196.2);
        assert!(setpoint.theta < (-86_f64).to_radians());
    }

    #[test]
    fn the_airspeed_follows_the_acceleration_at_once_and_a_gust_slowly() {
        let mut cruise = cruise();
        cruise.estimate(&level(20.0), 0.01);
        let mut gust = level(20.0);
        gust.airspeed = 24.0;
        for _ in 0..50 {
            cruise.estimate(&gust, 0.01);
        }
        // Half a second is one time constant.
        let expected = 20.0 + 4.0 * (1.0 - (-1.0_f64).exp());
        assert!((cruise.airspeed.unwrap() - expected).abs() < 0.05);
        let mut cruise = super::tests::cruise();
        for step in 0..200 {
            cruise.estimate(&level(20.0 + 0.02 * f64::from(step)), 0.01);
        }
        assert!((cruise.airspeed.unwrap() - 23.98).abs() < 0.05);
        assert!((cruise.acceleration - 2.0).abs() < 1e-6);
    }

    #[test]
    fn pitch_and_its_slew_are_limited() {
        let mut cruise = cruise();
        cruise.setpoint(&level(20.0), 0.01);
        let mut low = level(20.0);
        low.position_error.x = 1000.0;
        let first = cruise.setpoint(&low, 0.01).theta;
        assert!((first - (-86_f64).to_radians() - 7.0 / 20.0 * 0.01).abs() < 1e-9);
        let mut last = first;
        for _ in 0..3000 {
            last = cruise.setpoint(&low, 0.01).theta;
        }
        assert!((last - (-56_f64).to_radians()).abs() < 1e-9);
        // The integral has not wound up: level again, the pitch leaves its limit at once.
        let after = cruise.setpoint(&level(20.0), 0.01).theta;
        assert!(after < last);
    }
}
