//! The elementary functions of a control step: bounded polynomials in single precision.
//!
//! Every function runs in constant time, but for one short branch of [`angle`], and gives the same bits on every target: only correctly rounded operations
//! (+, −, ×, ÷, √) and bit moves, in a fixed order, never contracted. The accuracies stated are measured by the tests
//! below, against `f64` and against `libm`.
//!
//! `libm` is used where a step does not pass and where it stays in single precision (`atan2f` in diagnostics and
//! finders). On the step it costs more, or drops into software double precision. Instructions on the emulated
//! Cortex-M4F, median:
//!
//! | here | | `libm` | | why |
//! |---|---:|---|---:|---|
//! | [`sqrt`] | 1 | `sqrtf` | 55 | the hardware root |
//! | [`sin_cos`] | 50 | `sincosf` | 2248 | `libm` computes in double precision |
//! | [`angle`] | 36, with a call | `atan2f` | 89 | a pair of unit length |
//!
//! [`exp2`] and [`atan2`] have no special cases for infinities and signed zeros, where `expf` (63) and `atan2f` do.

/// π/2.
pub const FRAC_PI_2: f32 = core::f32::consts::FRAC_PI_2;
/// π.
pub const PI: f32 = core::f32::consts::PI;

// The C library's `sqrtf`, which the compiler knows and replaces by the hardware instruction; stable Rust
// offers no other way to reach that in a `no_std` crate. Correctly rounded by IEEE 754 on every target.
#[allow(unsafe_code)]
mod c {
    #[cfg(not(miri))]
    unsafe extern "C" {
        pub safe fn sqrtf(x: f32) -> f32;
    }
    // The interpreter has no C library.
    #[cfg(miri)]
    pub use libm::sqrtf;
}

/// Square root of `x` ≥ 0, correctly rounded.
#[inline(always)]
pub fn sqrt(x: f32) -> f32 {
    c::sqrtf(x)
}

/// The smaller of two numbers; `b` if `a` is NaN. (`f32::min` is a library call on this target.)
#[inline(always)]
pub const fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The greater of two numbers; `b` if `a` is NaN.
#[inline(always)]
pub const fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// `x` brought into [`low`, `high`], `low` ≤ `high`; NaN stays NaN. (`f32::clamp` can panic.)
#[inline(always)]
pub const fn clamp(x: f32, low: f32, high: f32) -> f32 {
    if x < low {
        low
    } else if x > high {
        high
    } else {
        x
    }
}

/// 2^`y` for −126 ≤ `y` ≤ 127, relative error below 2e-7. Outside that range the result is meaningless.
#[inline(always)]
pub const fn exp2(y: f32) -> f32 {
    // 1.5·2²³: adding it leaves the nearest integer in the low bits of the sum.
    const ROUND: f32 = 12_582_912.0;
    let shifted = y + ROUND;
    let f = y - (shifted - ROUND);
    // 2^f = 1 + f·q(f) on [−½, ½], minimax to 1.1e-7 with q(0) = ln 2.
    let q = 0.001_330_060_7;
    let q = 0.009_669_691 + f * q;
    let q = 0.055_505_585 + f * q;
    let q = 0.240_222_83 + f * q;
    let q = core::f32::consts::LN_2 + f * q;
    let p = 1.0 + f * q;
    f32::from_bits(p.to_bits().wrapping_add(shifted.to_bits() << 23))
}

/// Angle of the vector (`x`, `y`) from the x axis, in (−π, π], relative error below 3e-7; 0 for the zero vector.
///
/// Meant for vectors of ordinary length, between 1e-30 and 1e30.
#[inline(always)]
pub const fn atan2(y: f32, x: f32) -> f32 {
    let (ay, ax) = (y.abs(), x.abs());
    let steep = ay > ax;
    let (lo, hi) = if steep { (ax, ay) } else { (ay, ax) };
    // The added number vanishes in any ordinary `hi`, and makes 0/0 a zero.
    let t = lo / (hi + f32::MIN_POSITIVE);
    let a = atan(t);
    let a = if steep { FRAC_PI_2 - a } else { a };
    let a = if x < 0.0 { PI - a } else { a };
    a.copysign(y)
}

/// Angle whose sine and cosine are these, in [−π, π], relative error below 3e-7: cheaper than [`atan2`], for a pair
/// of unit length only.
#[inline(always)]
pub const fn angle(sin: f32, cos: f32) -> f32 {
    // Nothing to divide by but 1…2.
    angle_of_half(sin / (1.0 + cos.abs()), cos)
}

/// The angle that [`angle`] gives, from `t` = sin/(1 + |cos|), the tangent of half the angle from the nearer end of the
/// x axis, and from the sign of its cosine.
#[inline(always)]
pub const fn angle_of_half(t: f32, cos: f32) -> f32 {
    let a = 2.0 * atan(t);
    if cos < 0.0 {
        // Flight tail first is rare: its angle is not to be made ahead of the choice.
        core::hint::cold_path();
        PI.copysign(t) - a
    } else {
        a
    }
}

/// atan `t` for |`t`| ≤ 1, relative error below 1.5e-7.
#[inline(always)]
const fn atan(t: f32) -> f32 {
    let z = t * t;
    // atan t = t + t·z·q(z) on [0, 1], minimax.
    let q = 0.002_920_684_6;
    let q = -0.016_367_9 + z * q;
    let q = 0.043_211_814 + z * q;
    let q = -0.075_522_1 + z * q;
    let q = 0.106_660_03 + z * q;
    let q = -0.142_110_56 + z * q;
    let q = 0.199_937_73 + z * q;
    let q = -0.333_331_53 + z * q;
    t + t * (z * q)
}

/// (sin `x`, cos `x`), absolute error below 1.2e-7 for |`x`| ≤ 100 rad; NaN beyond 8192 rad and for a non-finite `x`.
///
/// The error of the argument's reduction grows with |`x`|: 1e-6 at 8000 rad. Unbounded, it makes pairs of 1e30.
pub const fn sin_cos(x: f32) -> (f32, f32) {
    let x = if x.abs() <= 8192.0 { x } else { f32::NAN };
    const ROUND: f32 = 12_582_912.0;
    // π/2 in three parts; products of the first two with a quadrant up to 2⁸ are exact.
    const P1: f32 = 1.570_312_5;
    const P2: f32 = 4.837_513e-4;
    const P3: f32 = 7.549_789_5e-8;
    let shifted = x * core::f32::consts::FRAC_2_PI + ROUND;
    let quadrant = shifted.to_bits();
    let n = shifted - ROUND;
    let r = ((x - n * P1) - n * P2) - n * P3;
    let (s, c) = sin_cos_near_zero(r);
    let (s, c) = if quadrant & 1 == 0 { (s, c) } else { (c, -s) };
    if quadrant & 2 == 0 { (s, c) } else { (-s, -c) }
}

/// (sin `r`, cos `r`) for |`r`| ≤ π/4, absolute error below 1.2e-7: what [`sin_cos`] comes to without its reduction.
#[inline(always)]
pub const fn sin_cos_near_zero(r: f32) -> (f32, f32) {
    let z = r * r;
    // Minimax on [−π/4, π/4].
    let s = -0.000_195_172_34;
    let s = 0.008_332_178 + z * s;
    let s = -0.166_666_55 + z * s;
    let s = r + r * (z * s);
    let c = 2.443_838e-5;
    let c = -0.001_388_736_7 + z * c;
    let c = 0.041_666_646 + z * c;
    let c = 1.0 - 0.5 * z + z * z * c;
    (s, c)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    /// Largest value of `error` over `n` + 1 equidistant points of [`a`, `b`].
    fn worst(a: f32, b: f32, n: u32, error: impl Fn(f32) -> f64) -> f64 {
        (0..=n)
            .map(|i| error(a + (b - a) * (i as f32 / n as f32)))
            .fold(0.0, |m, e| if e > m || e.is_nan() { e } else { m })
    }

    /// The other implementation agrees: a relative error of 4e-7 is that of both.
    #[test]
    fn libm_agrees() {
        let e = worst(-126.0, 127.0, 100_000, |y| {
            (f64::from(exp2(y)) / f64::from(libm::exp2f(y)) - 1.0).abs()
        });
        assert!(e < 4e-7, "{e:e}");
        let e = worst(-PI, PI, 100_000, |a| {
            let (y, x) = (libm::sinf(a), libm::cosf(a));
            let theirs = f64::from(libm::atan2f(y, x));
            let off = |ours: f32| (f64::from(ours) - theirs).abs() / theirs.abs().max(1e-30);
            f64::max(off(atan2(y, x)), off(angle(y, x)))
        });
        assert!(e < 5e-7, "{e:e}");
        let e = worst(-100.0, 100.0, 100_000, |x| {
            let (s, c) = sin_cos(x);
            f64::from((s - libm::sinf(x)).abs().max((c - libm::cosf(x)).abs()))
        });
        assert!(e < 2e-7, "{e:e}");
        assert!((0..10_000).all(|n| sqrt(n as f32 * 0.37) == libm::sqrtf(n as f32 * 0.37)));
    }

    #[test]
    fn exp2_is_accurate_over_its_range() {
        let e = worst(-126.0, 127.0, 2_000_000, |y| {
            (f64::from(exp2(y)) / f64::from(y).exp2() - 1.0).abs()
        });
        assert!(e < 2e-7, "{e:e}");
        assert_eq!(exp2(0.0), 1.0);
        assert_eq!(exp2(-126.0), f32::MIN_POSITIVE);
        assert!(exp2(f32::NAN).is_nan());
    }

    #[test]
    fn atan2_is_accurate_in_every_octant() {
        let e = worst(-3.15, 3.15, 2_000_000, |a| {
            let (y, x) = (f64::from(a).sin() as f32, f64::from(a).cos() as f32);
            let exact = f64::from(y).atan2(f64::from(x));
            [1.0f32, 1e-9, 3e12].iter().fold(0.0, |m, r| {
                let exact = f64::from(y * r).atan2(f64::from(x * r)).copysign(exact);
                f64::max(
                    m,
                    (f64::from(atan2(y * r, x * r)) - exact).abs() / exact.abs().max(1e-30),
                )
            })
        });
        assert!(e < 3e-7, "{e:e}");
        assert_eq!(atan2(0.0, 0.0), 0.0);
        assert_eq!(atan2(0.0, -1.0), PI);
        assert_eq!(atan2(-0.0, -1.0), -PI);
        assert_eq!(atan2(-2.0, 0.0), -FRAC_PI_2);
        assert!(atan2(f32::NAN, 1.0).is_nan() && atan2(1.0, f32::NAN).is_nan());
    }

    #[test]
    fn angle_agrees_with_atan2_on_the_unit_circle() {
        let e = worst(-PI, PI, 2_000_000, |a| {
            let (y, x) = (f64::from(a).sin() as f32, f64::from(a).cos() as f32);
            let exact = f64::from(y).atan2(f64::from(x));
            (f64::from(angle(y, x)) - exact).abs() / exact.abs().max(1e-30)
        });
        assert!(e < 3e-7, "{e:e}");
        assert_eq!(angle(0.0, 1.0), 0.0);
        assert_eq!(angle(0.0, -1.0), PI);
        assert_eq!(angle(-0.0, -1.0), -PI);
    }

    #[test]
    fn sin_cos_is_accurate_and_lets_nothing_non_finite_pass() {
        let error = |x: f32| {
            let (s, c) = sin_cos(x);
            let (es, ec) = f64::from(x).sin_cos();
            f64::max((f64::from(s) - es).abs(), (f64::from(c) - ec).abs())
        };
        let e = worst(-100.0, 100.0, 2_000_000, error);
        assert!(e < 1.2e-7, "{e:e}");
        let e = worst(-8000.0, 8000.0, 2_000_000, error);
        assert!(e < 1e-6, "{e:e}");
        for x in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 8193.0, -1e19] {
            assert!(sin_cos(x).0.is_nan() && sin_cos(x).1.is_nan());
        }
    }

    #[test]
    fn sqrt_is_correctly_rounded() {
        for i in 0..1_000_000u32 {
            let x = f32::from_bits(i * 2003);
            if x.is_finite() {
                // The f64 root of an f32 rounds to the correctly rounded f32 root.
                assert_eq!(sqrt(x), f64::from(x).sqrt() as f32);
            }
        }
    }
}
