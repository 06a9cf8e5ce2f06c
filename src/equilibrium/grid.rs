//! The angles of attack at which a vehicle is sampled around the circle.
//!
//! Finest where the coefficients of wings curve most: 0.5° up to 30° on either side, 1.25° within 30° of reverse flow,
//! 2.5° in between: the coefficients are off the chord of a cell by 0.02 at most, as a test below measures. Odd multiples of 0.25°, so that no
//! node lies on an axis of symmetry, where equilibria often are.

use crate::air::AngleOfAttack;

/// Half-width of the finest zone about α = 0, and of the finer one about α = π \[°\].
const NEAR: f32 = 30.0;
const FINEST: f32 = 0.5;
const FINER: f32 = 1.25;
const COARSE: f32 = 2.5;

const FINEST_NODES: usize = (NEAR / FINEST) as usize;
const COARSE_NODES: usize = ((180.0 - 2.0 * NEAR) / COARSE) as usize;
const FINER_NODES: usize = (NEAR / FINER) as usize;
const HALF: usize = FINEST_NODES + COARSE_NODES + FINER_NODES;

/// Number of nodes around the circle.
pub(super) const N: usize = 2 * HALF;

/// The nodes, by increasing angle from −179.75° to 179.75°.
pub(super) static NODES: [AngleOfAttack; N] = nodes();

/// Positive node number `i` \[°\].
const fn degrees(i: usize) -> f32 {
    let last_finest = FINEST * (FINEST_NODES as f32 - 0.5);
    let last_coarse = last_finest + COARSE * COARSE_NODES as f32;
    if i < FINEST_NODES {
        FINEST * (i as f32 + 0.5)
    } else if i < FINEST_NODES + COARSE_NODES {
        last_finest + COARSE * (i - FINEST_NODES + 1) as f32
    } else {
        last_coarse + FINER * (i - FINEST_NODES - COARSE_NODES + 1) as f32
    }
}

const fn nodes() -> [AngleOfAttack; N] {
    let mut nodes = [AngleOfAttack::from_radians(0.0); N];
    let mut i = 0;
    while i < HALF {
        let alpha = degrees(i).to_radians();
        nodes[HALF + i] = AngleOfAttack::from_radians(alpha);
        nodes[HALF - 1 - i] = AngleOfAttack::from_radians(-alpha);
        i += 1;
    }
    nodes
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{
        Aerodynamics, Combined, CombinedParameters, NACA_0021_RE_5E6, NACA_0021_RE_160E3, Table,
    };

    #[test]
    fn the_nodes_go_once_around() {
        assert_eq!(N, 264);
        // As the compiler made them, and as they are made now.
        let nodes = nodes();
        assert_eq!(nodes, NODES);
        let degrees = |i: usize| nodes[i].rad.to_degrees();
        assert!((degrees(0) + 179.75).abs() < 1e-4 && (degrees(N - 1) - 179.75).abs() < 1e-4);
        for i in 1..N {
            let step = degrees(i) - degrees(i - 1);
            let middle = 0.5 * (degrees(i) + degrees(i - 1)).abs();
            let expected = match middle {
                m if m < 29.75 => 0.5,
                m if m > 149.75 => 1.25,
                _ => 2.5,
            };
            assert!((step - expected).abs() < 1e-3, "{middle}: {step}");
        }
    }

    /// The zones measured: how far c_L and c_D are off the chord of a cell at most. Nowhere by more than 0.02 (the
    /// table at Re = 5e6, which has kinks at 20° and 30°; half of that for the others); cells of 2.5° all around would
    /// be off by more than that in every stall, and by 0.3 in the worst.
    #[test]
    fn the_zones_follow_the_curvature() {
        let worst = |model: &dyn Aerodynamics, from: f32, to: f32, width: f32| {
            let bend = |a: f32| {
                let c = model.coefficients(AngleOfAttack::from_radians(a.to_radians()));
                f32::max(c.ddc_l.abs(), c.ddc_d.abs())
            };
            let samples = ((to - from) / 0.05) as usize;
            let bends = (0..samples).map(|i| bend(from + 0.05 * i as f32));
            bends.fold(0.0, f32::max) * width.to_radians().powi(2) / 8.0
        };
        let combined = |p| -> std::boxed::Box<dyn Aerodynamics> {
            std::boxed::Box::new(Combined::new(p).unwrap())
        };
        let models = [
            combined(CombinedParameters::NACA_0021_RE_160E3),
            combined(CombinedParameters::NACA_0021_RE_5E6),
            std::boxed::Box::new(Table::new(&NACA_0021_RE_160E3)),
            std::boxed::Box::new(Table::new(&NACA_0021_RE_5E6)),
        ];
        for model in &models {
            let model = model.as_ref();
            let finest = worst(model, 0.0, 30.0, FINEST);
            let coarse = worst(model, 30.0, 150.0, COARSE);
            let finer = worst(model, 150.0, 180.0, FINER);
            assert!(finest < 0.02 && coarse < 0.02 && finer < 0.02);
            assert!(worst(model, 0.0, 30.0, COARSE) > 0.02);
        }
    }
}
