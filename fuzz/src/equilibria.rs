//! Sets of equilibria, folds, and what the theorems of existence say.

use alula::AngleOfAttack;
use alula::planar::Reference;
use alula::planar::equilibrium::{CAPACITY, Ratio, Spherical, existence};
use alula::planar::equilibrium::{Equilibria, FoldMap};
use alula::planar::equivalency::ApparentForces;

use crate::assert_finite;
use crate::bytes::Bytes;

pub fn run(data: &[u8]) -> u64 {
    crate::vehicle::with(&mut Bytes::new(data), |bytes, vehicle| {
        let map = FoldMap::new(&vehicle);
        let mut calls = 1;
        // Neither panics nor says what is no number.
        let _ = existence::theorem_1_symmetric(&vehicle);
        let _ = existence::theorem_1_bisymmetric(vehicle.model());
        let _ = existence::theorem_2(vehicle.model());
        let _ = existence::passive(vehicle.model());
        let spherical = Spherical::new(&vehicle);
        calls += 5;
        // A set costs some hundred evaluations: four are enough.
        for _ in 0..4 {
            if bytes.is_empty() {
                break;
            }
            let reference = Reference {
                velocity: bytes.inertial(30.0),
                acceleration: bytes.inertial(10.0),
            };
            let wind = bytes.inertial(15.0);
            calls += 1;
            if let Ok(set) = Equilibria::find(&vehicle, &reference, wind) {
                let all = set.as_slice();
                assert!(all.len() <= CAPACITY);
                assert!(all.is_sorted_by(|a, b| a.alpha <= b.alpha));
                for e in all {
                    assert_finite(&[e.alpha, e.thrust, e.t_p]);
                    let unit = e.attitude.cos.hypot(e.attitude.sin);
                    assert!((unit - 1.0).abs() < 1e-5, "{e:?}");
                }
                if let Ok(sphere) = &spherical
                    && let Some((attitude, thrust)) = sphere.equilibrium(&reference, wind)
                {
                    assert_finite(&[attitude.cos, attitude.sin, thrust]);
                }
                calls += 1;
            }
            let forces = ApparentForces::new(
                &vehicle,
                bytes.attitude(),
                reference.velocity - wind,
                reference.acceleration,
            );
            if let Some(margin) = map.margin(&forces) {
                assert_finite(&[margin.a]);
                assert!(margin.alpha.abs() <= FoldMap::HORIZON + 0.02, "{margin:?}");
            }
            let alpha = AngleOfAttack::from_radians(bytes.between(-4.0, 4.0));
            let _ = Ratio::at(&vehicle, alpha, bytes.between(-4.0, 4.0));
            calls += 2;
        }
        calls
    })
    .unwrap_or(1)
}
