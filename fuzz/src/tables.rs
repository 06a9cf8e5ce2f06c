//! Tables from arbitrary rows: refused by row and reason, or finite everywhere and between the rows.

use alula::aero::{Aerodynamics, Polar};
use alula::{AngleOfAttack, Table};

use crate::assert_finite;
use crate::bytes::Bytes;
use crate::vehicle::{ROOM, nodes};

pub fn run(data: &[u8]) -> u64 {
    let mut bytes = Bytes::new(data);
    let nodes = nodes(&mut bytes);
    let polar = match Polar::<ROOM>::new(&nodes) {
        Ok(polar) => polar,
        Err(error) => {
            assert!(error.row <= nodes.len());
            return 1;
        }
    };
    let table = Table::new(&polar);
    let mut calls = 1;
    let most = |f: fn(&alula::aero::Node) -> f32| nodes.iter().map(f).fold(0.0, f32::max);
    let (lift, drag) = (most(|n| n.c_l.abs()), most(|n| n.c_d));
    let least = nodes.iter().map(|n| n.c_d).fold(f32::MAX, f32::min);
    let mut look = |alpha: f32| {
        let c = table.coefficients(AngleOfAttack::from_radians(alpha));
        assert_finite(&[c.c_l, c.c_d, c.dc_l, c.dc_d, c.ddc_l, c.ddc_d]);
        // Monotone between rows, to roundings of a quintic's terms.
        assert!(c.c_l.abs() <= lift * (1.0 + 1e-4), "{alpha}: {c:?}");
        assert!(c.c_d <= drag * (1.0 + 1e-4), "{alpha}: {c:?}");
        assert!(c.c_d >= least - drag * 1e-4, "{alpha}: {c:?}");
        calls += 1;
    };
    for node in &nodes {
        look(node.alpha);
    }
    for n in -90..=90 {
        look(n as f32 * 0.035);
    }
    while !bytes.is_empty() {
        look(bytes.between(-7.0, 7.0));
    }
    calls
}
