//! Before a flight: what an autopilot says of itself, and whether it can be flown so.
//!
//! [`Preflight`] connects, asks for parameters, watches the streams, and judges. What is judged is what flights on the real programs were lost by.

use std::collections::BTreeMap;

use super::detector::BREAKER;
use super::inbox::Inbox;
use super::{Kind, MavHeader, MavMessage, Parameters, Turning, outbox, parameters};

/// What is believed of the vehicle, against which its autopilot is held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Believed {
    /// Share of the throttle that holds the weight.
    pub hover_thrust: f64,
    /// What turns it.
    pub turning: Turning,
    /// Whether PX4 is asked for attitudes, and not for rates.
    pub attitudes: bool,
}

/// How a finding is to be taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Weight {
    /// As it should be.
    Good,
    /// To be known.
    Remark,
    /// No flight.
    NoGo,
}

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// How it is to be taken.
    pub weight: Weight,
    /// What it is, and why it matters.
    pub what: String,
    /// What is to be changed: a parameter with its value, or the like.
    pub change: Option<String>,
}

impl Finding {
    fn new(weight: Weight, what: impl Into<String>, change: Option<String>) -> Self {
        Self {
            weight,
            what: what.into(),
            change,
        }
    }
}

/// What the streams were like.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Streams {
    /// Rates of attitude and position, and of the accelerometer \[Hz\].
    pub attitude_hz: f64,
    /// See there.
    pub motion_hz: f64,
    /// See there.
    pub force_hz: f64,
    /// Age of the state, by the autopilot's clock: the greatest \[s\].
    pub age_s: f64,
}

/// ArduPlane's parameters as they are to be: the one list, which users load.
const QACRO: &str = include_str!("../../../examples/ardupilot/qacro.parm");
/// PX4's.
const OFFBOARD: &str = include_str!("../../../examples/px4/offboard.params");

/// Parameters that an autopilot has under one of two names, by its version: older, newer.
const RENAMED: [(&str, &str); 1] = [("SYSID_MYGCS", "MAV_GCS_SYSID")];

/// Least rates of streams \[Hz\] to fly by, and those that are good.
const RATES: [f64; 2] = [25.0, 40.0];
/// Ages of the state \[s\] up to which it is good, and to be flown by.
const AGES: [f64; 2] = [0.1, 0.2];
/// How far the throttle in hover may be off what the vehicle's file says: the integral makes up for more, but not at once.
const HOVER: f64 = 0.2;

/// What must be as the list says, and what it costs if it is not. Others are of the vehicle's own.
fn why(name: &str) -> &'static str {
    match name {
        "Q_A_ACCEL_R_MAX" | "Q_A_ACCEL_P_MAX" | "Q_A_ACCEL_Y_MAX" => {
            "rates are ramped, as shipped at 300°/s²: the vehicle is lost where it crosses the stall"
        }
        "Q_M_SPIN_ARM" | "Q_M_SPIN_MIN" => {
            "it does not arm with Q_M_SPIN_ARM above Q_M_SPIN_MIN, and idle is thrust that nobody asked for"
        }
        "Q_M_SPIN_MAX" | "Q_THROTTLE_EXPO" => "thrust is not proportional to the throttle",
        "THR_MDL_FAC" => {
            "thrust is proportional to the set-point only where the outputs of the motors are thrusts already, as in PX4's SIH. The nudge in hover measures it"
        }
        "Q_ACRO_RLL_RATE" | "Q_ACRO_PIT_RATE" | "Q_ACRO_YAW_RATE" => {
            "a full stick is another rate than --stick-rates says"
        }
        "SYSID_MYGCS" => "overrides of another system are not taken",
        "VT_ELEV_MC_LOCK" => "elevons are locked in the multicopter state: nothing pitches",
        "VT_TYPE" => "it is no tail-sitter: axes are others",
        "COM_OF_LOSS_T" => "OFFBOARD is left at gaps of a link that are flown through",
        _ => "sticks are taken otherwise than they are sent",
    }
}

/// What another value weighs. PX4's model of the thrust is right or wrong with the motors, which a nudge shows.
fn weighs(name: &str) -> Weight {
    match name {
        "THR_MDL_FAC" => Weight::Remark,
        _ => Weight::NoGo,
    }
}

fn expected(kind: Kind) -> Parameters {
    let text = match kind {
        Kind::Px4 => OFFBOARD,
        Kind::ArduPlane(_) => QACRO,
    };
    Parameters::from_text(text).expect("tested")
}

/// Parameters that are asked for besides.
fn besides(kind: Kind) -> &'static [&'static str] {
    match kind {
        Kind::Px4 => &[
            "MPC_THR_HOVER",
            "FD_FAIL_P",
            "FD_FAIL_R",
            "CBRK_FLIGHTTERM",
            "FW_PR_P",
            "FW_PR_FF",
            "FW_RR_P",
            "FW_RR_FF",
            "FW_ARSP_SCALE_EN",
            "FW_AIRSPD_TRIM",
            "FW_AIRSPD_STALL",
        ],
        Kind::ArduPlane(_) => &["Q_M_THST_HOVER"],
    }
}

/// What PX4 multiplies the elevons' feed-forward with in hover, and their other gains with twice: FW_AIRSPD_TRIM over FW_AIRSPD_STALL.
#[must_use]
pub fn hover_scale(parameters: &Parameters) -> f64 {
    let get = |name| parameters.get(name);
    match (
        get("FW_ARSP_SCALE_EN"),
        get("FW_AIRSPD_TRIM"),
        get("FW_AIRSPD_STALL"),
    ) {
        (Some(scaled), Some(trim), Some(stall)) if scaled != 0.0 => trim / stall.max(0.1),
        _ => 1.0,
    }
}

/// What PX4's failure detector makes of a flight in the multicopter state: in cruise pitch is near −90° there, and in a bank roll is anything. It looks where
/// PX4 controls the attitude: at attitude set-points throughout, and at rates from where OFFBOARD ends on.
fn failures(parameters: &Parameters, attitudes: bool) -> Option<Finding> {
    let limits = [("FD_FAIL_P", 90.0), ("FD_FAIL_R", 180.0)].into_iter();
    let seen = limits.filter_map(|(name, most)| {
        let angle = parameters.get(name)?;
        (angle > 0.0 && angle < most).then_some((name, angle))
    });
    let seen: Vec<(&str, f64)> = seen.collect();
    if seen.is_empty() {
        return None;
    }
    let join = |words: Vec<String>| words.join(" and ");
    let limits = join(
        seen.iter()
            .map(|(name, angle)| format!("{name} is {angle}°"))
            .collect(),
    );
    let change = join(seen.iter().map(|(name, _)| format!("{name} 0")).collect());
    let when = match attitudes {
        true => "at attitude set-points beyond",
        false => "where the pilot, or a link that is lost, ends OFFBOARD in cruise",
    };
    Some(match parameters.get("CBRK_FLIGHTTERM") {
        Some(BREAKER) => Finding::new(
            Weight::Remark,
            format!("{limits}: PX4 warns {when}; it goes on, as CBRK_FLIGHTTERM is {BREAKER}"),
            None,
        ),
        breaker => {
            let breaker = breaker.map_or("was not told".to_owned(), |value| format!("is {value}"));
            Finding::new(
                Weight::NoGo,
                format!(
                    "{limits}, and CBRK_FLIGHTTERM {breaker}: PX4 ends the flight, motors off, {when}"
                ),
                Some(format!("{change}, or CBRK_FLIGHTTERM {BREAKER}")),
            )
        }
    })
}

/// Judges what is known.
#[must_use]
pub fn judge(
    kind: Kind,
    parameters: &Parameters,
    streams: &Streams,
    believed: &Believed,
) -> Vec<Finding> {
    use Weight::{Good, NoGo, Remark};
    let mut findings = Vec::new();
    let get = |name: &str| {
        let renamed = RENAMED.iter().find(|(old, _)| *old == name);
        parameters.get(name).or_else(|| parameters.get(renamed?.1))
    };
    let mut as_expected = 0;
    for (name, wanted) in expected(kind).iter() {
        // Locks of elevons are of no matter to motors.
        if !believed.turning.elevons && name == "VT_ELEV_MC_LOCK" {
            continue;
        }
        let wanted = match (kind, name) {
            (Kind::ArduPlane(sticks), "Q_ACRO_RLL_RATE") => f64::from(sticks.roll).to_degrees(),
            (Kind::ArduPlane(sticks), "Q_ACRO_PIT_RATE") => f64::from(sticks.pitch).to_degrees(),
            (Kind::ArduPlane(sticks), "Q_ACRO_YAW_RATE") => f64::from(sticks.yaw).to_degrees(),
            _ => wanted,
        };
        let change = Some(match weighs(name) {
            Remark => format!(
                "{name}: none before the nudge of the thrust in hover. At 100 % of a change it is right, at 200 % it is to be more, at 50 % less"
            ),
            _ => format!("{name} {wanted}"),
        });
        match get(name) {
            Some(value) if (value - wanted).abs() <= 1e-3 * wanted.abs().max(1.0) => {
                as_expected += 1;
            }
            Some(value) => findings.push(Finding::new(
                weighs(name),
                format!("{name} is {value}: {}", why(name)),
                change,
            )),
            None => findings.push(Finding::new(
                NoGo,
                format!("{name} was not told: {}", why(name)),
                change,
            )),
        }
    }
    findings.push(Finding::new(
        Good,
        format!("{as_expected} parameters are as they should be"),
        None,
    ));
    if let Kind::ArduPlane(sticks) = kind {
        let full = f64::from(sticks.pitch.min(sticks.yaw).min(sticks.roll));
        let weight = if full < believed.turning.max_rate {
            NoGo
        } else {
            Good
        };
        let change = (weight == NoGo).then(|| {
            let degrees = believed.turning.max_rate.to_degrees().ceil();
            format!(
                "Q_ACRO_RLL_RATE, _PIT_RATE and _YAW_RATE {degrees} and more, and --stick-rates"
            )
        });
        let what = format!(
            "a full stick is {full:.1} rad/s, and the guidance asks for up to {:.1}",
            believed.turning.max_rate
        );
        findings.push(Finding::new(weight, what, change));
    }
    let hover = match kind {
        Kind::Px4 => "MPC_THR_HOVER",
        Kind::ArduPlane(_) => "Q_M_THST_HOVER",
    };
    if let Some(had) = get(hover) {
        let off = (had / believed.hover_thrust - 1.0).abs();
        let weight = if off > HOVER { NoGo } else { Good };
        let change = (weight == NoGo).then(|| {
            format!("{hover} as it hovers; then mass_kg and thrust_to_weight of the vehicle, or --hover-thrust {had:.2}")
        });
        let what = format!(
            "hover takes {had:.2} of the throttle by {hover}, and {:.2} by the vehicle's file",
            believed.hover_thrust
        );
        findings.push(Finding::new(weight, what, change));
    }
    if kind == Kind::Px4 {
        let scale = hover_scale(parameters);
        let gains = [
            ("FW_PR_P", 2),
            ("FW_PR_FF", 1),
            ("FW_RR_P", 2),
            ("FW_RR_FF", 1),
        ]
        .map(|(name, power)| {
            get(name).map(|value| {
                format!(
                    "{name} {value:.3}, {:.3} in hover",
                    value * scale.powi(power)
                )
            })
        });
        let gains: Vec<String> = gains.into_iter().flatten().collect();
        if believed.turning.elevons && !gains.is_empty() {
            findings.push(Finding::new(
                Remark,
                format!(
                    "elevons follow {}, and not MC_PITCHRATE_*: with more thrust there is more slipstream and more loop gain. The nudge in hover measures the \
                     loop",
                    gains.join(", ")
                ),
                None,
            ));
        }
        findings.extend(failures(parameters, believed.attitudes));
    }
    for (what, rate, needed) in [
        ("attitudes", streams.attitude_hz, true),
        ("positions", streams.motion_hz, true),
        ("specific forces", streams.force_hz, false),
    ] {
        let [least, good] = RATES;
        let weight = match rate {
            rate if rate >= good => Good,
            rate if rate >= least || !needed => Remark,
            _ => NoGo,
        };
        let change = (weight != Good).then(|| {
            "the rate of the stream: SR*_ or MAV_*_RATE of this link, or a faster baud rate"
                .to_owned()
        });
        findings.push(Finding::new(
            weight,
            format!("{what} at {rate:.0} Hz"),
            change,
        ));
    }
    let [good, most] = AGES;
    let weight = match streams.age_s {
        age if age <= good => Good,
        age if age <= most => Remark,
        _ => NoGo,
    };
    let change = (weight != Good)
        .then(|| "a link that does not queue, a machine that is not busy".to_owned());
    findings.push(Finding::new(
        weight,
        format!("the state is up to {:.0} ms old", 1e3 * streams.age_s),
        change,
    ));
    findings
}

/// Time \[s\] for which streams are watched, and after which a parameter is asked for again; how often.
const WATCHED: f64 = 4.0;
const AGAIN: f64 = 0.5;
const TRIES: u32 = 8;

/// The state machine.
pub struct Preflight {
    kind: Kind,
    believed: Believed,
    inbox: Inbox,
    parameters: Parameters,
    /// Names that are asked for, and how often they were.
    asked: BTreeMap<String, u32>,
    next: f64,
    since: Option<f64>,
    counts: [u32; 3],
    age: f64,
}

impl Preflight {
    /// One that waits for an autopilot.
    #[must_use]
    pub fn new(kind: Kind, believed: Believed) -> Self {
        let listed = expected(kind);
        let names = listed.iter().map(|(name, _)| name);
        let renamed = RENAMED.iter().map(|(_, new)| *new);
        let renamed = renamed.filter(|_| kind != Kind::Px4);
        let names = names.chain(besides(kind).iter().copied()).chain(renamed);
        Self {
            kind,
            believed,
            inbox: Inbox::new(kind),
            asked: names.map(|name| (name.to_owned(), 0)).collect(),
            parameters: Parameters::default(),
            next: f64::NEG_INFINITY,
            since: None,
            counts: [0; 3],
            age: 0.0,
        }
    }

    /// Header of its messages: the companion's.
    #[must_use]
    pub fn header(&self) -> MavHeader {
        MavHeader {
            system_id: self.kind.own_system().into(),
            component_id: 191,
            sequence: 0,
        }
    }

    /// Takes a message that arrived `now` \[s\].
    pub fn receive(&mut self, now: f64, header: &MavHeader, message: &MavMessage) {
        self.inbox.take(now, header, message);
        if self.inbox.system != Some(header.system_id) {
            return;
        }
        match message {
            MavMessage::PARAM_VALUE(value) => self.parameters.take(self.kind, value),
            MavMessage::ATTITUDE_QUATERNION(_) => self.counts[0] += 1,
            MavMessage::LOCAL_POSITION_NED(_) => self.counts[1] += 1,
            MavMessage::HIGHRES_IMU(_) => self.counts[2] += 1,
            _ => {}
        }
    }

    /// One step, `now` \[s\]: messages to send.
    pub fn step(&mut self, now: f64) -> Vec<MavMessage> {
        let target = self.inbox.system.and_then(|system| system.try_into().ok());
        let Some(target) = target else {
            return match now >= self.next {
                true => {
                    self.next = now + 1.0;
                    vec![outbox::heartbeat()]
                }
                false => Vec::new(),
            };
        };
        if self.since.is_some_and(|since| now > since + 1.0) {
            let age = self.inbox.age_by_clock(now);
            self.age = self.age.max(if age.is_finite() { age } else { 0.0 });
        }
        if self.since.is_some() && now < self.next {
            return Vec::new();
        }
        if self.since.is_none() {
            // Streams that were asked for take a second to come.
            self.since = Some(now);
        }
        if self.since.is_some_and(|since| now - since < 1.0) {
            self.counts = [0; 3];
        }
        self.next = now + AGAIN;
        let mut messages = vec![outbox::heartbeat(), outbox::time(now)];
        messages.extend(outbox::requests_of_state(target));
        for (name, tries) in &mut self.asked {
            if self.parameters.get(name).is_none() && *tries < TRIES {
                *tries += 1;
                messages.push(parameters::request(target, name));
            }
        }
        messages
    }

    /// What was found, once everything was looked at.
    #[must_use]
    pub fn findings(&self, now: f64) -> Option<Vec<Finding>> {
        let watched = now - self.since? - 1.0;
        let missing =
            |(name, tries): (&String, &u32)| self.parameters.get(name).is_none() && *tries < TRIES;
        if watched < WATCHED || self.asked.iter().any(missing) {
            return None;
        }
        let rate = |count: u32| f64::from(count) / watched;
        let [attitude_hz, motion_hz, force_hz] = self.counts.map(rate);
        let streams = Streams {
            attitude_hz,
            motion_hz,
            force_hz,
            age_s: self.age,
        };
        Some(judge(self.kind, &self.parameters, &streams, &self.believed))
    }
}

/// Whether a flight may begin after these findings.
#[must_use]
pub fn is_go(findings: &[Finding]) -> bool {
    findings
        .iter()
        .all(|finding| finding.weight != Weight::NoGo)
}
