//! ArduPlane's rules of QACRO, of the simulated autopilot.
//!
//! Channels are read at 50 Hz. Each is overridden on its own. A pulse of 0 gives it back to the transmitter, and 65535
//! leaves it as it is. After `RC_OVERRIDE_TIME` without a pulse the transmitter has it again. The throttle is in whole
//! per cent and filtered at 10 Hz. Rates are ramped at `Q_A_ACCEL_*_MAX`, 300 °/s² in pitch and roll as shipped.
//! (ArduPlane 4.6: `RC_Channel::has_override`, `GCS_MAVLINK::handle_rc_channels_override`, `ModeQAcro::run`,
//! `AC_AttitudeControl::input_shaping_ang_vel`.) Not simulated is its motors' idle (`Q_M_SPIN_MIN`).

use mavlink::dialects::ardupilotmega::RC_CHANNELS_OVERRIDE_DATA;

use super::{Kind, MavHeader, Parameters, Sticks};

/// Period \[s\] at which channels are read.
const READ: f64 = 0.02;
/// RC_OVERRIDE_TIME \[s\].
const OVERRIDE: f64 = 3.0;
/// Cutoff \[Hz\] of the throttle's filter.
const CUTOFF: f64 = 10.0;

/// The channels, and what is made of them.
#[derive(Clone, Copy, Debug)]
pub struct Qacro {
    sticks: Sticks,
    /// Pulses \[µs\] of the transmitter.
    transmitter: [u16; 4],
    /// Pulses that came in their place, and when \[s\].
    overrides: [Option<(u16, f64)>; 4],
    /// The pulses as they were read last.
    read: [u16; 4],
    next: f64,
    /// Share of the throttle, filtered.
    throttle: f64,
    /// Rates about hover's axes [rad/s], and how fast they are ramped [rad/s²].
    rates: [f64; 3],
    ramps: [f64; 3],
}

impl Qacro {
    /// Under a transmitter whose sticks are centred, the throttle at the share `hover`.
    pub fn new(sticks: Sticks, hover: f64) -> Self {
        let (transmitter, throttle) = sticks.pulses([0.0; 3], hover as f32);
        Self {
            sticks,
            transmitter,
            overrides: [None; 4],
            read: transmitter,
            next: f64::NEG_INFINITY,
            throttle: throttle.into(),
            rates: [0.0; 3],
            ramps: [f64::INFINITY; 3],
        }
    }

    /// Ramps rates as these parameters say: 0 is none, and what is not there as shipped for tail-sitters.
    pub fn ramp(&mut self, parameters: &Parameters) {
        let ramps = [
            ("Q_A_ACCEL_R_MAX", 30_000.0),
            ("Q_A_ACCEL_P_MAX", 30_000.0),
            ("Q_A_ACCEL_Y_MAX", 10_000.0),
        ];
        self.ramps = ramps.map(
            |(name, shipped)| match parameters.get(name).unwrap_or(shipped) {
                centidegrees if centidegrees > 0.0 => (0.01 * centidegrees).to_radians(),
                _ => f64::INFINITY,
            },
        );
    }

    /// Takes an override that arrived `now` \[s\]. One that is not of the ground station is dropped.
    pub fn take(&mut self, now: f64, header: &MavHeader, m: &RC_CHANNELS_OVERRIDE_DATA) {
        let station = Kind::ArduPlane(self.sticks).own_system();
        if header.system_id != u32::from(station) {
            return;
        }
        let pulses = [m.chan1_raw, m.chan2_raw, m.chan3_raw, m.chan4_raw];
        for (place, pulse) in self.overrides.iter_mut().zip(pulses) {
            match pulse {
                u16::MAX => {}
                0 => *place = None,
                _ => *place = Some((pulse, now)),
            }
        }
    }

    /// Whether any channel is overridden.
    pub fn is_overridden(&self) -> bool {
        self.overrides.iter().any(Option::is_some)
    }

    /// Lets `dt` \[s\] pass from `now`: whether the transmitter has all channels again because nothing came in their place any more.
    pub fn advance(&mut self, now: f64, dt: f64) -> bool {
        let had = self.is_overridden();
        for place in &mut self.overrides {
            *place = place.filter(|(_, at)| now - at < OVERRIDE);
        }
        // A hair early, so that rounding does not shift it by a step.
        if now >= self.next - 1e-6 {
            self.next = if self.next.is_finite() {
                self.next
            } else {
                now
            } + READ;
            let both = self.overrides.iter().zip(self.transmitter);
            for (read, (place, own)) in self.read.iter_mut().zip(both) {
                *read = place.map_or(own, |(pulse, _)| pulse);
            }
        }
        let share = dt / (dt + 1.0 / (std::f64::consts::TAU * CUTOFF));
        let (throttle, rates) = self.sticks.read(self.read);
        self.throttle += share * (throttle - self.throttle);
        for ((rate, wanted), ramp) in self.rates.iter_mut().zip(rates).zip(self.ramps) {
            *rate += (wanted - *rate).clamp(-ramp * dt, ramp * dt);
        }
        had && !self.is_overridden()
    }

    /// Share of the throttle, and rates [rad/s] about hover's axes.
    pub fn command(&self) -> (f64, [f64; 3]) {
        (self.throttle, self.rates)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(pulses: [u16; 4]) -> RC_CHANNELS_OVERRIDE_DATA {
        let [chan1_raw, chan2_raw, chan3_raw, chan4_raw] = pulses;
        RC_CHANNELS_OVERRIDE_DATA {
            chan1_raw,
            chan2_raw,
            chan3_raw,
            chan4_raw,
            ..RC_CHANNELS_OVERRIDE_DATA::default()
        }
    }

    /// Each channel is taken, kept and given back on its own, and by time.
    #[test]
    fn channels_are_overridden_one_by_one_and_come_back() {
        let mut qacro = Qacro::new(Sticks::default(), 0.5);
        let station = MavHeader {
            system_id: 255,
            component_id: 191,
            sequence: 0,
        };
        let stranger = MavHeader {
            system_id: 1,
            ..station
        };
        let read = |qacro: &mut Qacro, now| {
            qacro.next = now;
            qacro.advance(now, 0.002);
            qacro.read
        };
        qacro.take(0.0, &stranger, &message([1600; 4]));
        assert_eq!(read(&mut qacro, 0.0), [1500; 4]);
        qacro.take(0.1, &station, &message([1600, 1700, 1800, 1400]));
        assert_eq!(read(&mut qacro, 0.1), [1600, 1700, 1800, 1400]);
        qacro.take(0.2, &station, &message([0, u16::MAX, 1900, u16::MAX]));
        assert_eq!(read(&mut qacro, 0.2), [1500, 1700, 1900, 1400]);
        // The throttle came 0.1 s later than the others.
        assert_eq!(read(&mut qacro, 3.15), [1500, 1500, 1900, 1500]);
        assert!(qacro.advance(3.25, 0.002) && !qacro.is_overridden());
        assert!(!qacro.advance(3.3, 0.002));
    }

    /// A pulse acts from the next reading on, and the throttle through a filter of 16 ms.
    #[test]
    fn pulses_are_read_at_50_hz() {
        let mut qacro = Qacro::new(Sticks::default(), 0.5);
        let station = MavHeader {
            system_id: 255,
            component_id: 191,
            sequence: 0,
        };
        qacro.advance(0.0, 0.002);
        qacro.take(0.003, &station, &message([1500, 2000, 1809, 1500]));
        qacro.advance(0.018, 0.002);
        assert_eq!(qacro.command(), (0.5, [0.0; 3]));
        for step in 10..18 {
            qacro.advance(0.002 * f64::from(step), 0.002);
        }
        let (throttle, rates) = qacro.command();
        assert!((rates[1] - 180_f64.to_radians()).abs() < 1e-6);
        // 16 ms of a filter of 15.9 ms, in backward steps: 63 %, less 3.
        assert!((throttle - 0.5 - 0.6 * 0.3).abs() < 0.01, "{throttle}");
    }
}
