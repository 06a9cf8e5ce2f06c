//! A ground station at a companion: its mission is the pilot's.

use alula_bridges::companion::messages::MavSeverity;
use alula_bridges::companion::{Change, Companion, GroundStation, MavHeader, MavMessage, Shown};
use alula_sim::experiment::plan::Home;

use super::OnPath;

/// The companion to a ground station.
#[derive(Default)]
pub struct Ground {
    station: GroundStation,
    /// What was last said of the mission.
    said: Option<&'static str>,
}

impl Ground {
    /// Header of its messages.
    pub const HEADER: MavHeader = GroundStation::HEADER;

    /// Without a mission of a station's.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes a message of the station that arrived `now` \[s\].
    pub fn receive(
        &mut self,
        now: f64,
        header: &MavHeader,
        message: &MavMessage,
        companion: &Companion,
        pilot: &mut OnPath,
    ) {
        let home = companion.inbox().global_origin.map(Home);
        self.station
            .receive(now, header, message, |items| pilot.check(items, home));
        match self.station.change() {
            Some(Change::Mission) => {
                let items = self.station.items();
                let taken = home.map(|home| pilot.upload(items, home));
                if let Some(Err((_, why))) = taken {
                    self.station.say(MavSeverity::MAV_SEVERITY_ERROR, &why);
                }
            }
            Some(Change::Current(item)) => pilot.go_to(item.into()),
            None => {}
        }
    }

    /// What is said to the station, `now` \[s\].
    pub fn step(&mut self, now: f64, companion: &Companion, pilot: &OnPath) -> Vec<MavMessage> {
        let remark = pilot.remark();
        if self.said != remark {
            self.said = remark;
            if let Some(remark) = remark {
                self.station.say(MavSeverity::MAV_SEVERITY_WARNING, remark);
            }
        }
        let inbox = companion.inbox();
        let Some(motion) = inbox.motion else {
            return self.station.step(now, &Shown::default());
        };
        let (x, velocity) = motion.value;
        let home = inbox.global_origin.map(Home);
        let place = [x.north, x.east, x.down].map(f64::from);
        let course = velocity.east.atan2(velocity.north).to_degrees();
        let shown = Shown {
            global: home.map(|home| home.global(place)),
            height: -x.down,
            velocity,
            course: course.rem_euclid(360.0),
            armed: inbox.armed,
            item: pilot.item().try_into().unwrap_or(u16::MAX),
        };
        self.station.step(now, &shown)
    }
}
