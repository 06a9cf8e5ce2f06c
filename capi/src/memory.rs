//! What `alula_guide` remembers between calls.

use alula::guidance::Across;
use alula::ned::{BodyAxes, VerticalPlane};
use alula::{GainChoice, Guidance, GuidanceState, Model};

use crate::ned_command::NedCommand;
use crate::ned_input::{in_range, plane_of};

/// The guidance's state, the vertical plane that it is in, and the last command.
#[derive(Clone, Copy)]
pub(crate) struct Memory {
    pub state: GuidanceState,
    /// What the state has across the plane.
    pub across: Across,
    /// Heading of the plane \[rad\]; NaN before the first call.
    heading: f32,
    plane: VerticalPlane,
    /// The last command with an attitude set-point.
    last: NedCommand,
    /// The body axes that it is in: 1 nose forward, 2 nose up, else there is none. A number, not `Option`: every bit pattern
    /// has a meaning.
    last_axes: u8,
}

impl Default for Memory {
    fn default() -> Self {
        Self {
            state: GuidanceState::default(),
            across: Across::default(),
            heading: f32::NAN,
            plane: VerticalPlane::from_heading(0.0),
            last: NedCommand::SAFE,
            last_axes: 0,
        }
    }
}

impl Memory {
    /// The plane of `heading` \[rad\], into which what is remembered is turned if it is another one than before.
    #[inline(always)]
    pub fn enter(&mut self, guidance: &Guidance<Model, GainChoice>, heading: f32) -> VerticalPlane {
        if heading == self.heading {
            self.plane
        } else {
            self.turn(guidance, heading)
        }
    }

    #[inline(never)]
    fn turn(&mut self, guidance: &Guidance<Model, GainChoice>, heading: f32) -> VerticalPlane {
        let plane = plane_of(heading);
        // A heading that is refused is not turned to.
        if in_range(heading) {
            if self.heading.is_finite() {
                let (cos, sin) = self.plane.angle_to(&plane);
                guidance.turn_plane(&mut self.state, &mut self.across, cos, sin);
            }
            (self.heading, self.plane) = (heading, plane);
        }
        plane
    }

    /// Computes the plane anew from its heading: if it has been corrupted, no frame is accepted until it is mended.
    pub fn renew_plane(&mut self) {
        self.plane = plane_of(self.heading);
    }

    /// Keeps a command that has an attitude set-point, and returns it.
    #[inline(always)]
    pub fn keep(&mut self, command: NedCommand, axes: BodyAxes) -> NedCommand {
        self.last = command;
        self.last_axes = number(axes);
        self.last
    }

    /// The last command that was kept, in the body axes `axes`, if there is one. A corrupt one, with a number that is not
    /// finite, is none.
    pub fn last(&self, axes: BodyAxes) -> Option<NedCommand> {
        match self.last_axes {
            1 | 2 if !self.last.is_finite() => None,
            1 | 2 if self.last_axes != number(axes) => Some(self.last.in_axes(axes)),
            1 | 2 => Some(self.last),
            _ => None,
        }
    }
}

const fn number(axes: BodyAxes) -> u8 {
    match axes {
        BodyAxes::NoseForward => 1,
        BodyAxes::NoseUp => 2,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alula::{
        BandwidthGains, Combined, CombinedParameters, GuidanceParameters, Vehicle,
        VehicleParameters,
    };

    fn guidance() -> Guidance<Model<'static>, GainChoice> {
        let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        let vehicle = Vehicle::new(VehicleParameters::PAPER, Model::Combined(model)).unwrap();
        let p = GuidanceParameters::default();
        let gains = GainChoice::Bandwidth(BandwidthGains::new(&p, &vehicle).unwrap());
        Guidance::with_gains(vehicle, gains, &p).unwrap()
    }

    #[test]
    fn the_plane_is_that_of_the_last_good_heading() {
        let (guidance, mut memory) = (guidance(), Memory::default());
        let plane = plane_of(0.7);
        assert_eq!(memory.enter(&guidance, 0.7), plane);
        assert_eq!(memory.enter(&guidance, 0.7), plane);
        // A bad heading has no plane, and does not replace the good one.
        for bad in [f32::NAN, f32::INFINITY, 1e6] {
            let none = memory.enter(&guidance, bad);
            assert!(none.project(crate::ned_input::ned([1.0; 3])).1.is_nan());
            assert_eq!((memory.heading, memory.plane), (0.7, plane));
        }
        memory.plane = plane_of(f32::NAN);
        memory.renew_plane();
        assert_eq!(memory.enter(&guidance, 0.7), plane);
        // A corrupt heading is replaced by the next good one.
        memory.heading = f32::NAN;
        memory.renew_plane();
        assert_eq!(memory.enter(&guidance, 0.7), plane);
    }

    #[test]
    fn a_corrupt_command_is_not_held() {
        let mut memory = Memory::default();
        let axes = BodyAxes::NoseUp;
        assert_eq!(memory.last(axes), None);
        memory.keep(NedCommand::SAFE, axes);
        assert_eq!(memory.last(axes), Some(NedCommand::SAFE));
        memory.last.quaternion[2] = f32::NAN;
        assert_eq!(memory.last(axes), None);
    }
}
