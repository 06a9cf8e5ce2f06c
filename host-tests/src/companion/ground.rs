//! A ground station at a companion: its mission is the pilot's.

use alula::mission::{Item, Pass, Until};
use alula::ned::Ned;
use alula_bridges::companion::messages::{MISSION_ITEM_INT_DATA, MavCmd, MavFrame, MavSeverity};
use alula_bridges::companion::{Change, Companion, GroundStation, MavHeader, MavMessage, Shown};
use alula_sim::experiment::plan::Home;

use super::OnPath;

/// The companion to a ground station.
#[derive(Default)]
pub struct Ground {
    station: GroundStation,
    /// Whether the station has the mission of the experiment, or one of its own.
    shown: bool,
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
                self.shown = true;
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
        if let Some(home) = home.filter(|_| !self.shown) {
            self.shown = true;
            let items = pilot.items().iter().enumerate();
            let start = pilot.start().unwrap_or(x);
            let messages = items.map(|(n, item)| message(n as u16, item, home, start));
            self.station.show(messages.collect());
        }
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

/// An item of number `seq` as a station draws it, of a mission that is counted from `start` in the autopilot's frame. A waypoint that is flown over is one
/// that is passed: messages do not tell them apart.
fn message(seq: u16, item: &Item, home: Home, start: Ned) -> MISSION_ITEM_INT_DATA {
    let mut message = MISSION_ITEM_INT_DATA {
        seq,
        frame: MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT,
        param4: f32::NAN,
        target_system: 0,
        target_component: 0,
        autocontinue: 1,
        ..MISSION_ITEM_INT_DATA::default()
    };
    let mut place = None;
    message.command = match *item {
        Item::TakeOff { height } => {
            place = Some(Ned::new(0.0, 0.0, -height));
            MavCmd::MAV_CMD_NAV_VTOL_TAKEOFF
        }
        Item::Waypoint { place: at, pass } => {
            place = Some(at);
            if let Pass::Hover(time) = pass {
                message.param1 = time;
            }
            MavCmd::MAV_CMD_NAV_WAYPOINT
        }
        Item::Loiter {
            centre,
            radius,
            until,
        } => {
            place = Some(centre);
            message.param3 = radius;
            match until {
                Until::Turns(turns) => {
                    message.param1 = turns;
                    MavCmd::MAV_CMD_NAV_LOITER_TURNS
                }
                Until::Time(time) => {
                    message.param1 = time;
                    MavCmd::MAV_CMD_NAV_LOITER_TIME
                }
                // For ever, or for what MAVLink has no command of.
                _ => MavCmd::MAV_CMD_NAV_LOITER_UNLIM,
            }
        }
        Item::Speed(speed) => {
            message.param2 = speed;
            message.frame = MavFrame::MAV_FRAME_MISSION;
            MavCmd::MAV_CMD_DO_CHANGE_SPEED
        }
        Item::Altitude { down } => {
            message.z = -down - start.down;
            MavCmd::MAV_CMD_NAV_CONTINUE_AND_CHANGE_ALT
        }
        Item::Land { place: at } => {
            place = at;
            MavCmd::MAV_CMD_NAV_VTOL_LAND
        }
        Item::Return => MavCmd::MAV_CMD_NAV_RETURN_TO_LAUNCH,
        // What MAVLink has no command of.
        _ => MavCmd::MAV_CMD_USER_1,
    };
    if let Some(at) = place {
        let at = at + start;
        let [lat, lon, _] = home.global([at.north, at.east, at.down].map(f64::from));
        let degrees = |x: f64| (x * 1e7).round() as i32;
        (message.x, message.y, message.z) = (degrees(lat), degrees(lon), -at.down);
    }
    message
}
