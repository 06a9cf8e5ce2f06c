//! Attitudes: any quaternion, any rates.

use alula::ned::{BodyAxes, BodyRates, Quaternion};
use alula::spatial::{Ned, Orientation};

use crate::assert_finite;
use crate::bytes::Bytes;

pub fn run(data: &[u8]) -> u64 {
    let mut bytes = Bytes::new(data);
    let mut calls = 0;
    while !bytes.is_empty() {
        let mut q = [0; 4].map(|_| bytes.number(1.0));
        if bytes.byte() & 3 != 0 {
            let norm = q.iter().map(|x| x * x).sum::<f32>().sqrt();
            q = q.map(|x| x / norm);
        }
        let [w, x, y, z] = q;
        let q = Quaternion { w, x, y, z };
        let mut vector = || [0; 3].map(|_| bytes.number(50.0));
        let ([north, east, down], [roll, pitch, yaw]) = (vector(), vector());
        let (v, rates) = (
            Ned::new(north, east, down),
            BodyRates::new(roll, pitch, yaw),
        );
        for axes in [BodyAxes::NoseForward, BodyAxes::NoseUp] {
            calls += 1;
            let Ok(o) = Orientation::from_quaternion(&q, axes) else {
                continue;
            };
            assert_unit(&o.to_quaternion(axes));
            // Rates within the guidance's limits.
            if roll * roll + pitch * pitch + yaw * yaw < 1e6 {
                assert_unit(&q.leading(axes, rates, 0.15).0);
            }
            if v.norm_squared() < 1e12 {
                let off = (o.to_world(o.to_body(v)) - v).norm_squared();
                assert!(off <= 1e-11 * v.norm_squared() + 1e-37, "{v:?} {off:e}");
            }
            if let Some(o) = Orientation::from_directions(o.forward(), v) {
                assert_unit(&o.to_quaternion(axes));
            }
            calls += 4;
        }
    }
    calls.max(1)
}

#[track_caller]
fn assert_unit(q: &Quaternion) {
    let Quaternion { w, x, y, z } = *q;
    assert_finite(&[w, x, y, z]);
    let square = w * w + x * x + y * y + z * z;
    assert!((square - 1.0).abs() < 1e-5, "{q:?}");
}
