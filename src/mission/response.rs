//! What is done when something fails: a table.

use crate::parameters::setters;

/// What is done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Response {
    /// The mission goes on.
    #[default]
    Continue,
    /// On the wing a circle, in hover a stop, for as long as it lasts. Then the mission goes on.
    Loiter,
    /// Back to where it took off, and a landing there. It is kept to.
    Return,
    /// A landing where it is. It is kept to.
    Land,
}

impl Response {
    /// Name for logs, as files have it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Continue => "continue",
            Self::Loiter => "loiter",
            Self::Return => "return",
            Self::Land => "land",
        }
    }
}

/// What has failed: flags.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Troubles(u8);

bitflags::bitflags! {
    impl Troubles: u8 {
        /// The link to whoever flies is lost.
        const LINK = 1;
        /// Nothing is known of the air.
        const AIR = 1 << 1;
        /// Nothing is known of the position.
        const POSITION = 1 << 2;
        /// The battery is low.
        const BATTERY = 1 << 3;
        /// The vehicle does not follow: for 5 s it has been far from the path.
        const FOLLOW = 1 << 4;
        /// Whoever flies wants it to stop: on the ground no take-off, in a landing a go-around, else a loiter.
        const ABORT = 1 << 5;
    }
}

/// What is done when each of them fails; of several the gravest. From the default, to go on, by the method of each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
#[non_exhaustive]
pub struct Responses {
    /// The link.
    pub link: Response,
    /// Air data.
    pub air: Response,
    /// The position.
    pub position: Response,
    /// The battery.
    pub battery: Response,
    /// The vehicle does not follow.
    pub follow: Response,
}

setters! {
    Responses {
        link: Response,
        air: Response,
        position: Response,
        battery: Response,
        follow: Response,
    }
}

/// The same, by what is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Rules {
    land: Troubles,
    back: Troubles,
    loiter: Troubles,
}

impl Rules {
    pub fn new(responses: &Responses) -> Self {
        let answered = |so: Response| {
            [
                (Troubles::LINK, responses.link),
                (Troubles::AIR, responses.air),
                (Troubles::POSITION, responses.position),
                (Troubles::BATTERY, responses.battery),
                (Troubles::FOLLOW, responses.follow),
                (Troubles::ABORT, Response::Loiter),
            ]
            .into_iter()
            .filter(|(_, response)| *response == so)
            .fold(Troubles::empty(), |all, (trouble, _)| all | trouble)
        };
        Self {
            land: answered(Response::Land),
            back: answered(Response::Return),
            loiter: answered(Response::Loiter),
        }
    }

    /// The gravest response to `troubles`.
    #[inline]
    pub fn to(&self, troubles: Troubles) -> Response {
        if troubles.intersects(self.land) {
            Response::Land
        } else if troubles.intersects(self.back) {
            Response::Return
        } else if troubles.intersects(self.loiter) {
            Response::Loiter
        } else {
            Response::Continue
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_several_the_gravest_is_done() {
        let responses = Responses {
            link: Response::Return,
            battery: Response::Land,
            ..Responses::default()
        };
        let to = |troubles| Rules::new(&responses).to(troubles);
        assert_eq!(to(Troubles::empty()), Response::Continue);
        assert_eq!(to(Troubles::AIR), Response::Continue);
        assert_eq!(to(Troubles::LINK | Troubles::ABORT), Response::Return);
        assert_eq!(to(Troubles::all()), Response::Land);
    }
}
