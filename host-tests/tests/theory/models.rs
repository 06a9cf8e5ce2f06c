//! Proposition 1 and Lemma 4: which models are spherical, and their closed forms.

use std::f64::consts::PI;

use alula::aero::Coefficients;
use alula::planar::equivalency::{
    condition_residual, equivalent_coefficients, lambda, lambda_parallel,
    parallel_condition_residual,
};
use alula::planar::{AirData, Attitude, Body, ThrustLine};
use alula::{
    Aerodynamics, AngleOfAttack, Combined, LargeAngle, LargeAngleParameters, SmallAngle,
    SmallAngleParameters,
};

use crate::SETS;

const SMALL: SmallAngleParameters = SmallAngleParameters {
    c0: 0.014,
    c2: 5.5,
    c3: 0.3,
};

/// Air data at `alpha` and `delta` \[rad\], from v_a = |v_a|(−cos(α+δ), sin(α+δ)).
fn air(alpha: f32, delta: f32) -> AirData {
    let sum = Attitude::from_angle(alpha + delta);
    let line = ThrustLine::new(delta).unwrap();
    AirData::new(Body::new(-sum.cos, sum.sin), &line)
}

/// 2n angles over a full turn, off the round ones.
fn angles(n: i32) -> impl Iterator<Item = f32> + Clone {
    (-n..n).map(move |i| ((f64::from(i) + 0.3) * PI / f64::from(n)) as f32)
}

/// Proposition 1 i): λ, c̄_L, c̄_D of the large-α model at every δ. The tolerance is 16 roundings
/// of coefficients of size 2.
#[test]
fn the_large_angle_model_has_its_closed_forms() {
    let p = LargeAngleParameters::NACA_0021_RE_160E3;
    let model = LargeAngle::new(p).unwrap();
    let (c0, c1) = (f64::from(p.c0), f64::from(p.c1));
    for delta in angles(40) {
        for alpha in angles(90) {
            let air = air(alpha, delta);
            let c = model.coefficients(air.alpha);
            let lambda = lambda(&c, &air);
            let (c_l_bar, c_d_bar) = equivalent_coefficients(&c, &air, lambda);
            let (a, d) = (f64::from(alpha), f64::from(delta));
            for (got, want) in [
                (lambda, 2.0 * c1 * (a - d).cos()),
                (c_l_bar, -c1 * (2.0 * d).sin()),
                (c_d_bar, c0 + 2.0 * c1 * d.cos().powi(2)),
            ] {
                let error = (f64::from(got) - want).abs();
                assert!(error < 2e-6, "{alpha} {delta}: {got} {want}");
            }
        }
    }
}

/// Proposition 1 ii): λ by `eq:pPC`, c̄_L and c̄_D of the small-α model at δ = 0. Tolerance:
/// 8 roundings of λ, and the rounding of the angle (1e-7) through c_L ∝ c2²/D(α), |D′| ≤ c2.
#[test]
fn the_small_angle_model_has_its_closed_forms() {
    let model = SmallAngle::new(SMALL).unwrap();
    let [c0, c2, c3] = [SMALL.c0, SMALL.c2, SMALL.c3].map(f64::from);
    for alpha in angles(500) {
        let air = air(alpha, 0.0);
        let c = model.coefficients(air.alpha);
        let lambda = lambda_parallel(&c, air.alpha);
        let (c_l_bar, c_d_bar) = equivalent_coefficients(&c, &air, lambda);
        let cos = f64::from(alpha).cos();
        let denominator = (c2 - c3) * cos * cos + c3;
        let printed = c2 * c2 * cos / denominator;
        let tolerance = 5e-7 * (1.0 + printed.abs()) + 1e-7 * c2 * (c2 / denominator).powi(2);
        for (got, want) in [(lambda, printed), (c_l_bar, 0.0), (c_d_bar, c0 + c2)] {
            let error = (f64::from(got) - want).abs();
            assert!(error < tolerance, "{alpha}: {got} {want} {tolerance}");
        }
        let residual = f64::from(parallel_condition_residual(&c, air.alpha));
        assert!(residual.abs() < tolerance, "{alpha}: {residual}");
    }
}

/// The large-α family with a symmetric harmonic added to lift or drag.
struct Perturbed {
    base: LargeAngle,
    harmonic: f32,
    lift: f32,
    drag: f32,
}

impl Aerodynamics for Perturbed {
    fn coefficients(&self, alpha: AngleOfAttack) -> Coefficients {
        let base = self.base.coefficients(alpha);
        let n = self.harmonic;
        let (sin, cos) = (n * alpha.rad).sin_cos();
        Coefficients {
            c_l: base.c_l + self.lift * sin,
            dc_l: base.dc_l + self.lift * n * cos,
            ddc_l: base.ddc_l - self.lift * n * n * sin,
            c_d: base.c_d + self.drag * cos,
            dc_d: base.dc_d - self.drag * n * sin,
            ddc_d: base.ddc_d - self.drag * n * n * cos,
        }
    }
}

/// The largest residual of `eq:condition` over α.
fn worst(model: &impl Aerodynamics, delta: f32) -> f32 {
    let residual = |alpha| {
        let air = air(alpha, delta);
        condition_residual(&model.coefficients(air.alpha), &air).abs()
    };
    angles(720).map(residual).fold(0.0, f32::max)
}

/// Lemma 4: among symmetric shapes the large-α family alone satisfies `eq:condition` for every δ.
/// Its residual is rounding (of terms of size 4·c1); that of the other models is not small at any
/// δ, nor, at some δ, that of the family with one percent of any other symmetric harmonic.
#[test]
fn only_the_large_angle_family_is_spherical_for_every_thrust_line() {
    let base = LargeAngle::new(LargeAngleParameters::NACA_0021_RE_160E3).unwrap();
    let small = SmallAngle::new(SMALL).unwrap();
    let combined = SETS.map(|set| Combined::new(set).unwrap());
    for delta in angles(24) {
        assert!(worst(&base, delta) < 5e-6, "{delta}");
        assert!(worst(&small, delta) > 1.0, "{delta}");
        for model in &combined {
            assert!(worst(model, delta) > 1.0, "{delta}");
        }
    }
    for harmonic in 1..8_u8 {
        for (lift, drag) in [(0.01, 0.0), (0.0, 0.01), (0.01, 0.01)] {
            let model = Perturbed {
                base,
                harmonic: harmonic.into(),
                lift,
                drag,
            };
            let residual = angles(24).map(|d| worst(&model, d)).fold(0.0, f32::max);
            assert!(residual > 0.01, "{harmonic} {lift} {drag}: {residual}");
        }
    }
}
