//! Attitude in space: the body axes by their world components.
//!
//! What is public is forward-right-down. Inside, the axes are the paper's: i, j and w.

use super::vector::Body;
use crate::control::Fault;
use crate::frame::Attitude;
use crate::math;
use crate::ned::{BodyAxes, BodyRates, Frd, Ned, Quaternion};

/// Quaternions whose |q|² is further from 1 than this are refused: they are no attitude.
const MAX_DEFECT: f32 = 1e-3;
/// Most that a set-point leads the attitude by \[rad\].
const MAX_LEAD: f32 = core::f32::consts::FRAC_PI_2;
/// Added to 1 + cos φ where that is divided by: it keeps a rotation by an angle φ near 180° finite.
const REGULARISATION: f32 = 0.02;
/// Two directions whose sine is below this are taken for parallel.
const MIN_SINE: f32 = 1e-3;

/// The three body axes, unit vectors by their world components. A value that exists is a rotation, or
/// [`UNKNOWN`](Self::UNKNOWN): only a checked quaternion or checked axes make one.
///
/// | body axes of an autopilot | x | y | z |
/// |---|---|---|---|
/// | nose forward (fixed wing) | forward | right | down |
/// | nose up (multicopter) | down | right | −forward |
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "[Ned; 3]", into = "[Ned; 3]"))]
pub struct Orientation {
    i: Ned,
    j: Ned,
    w: Ned,
}

impl From<Orientation> for [Ned; 3] {
    /// The axes forward, right, down.
    fn from(o: Orientation) -> Self {
        [-o.i, o.w, o.j]
    }
}

impl TryFrom<[Ned; 3]> for Orientation {
    type Error = Fault;

    /// The attitude with the axes forward, right, down.
    ///
    /// # Errors
    /// [`Fault::Attitude`] if they are not of unit length, normal to each other and right-handed, to 1e-3.
    fn try_from([forward, w, j]: [Ned; 3]) -> Result<Self, Fault> {
        let i = -forward;
        let o = Self { i, j, w };
        if o.is_sound() && (i.cross(j) - w).norm_squared() <= MAX_DEFECT {
            Ok(o)
        } else {
            Err(Fault::Attitude)
        }
    }
}

impl Orientation {
    /// Hover with the nose up and the belly to the north.
    pub const NOSE_UP: Self = Self {
        i: Ned::new(0.0, 0.0, 1.0),
        j: Ned::new(1.0, 0.0, 0.0),
        w: Ned::new(0.0, 1.0, 0.0),
    };

    /// No attitude: its axes are NaN. Guidance and laws refuse it. It is what to give the guidance where
    /// [`from_quaternion`](Self::from_quaternion) fails, so that it bridges the frame.
    pub const UNKNOWN: Self = {
        let nan = Ned::new(f32::NAN, f32::NAN, f32::NAN);
        Self {
            i: nan,
            j: nan,
            w: nan,
        }
    };

    /// The attitude θ in the vertical plane to the north, to be checked by [`is_sound`](Self::is_sound).
    #[inline(always)]
    pub(crate) const fn in_plane(attitude: Attitude) -> Self {
        let Attitude { cos, sin } = attitude;
        Self {
            i: Ned::new(sin, 0.0, cos),
            j: Ned::new(cos, 0.0, -sin),
            w: Ned::new(0.0, 1.0, 0.0),
        }
    }

    /// The attitude `q` of body axes `axes`. The axes are divided by |q|², so that what is left of a drifted
    /// normalisation is no part of them.
    ///
    /// # Errors
    /// [`Fault::Attitude`] if |q|² is further than 1e-3 from 1, or not a number.
    #[inline]
    pub fn from_quaternion(q: &Quaternion, axes: BodyAxes) -> Result<Self, Fault> {
        let Quaternion { w, x, y, z } = *q;
        let square = (w * w + x * x) + (y * y + z * z);
        if !matches!((square - 1.0).abs(), d if d <= MAX_DEFECT) {
            return Err(Fault::Attitude);
        }
        // 1/|q|² and 2/|q|²: the matrix of a quaternion of any length.
        let s = 1.0 / square;
        let (x2, y2, z2) = ((s + s) * x, (s + s) * y, (s + s) * z);
        let (wx, wy, wz) = (w * x2, w * y2, w * z2);
        let (xx, xy, xz) = (x * x2, x * y2, x * z2);
        let (yy, yz, zz) = (y * y2, y * z2, z * z2);
        let axis_x = Ned::new(1.0 - (yy + zz), xy + wz, xz - wy);
        let axis_y = Ned::new(xy - wz, 1.0 - (xx + zz), yz + wx);
        let axis_z = Ned::new(xz + wy, yz - wx, 1.0 - (xx + yy));
        Ok(match axes {
            BodyAxes::NoseUp => Self {
                i: axis_z,
                j: axis_x,
                w: axis_y,
            },
            BodyAxes::NoseForward => Self {
                i: Ned::ZERO - axis_x,
                j: axis_z,
                w: axis_y,
            },
        })
    }

    /// The attitude with the nose along `forward` and the belly to the side of `down`, neither of which need be of unit length.
    /// `None` if they are parallel to 1e-3, zero, or not finite.
    pub fn from_directions(forward: Ned, down: Ned) -> Option<Self> {
        let (tail, belly) = (-forward, down);
        let (length, width) = (
            math::sqrt(tail.norm_squared()),
            math::sqrt(belly.norm_squared()),
        );
        let product = length * width;
        // NaN and infinity fail too.
        if !(product > 0.0 && product < f32::INFINITY) {
            return None;
        }
        let (i, side) = (tail * (1.0 / length), belly * (1.0 / width));
        let across = side - i * i.dot(side);
        let sine = math::sqrt(across.norm_squared());
        if sine < MIN_SINE {
            return None;
        }
        // A second time: where the difference is small, the first one has lost digits to cancellation.
        let j = across * (1.0 / sine);
        let j = j - i * i.dot(j);
        let j = j * (1.0 / math::sqrt(j.norm_squared()));
        Some(Self {
            i,
            j,
            w: i.cross(j),
        })
    }

    /// The attitude turned by θ about its right wing.
    pub fn pitched(&self, attitude: Attitude) -> Self {
        let Attitude { cos, sin } = attitude;
        Self {
            i: self.i * cos + self.j * sin,
            j: self.j * cos - self.i * sin,
            w: self.w,
        }
    }

    /// The quaternion of the body axes `axes`, of unit length. Of its two signs it has the one whose greatest component is
    /// positive.
    pub fn to_quaternion(&self, axes: BodyAxes) -> Quaternion {
        let (x, y, z) = match axes {
            BodyAxes::NoseUp => (self.j, self.w, self.i),
            BodyAxes::NoseForward => (-self.i, self.w, self.j),
        };
        // The largest component is found from the diagonal, and the others by division through it. What is under the roots
        // is not negative: the compiler sees it by the magnitude, and needs no call for NaN.
        let (a, b, c) = (x.north, y.east, z.down);
        let (r, q) = if a + b + c >= 0.0 {
            let r = math::sqrt((1.0 + a + b + c).abs());
            let v = [r * r, y.down - z.east, z.north - x.down, x.east - y.north];
            (r, v)
        } else if (a >= b) & (a >= c) {
            let r = math::sqrt((1.0 + a - b - c).abs());
            let v = [y.down - z.east, r * r, x.east + y.north, z.north + x.down];
            (r, v)
        } else if b >= c {
            let r = math::sqrt((1.0 - a + b - c).abs());
            let v = [z.north - x.down, x.east + y.north, r * r, y.down + z.east];
            (r, v)
        } else {
            let r = math::sqrt((1.0 - a - b + c).abs());
            let v = [x.east - y.north, z.north + x.down, y.down + z.east, r * r];
            (r, v)
        };
        let [w, x, y, z] = q.map(|v| v * (0.5 / r));
        Quaternion { w, x, y, z }
    }

    /// Whether i and j are of unit length. NaN is not.
    #[inline(always)]
    pub(crate) fn is_sound(&self) -> bool {
        (self.i.norm_squared() - 1.0).abs() + (self.j.norm_squared() - 1.0).abs() <= MAX_DEFECT
    }

    /// Along the nose, which is where thrust points: a unit vector, as the two others.
    #[inline]
    pub fn forward(&self) -> Ned {
        -self.i
    }

    /// Along the right wing.
    #[inline]
    pub fn right(&self) -> Ned {
        self.w
    }

    /// Towards the belly.
    #[inline]
    pub fn down(&self) -> Ned {
        self.j
    }

    /// The body components of a world vector.
    #[inline(always)]
    pub fn to_body(&self, v: Ned) -> Frd {
        self.to_axes(v).into()
    }

    /// The world components of a body vector.
    #[inline(always)]
    pub fn to_world(&self, v: Frd) -> Ned {
        self.of_axes(v.into())
    }

    /// i: towards the tail, opposite to thrust.
    #[inline]
    pub(crate) fn i(&self) -> Ned {
        self.i
    }

    /// j: towards the belly.
    #[inline]
    pub(crate) fn j(&self) -> Ned {
        self.j
    }

    /// w: the right wing.
    #[inline]
    pub(crate) fn w(&self) -> Ned {
        self.w
    }

    /// The components of a world vector along i, j and w.
    #[inline(always)]
    pub(crate) fn to_axes(self, v: Ned) -> Body {
        Body::new(self.i.dot(v), self.j.dot(v), self.w.dot(v))
    }

    /// The world vector with these components along i, j and w.
    #[inline(always)]
    pub(crate) fn of_axes(&self, v: Body) -> Ned {
        self.i * v.i + self.j * v.j + self.w * v.w
    }

    /// The shortest rotation from this attitude to the one with the axes `i`, `j` and `w`, in body components \[rad\]: along its
    /// axis, and 2 tan(φ/2) long for an angle φ, which is φ where it is small. At 180° there is no shortest way and it is zero;
    /// near that it is at most 10 long.
    #[inline(always)]
    pub(crate) fn rotation_to(&self, i: Ned, j: Ned, w: Ned) -> Body {
        let (i, j, w) = (self.to_axes(i), self.to_axes(j), self.to_axes(w));
        // The sum of the vector products of present and wanted axes is 2 sin φ long, that of their scalar products 1 + 2 cos φ.
        let scale = 1.0 / (0.5 * (1.0 + i.i + j.j + w.w) + REGULARISATION);
        Body::new(j.w - w.j, w.i - i.w, i.j - j.i) * scale
    }
}

impl Default for Orientation {
    fn default() -> Self {
        Self::NOSE_UP
    }
}

impl BodyAxes {
    /// The components along these axes, (x, y, z), of a body vector or of body rates.
    #[inline(always)]
    pub fn components(self, v: impl Into<Frd>) -> [f32; 3] {
        let Frd {
            forward,
            right,
            down,
        } = v.into();
        match self {
            Self::NoseUp => [down, right, -forward],
            Self::NoseForward => [forward, right, down],
        }
    }

    /// The body vector, or the body rates, with these components (x, y, z) along these axes.
    #[inline(always)]
    pub fn vector<V: From<Frd>>(self, [x, y, z]: [f32; 3]) -> V {
        V::from(match self {
            Self::NoseUp => Frd::new(-z, y, x),
            Self::NoseForward => Frd::new(x, y, z),
        })
    }
}

impl Quaternion {
    /// The attitude set-point with which an attitude loop of gain 1/`time` asks for `rates` [rad/s]: this attitude, of body
    /// axes `axes`, turned by `rates` times `time` \[s\], and whether that turn has been limited to 90°. Of unit length, if
    /// this quaternion is that of an [`Orientation`]; continuous in it and in the rates.
    #[inline]
    pub fn leading(&self, axes: BodyAxes, rates: BodyRates, time: f32) -> (Self, bool) {
        let Self { w, x, y, z } = *self;
        let square = (w * w + x * x) + (y * y + z * z);
        let rate = math::sqrt(Body::from(rates).norm_squared());
        let lead = rate * time;
        let limited = lead > MAX_LEAD;
        let half = 0.5 * if limited { MAX_LEAD } else { lead };
        let (sin, cos) = math::sin_cos_near_zero(half);
        let unit = 1.0 / math::sqrt(square);
        // sin(half) over the rate. Without a rate there is no turn.
        let share = unit * (sin / (rate + f32::MIN_POSITIVE));
        let (c, [a, b, d]) = (unit * cos, axes.components(rates).map(|r| share * r));
        let turned = Self {
            w: (w * c - x * a) - (y * b + z * d),
            x: (w * a + x * c) + (y * d - z * b),
            y: (w * b + y * c) + (z * a - x * d),
            z: (w * d + z * c) + (x * b - y * a),
        };
        (turned, limited)
    }

    /// The quaternion of the body axes `to` of the attitude of which this is the one of `from`.
    pub const fn in_axes(self, from: BodyAxes, to: BodyAxes) -> Self {
        // The axes are a quarter turn about the wing apart: q · (cos 45°, 0, ± sin 45°, 0).
        let sign = match (from, to) {
            (BodyAxes::NoseUp, BodyAxes::NoseForward) => 1.0,
            (BodyAxes::NoseForward, BodyAxes::NoseUp) => -1.0,
            _ => return self,
        };
        const HALF: f32 = core::f32::consts::FRAC_1_SQRT_2;
        let Self { w, x, y, z } = self;
        Self {
            w: HALF * (w - sign * y),
            x: HALF * (x - sign * z),
            y: HALF * (y + sign * w),
            z: HALF * (z + sign * x),
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn known_attitudes() {
        let level = Quaternion {
            w: 1.0,
            x: 0.0,
            y: 0.0,
            z: 0.0,
        };
        // No rotation is hover in multicopter axes, and level cruise to the north in fixed-wing axes.
        let hover = Orientation::from_quaternion(&level, BodyAxes::NoseUp).unwrap();
        assert_eq!(hover, Orientation::NOSE_UP);
        let cruise = Orientation::from_quaternion(&level, BodyAxes::NoseForward).unwrap();
        assert_eq!(cruise.i().north, -1.0);
        assert_eq!(cruise.j(), Ned::new(0.0, 0.0, 1.0));
        assert_eq!(cruise.w(), Ned::new(0.0, 1.0, 0.0));
    }

    /// A unit quaternion, uniform enough.
    fn any(n: usize) -> Quaternion {
        let a = n as f32;
        let raw = [(a * 0.7).sin(), (a * 1.3).cos(), (a * 2.1).sin(), a.cos()];
        let norm = raw.iter().map(|x| x * x).sum::<f32>().sqrt();
        let [w, x, y, z] = raw.map(|x| x / norm);
        Quaternion { w, x, y, z }
    }

    /// The shortest rotation from one attitude to another, against their quaternions: 2 tan(φ/2) along its axis is 2 v/w of q̄ p. The
    /// regularisation shortens it, by 1 % where φ is small and by a tenth at 145°. The tolerance is the rounding of nine products
    /// in `f32`, divided by 1 + cos φ ≥ 0.1.
    #[test]
    fn the_shortest_rotation_is_that_of_the_quaternions() {
        let of = |q: &Quaternion| Orientation::from_quaternion(q, BodyAxes::NoseUp).unwrap();
        for n in 0..200 {
            let (from, to) = (any(n), any(7 * n + 3));
            let target = of(&to);
            let Body { i, j, w } = of(&from).rotation_to(target.i, target.j, target.w);
            let [a, x, y, z] = exact(&from);
            let q = product([a, -x, -y, -z], exact(&to));
            // Half of 1 + cos φ.
            let half = q[0] * q[0];
            if half < 0.05 {
                continue;
            }
            let scale = 2.0 / q[0] * half / (half + 0.5 * f64::from(REGULARISATION));
            // Of these axes x, y, z are j, w, i.
            for (got, part) in [(j, q[1]), (w, q[2]), (i, q[3])] {
                let expected = scale * part;
                assert!(
                    (f64::from(got) - expected).abs() < 1e-5 * (1.0 + expected.abs()),
                    "{n}: {got} {expected}"
                );
            }
        }
    }

    /// Rates along the shortest rotation bring any attitude to any other, the angle between them falling at every step but for the
    /// rounding of 1 + 2 cos φ in `f32`; also from 179.9° off.
    #[test]
    fn along_the_shortest_rotation_every_attitude_is_reached() {
        let target = Orientation::NOSE_UP;
        let over = Quaternion {
            w: 8.7e-4,
            x: 0.6,
            y: 0.0,
            z: 0.8,
        };
        for start in (1..100).map(any).chain([over]) {
            let mut at = Orientation::from_quaternion(&start, BodyAxes::NoseUp).unwrap();
            let cosine =
                |o: &Orientation| o.i.dot(target.i) + o.j.dot(target.j) + o.w.dot(target.w);
            let mut before = cosine(&at);
            for _ in 0..300 {
                let rotation = at.rotation_to(target.i, target.j, target.w);
                let rates = at.of_axes(rotation) * 6.4;
                let length = math::sqrt(rates.norm_squared());
                let rates = rates * (3.5 / if length > 3.5 { length } else { 3.5 });
                // A step of 10 ms by Rodrigues' formula, exact.
                let turned = |v: Ned| {
                    let angle = math::sqrt(rates.norm_squared()) * 0.01;
                    let axis = rates * (0.01 / (angle + 1e-9));
                    let (sin, cos) = math::sin_cos(angle);
                    v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos))
                };
                at = Orientation {
                    i: turned(at.i),
                    j: turned(at.j),
                    w: turned(at.w),
                };
                let now = cosine(&at);
                assert!(now > before - 1e-5, "{start:?}: {before} {now}");
                before = now;
            }
            assert!(before > 2.9999, "{start:?}: {before}");
        }
    }

    /// A quaternion (w, x, y, z) in double precision.
    type Exact = [f64; 4];

    fn exact(q: &Quaternion) -> Exact {
        [q.w, q.x, q.y, q.z].map(f64::from)
    }

    fn product([w, x, y, z]: Exact, [a, b, c, d]: Exact) -> Exact {
        [
            w * a - x * b - y * c - z * d,
            w * b + x * a + y * d - z * c,
            w * c - x * d + y * a + z * b,
            w * d + x * c - y * b + z * a,
        ]
    }

    /// The angle \[rad\] between two attitudes.
    fn apart([w, x, y, z]: Exact, b: Exact) -> f64 {
        let [w, x, y, z] = product([w, -x, -y, -z], b);
        2.0 * x.hypot(y).hypot(z).atan2(w.abs())
    }

    const BOTH: [BodyAxes; 2] = [BodyAxes::NoseUp, BodyAxes::NoseForward];

    /// Half turns about the axes, and their neighbours, are where a component of the quaternion that is divided by could
    /// vanish.
    #[test]
    fn quaternions_come_back_in_both_axes() {
        let mut worst = 0f64;
        for n in 0..40_000 {
            let mut q = any(n);
            if n % 4 == 0 {
                let mut c = [1e-7, -1e-4, 3e-4, 0.0];
                c[n / 4 % 4] = 1.0;
                let [w, x, y, z] = c;
                q = Quaternion { w, x, y, z };
            }
            for axes in BOTH {
                let o = Orientation::from_quaternion(&q, axes).unwrap();
                let back = o.to_quaternion(axes);
                worst = worst.max(apart(exact(&back), exact(&q)));
                let length = back.w * back.w + back.x * back.x + back.y * back.y + back.z * back.z;
                assert!((length - 1.0).abs() < 2e-6);
                for to in BOTH {
                    let other = exact(&o.to_quaternion(to));
                    worst = worst.max(apart(other, exact(&q.in_axes(axes, to))));
                }
            }
        }
        // Three roundings of the axes, doubled by the angle: measured 5.9e-7.
        assert!(worst < 1.2e-6, "{worst:e}");
    }

    /// Against rotation vectors in double precision.
    #[test]
    fn set_points_lead_by_rate_times_time() {
        let mut worst = 0f64;
        for n in 0..40_000 {
            let (q, a) = (any(n), n as f32);
            let scale = [0.0, 1e-20, 1e-3, 1.0, 7.0, 300.0][n % 6];
            let rates = Body::new((a * 0.9).sin(), (a * 0.4).cos(), (a * 1.7).sin()) * scale;
            let time = 0.15;
            for axes in BOTH {
                let (led, limited) = q.leading(axes, rates.into(), time);
                let [x, y, z] = axes.components(rates).map(f64::from);
                let rate = x.hypot(y).hypot(z);
                let angle = rate * f64::from(time);
                assert_eq!(limited, angle > core::f64::consts::FRAC_PI_2);
                let (sin, cos) = (0.5 * angle.min(core::f64::consts::FRAC_PI_2)).sin_cos();
                let share = if rate > 0.0 { sin / rate } else { 0.0 };
                let turn = [cos, share * x, share * y, share * z];
                worst = worst.max(apart(exact(&led), product(exact(&q), turn)));
                let length = led.w * led.w + led.x * led.x + led.y * led.y + led.z * led.z;
                assert!((length - 1.0).abs() < 2e-6);
            }
        }
        // Roundings of four components and of the sine, doubled: measured 3.4e-7.
        assert!(worst < 1e-6, "{worst:e}");
    }

    /// A rate about the right wing raises a forward nose; about the tail and the belly as the axes' table says.
    #[test]
    fn rates_of_both_axes_turn_the_same_way() {
        let level = Orientation::NOSE_UP.pitched(Attitude {
            cos: 0.0,
            sin: -1.0,
        });
        // Level to the north: tail to the south, belly down, right wing east.
        assert_eq!(level.i(), Ned::new(-1.0, 0.0, 0.0));
        assert_eq!(level.j(), Ned::new(0.0, 0.0, 1.0));
        for axes in BOTH {
            let q = level.to_quaternion(axes);
            let turned = |rates| {
                let (q, _) = q.leading(axes, rates, 0.1);
                Orientation::from_quaternion(&q, axes).unwrap()
            };
            // 0.1 rad: the sine, and its rounding.
            let near = |a: f32| (a - 0.1f32.sin()).abs() < 1e-6;
            assert!(near(turned(BodyRates::new(0.0, 1.0, 0.0)).i().down));
            // About the tail: the belly moves to the right wing.
            assert!(near(turned(BodyRates::new(-1.0, 0.0, 0.0)).j().east));
            // About the belly: the right wing turns to the tail, w × … : the nose turns right.
            assert!(near(-turned(BodyRates::new(0.0, 0.0, 1.0)).i().east));
            assert_eq!(
                axes.vector::<Body>(axes.components(Body::new(1.0, 2.0, 3.0))),
                Body::new(1.0, 2.0, 3.0)
            );
        }
    }

    /// In the plane to the north the axes are those of the planar attitude.
    #[test]
    fn agrees_with_the_planar_attitude() {
        for n in 0..400 {
            let planar = Attitude::from_angle(n as f32 * 0.11 - 22.0);
            let o = Orientation::NOSE_UP.pitched(planar);
            assert_eq!(o, Orientation::in_plane(planar));
            let nose = o.forward() * 3.0;
            let spanned = Orientation::from_directions(nose, o.down() + o.i()).unwrap();
            // 1e-6: roundings of three normalisations.
            assert!(
                (spanned.i() - o.i()).norm_squared() + (spanned.j() - o.j()).norm_squared() < 1e-12
            );
        }
        // Nearly parallel, it is a rotation all the same.
        let (nose, belly) = (Ned::new(0.3, 0.5, -2.0), Ned::new(0.303, 0.5, -2.0));
        let o = Orientation::from_directions(nose, belly).unwrap();
        assert_eq!(Orientation::try_from(<[Ned; 3]>::from(o)), Ok(o));
        assert!(o.forward().dot(nose) > 2.0 && o.forward().cross(o.right()).dot(o.down()) > 0.99);
        assert!((o.to_world(o.to_body(belly)) - belly).norm_squared() < 1e-12);
        assert!(o.i().dot(o.j()).abs() < 1e-6 && o.to_body(belly).down > 0.0);
        let up = Ned::new(0.0, 0.0, -2.0);
        for bad in [
            up,
            Ned::ZERO,
            Ned::new(f32::NAN, 1.0, 0.0),
            Ned::new(f32::INFINITY, 0.0, 0.0),
        ] {
            assert_eq!(Orientation::from_directions(up, bad), None);
            assert_eq!(Orientation::from_directions(bad, up), None);
        }
        assert!(!Orientation::UNKNOWN.is_sound());
    }

    /// The axes stay orthonormal for every quaternion that is accepted, however far from a unit.
    #[test]
    fn the_axes_are_a_right_handed_orthonormal_set() {
        let mut accepted = 0;
        for n in 0..20_000 {
            let a = n as f32;
            let raw = [(a * 0.7).sin(), (a * 1.3).cos(), (a * 2.1).sin(), a.cos()];
            let norm = raw.iter().map(|x| x * x).sum::<f32>().sqrt();
            let stretch = (1.0 + 4.9e-4 * (a * 0.01).sin()) / norm;
            let [w, x, y, z] = raw.map(|x| x * stretch);
            let q = Quaternion { w, x, y, z };
            let Ok(o) = Orientation::from_quaternion(&q, BodyAxes::NoseUp) else {
                continue;
            };
            accepted += 1;
            let (i, j) = (o.i(), o.j());
            let cross = i.cross(j);
            // 1e-6: some ten roundings of numbers below 1.
            assert!((cross - o.w()).norm_squared() < 1e-12);
            assert!((i.norm_squared() - 1.0).abs() < 1e-6 && i.dot(j).abs() < 1e-6);
            let v = Ned::new(3.0, -4.0, 12.0);
            assert!((o.to_world(o.to_body(v)) - v).norm_squared() < 1e-9);
        }
        assert!(accepted > 19_000);
    }

    #[test]
    fn what_is_no_attitude_is_refused() {
        for bad in [f32::NAN, f32::INFINITY, 1.1, 0.0, 3e38] {
            let q = Quaternion {
                w: bad,
                x: 0.0,
                y: 0.0,
                z: 0.0,
            };
            let refused = Orientation::from_quaternion(&q, BodyAxes::NoseForward);
            assert_eq!(refused, Err(Fault::Attitude));
        }
    }
}
