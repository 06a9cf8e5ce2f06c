//! Flight as an aeroplane in the manner of ArduPilot's total-energy control, TECS.
//!
//! Throttle answers the error of total energy, around its trim; pitch the error of the balance of potential and kinetic
//! energy. Both errors decay with one time constant; both loops have a feed-forward of the energy rate asked for, a damping
//! on its error, and an integral.
//!
//! | field | ArduPilot, stock for tail-sitters |
//! |---|---|
//! | `airspeed_m_s` | `AIRSPEED_MIN` 9, `AIRSPEED_MAX` 22 |
//! | `trim_throttle`, `throttle` | `TRIM_THROTTLE` 45 %; `THR_MIN` 0, `THR_MAX` 100 % |
//! | `pitch_deg` | `PTCH_LIM_MIN_DEG` −30, `TECS_PITCH_MAX` 15 |
//! | `level_pitch_deg` | `PTCH_TRIM_DEG` 0 |
//! | `climb_m_s` | `TECS_CLMB_MAX` 5 |
//! | `sink_m_s` | `TECS_SINK_MIN` 2, `TECS_SINK_MAX` 5 |
//! | `time_s` | `TECS_TIME_CONST` 5 |
//! | `height_s` | `TECS_HDEM_TCONST` 3 |
//! | `speed_weight` | `TECS_SPDWEIGHT` 1 |
//! | `throttle_damping_s` | `TECS_THR_DAMP` 0.5 |
//! | `pitch_damping` | `TECS_PTCH_DAMP` 0.3 |
//! | `integral_1_s` | `TECS_INTEG_GAIN` 0.3 |
//! | `vertical_acceleration_m_s2` | `TECS_VERT_ACC` 7 |
//! | `attitude_1_s` | 1/`PTCH2SRV_TCONST`: 2 |
//!
//! Behaviour read in ArduPilot's `AP_TECS.cpp`; the parameters also in `AP_PitchController.cpp`, `tailsitter.cpp` and `config.h`
//! of Plane. Airspeed is what a pitot tube measures, along the nose. Too slow is below 0.9 of the least airspeed at 95 % of
//! throttle or more: then full throttle, the least airspeed, and pitch for speed alone, until the height is reached.
//! Left out: the detection of a descent that cannot be flown, and the lowering of the greatest airspeed and of the demanded
//! climb while throttle or pitch is at its limit.

use super::policy::{CruiseTable, in_order};
use super::{Measured, Setpoint};
use crate::experiment::FieldError;
use crate::experiment::table::{
    Range::{Finite, Positive, Within},
    table,
};
use crate::reference::Vector;

table! {
    /// `[controller.ardupilot-like.cruise]`.
    pub struct TecsSpec {
        airspeed_m_s: [f64; 2], Positive, "Least and greatest airspeed asked for \\[m/s\\].";
        trim_throttle: f64, Finite, "Throttle of level cruise, of the greatest thrust.";
        throttle: [f64; 2], Finite, "Least and greatest throttle.";
        pitch_deg: [f64; 2], Finite, "Least and greatest pitch over the horizon \\[°\\].";
        level_pitch_deg: f64, Finite, "Pitch over the horizon in level cruise \\[°\\].";
        climb_m_s: f64, Positive, "Climb that the greatest throttle gives at constant speed \\[m/s\\]; no faster climb is asked for.";
        sink_m_s: [f64; 2], Positive, "Sink \\[m/s\\] that the least throttle gives at constant speed, and the fastest that is asked for.";
        time_s: f64, Positive, "Time constant of errors of height and speed \\[s\\].";
        height_s: f64, Positive, "Time constant of the lag of the height asked for \\[s\\].";
        speed_weight: f64, Within(0.0, 2.0), "Weight of speed in the energy balance, 0 to 2; height has the rest.";
        throttle_damping_s: f64, Within(0.0, 100.0), "Error of energy per error of its rate \\[s\\].";
        pitch_damping: f64, Within(0.0, 100.0), "Balance rate per its error.";
        integral_1_s: f64, Within(0.0, 100.0), "Gain of both integrals \\[1/s\\].";
        vertical_acceleration_m_s2: f64, Positive, "Vertical acceleration that limits how fast the pitch asked for changes \\[m/s²\\].";
        attitude_1_s: f64, Positive, "Rate per attitude error \\[1/s\\].";
    }
}

const GRAVITY: f64 = 9.81;
/// Crossover of acceleration and airspeed in the airspeed's estimate \[rad/s\]: `TECS_SPD_OMEGA`.
const CROSSOVER: f64 = 2.0;
/// Time constant of the measured acceleration \[s\], in place of a mean over 0.1 s.
const ACCELERATION: f64 = 0.05;
/// Time constant of the error of the energy rate \[s\].
const ENERGY_RATE: f64 = 0.5;
/// Airspeed is never taken for less \[m/s\].
const LEAST_AIRSPEED: f64 = 3.0;
/// Change of throttle per second: `THR_SLEWRATE` 100 %.
const SLEW: f64 = 1.0;
/// Part of the most energy rate that changes of airspeed may ask for.
const SHARE: f64 = 0.5;

impl CruiseTable for TecsSpec {
    type Loops = Tecs;

    fn validate(&self, table: &str) -> Result<(), FieldError> {
        self.in_range(table)?;
        let ranges = [self.airspeed_m_s, self.throttle, self.pitch_deg];
        in_order(table, ranges, self.trim_throttle)
    }

    fn loops(self, full: f64) -> Tecs {
        Tecs {
            spec: self,
            full,
            memory: None,
        }
    }
}

/// What the loops remember between steps.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Memory {
    velocity: Vector,
    /// Acceleration along the nose, and its low-passed part \[m/s²\].
    acceleration: [f64; 2],
    /// Airspeed, estimated \[m/s\], and the integral of its error \[m/s²\].
    airspeed: [f64; 2],
    /// Airspeed asked for \[m/s\], and its low-passed rate \[m/s²\].
    wanted_airspeed: [f64; 2],
    /// Height of the reference, limited in its rate, and after its lag; over the reference's height at the reset \[m\].
    height: [f64; 3],
    /// Error of the energy rate, filtered \[m²/s³\].
    rate_error: f64,
    /// Throttle without its integral; the integral; their sum.
    throttle: [f64; 3],
    /// Integral of the balance rate, and of the kinetic energy \[m²/s³\].
    balance: [f64; 2],
    /// Pitch asked for, over the horizon and without the level pitch \[rad\].
    pitch: f64,
    /// Whether it is too slow.
    slow: bool,
}

/// The loops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tecs {
    spec: TecsSpec,
    /// Thrust at full throttle \[N\].
    full: f64,
    memory: Option<Memory>,
}

/// `state` after `dt` on its way to `value` with this time constant.
fn lag(state: f64, value: f64, time: f64, dt: f64) -> f64 {
    state + (value - state) * (dt / (time + dt))
}

impl Tecs {
    /// Forgets what was before.
    pub fn reset(&mut self) {
        self.memory = None;
    }

    /// Rate per attitude error \[1/s\].
    pub fn gain(&self) -> f64 {
        self.spec.attitude_1_s
    }

    /// θ of level cruise \[rad\].
    fn level(&self) -> f64 {
        (self.spec.level_pitch_deg - 90.0).to_radians()
    }

    /// Thrust of level cruise \[N\].
    pub fn trim(&self) -> f64 {
        self.spec.trim_throttle * self.full
    }

    /// Most and least rate of specific energy \[m²/s³\].
    fn rates(&self) -> [f64; 2] {
        [self.spec.climb_m_s, -self.spec.sink_m_s[0]].map(|v| GRAVITY * v)
    }

    /// The aeroplane's setpoint, `dt` \[s\] after the last. As long as the vehicle is `carried` by its rotors, height and speed
    /// are controlled apart: height by pitch, speed by throttle.
    pub fn setpoint(&mut self, measured: &Measured, carried: bool, dt: f64) -> Setpoint {
        let spec = self.spec;
        let nose = Vector::new(-measured.theta.cos(), -measured.theta.sin());
        let mut m = self.memory.unwrap_or_else(|| self.begin(measured));
        let slope = nose.dot(&((measured.velocity - m.velocity) / dt));
        m.velocity = measured.velocity;
        m.acceleration[0] = lag(m.acceleration[0], slope, ACCELERATION, dt);
        m.acceleration[1] = lag(m.acceleration[1], m.acceleration[0], spec.time_s, dt);
        let error = measured.nose_airspeed - m.airspeed[0];
        m.airspeed[1] += CROSSOVER * CROSSOVER * error * dt;
        let rate = m.airspeed[1] + m.acceleration[0] + 2.0_f64.sqrt() * CROSSOVER * error;
        m.airspeed[0] = (m.airspeed[0] + rate * dt).max(LEAST_AIRSPEED);
        let airspeed = m.airspeed[0];

        let [most, fall] = self.rates();
        let [least, greatest] = spec.airspeed_m_s;
        let asked = match m.slow {
            true => least,
            false => measured.reference_airspeed.clamp(least, greatest),
        };
        let before = m.wanted_airspeed[0];
        let faster =
            ((asked - before) / dt).clamp(SHARE * fall / airspeed, SHARE * most / airspeed);
        m.wanted_airspeed[0] = (before + faster * dt).clamp(least, greatest);
        m.wanted_airspeed[1] = lag(m.wanted_airspeed[1], faster, spec.time_s, dt);

        // Heights: of the vehicle, and as asked for.
        m.height[0] -= measured.reference.x * dt;
        let is = m.height[0] - measured.position_error.x;
        let [up, down] = [spec.climb_m_s, spec.sink_m_s[1]];
        m.height[1] = m.height[0].clamp(m.height[1] - down * dt, m.height[1] + up * dt);
        let climb = (m.height[1] - m.height[2]) / spec.height_s;
        m.height[2] = lag(m.height[2], m.height[1], spec.height_s, dt);
        let low = m.height[2] - is;

        let too_slow = airspeed < 0.9 * least && m.throttle[2] >= 0.95 * spec.throttle[1];
        m.slow = !carried && (too_slow || (m.slow && low > 0.0 && airspeed < 1.15 * least));

        // Errors of specific potential and kinetic energy [m²/s²], and their rates, asked for and measured [m²/s³].
        let kinetic = |v: f64| 0.5 * v * v;
        let errors = [
            GRAVITY * low,
            kinetic(m.wanted_airspeed[0]) - kinetic(airspeed),
        ];
        let wanted = airspeed * (faster - m.wanted_airspeed[1]);
        let had = [
            -GRAVITY * measured.velocity.x,
            airspeed * (m.acceleration[0] - m.acceleration[1]),
        ];
        let room = match carried {
            true => [0.0; 2],
            false => [greatest, least].map(|v| kinetic(airspeed) - kinetic(v)),
        };
        let held = errors[0].clamp(room[0].min(0.0), room[1].max(0.0));
        let rate = (errors[0] / spec.time_s + wanted).clamp(fall, most);
        m.rate_error = lag(m.rate_error, rate - had[0] - had[1], ENERGY_RATE, dt);
        self.throttle(&mut m, held + errors[1], rate, dt);

        let weight = match (carried, m.slow) {
            (true, _) => 0.0,
            (_, true) => 2.0,
            _ => spec.speed_weight,
        };
        let weights = [(2.0 - weight).min(1.0), weight.min(1.0)];
        self.pitch(&mut m, weights, errors, climb, had, dt);
        self.memory = Some(m);
        Setpoint {
            theta: m.pitch + self.level(),
            gain: self.gain(),
            thrust: m.throttle[2] * self.full,
        }
    }

    /// The memory at the first step.
    fn begin(&self, measured: &Measured) -> Memory {
        let airspeed = measured.nose_airspeed.max(LEAST_AIRSPEED);
        let height = -measured.position_error.x;
        Memory {
            velocity: measured.velocity,
            acceleration: [0.0; 2],
            airspeed: [airspeed, 0.0],
            wanted_airspeed: [airspeed, 0.0],
            height: [0.0, height, height],
            rate_error: 0.0,
            throttle: [self.spec.trim_throttle, 0.0, self.spec.trim_throttle],
            balance: [0.0; 2],
            pitch: measured.theta - self.level(),
            slow: false,
        }
    }

    /// Throttle for an `error` of energy \[m²/s²\] and a `rate` asked for \[m²/s³\].
    fn throttle(&self, m: &mut Memory, error: f64, rate: f64, dt: f64) {
        let spec = &self.spec;
        let [low, high] = spec.throttle;
        let [most, fall] = self.rates();
        let range = high - low;
        let per_rate = range / (most - fall);
        let gain = per_rate / spec.time_s;
        if m.slow {
            m.throttle[2] = high;
            return;
        }
        let damped = error + spec.throttle_damping_s * m.rate_error;
        let asked = spec.trim_throttle + rate * per_rate + gain * damped;
        // The integral may reach a tenth beyond the limits, and half of the range.
        let bound = |x: f64| x.clamp(-0.5 * range, 0.5 * range);
        m.throttle[1] = (m.throttle[1] + spec.integral_1_s * gain * error * dt)
            .clamp(bound(low - asked - 0.1), bound(high - asked + 0.1));
        let step = SLEW * range * dt;
        m.throttle[0] = asked.clamp(m.throttle[0] - step, m.throttle[0] + step);
        m.throttle[2] = (m.throttle[0] + m.throttle[1]).clamp(low, high);
    }

    /// Pitch for `errors` of energy \[m²/s²\] with these weights, a `climb` asked for, and the rates had \[m²/s³\].
    fn pitch(
        &self,
        m: &mut Memory,
        weights: [f64; 2],
        errors: [f64; 2],
        climb: f64,
        had: [f64; 2],
        dt: f64,
    ) {
        let spec = &self.spec;
        let balance = |[a, b]: [f64; 2]| weights[0] * a - weights[1] * b;
        let [low, high] = spec.pitch_deg.map(f64::to_radians);
        let scale = GRAVITY * m.airspeed[0];
        let asked = (GRAVITY * climb * weights[0] + balance(errors) / spec.time_s)
            .clamp(-GRAVITY * spec.sink_m_s[1], GRAVITY * spec.climb_m_s);
        let error = asked - balance(had);
        let rest = asked + spec.pitch_damping * error;
        let step = spec.integral_1_s * error * dt;
        let beyond = (rest + m.balance[0] + step + m.balance[1]) / scale;
        if (beyond > high && step > 0.0) || (beyond < low && step < 0.0) {
            m.balance = m.balance.map(|b| b * (spec.time_s / (spec.time_s + dt)));
        } else {
            m.balance[0] += step;
            m.balance[1] -= errors[1] * weights[1] * dt / spec.time_s;
        }
        // Up to 5° beyond the limits; a quarter of the range for the kinetic energy.
        let room = |limit: f64| scale * limit - rest;
        let slack = 5_f64.to_radians();
        m.balance[0] = m.balance[0].clamp(room(low - slack), room(high + slack));
        let quarter = 0.25 * (high - low) * scale;
        m.balance[1] = m.balance[1].clamp(-quarter, quarter);
        let pitch = ((rest + m.balance[0] + m.balance[1]) / scale).clamp(low, high);
        let step = spec.vertical_acceleration_m_s2 / m.airspeed[0] * dt;
        m.pitch = pitch.clamp(m.pitch - step, m.pitch + step);
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::super::measured::tests::steady;
    use super::*;

    /// ArduPilot's stock figures, but for the trim of the paper's vehicle at 20 m/s.
    pub(crate) const SPEC: TecsSpec = TecsSpec {
        airspeed_m_s: [9.0, 22.0],
        trim_throttle: 0.02,
        throttle: [0.0, 1.0],
        pitch_deg: [-30.0, 15.0],
        level_pitch_deg: 4.0,
        climb_m_s: 5.0,
        sink_m_s: [2.0, 5.0],
        time_s: 5.0,
        height_s: 3.0,
        speed_weight: 1.0,
        throttle_damping_s: 0.5,
        pitch_damping: 0.3,
        integral_1_s: 0.3,
        vertical_acceleration_m_s2: 7.0,
        attitude_1_s: 2.0,
    };

    fn level(speed: f64) -> Measured {
        steady([0.0, speed], (-86_f64).to_radians())
    }

    #[test]
    fn level_trim_is_an_equilibrium() {
        let mut tecs = SPEC.loops(196.2);
        // Level flight, whose pitot tube is 4° off the flow.
        let mut measured = level(20.0);
        measured.reference_airspeed = measured.nose_airspeed;
        for _ in 0..1000 {
            let setpoint = tecs.setpoint(&measured, false, 0.01);
            assert!((setpoint.theta - (-86_f64).to_radians()).abs() < 1e-9);
            assert!((setpoint.thrust - 3.924).abs() < 1e-9);
        }
    }

    #[test]
    fn throttle_answers_the_energy_and_pitch_the_balance() {
        let after = |altitude: f64, faster: f64| {
            let mut tecs = SPEC.loops(196.2);
            let mut measured = level(15.0);
            measured.reference_airspeed = measured.nose_airspeed;
            tecs.setpoint(&measured, false, 0.01);
            measured.position_error = Vector::new(-altitude, 0.0);
            measured.reference_airspeed += faster;
            (0..50).fold((0.0, 0.0), |_, _| {
                let setpoint = tecs.setpoint(&measured, false, 0.01);
                (setpoint.theta, setpoint.thrust)
            })
        };
        let trim = after(0.0, 0.0);
        let low = after(-2.0, 0.0);
        assert!(low.0 > trim.0 && low.1 > trim.1, "{low:?} {trim:?}");
        let slow = after(0.0, 2.0);
        assert!(slow.0 < trim.0 && slow.1 > trim.1, "{slow:?} {trim:?}");
    }

    /// An airspeed below the least does not count as too slow before the throttle is at its upper limit.
    #[test]
    fn too_slow_needs_full_throttle() {
        let run = |spec: TecsSpec, below: f64| {
            let mut tecs = spec.loops(196.2);
            let mut measured = level(7.5);
            measured.reference_airspeed = 9.0;
            measured.position_error.x = below;
            for _ in 0..6000 {
                tecs.setpoint(&measured, false, 0.01);
            }
            (
                tecs.memory.unwrap().slow,
                tecs.setpoint(&measured, false, 0.01),
            )
        };
        let mild = TecsSpec {
            climb_m_s: 40.0,
            ..SPEC
        };
        assert!(!run(mild, 0.0).0);
        let (slow, setpoint) = run(SPEC, 60.0);
        // 60 m below, and yet in a minute the nose goes down for speed.
        assert!(slow && setpoint.thrust == 196.2);
        assert!(setpoint.theta < (-86_f64).to_radians());
    }

    #[test]
    fn pitch_is_limited_and_does_not_wind_up() {
        let mut tecs = SPEC.loops(196.2);
        let mut measured = level(20.0);
        measured.reference_airspeed = measured.nose_airspeed;
        tecs.setpoint(&measured, false, 0.01);
        let mut high = measured;
        high.position_error.x = -200.0;
        for _ in 0..3000 {
            let theta = tecs.setpoint(&high, false, 0.01).theta;
            assert!((-116.001_f64..-71.0).contains(&theta.to_degrees()));
        }
        // Where it should be again, it goes back within two time constants of the height.
        for _ in 0..600 {
            tecs.setpoint(&measured, false, 0.01);
        }
        let theta = tecs.setpoint(&measured, false, 0.01).theta.to_degrees();
        assert!(theta > -100.0, "{theta}");
    }
}
