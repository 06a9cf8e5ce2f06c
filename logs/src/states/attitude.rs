//! Attitude as quaternions.

/// w, x, y, z; from the body to north-east-down; Hamilton's convention.
pub type Quaternion = [f64; 4];

/// The product `a` ⊗ `b`: first the rotation `b`, then `a`.
#[must_use]
pub fn multiply(a: Quaternion, b: Quaternion) -> Quaternion {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

/// `q` of length 1; NaN if it has no direction.
pub(super) fn normalized(q: Quaternion) -> Quaternion {
    let length = q.iter().map(|c| c * c).sum::<f64>().sqrt();
    let usable = length.is_finite() && length > 1e-6;
    q.map(|c| if usable { c / length } else { f64::NAN })
}

/// The quaternion of roll, pitch and yaw [deg]: about north-east-down's z by the yaw, then y by the pitch, then x by the
/// roll.
pub(super) fn from_degrees([roll, pitch, yaw]: [f64; 3]) -> Quaternion {
    let half = |degrees: f64| (degrees.to_radians() / 2.0).sin_cos();
    let ((sr, cr), (sp, cp), (sy, cy)) = (half(roll), half(pitch), half(yaw));
    multiply(
        [cy, 0.0, 0.0, sy],
        multiply([cp, 0.0, sp, 0.0], [cr, sr, 0.0, 0.0]),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The body's axis `axis` in north-east-down.
    fn axis(q: Quaternion, axis: usize) -> [f64; 3] {
        let mut v = [0.0; 4];
        v[axis + 1] = 1.0;
        let conjugate = [q[0], -q[1], -q[2], -q[3]];
        let [_, n, e, d] = multiply(multiply(q, v), conjugate);
        [n, e, d]
    }

    fn close(a: [f64; 3], b: [f64; 3]) {
        // A dozen roundings of 1e-16 each.
        assert!(
            std::iter::zip(a, b).all(|(a, b)| (a - b).abs() < 1e-14),
            "{a:?}, {b:?}"
        );
    }

    #[test]
    fn angles_turn_the_axes_the_aeronautical_way() {
        // Nose up by 90°: x points up, which is −down, and z forward, north.
        let up = from_degrees([0.0, 90.0, 0.0]);
        close(axis(up, 0), [0.0, 0.0, -1.0]);
        close(axis(up, 2), [1.0, 0.0, 0.0]);
        // Yaw to the east, then right wing down.
        let east = from_degrees([90.0, 0.0, 90.0]);
        close(axis(east, 0), [0.0, 1.0, 0.0]);
        close(axis(east, 1), [0.0, 0.0, 1.0]);
    }

    #[test]
    fn a_quaternion_without_direction_is_no_attitude() {
        assert_eq!(normalized([0.0, 2.0, 0.0, 0.0]), [0.0, 1.0, 0.0, 0.0]);
        assert!(normalized([0.0; 4]).iter().all(|c| c.is_nan()));
        assert!(
            normalized([f64::INFINITY, 0.0, 0.0, 0.0])
                .iter()
                .all(|c| c.is_nan())
        );
    }
}
