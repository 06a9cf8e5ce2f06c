//! North-east-down: any quaternion and any heading.

use alula::ned::{BodyAxes, Ned, Quaternion, VerticalPlane};

use crate::assert_finite;
use crate::bytes::Bytes;

pub fn run(data: &[u8]) -> u64 {
    let mut bytes = Bytes::new(data);
    let mut calls = 0;
    while !bytes.is_empty() {
        let heading = bytes.number(7.0);
        let plane = VerticalPlane::from_heading(heading);
        let mut q = [0; 4].map(|_| bytes.number(1.0));
        if bytes.byte() & 3 != 0 {
            let norm = q.iter().map(|x| x * x).sum::<f32>().sqrt();
            q = q.map(|x| x / norm);
        }
        let [w, x, y, z] = q;
        for axes in [BodyAxes::NoseForward, BodyAxes::NoseUp] {
            calls += 1;
            let Some(p) = plane.attitude(&Quaternion { w, x, y, z }, axes) else {
                continue;
            };
            let (tilt, bank) = p.tilt_and_bank(axes);
            assert_finite(&[p.attitude.cos, p.attitude.sin, tilt, bank]);
            assert_finite(&p.normal);
            let unit = p.attitude.cos.hypot(p.attitude.sin);
            // What the guidance accepts as an attitude is off by 1e-3 at most.
            assert!((unit - 1.0).abs() < 1e-5, "{p:?}");
            let long: f32 = p.normal.iter().map(|x| x * x).sum();
            assert!((long - 1.0).abs() < 1e-5, "{p:?}");
            assert!(tilt.abs() <= core::f32::consts::FRAC_PI_2);
        }
        let v = Ned::new(bytes.number(50.0), bytes.number(50.0), bytes.number(50.0));
        let (inside, across) = plane.project(v);
        let back = plane.lift(inside, across);
        let size = v.north.abs() + v.east.abs();
        if heading.abs() < 1e3 && size < 1e30 {
            let off = (back.north - v.north).abs().max((back.east - v.east).abs());
            assert!(off <= 1e-6 * size + 1e-37, "{v:?} {back:?}");
        }
        calls += 2;
    }
    calls.max(1)
}
