//! The functions measured, each behind a call that is not inlined.

use super::sweep::Case;
use alula::aero::{
    Aerodynamics, Coefficients, Combined, CombinedParameters, LargeAngle, LargeAngleParameters,
    SmallAngle, SmallAngleParameters,
};
use alula::air::{AirData, AngleOfAttack, ThrustLine};
use alula::frame::Attitude;

/// What the functions are called on.
pub struct Fixture {
    thrust_line: ThrustLine,
    combined: Combined,
    large_angle: LargeAngle,
    small_angle: SmallAngle,
}

impl Fixture {
    pub fn new() -> Self {
        let p = CombinedParameters::NACA_0021_RE_160E3;
        Self {
            thrust_line: ThrustLine::new(0.1).unwrap(),
            combined: Combined::new(p).unwrap(),
            large_angle: LargeAngle::new(LargeAngleParameters { c0: p.c0, c1: p.c1 }).unwrap(),
            small_angle: SmallAngle::new(SmallAngleParameters {
                c0: p.c0,
                c2: p.c2,
                c3: p.c3,
            })
            .unwrap(),
        }
    }
}

/// Where the functions leave their results.
#[derive(Default)]
pub struct Output {
    coefficients: Coefficients,
    air: Option<AirData>,
    attitude: Attitude,
    number: f32,
}

/// A function measured.
pub type Function = fn(&Fixture, &Case, &mut Output);

macro_rules! functions {
    ($($name:ident => |$f:ident, $c:ident, $o:ident| $body:expr;)*) => {
        $(
            #[inline(never)]
            #[allow(unused_variables)]
            pub fn $name($f: &Fixture, $c: &Case, $o: &mut Output) { $body }
        )*
        /// Every function measured, by name.
        pub const TABLE: &[(&str, Function)] = &[$((stringify!($name), $name)),*];
    };
}

functions! {
    empty => |f, c, o| ();
    combined => |f, c, o| o.coefficients = f.combined.coefficients(c.alpha);
    large_angle => |f, c, o| o.coefficients = f.large_angle.coefficients(c.alpha);
    small_angle => |f, c, o| o.coefficients = f.small_angle.coefficients(c.alpha);
    air_data => |f, c, o| o.air = Some(AirData::new(c.v_a, &f.thrust_line));
    atan2 => |f, c, o| o.number = AngleOfAttack::from_sin_cos(c.alpha.sin, c.alpha.cos).rad;
    sin_cos => |f, c, o| o.attitude = Attitude::from_angle(c.alpha.rad);
    norm => |f, c, o| o.number = c.v_a.norm();
}

/// The function called `name`.
pub const fn by_name(name: &str) -> Function {
    let mut n = 0;
    while n < TABLE.len() {
        if equal(TABLE[n].0.as_bytes(), name.as_bytes()) {
            return TABLE[n].1;
        }
        n += 1;
    }
    panic!("no such function");
}

const fn equal(a: &[u8], b: &[u8]) -> bool {
    let mut same = a.len() == b.len();
    let mut n = 0;
    while same && n < a.len() {
        same = a[n] == b[n];
        n += 1;
    }
    same
}
