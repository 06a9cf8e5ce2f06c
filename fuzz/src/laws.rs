//! The two laws: whatever goes in, a finite command comes out, or the name of what is wrong.

use alula::guidance::GuidanceParameters;
use alula::planar::{FeedForward, GainParameters, Gains, Reference, State, VelocityControl};
use alula::{BandwidthGains, GainChoice};

use crate::assert_finite;
use crate::bytes::Bytes;

pub fn run(data: &[u8]) -> u64 {
    crate::vehicle::with(&mut Bytes::new(data), |bytes, vehicle| {
        let gains = if bytes.byte() & 1 == 0 {
            Gains::new(bytes.parameters(GainParameters::PAPER)).map(GainChoice::Constant)
        } else {
            let p = bytes.parameters(GuidanceParameters::default());
            BandwidthGains::new(&p, &vehicle).map(GainChoice::Bandwidth)
        };
        let Ok(gains) = gains else {
            return 1;
        };
        let control = VelocityControl::new(vehicle, gains);
        let mut calls = 0;
        while !bytes.is_empty() {
            let state = State {
                velocity: bytes.inertial(30.0),
                attitude: bytes.attitude(),
                wind: bytes.inertial(15.0),
            };
            let reference = Reference {
                velocity: bytes.inertial(30.0),
                acceleration: bytes.inertial(10.0),
            };
            let feed_forward = FeedForward {
                air_acceleration: bytes.inertial(10.0),
                jerk: bytes.inertial(10.0),
            };
            for ff in [None, Some(&feed_forward)] {
                for law in [VelocityControl::robust, VelocityControl::full] {
                    calls += 1;
                    let Ok(command) = law(&control, &state, &reference, ff) else {
                        continue;
                    };
                    let d = command.diagnostics;
                    assert_finite(&[command.thrust, command.rate]);
                    assert_finite(&[d.alpha, d.f_p.i(), d.f_p.j(), d.f_p_norm, d.t_p, d.k]);
                    assert!(d.alpha.abs() <= core::f32::consts::PI);
                    // One rounding above 1.
                    assert!((0.0..=1.000_001).contains(&d.guard_alignment), "{d:?}");
                    assert!((0.0..=1.000_001).contains(&d.guard_feed_forward), "{d:?}");
                }
            }
        }
        calls
    })
    .unwrap_or(1)
}
