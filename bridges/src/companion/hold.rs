//! What the guidance in a vertical plane leaves open: the attitude about the other two axes, and the position across the plane.

use alula::ned::Ned;

use super::plane::{Projection, VerticalPlane};

/// Parameters of [`Hold`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HoldParameters {
    /// Rate of turning over the angle to the plane [1/s].
    pub attitude_1_s: f32,
    /// Tilt over the velocity across the plane [rad s/m].
    pub velocity: f32,
    /// Tilt over the position across the plane [rad/m].
    pub position: f32,
    /// Largest tilt \[rad\].
    pub tilt: f32,
    /// Largest rate [rad/s].
    pub rate: f32,
}

impl Default for HoldParameters {
    fn default() -> Self {
        Self {
            attitude_1_s: 3.0,
            velocity: 0.1,
            position: 0.04,
            tilt: 0.25,
            rate: 1.5,
        }
    }
}

/// Keeps the vehicle in a vertical plane: its wing square to the plane but for a tilt of the nose against what is across it.
#[derive(Clone, Copy, Debug)]
pub struct Hold {
    parameters: HoldParameters,
    plane: VerticalPlane,
}

/// Within ±`most`; 0 for what is no number.
fn limited(value: f32, most: f32) -> f32 {
    if value.is_finite() {
        value.clamp(-most, most)
    } else {
        0.0
    }
}

impl Hold {
    /// Holds `plane`.
    #[must_use]
    pub fn new(parameters: HoldParameters, plane: VerticalPlane) -> Self {
        Self { parameters, plane }
    }

    /// The plane.
    #[must_use]
    pub fn plane(&self) -> &VerticalPlane {
        &self.plane
    }

    /// Body rates [rad/s] about (x, y, z) of hover's axes: θ̇ = `rate` in the plane, and towards it. `position` \[m\] is from a
    /// point of the plane.
    #[must_use]
    pub fn rates(
        &self,
        attitude: &Projection,
        rate: f32,
        position: Ned,
        velocity: Ned,
    ) -> [f32; 3] {
        let p = &self.parameters;
        let (across, speed) = (
            self.plane.project(position).1,
            self.plane.project(velocity).1,
        );
        // Thrust along the nose pushes to the right when the nose is out of the plane to the right.
        let tilt = limited(-p.position * across - p.velocity * speed, p.tilt);
        let [x, y, z] = attitude.normal;
        // The nose is −z; the wing is turned towards the normal, less the tilt wanted: ω = k ŷ × n. Upside down both parts
        // vanish, and either way round is as good: one is taken.
        let (about_x, about_z) = match y < 0.0 && x.abs() + z.abs() < 0.1 {
            true => (1.0, 0.0),
            false => (z + tilt, -x),
        };
        let towards = |error: f32| limited(p.attitude_1_s * error, p.rate);
        [
            rate * x + towards(about_x),
            rate * y,
            rate * z + towards(about_z),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alula::ned::{BodyAxes, Quaternion};
    use alula::spatial::Orientation;

    fn hold() -> Hold {
        Hold::new(HoldParameters::default(), VerticalPlane::from_heading(0.0))
    }

    /// The attitude after a turn by `angle` about axis `x`, `y`, `z` of hover.
    fn turned(angle: f32, [x, y, z]: [f32; 3]) -> Projection {
        let (s, c) = ((0.5 * angle).sin(), (0.5 * angle).cos());
        let q = Quaternion {
            w: c,
            x: s * x,
            y: s * y,
            z: s * z,
        };
        let orientation = Orientation::from_quaternion(&q, BodyAxes::NoseUp).unwrap();
        hold().plane.attitude(&orientation).unwrap()
    }

    #[test]
    fn attitudes_out_of_the_plane_are_turned_back() {
        let rates = |attitude| hold().rates(&attitude, 0.5, Ned::default(), Ned::default());
        assert_eq!(rates(turned(0.0, [1.0, 0.0, 0.0])), [0.0, 0.5, 0.0]);
        // Turned about the belly, and about the tail: back, at 3/s, with θ̇ about the plane's normal.
        let [x, ..] = rates(turned(0.1, [1.0, 0.0, 0.0]));
        assert!((x + 0.3).abs() < 0.01, "{x}");
        let [.., z] = rates(turned(0.1, [0.0, 0.0, 1.0]));
        assert!((z + 0.3).abs() < 0.06, "{z}");
    }

    /// To the right of the plane, and on the way to the right, the nose is wanted to the left: a negative turn about the belly's axis,
    /// which moves the tail, z, to the right.
    #[test]
    fn the_nose_tilts_back_to_the_plane() {
        let upright = turned(0.0, [1.0, 0.0, 0.0]);
        let right = Ned::new(7.0, 1.0, -3.0);
        let [x, y, z] = hold().rates(&upright, 0.0, right, Ned::default());
        assert!((x + 3.0 * 0.04).abs() < 1e-6 && (y, z) == (0.0, 0.0), "{x}");
        let [x, ..] = hold().rates(&upright, 0.0, Ned::default(), Ned::new(20.0, 1.0, 0.0));
        assert!((x + 0.3).abs() < 1e-6, "{x}");
        let [x, ..] = hold().rates(&upright, 0.0, Ned::new(0.0, 1e9, 0.0), Ned::default());
        assert!((x + 0.75).abs() < 1e-6, "{x}");
        let [x, ..] = hold().rates(&upright, 0.0, Ned::new(0.0, f32::NAN, 0.0), Ned::default());
        assert_eq!(x, 0.0);
    }
}
