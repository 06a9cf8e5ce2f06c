//! A ground station that uploads, downloads, moves and clears the mission of a companion, over links that lose messages.

use alula_bridges::companion::messages::{
    COMMAND_LONG_DATA, MISSION_ACK_DATA, MISSION_CLEAR_ALL_DATA, MISSION_COUNT_DATA,
    MISSION_ITEM_INT_DATA, MISSION_REQUEST_INT_DATA, MISSION_REQUEST_LIST_DATA, MavCmd, MavFrame,
    MavMissionResult,
};
use alula_bridges::companion::{
    Autopilot, Companion, Kind, MavHeader, MavMessage, Settings, Stage,
};
use alula_sil::companion::{Craft, Ground, Lead, OnPath, settings};
use alula_sim::experiment::plan::Home;
use alula_sim::experiment::{Document, Experiment, V3};

use super::link::{BAD, Channel, GOOD, PLANT, Quality, RATE};

/// Where the simulated autopilot counts from.
const HOME: Home = Home([47.397742, 8.545594, 488.0]);

/// What is done next.
#[derive(Clone, Debug)]
enum Job {
    Upload(Vec<MISSION_ITEM_INT_DATA>),
    Download,
    GoTo(u16),
    Clear,
}

/// A ground station: one job at a time, each message repeated until it is answered.
struct Station {
    job: Option<Job>,
    again: f64,
    /// Of a download: how many there are, and those that came.
    count: Option<u16>,
    came: Vec<MISSION_ITEM_INT_DATA>,
    /// The item that was asked for last, and the answer.
    asked: u16,
    result: Option<MavMissionResult>,
    /// What the vehicle says.
    current: u16,
    places: usize,
    texts: Vec<String>,
}

const HEADER: MavHeader = MavHeader {
    system_id: 255,
    component_id: 190,
    sequence: 0,
};

impl Station {
    fn new() -> Self {
        Self {
            job: None,
            again: 0.0,
            count: None,
            came: Vec::new(),
            asked: 0,
            result: None,
            current: 0,
            places: 0,
            texts: Vec::new(),
        }
    }

    fn begin(&mut self, job: Job) {
        assert!(self.job.is_none(), "{:?}", self.job);
        (self.count, self.result, self.again) = (None, None, 0.0);
        self.came.clear();
        self.job = Some(job);
    }

    /// What is sent again while nothing is answered.
    fn repeated(&self) -> Option<MavMessage> {
        let (target_system, target_component) = (1, 1);
        Some(match self.job.as_ref()? {
            Job::Upload(items) => MavMessage::MISSION_COUNT(MISSION_COUNT_DATA {
                count: items.len() as u16,
                target_system,
                target_component,
            }),
            Job::Download => match self.count {
                None => MavMessage::MISSION_REQUEST_LIST(MISSION_REQUEST_LIST_DATA {
                    target_system,
                    target_component,
                }),
                Some(_) => MavMessage::MISSION_REQUEST_INT(MISSION_REQUEST_INT_DATA {
                    seq: self.came.len() as u16,
                    target_system,
                    target_component,
                }),
            },
            Job::GoTo(item) => MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
                command: MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT,
                param1: (*item).into(),
                target_system,
                target_component,
                ..COMMAND_LONG_DATA::default()
            }),
            Job::Clear => MavMessage::MISSION_CLEAR_ALL(MISSION_CLEAR_ALL_DATA {
                target_system,
                target_component,
            }),
        })
    }

    fn step(&mut self, now: f64) -> Option<MavMessage> {
        if now < self.again {
            return None;
        }
        self.again = now + 0.7;
        self.repeated()
    }

    /// Takes a message of the vehicle; what is sent at once.
    fn receive(&mut self, now: f64, message: &MavMessage) -> Option<MavMessage> {
        match (message, &self.job) {
            (MavMessage::MISSION_REQUEST_INT(m), Some(Job::Upload(items))) => {
                (self.asked, self.again) = (m.seq, now + 0.7);
                Some(MavMessage::MISSION_ITEM_INT(MISSION_ITEM_INT_DATA {
                    target_system: 1,
                    target_component: 1,
                    ..items[usize::from(m.seq)].clone()
                }))
            }
            (MavMessage::MISSION_ACK(m), Some(Job::Upload(_) | Job::Clear)) => {
                (self.result, self.job) = (Some(m.mavtype), None);
                None
            }
            (MavMessage::MISSION_COUNT(m), Some(Job::Download)) => {
                self.count = Some(m.count);
                self.again = now;
                None
            }
            (MavMessage::MISSION_ITEM_INT(m), Some(Job::Download)) => {
                if usize::from(m.seq) == self.came.len() {
                    self.came.push(m.clone());
                }
                self.again = now;
                (self.count == Some(self.came.len() as u16)).then(|| {
                    self.job = None;
                    MavMessage::MISSION_ACK(MISSION_ACK_DATA {
                        target_system: 1,
                        target_component: 1,
                        mavtype: MavMissionResult::MAV_MISSION_ACCEPTED,
                    })
                })
            }
            (MavMessage::COMMAND_ACK(_), Some(Job::GoTo(_))) => {
                self.job = None;
                None
            }
            (MavMessage::MISSION_CURRENT(m), _) => {
                self.current = m.seq;
                None
            }
            (MavMessage::GLOBAL_POSITION_INT(m), _) => {
                assert!((m.lat - 473_977_420).abs() < 200_000, "{m:?}");
                self.places += 1;
                None
            }
            (MavMessage::STATUSTEXT(m), _) => {
                self.texts
                    .push(m.text.to_str().unwrap_or_default().to_owned());
                None
            }
            _ => None,
        }
    }
}

/// An item at a place north, east and above \[m\].
fn at(
    seq: u16,
    command: MavCmd,
    params: [f32; 4],
    [north, east, up]: [f64; 3],
) -> MISSION_ITEM_INT_DATA {
    let [lat, lon, _] = HOME.global([north, east, -up]);
    let [param1, param2, param3, param4] = params;
    let degrees = |x: f64| (x * 1e7).round() as i32;
    MISSION_ITEM_INT_DATA {
        param1,
        param2,
        param3,
        param4,
        x: degrees(lat),
        y: degrees(lon),
        z: up as f32,
        seq,
        command,
        target_system: 1,
        target_component: 1,
        frame: MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT,
        current: 0,
        autocontinue: 1,
    }
}

fn experiment() -> Experiment {
    let mut document = Document::load("survey").unwrap();
    for setting in [
        "duration_s=130",
        "initial.thrust_n=98.1",
        "weather.turbulence.wind_at_20_ft_m_s=0.001",
    ] {
        document.assign(setting).unwrap();
    }
    document.checked().unwrap()
}

/// What is seen of a flight every plant step.
struct Scene<'a> {
    now: f64,
    station: &'a mut Station,
    vehicle: V3,
    speed: f64,
}

/// Flies a companion with a ground station behind a link of `quality`; `script` acts at every step. How the flight stands at the end.
fn flies(quality: Quality, duration: f64, mut script: impl FnMut(Scene)) -> Stage {
    let experiment = experiment();
    let mut pilot = OnPath::new(&experiment, Lead::Path(None)).unwrap();
    let mut companion = Companion::new(Settings {
        engage: true,
        ..settings(&experiment, None).unwrap()
    });
    let mut autopilot = Autopilot::new(Craft::new(&experiment).unwrap(), Kind::Px4);
    let (mut ground, mut station) = (Ground::new(), Station::new());
    let [mut down, mut up] = [1, 2].map(|seed| Channel::new(GOOD, seed));
    let [mut to_station, mut from_station] = [3, 4].map(|seed| Channel::new(quality, seed));
    for step in 0..(duration * f64::from(PLANT)) as u32 {
        let now = f64::from(step) / f64::from(PLANT);
        for message in autopilot.send(now) {
            down.send(now, Autopilot::<Craft>::HEADER, &message);
        }
        for (header, message) in down.receive(now) {
            companion.receive(now, &header, &message);
        }
        if step % (PLANT / RATE) == 0 {
            for message in companion.step(now, &mut pilot).0 {
                up.send(now, companion.header(), &message);
            }
            for message in ground.step(now, &companion, &pilot) {
                to_station.send(now, Ground::HEADER, &message);
            }
        }
        for (header, message) in up.receive(now) {
            autopilot.receive(now, &header, &message);
        }
        for (header, message) in from_station.receive(now) {
            ground.receive(now, &header, &message, &companion, &mut pilot);
        }
        for (_, message) in to_station.receive(now) {
            let answer = station.receive(now, &message);
            if let Some(answer) = answer {
                from_station.send(now, HEADER, &answer);
            }
        }
        if let Some(message) = station.step(now) {
            from_station.send(now, HEADER, &message);
        }
        autopilot.advance(now, 1.0 / f64::from(PLANT));
        let state = *autopilot.body().spatial();
        script(Scene {
            now,
            station: &mut station,
            vehicle: state.position,
            speed: state.velocity.norm(),
        });
    }
    companion.stage()
}

/// A fifth of the messages is lost each way, and others are late.
fn lossy() -> Quality {
    BAD.losing(0.2)
}

const NONE: [f32; 4] = [0.0, 0.0, 0.0, f32::NAN];

fn survey() -> Vec<MISSION_ITEM_INT_DATA> {
    let by = MavCmd::MAV_CMD_NAV_WAYPOINT;
    vec![
        at(0, MavCmd::MAV_CMD_NAV_VTOL_TAKEOFF, NONE, [0.0, 0.0, 30.0]),
        at(1, by, NONE, [300.0, 0.0, 40.0]),
        at(2, by, NONE, [300.0, 250.0, 40.0]),
        at(
            3,
            MavCmd::MAV_CMD_NAV_LOITER_TURNS,
            [3.0, 0.0, 120.0, 1.0],
            [0.0, 250.0, 40.0],
        ),
        at(4, by, NONE, [-200.0, 0.0, 40.0]),
        at(5, MavCmd::MAV_CMD_NAV_RETURN_TO_LAUNCH, NONE, [0.0; 3]),
    ]
}

/// Uploaded before the flight, read back, flown; in flight another item, then another mission, and at the end none, in which it waits where it is.
#[test]
fn a_station_uploads_reads_moves_and_clears_a_mission() {
    let hover = vec![at(
        0,
        MavCmd::MAV_CMD_NAV_WAYPOINT,
        [60.0, 0.0, 0.0, f32::NAN],
        [-150.0, 60.0, 25.0],
    )];
    let (mut done, mut read, mut seen) = (0, Vec::new(), Vec::new());
    let (mut there, mut places, mut last) = (None, 0, V3::zeros());
    let stage = flies(lossy(), 115.0, |scene| {
        let Scene {
            now,
            station,
            vehicle,
            speed,
        } = scene;
        (places, last) = (station.places, vehicle);
        if seen.last() != Some(&station.current) {
            seen.push(station.current);
        }
        if (103.0..105.0).contains(&now) {
            there = Some((vehicle - V3::new(-150.0, 60.0, -25.0), speed));
        }
        if station.job.is_none() {
            match done {
                0 if now > 0.5 => station.begin(Job::Upload(survey())),
                1 => station.begin(Job::Download),
                2 => read = station.came.clone(),
                3 if now > 40.0 => station.begin(Job::GoTo(4)),
                4 if now > 50.0 => station.begin(Job::Upload(hover.clone())),
                5 if now > 105.0 => station.begin(Job::Clear),
                _ => return,
            }
            done += 1;
        }
    });
    assert!(matches!(stage, Stage::Flying(_)), "{stage:?}");
    assert_eq!(done, 6);
    // What is read back is what was uploaded, but for NaN, which is not equal to itself.
    let plain = |items: &[MISSION_ITEM_INT_DATA]| -> Vec<_> {
        let items = items.iter();
        items
            .map(|m| (m.seq, m.command, m.x, m.y, m.z, m.param1, m.param3, m.frame))
            .collect()
    };
    assert_eq!(plain(&read), plain(&survey()));
    // The take-off is passed in the air; the station has moved it from the loiter's way to item 4, and then to the other mission.
    assert!(
        seen.windows(2).any(|w| w == [1, 2]) && seen.contains(&4),
        "{seen:?}"
    );
    assert!(!seen.contains(&5), "{seen:?}");
    let (off, speed) = there.unwrap();
    assert!(off.norm() < 2.0 && speed < 0.5, "{off} {speed}");
    // Without a mission it waits there. Of four places a second a fifth is lost.
    let waits = (last - V3::new(-150.0, 60.0, -25.0)).norm();
    assert!(
        waits < 2.0 && (330..400).contains(&places),
        "{waits} {places}"
    );
}

/// A station that has uploaded nothing draws the mission of the experiment, at its places; what it reads it may upload again as it is.
#[test]
fn the_experiments_own_mission_is_drawn_and_uploaded_again() {
    let (mut step, mut read, mut result) = (0, Vec::new(), None);
    flies(GOOD, 12.0, |scene| {
        let Scene { now, station, .. } = scene;
        if station.job.is_some() {
            return;
        }
        match step {
            0 if now > 1.0 => station.begin(Job::Download),
            1 => {
                read = station.came.clone();
                station.begin(Job::Upload(read.clone()));
            }
            2 => result = station.result,
            _ => return,
        }
        step += 1;
    });
    assert_eq!(result, Some(MavMissionResult::MAV_MISSION_ACCEPTED));
    // Take-off, ten waypoints and the return.
    assert_eq!(read.len(), 12);
    assert_eq!(read[11].command, MavCmd::MAV_CMD_NAV_RETURN_TO_LAUNCH);
    let expected = at(2, MavCmd::MAV_CMD_NAV_WAYPOINT, NONE, [800.0, -100.0, 80.0]);
    let of = |m: &MISSION_ITEM_INT_DATA| (m.seq, m.command, m.x, m.y, m.z);
    let (drawn, wanted) = (of(&read[2]), of(&expected));
    // A centimetre of rounding.
    assert!(
        (drawn.2 - wanted.2).abs() < 2 && (drawn.3 - wanted.3).abs() < 2,
        "{drawn:?} {wanted:?}"
    );
    assert_eq!((drawn.0, drawn.1, drawn.4), (wanted.0, wanted.1, wanted.4));
}

/// Each is refused with the code of the protocol as an answer to the item that is wrong, and said; the mission that is there stays.
#[test]
fn what_cannot_be_flown_is_refused_by_item() {
    type Code = MavMissionResult;
    let changed = |item: usize, change: fn(&mut MISSION_ITEM_INT_DATA)| {
        let mut items = survey();
        change(&mut items[item]);
        items
    };
    let many: Vec<_> = (0..200)
        .map(|n| at(n, MavCmd::MAV_CMD_NAV_WAYPOINT, NONE, [100.0, 0.0, 40.0]))
        .collect();
    let wrong = [
        (
            changed(2, |m| m.command = MavCmd::MAV_CMD_NAV_SPLINE_WAYPOINT),
            2,
            Code::MAV_MISSION_UNSUPPORTED,
            "MAV_CMD 82",
        ),
        (
            changed(1, |m| m.frame = MavFrame::MAV_FRAME_GLOBAL_TERRAIN_ALT),
            1,
            Code::MAV_MISSION_UNSUPPORTED_FRAME,
            "frame",
        ),
        (
            changed(3, |m| m.param3 = 0.0),
            3,
            Code::MAV_MISSION_INVALID_PARAM3,
            "radius",
        ),
        (
            changed(3, |m| m.param3 = 20.0),
            3,
            Code::MAV_MISSION_INVALID_PARAM3,
            "turns on",
        ),
        (
            changed(3, |m| m.param1 = -1.0),
            3,
            Code::MAV_MISSION_INVALID_PARAM1,
            "until",
        ),
        (
            changed(4, |m| m.x = 910_000_000),
            4,
            Code::MAV_MISSION_INVALID_PARAM5_X,
            "latitude",
        ),
        (
            changed(4, |m| m.z = f32::NAN),
            4,
            Code::MAV_MISSION_INVALID_PARAM7,
            "altitude",
        ),
        (
            changed(2, |m| m.x = 500_000_000),
            2,
            Code::MAV_MISSION_INVALID_PARAM5_X,
            "place",
        ),
        (
            changed(0, |m| m.z = -5.0),
            0,
            Code::MAV_MISSION_INVALID_PARAM7,
            "height",
        ),
        (
            changed(4, |m| m.command = MavCmd::MAV_CMD_NAV_TAKEOFF),
            4,
            Code::MAV_MISSION_INVALID,
            "take-off",
        ),
        (many, 0, Code::MAV_MISSION_NO_SPACE, ""),
    ];
    let count = wrong.len();
    let mut results = Vec::new();
    let mut begun = 0;
    let mut stored = Vec::new();
    flies(GOOD, 20.0, |scene| {
        let Scene { now, station, .. } = scene;
        if station.job.is_some() || now < 0.5 {
            return;
        }
        if begun > 0 && begun <= count {
            results.push((
                station.asked,
                station.result.unwrap(),
                std::mem::take(&mut station.texts).join("; "),
            ));
        }
        match begun {
            n if n < count => station.begin(Job::Upload(wrong[n].0.clone())),
            n if n == count => station.begin(Job::Upload(survey())),
            n if n == count + 1 => station.begin(Job::Upload(wrong[0].0.clone())),
            n if n == count + 2 => station.begin(Job::Download),
            n if n == count + 3 => stored = station.came.clone(),
            _ => return,
        }
        begun += 1;
    });
    assert_eq!(results.len(), count);
    for ((_, item, code, text), (asked, result, said)) in wrong.iter().zip(&results) {
        assert_eq!(result, code, "{said}");
        if *code != Code::MAV_MISSION_NO_SPACE {
            assert_eq!(asked, item, "{said}");
            assert!(
                said.starts_with(&format!("item {item}: ")) && said.contains(text),
                "{said}"
            );
        }
    }
    assert_eq!(stored.len(), survey().len());
}
