//! The reference limit in space: on speed and direction.

use super::command::FeedForward;
use crate::error::{ParameterError, positive};
use crate::math;
use crate::ned::Ned;

/// Parameters of the reference limit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ReferenceLimitParameters {
    /// Rate [1/s] at which the velocity followed approaches the one asked for.
    pub rate: f32,
    /// Largest acceleration [m/s²]: in any direction below `speed`, forward above it, and vertically.
    pub acceleration: f32,
    /// Largest acceleration across the course [m/s²] above `speed`.
    pub turn: f32,
    /// Largest braking [m/s²] above `speed`: what drag alone can do.
    pub brake: f32,
    /// Horizontal speed [m/s] above which the wing carries.
    pub speed: f32,
}

/// Limits how fast a velocity reference changes.
///
/// Above `speed` the horizontal velocity is limited by length and direction: it turns at constant length, and a reversal
/// is a turn (to the right, where it is exact). Braked along its line through zero it could not be flown, for a clean
/// aircraft brakes by its drag alone. Below `speed`, and vertically, the limit is on the vector.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ReferenceLimit {
    p: ReferenceLimitParameters,
}

/// What the limit remembers: the velocity followed [m/s].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ReferenceLimitState {
    /// Velocity followed [m/s].
    pub velocity: Ned,
}

impl ReferenceLimit {
    /// The limit with these parameters.
    ///
    /// # Errors
    /// `rate` outside [1e-3, 1e2], `acceleration`, `turn` or `brake` outside [1e-3, 1e3], `speed` outside [1e-1, 1e3];
    /// or any not finite or not positive.
    pub fn new(p: ReferenceLimitParameters) -> Result<Self, ParameterError> {
        positive("rate", p.rate, 1e-3, 1e2)?;
        positive("acceleration", p.acceleration, 1e-3, 1e3)?;
        positive("turn", p.turn, 1e-3, 1e3)?;
        positive("brake", p.brake, 1e-3, 1e3)?;
        positive("speed", p.speed, 1e-1, 1e3)?;
        Ok(Self { p })
    }

    /// Moves the velocity followed towards `asked` [m/s] for `dt` \[s\], and gives its acceleration [m/s²], and the jerk
    /// [m/s³] by which a turn turns it: what [`WingedControl`](super::WingedControl) takes as reference and feed-forward.
    ///
    /// `asked` and `dt` are to be finite, `dt` positive.
    pub fn update(&self, state: &mut ReferenceLimitState, asked: Ned, dt: f32) -> FeedForward {
        let ReferenceLimitParameters {
            rate,
            acceleration: most,
            turn,
            brake,
            speed,
        } = self.p;
        // No faster than in one step, however large the rate.
        let rate = math::min(rate, 1.0 / dt);
        let v = state.velocity;
        let error = asked - v;
        let length = math::sqrt(v.north * v.north + v.east * v.east);
        let (mut north, mut east) = (rate * error.north, rate * error.east);
        let mut turning = 0.0;
        if length > speed {
            let (t_n, t_e) = (v.north / length, v.east / length);
            let wanted = math::sqrt(asked.north * asked.north + asked.east * asked.east);
            let ahead = asked.north * t_n + asked.east * t_e;
            let right = asked.east * t_n - asked.north * t_e;
            // The direction asked for, from the course: its sine, 1 beyond a quarter turn; and less, in proportion, where
            // less than `speed` is asked for.
            let whole = if wanted > speed { wanted } else { speed };
            let sine = if ahead >= 0.0 {
                right
            } else if right < 0.0 {
                -wanted
            } else {
                wanted
            } / whole;
            let along = math::clamp(rate * (wanted - length), -brake, most);
            let across = math::clamp(rate * length * sine, -turn, turn);
            north = along * t_n - across * t_e;
            east = along * t_e + across * t_n;
            turning = across / length;
        } else {
            let square = north * north + east * east;
            if square > most * most {
                let scale = most / math::sqrt(square);
                (north, east) = (scale * north, scale * east);
            }
        }
        let down = math::clamp(rate * error.down, -most, most);
        let acceleration = Ned::new(north, east, down);
        state.velocity = v + acceleration * dt;
        FeedForward {
            air_acceleration: acceleration,
            jerk: Ned::new(-turning * east, turning * north, 0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    const GOOD: ReferenceLimitParameters = ReferenceLimitParameters {
        rate: 0.8,
        acceleration: 3.0,
        turn: 6.0,
        brake: 0.6,
        speed: 10.0,
    };
    const DT: f32 = 0.01;

    fn limit() -> ReferenceLimit {
        ReferenceLimit::new(GOOD).unwrap()
    }

    /// Velocities while `asked` is approached from `start`, every 10 ms for `time` \[s\].
    fn follow(start: Ned, asked: Ned, time: f32) -> std::vec::Vec<(Ned, FeedForward)> {
        let mut state = ReferenceLimitState { velocity: start };
        (0..(time / DT) as usize)
            .map(|_| {
                let ff = limit().update(&mut state, asked, DT);
                (state.velocity, ff)
            })
            .collect()
    }

    #[test]
    fn a_reversal_at_speed_is_a_turn_to_the_right() {
        let path = follow(Ned::new(20.0, 0.0, 0.0), Ned::new(-20.0, 0.0, 0.0), 20.0);
        assert!(path[200].0.east > 5.0);
        for (v, ff) in &path {
            let length = v.norm_squared().sqrt();
            // Euler's method gains a little speed in a turn, which is taken off again.
            assert!((length - 20.0).abs() < 0.1, "{length}");
            assert!(ff.air_acceleration.norm_squared().sqrt() < 6.1);
        }
        let (last, _) = path[path.len() - 1];
        assert!((last - Ned::new(-20.0, 0.0, 0.0)).norm_squared() < 0.1);
        // The other way round for a direction to the left.
        let left = follow(Ned::new(20.0, 0.0, 0.0), Ned::new(-20.0, -1.0, 0.0), 2.0);
        assert!(left[190].0.east < -5.0);
    }

    #[test]
    fn the_jerk_is_the_rate_of_the_acceleration_in_a_steady_turn() {
        let path = follow(Ned::new(20.0, 0.0, 0.0), Ned::new(-20.0, 0.0, 0.0), 2.0);
        for n in 50..150 {
            let rate = (path[n + 1].1.air_acceleration - path[n - 1].1.air_acceleration) * 50.0;
            // 3 %: the course turns by 0.17° a step, and speed is being corrected.
            let error = (path[n].1.jerk - rate).norm_squared().sqrt();
            assert!(error < 0.03 * 1.8, "{error}");
        }
    }

    #[test]
    fn braking_at_speed_is_drags_and_below_it_the_vectors() {
        let path = follow(Ned::new(20.0, 0.0, 0.0), Ned::ZERO, 30.0);
        assert!((path[100].1.air_acceleration.north + 0.6).abs() < 1e-5);
        let slow = path.iter().find(|(v, _)| v.north < 9.9).unwrap();
        assert!(slow.1.air_acceleration.north < -2.9);
        assert!(path[path.len() - 1].0.norm_squared() < 1e-4);
        // From rest in any direction, and vertically, within a_max; and there in the end.
        let path = follow(Ned::ZERO, Ned::new(6.0, -6.0, -4.0), 30.0);
        for (_, ff) in &path {
            let a = ff.air_acceleration;
            assert!(a.north.hypot(a.east) < 3.0001 && a.down.abs() < 3.0001);
        }
        assert!((path[path.len() - 1].0 - Ned::new(6.0, -6.0, -4.0)).norm_squared() < 1e-4);
    }

    #[test]
    fn bad_parameters_are_named() {
        let name = |p| ReferenceLimit::new(p).unwrap_err().parameter;
        assert_eq!(name(ReferenceLimitParameters { rate: 0.0, ..GOOD }), "rate");
        assert_eq!(
            name(ReferenceLimitParameters {
                acceleration: f32::NAN,
                ..GOOD
            }),
            "acceleration"
        );
        assert_eq!(
            name(ReferenceLimitParameters { turn: -1.0, ..GOOD }),
            "turn"
        );
        assert_eq!(
            name(ReferenceLimitParameters { brake: 1e9, ..GOOD }),
            "brake"
        );
        assert_eq!(
            name(ReferenceLimitParameters { speed: 0.0, ..GOOD }),
            "speed"
        );
    }
}
