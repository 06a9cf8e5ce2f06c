//! The companion as a vehicle to a ground station: where it is, and its mission, by MAVLink's mission protocol
//! (<https://mavlink.io/en/services/mission.html>).
//!
//! Of two messages that mean the same, the vehicle asks for items as integers and takes either. Whatever is lost is asked for again. Items are
//! checked as they come, so that the one that is refused is the one that the answer is to.

use alula::ned::Ned;
use mavlink::dialects::ardupilotmega::{
    COMMAND_ACK_DATA, GLOBAL_POSITION_INT_DATA, HEARTBEAT_DATA, MISSION_ACK_DATA,
    MISSION_COUNT_DATA, MISSION_CURRENT_DATA, MISSION_ITEM_INT_DATA, MISSION_REQUEST_INT_DATA,
    MavAutopilot, MavCmd, MavMissionResult, MavModeFlag, MavResult, MavSeverity, MavState, MavType,
    STATUSTEXT_DATA,
};

use super::{MavHeader, MavMessage, milliseconds};

/// A mission as it is stored.
pub type MissionItems = Vec<MISSION_ITEM_INT_DATA>;

/// Why an item is refused: the code, and a sentence for the person at the station.
pub type Refused = (MavMissionResult, String);

/// What a ground station has changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// It has uploaded another mission, or cleared it.
    Mission,
    /// It wants this item, counted from 0, to be flown now.
    Current(u16),
}

/// What is told to the station.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shown {
    /// Latitude and longitude \[°\], altitude over the sea \[m\], if they are known.
    pub global: Option<[f64; 3]>,
    /// Height over the origin \[m\].
    pub height: f32,
    /// Velocity [m/s].
    pub velocity: Ned,
    /// Course \[°\], 0 to 360.
    pub course: f32,
    /// Whether it is armed.
    pub armed: bool,
    /// The item that is flown.
    pub item: u16,
}

/// The vehicle's side of the protocol.
#[derive(Default)]
pub struct GroundStation {
    items: MissionItems,
    upload: Option<Upload>,
    /// What is still to be said.
    answers: Vec<MavMessage>,
    change: Option<Change>,
    /// When it says again where it is, and that it is there \[s\].
    next: [f64; 2],
}

/// A mission on its way from a station.
struct Upload {
    from: (u8, u8),
    count: u16,
    items: MissionItems,
    /// When the next item is asked for again \[s\], and how often it still is.
    again: f64,
    tries: u32,
}

/// Time \[s\] after which an item is asked for again, and how often it is.
const AGAIN: f64 = 0.25;
const TRIES: u32 = 20;
/// Period \[s\] of the position, and of the heartbeat with the current item.
const POSITION: f64 = 0.25;
const HEARTBEAT: f64 = 1.0;

impl GroundStation {
    /// Header of its messages: to a ground station it is an autopilot.
    pub const HEADER: MavHeader = MavHeader {
        system_id: 1,
        component_id: 1,
        sequence: 0,
    };

    /// The mission.
    #[must_use]
    pub fn items(&self) -> &[MISSION_ITEM_INT_DATA] {
        &self.items
    }

    /// Has this mission, which no station has uploaded.
    pub fn show(&mut self, items: MissionItems) {
        self.items = items;
    }

    /// What has been changed since the last call.
    pub fn change(&mut self) -> Option<Change> {
        self.change.take()
    }

    /// Says something to the person at the station.
    pub fn say(&mut self, severity: MavSeverity, text: &str) {
        self.answers.push(MavMessage::STATUSTEXT(STATUSTEXT_DATA {
            severity,
            text: text.chars().take(50).collect::<String>().as_str().into(),
        }));
    }

    fn acknowledge(
        &mut self,
        (target_system, target_component): (u8, u8),
        mavtype: MavMissionResult,
    ) {
        self.answers.push(MavMessage::MISSION_ACK(MISSION_ACK_DATA {
            target_system,
            target_component,
            mavtype,
        }));
    }

    /// Asks for the next item of the upload.
    fn ask(&mut self, now: f64) {
        if let Some(upload) = &mut self.upload {
            upload.again = now + AGAIN;
            let (target_system, target_component) = upload.from;
            let seq = upload.items.len() as u16;
            self.answers
                .push(MavMessage::MISSION_REQUEST_INT(MISSION_REQUEST_INT_DATA {
                    seq,
                    target_system,
                    target_component,
                }));
        }
    }

    /// Takes a message that arrived `now` \[s\]. `check` is asked whether a mission that begins with these items is flown.
    #[expect(
        deprecated,
        reason = "stations still send MISSION_REQUEST and MISSION_SET_CURRENT"
    )]
    pub fn receive(
        &mut self,
        now: f64,
        header: &MavHeader,
        message: &MavMessage,
        mut check: impl FnMut(&[MISSION_ITEM_INT_DATA]) -> Result<(), Refused>,
    ) {
        let Ok(system) = u8::try_from(header.system_id) else {
            return;
        };
        let from = (system, header.component_id);
        let to_us = |system: u8| system == 0 || u32::from(system) == Self::HEADER.system_id;
        match message {
            MavMessage::MISSION_REQUEST_LIST(m) if to_us(m.target_system) => {
                self.answers
                    .push(MavMessage::MISSION_COUNT(MISSION_COUNT_DATA {
                        count: self.items.len() as u16,
                        target_system: from.0,
                        target_component: from.1,
                    }));
            }
            MavMessage::MISSION_REQUEST_INT(m) if to_us(m.target_system) => self.send(m.seq, from),
            MavMessage::MISSION_REQUEST(m) if to_us(m.target_system) => self.send(m.seq, from),
            MavMessage::MISSION_CLEAR_ALL(m) if to_us(m.target_system) => {
                self.upload = None;
                self.store(MissionItems::new());
                self.acknowledge(from, MavMissionResult::MAV_MISSION_ACCEPTED);
            }
            MavMessage::MISSION_SET_CURRENT(m) if to_us(m.target_system) && !self.go_to(m.seq) => {
                self.acknowledge(from, MavMissionResult::MAV_MISSION_INVALID_SEQUENCE);
            }
            MavMessage::COMMAND_LONG(m) if to_us(m.target_system) => {
                let accepted = m.command == MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT
                    && self.go_to(m.param1 as u16);
                self.answers.push(MavMessage::COMMAND_ACK(COMMAND_ACK_DATA {
                    command: m.command,
                    result: match accepted {
                        true => MavResult::MAV_RESULT_ACCEPTED,
                        false => MavResult::MAV_RESULT_UNSUPPORTED,
                    },
                }));
            }
            MavMessage::MISSION_COUNT(m) if to_us(m.target_system) => {
                // A count that comes twice does not begin anew what has begun.
                let same = |upload: &Upload| upload.from == from && upload.count == m.count;
                if m.count == 0 {
                    self.upload = None;
                    self.store(MissionItems::new());
                    self.acknowledge(from, MavMissionResult::MAV_MISSION_ACCEPTED);
                } else if usize::from(m.count) > alula::mission::CAPACITY {
                    self.acknowledge(from, MavMissionResult::MAV_MISSION_NO_SPACE);
                } else if !self.upload.as_ref().is_some_and(same) {
                    self.upload = Some(Upload {
                        from,
                        count: m.count,
                        items: MissionItems::new(),
                        again: now,
                        tries: TRIES,
                    });
                    self.ask(now);
                }
            }
            MavMessage::MISSION_ITEM_INT(m) if to_us(m.target_system) => {
                self.take(now, from, m, &mut check);
            }
            _ => {}
        }
    }

    /// Whether there is such an item, to go to.
    fn go_to(&mut self, item: u16) -> bool {
        let there = usize::from(item) < self.items.len();
        if there {
            self.change = Some(Change::Current(item));
        }
        there
    }

    /// Sends an item.
    fn send(&mut self, seq: u16, from: (u8, u8)) {
        match self.items.get(usize::from(seq)) {
            Some(item) => self
                .answers
                .push(MavMessage::MISSION_ITEM_INT(MISSION_ITEM_INT_DATA {
                    seq,
                    target_system: from.0,
                    target_component: from.1,
                    ..*item
                })),
            None => self.acknowledge(from, MavMissionResult::MAV_MISSION_INVALID_SEQUENCE),
        }
    }

    /// Takes an item of an upload.
    fn take(
        &mut self,
        now: f64,
        from: (u8, u8),
        item: &MISSION_ITEM_INT_DATA,
        check: &mut impl FnMut(&[MISSION_ITEM_INT_DATA]) -> Result<(), Refused>,
    ) {
        let Some(upload) = self.upload.as_mut().filter(|upload| upload.from == from) else {
            // The last acknowledgement was lost: what is stored is what came.
            let last = self.items.len().checked_sub(1);
            if last == Some(item.seq.into()) {
                self.acknowledge(from, MavMissionResult::MAV_MISSION_ACCEPTED);
            }
            return;
        };
        // Items that come twice or too late are passed over.
        if usize::from(item.seq) != upload.items.len() {
            return;
        }
        upload.items.push(item.clone());
        upload.tries = TRIES;
        if let Err((result, why)) = check(&upload.items) {
            self.upload = None;
            self.acknowledge(from, result);
            self.say(MavSeverity::MAV_SEVERITY_ERROR, &why);
        } else if upload.items.len() == usize::from(upload.count) {
            let items = std::mem::take(&mut upload.items);
            self.upload = None;
            self.store(items);
            self.acknowledge(from, MavMissionResult::MAV_MISSION_ACCEPTED);
        } else {
            self.ask(now);
        }
    }

    fn store(&mut self, items: MissionItems) {
        self.items = items;
        self.change = Some(Change::Mission);
    }

    /// What is said to the station, `now` \[s\].
    pub fn step(&mut self, now: f64, shown: &Shown) -> Vec<MavMessage> {
        if let Some(upload) = &mut self.upload
            && now >= upload.again
        {
            upload.tries -= 1;
            if upload.tries == 0 {
                let from = upload.from;
                self.upload = None;
                self.acknowledge(from, MavMissionResult::MAV_MISSION_OPERATION_CANCELLED);
            } else {
                self.ask(now);
            }
        }
        let mut said = std::mem::take(&mut self.answers);
        let [position, heartbeat] = &mut self.next;
        if now >= *position {
            *position = now + POSITION;
            said.extend(shown.global.map(|global| shown.position(now, global)));
        }
        if now >= *heartbeat {
            *heartbeat = now + HEARTBEAT;
            said.push(shown.heartbeat());
            said.push(MavMessage::MISSION_CURRENT(MISSION_CURRENT_DATA {
                seq: shown.item,
            }));
        }
        said
    }
}

impl Shown {
    fn heartbeat(&self) -> MavMessage {
        let mut base_mode = MavModeFlag::MAV_MODE_FLAG_AUTO_ENABLED;
        base_mode.set(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED, self.armed);
        MavMessage::HEARTBEAT(HEARTBEAT_DATA {
            custom_mode: 0,
            mavtype: MavType::MAV_TYPE_VTOL_TAILSITTER_DUOROTOR,
            autopilot: MavAutopilot::MAV_AUTOPILOT_GENERIC,
            base_mode,
            system_status: MavState::MAV_STATE_ACTIVE,
            mavlink_version: 3,
        })
    }

    fn position(&self, now: f64, [lat, lon, alt]: [f64; 3]) -> MavMessage {
        let degrees = |x: f64| (x * 1e7).round() as i32;
        let millimetres = |x: f64| (x * 1e3).round() as i32;
        let [vx, vy, vz] = [self.velocity.north, self.velocity.east, self.velocity.down]
            .map(|v| (v * 100.0) as i16);
        MavMessage::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA {
            time_boot_ms: milliseconds(now),
            lat: degrees(lat),
            lon: degrees(lon),
            alt: millimetres(alt),
            relative_alt: millimetres(self.height.into()),
            vx,
            vy,
            vz,
            hdg: (self.course * 100.0) as u16,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mavlink::dialects::ardupilotmega::{
        COMMAND_LONG_DATA, MISSION_CLEAR_ALL_DATA, MISSION_REQUEST_LIST_DATA,
    };

    /// Messages of any station in any order: nothing panics, an upload that stalls ends, and what is stored was checked.
    #[test]
    fn stations_may_send_anything() {
        let mut ground = GroundStation::default();
        let mut state = 9_u64;
        let mut random = |below: u64| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 33) % below
        };
        let (mut stored, mut cancelled) = (0, 0);
        for n in 0..200_000_u32 {
            let now = 0.02 * f64::from(n);
            let header = MavHeader {
                system_id: (250 + random(3)) as u32 as _,
                component_id: random(2) as u8,
                sequence: 0,
            };
            let target_system = random(3) as u8;
            let message = match random(16) {
                0 => MavMessage::MISSION_REQUEST_LIST(MISSION_REQUEST_LIST_DATA {
                    target_system,
                    ..MISSION_REQUEST_LIST_DATA::default()
                }),
                1 => MavMessage::MISSION_REQUEST_INT(MISSION_REQUEST_INT_DATA {
                    seq: random(8) as u16,
                    target_system,
                    target_component: 0,
                }),
                2 if random(20) == 0 => MavMessage::MISSION_CLEAR_ALL(MISSION_CLEAR_ALL_DATA {
                    target_system,
                    ..MISSION_CLEAR_ALL_DATA::default()
                }),
                3 => MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
                    command: MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT,
                    param1: f32::from_bits(random(1 << 32) as u32),
                    target_system,
                    ..COMMAND_LONG_DATA::default()
                }),
                4 if random(50) == 0 => MavMessage::MISSION_COUNT(MISSION_COUNT_DATA {
                    count: random(140) as u16 % (1 + random(140) as u16),
                    target_system,
                    target_component: 0,
                }),
                5.. if random(400) > 0 => MavMessage::MISSION_ITEM_INT(MISSION_ITEM_INT_DATA {
                    seq: ground
                        .upload
                        .as_ref()
                        .map_or(random(9) as u16, |u| u.items.len() as u16),
                    target_system,
                    ..MISSION_ITEM_INT_DATA::default()
                }),
                _ => continue,
            };
            let refuses = random(400) == 0;
            ground.receive(now, &header, &message, |items| match refuses {
                true => Err((
                    MavMissionResult::MAV_MISSION_INVALID,
                    format!("item {}", items.len()),
                )),
                false => Ok(()),
            });
            // Now and then nobody answers for a while.
            let silent = if random(3000) == 0 { 100 } else { 1 };
            for k in 0..silent {
                for said in ground.step(now + 0.1 * f64::from(k), &Shown::default()) {
                    if let MavMessage::MISSION_ACK(m) = said {
                        let gone = MavMissionResult::MAV_MISSION_OPERATION_CANCELLED;
                        cancelled += u32::from(m.mavtype == gone);
                    }
                }
            }
            stored += u32::from(ground.change() == Some(Change::Mission));
            assert!(ground.items().len() <= alula::mission::CAPACITY);
        }
        assert!(stored > 100 && cancelled > 0, "{stored} {cancelled}");
    }
}
