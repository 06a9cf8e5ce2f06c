//! The guidance as a companion's pilot, along a path, on a mission, or by what comes over the link.
//!
//! The path begins where the vehicle is when the flight begins, in the axes of its own north: [`Lead::Path`] says where that points. What is told
//! is turned into these axes, and the record is in them.

use alula::aero::Aerodynamics;
use alula::mission::{
    Activity, Gate, Item, ItemProblem, MissionError, MissionInput, MissionOutput, Pass,
};
use alula::ned::{BodyAxes, Frd, Ned};
use alula::spatial::{Heading, Orientation, Reference};
use alula::{AngleOfAttack, GuidanceInput, GuidanceOutput};
use alula_bridges::companion::messages::{MISSION_ITEM_INT_DATA, MavMissionResult};
use alula_bridges::companion::{
    Believed, Command, End, Finding, Kind, Nudge, Pilot, Refused, Setpoint, Settings, Told,
    Turning, is_go,
};
use anyhow::ensure;
use nalgebra::{Quaternion, UnitQuaternion};

use alula_sim::controllers::{Answer, Controller, GuidanceSpec, Input};
use alula_sim::experiment::plan::{Home, MavItem, items_flown};
use alula_sim::experiment::{Experiment, Path, State, Target, V3, Vehicle, angle, double, ned};
use alula_sim::flown_mission::{FlownMission, passed};
use alula_sim::reference::wrap;
use alula_sim::simulate::{Record, Step};

/// Speed [m/s] up to which a vehicle hovers.
const SLOW: f32 = 2.0;

/// Settings for flying `experiment`, of whose belief `hover_thrust` is the autopilot's thrust in hover. If it is none, thrust is taken for
/// proportional up to the most.
pub fn settings(experiment: &Experiment, hover_thrust: Option<f64>) -> anyhow::Result<Settings> {
    let spec = experiment.spec()?;
    let weight = spec.belief().unwrap_or(&experiment.vehicle).weight();
    let most = experiment.thrust_limits(None, weight)[1];
    let hover_thrust = hover_thrust.unwrap_or(weight / most);
    ensure!(
        (0.05..=0.95).contains(&hover_thrust),
        "the thrust in hover is {hover_thrust}, must be from 0.05 to 0.95"
    );
    Ok(Settings {
        kind: Kind::Px4,
        weight: weight as f32,
        hover_thrust: hover_thrust as f32,
        engage: false,
        led: false,
        duration: experiment.duration_s,
        timeout: 0.5,
    })
}

/// What a preflight holds an autopilot against: of `experiment`, in hover at this share of the throttle.
pub fn believed(experiment: &Experiment, hover_thrust: f64) -> anyhow::Result<Believed> {
    Ok(Believed {
        hover_thrust,
        turning: turning(experiment)?,
        attitudes: false,
    })
}

/// What the guidance believes of what turns the vehicle.
fn turning(experiment: &Experiment) -> anyhow::Result<Turning> {
    let spec = GuidanceSpec::of(experiment)?;
    let vehicle = spec.vehicle.as_ref().unwrap_or(&experiment.vehicle);
    let limits = experiment.thrust_limits(spec.thrust_n, vehicle.weight());
    let parameters = spec.ruled(&vehicle.parameters(limits), &spec.parameters)?;
    Ok(Turning {
        elevons: vehicle.authority.slipstream_rad_s2 > 0.0,
        max_rate: parameters.max_rate.into(),
        wing: most_by_wing(&vehicle.limited(limits)?),
    })
}

/// Greatest angular acceleration in pitch by the wing in steady level flight [rad/s²]. At an angle of attack the drag is T cos α, and lift with T sin α the weight.
fn most_by_wing(vehicle: &Vehicle) -> f64 {
    let steady = (1..90_u8).filter_map(|degrees| {
        let alpha = f32::from(degrees).to_radians();
        let (sin, cos) = alpha.sin_cos();
        let c = vehicle
            .model()
            .coefficients(AngleOfAttack::from_radians(alpha));
        let square = vehicle.weight() / (vehicle.k_a() * (c.c_l + c.c_d * sin / cos));
        let thrust = vehicle.k_a() * square * c.c_d / cos;
        let speed = square.sqrt();
        // What the actuators add is as much to either side.
        let [least, most] = vehicle.pitch_acceleration(speed * cos, speed * sin, 0.0);
        (thrust <= vehicle.thrust_max()).then_some(0.5 * f64::from(least + most).abs())
    });
    steady.fold(0.0, f64::max)
}

/// By what a flight is led.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lead {
    /// The experiment's path or mission, its north at this heading \[rad\]; the vehicle's at the start if none.
    Path(Option<f32>),
    /// What comes over the link, in its axes.
    Link,
}

/// The guidance on its path.
pub struct OnPath {
    controller: Box<dyn Controller>,
    led: Led,
    /// Heading of the path's north \[rad\], if it is known before the start.
    heading: Option<f32>,
    axes: Axes,
    gravity: f64,
    /// When the path was asked last \[s\], and how fast it goes on since.
    last: (f64, f64),
    /// The attitude θ \[rad\], counted on through full turns.
    theta: f64,
    record: Record,
    /// What is measured in hover before the path is flown, and the lag that is believed \[s\]; none where it is not, or was.
    nudge: Option<Nudge>,
    /// What turns the vehicle, as the guidance believes.
    turning: Turning,
    /// How long that took \[s\], and what came of it.
    nudged: f32,
    findings: Vec<Finding>,
    /// Whether a loop that cannot be flown ends the flight.
    refuses: bool,
}

/// What is flown.
enum Led {
    Path(Path),
    Link,
    Mission(Box<OnMission>),
}

/// A mission, which begins in the air.
struct OnMission {
    run: FlownMission,
    /// What a ground station has uploaded, and where on earth positions are counted from.
    uploaded: Option<(Vec<MISSION_ITEM_INT_DATA>, Home)>,
    /// Of each item the number of the one uploaded that it is of.
    numbers: Vec<usize>,
    /// The start in the autopilot's frame, once it is known.
    start: Option<Ned>,
    last: Option<MissionOutput>,
    /// Thrust commanded last \[N\].
    thrust: f32,
}

/// The axes of a path: the world's, turned to a heading.
#[derive(Clone, Copy, Debug)]
struct Axes {
    cos: f32,
    sin: f32,
}

impl Axes {
    fn new(heading: f32) -> Self {
        let (sin, cos) = heading.sin_cos();
        Self { cos, sin }
    }

    /// A vector of the world in these axes.
    fn of(&self, v: Ned) -> Ned {
        let &Self { cos, sin } = self;
        Ned::new(
            cos * v.north + sin * v.east,
            cos * v.east - sin * v.north,
            v.down,
        )
    }

    /// What is told, in these axes.
    fn told(&self, told: &Told) -> Told {
        let axes: [Ned; 3] = told.orientation.into();
        let orientation = Orientation::try_from(axes.map(|axis| self.of(axis)));
        Told {
            position: self.of(told.position),
            velocity: self.of(told.velocity),
            orientation: orientation.unwrap_or(Orientation::UNKNOWN),
            air: told.air.map(|v| self.of(v)),
            asked: told.asked.map(|(asked, age)| {
                let turned = Setpoint {
                    velocity: self.of(asked.velocity),
                    acceleration: self.of(asked.acceleration),
                    position: asked.position.map(|x| self.of(x)),
                };
                (turned, age)
            }),
            ..*told
        }
    }
}

/// What is to be flown at one step.
struct Asked {
    target: Target,
    /// Whether at its position.
    placed: bool,
    /// Its age \[s\].
    age: f32,
}

impl OnPath {
    /// The guidance of `experiment`, led by `lead`.
    pub fn new(experiment: &Experiment, lead: Lead) -> anyhow::Result<Self> {
        ensure!(
            experiment.controller.kind == "guidance",
            "controller.{}: flies in a plane and holds nothing across it; beside an autopilot flies the guidance",
            experiment.controller.kind
        );
        let (led, heading) = match (lead, experiment.flown_mission()?) {
            (Lead::Path(heading), None) => (Led::Path(experiment.path.path()?), heading),
            (Lead::Path(_), Some(run)) => (
                Led::Mission(Box::new(OnMission {
                    numbers: (0..run.items().len()).collect(),
                    run,
                    uploaded: None,
                    start: None,
                    last: None,
                    thrust: 0.0,
                })),
                Some(0.0),
            ),
            (Lead::Link, _) => (Led::Link, Some(0.0)),
        };
        if let Some(heading) = heading {
            angle("heading", heading.to_degrees().into())?;
        }
        // With a heading of its own at the start it is in no plane, and its guidance turns.
        let mut turned = experiment.clone();
        turned.initial.heading_deg = Some(0.0);
        Ok(Self {
            controller: turned.controller()?,
            led,
            heading,
            axes: Axes::new(heading.unwrap_or_default()),
            gravity: experiment.vehicle.gravity_m_s2,
            last: (0.0, 1.0),
            theta: 0.0,
            record: Record::new(),
            nudge: None,
            turning: turning(experiment)?,
            nudged: 0.0,
            findings: Vec::new(),
            refuses: true,
        })
    }

    /// The same, with the rate loop of an autopilot of this `kind` measured in hover before the path, against the `lag` \[s\] that is believed; the flight is then longer by
    /// [`Nudge::DURATION`]. It ends there if the loop cannot be flown, unless it goes on `despite` that. A flight that begins at speed is flown at once.
    #[must_use]
    pub fn nudged(mut self, kind: Kind, lag: f64, despite: bool) -> Self {
        if matches!(self.led, Led::Path(_)) {
            self.nudge = Some(Nudge::new(kind, lag, self.turning));
        }
        self.refuses = !despite;
        self
    }

    /// Whether the rate loop is being measured.
    pub fn is_nudging(&self) -> bool {
        self.nudge.is_some()
    }

    /// What was found of the rate loop.
    pub fn findings(&self) -> &[Finding] {
        &self.findings
    }

    /// What was told and answered. Of the truth nothing is known but what the autopilot says.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// Takes the mission that a ground station has uploaded, from the first item on; `home` is where the autopilot's positions are counted from.
    ///
    /// # Errors
    /// As [`check`](Self::check).
    pub fn upload(&mut self, items: &[MISSION_ITEM_INT_DATA], home: Home) -> Result<(), Refused> {
        let mission = self.mission_mut()?;
        let start = mission.start.unwrap_or_default();
        let (numbers, items_of_core) = mission.converted(items, home, start)?;
        let made = mission.run.mission(&items_of_core);
        let made = made.map_err(|e| of_item(&e, &numbers))?;
        mission.run.replace(made, 0);
        (mission.numbers, mission.uploaded) = (numbers, Some((items.to_vec(), home)));
        Ok(())
    }

    /// Whether a mission that begins with `items` is flown.
    ///
    /// # Errors
    /// The code of the protocol and a sentence about the first item that is not.
    pub fn check(
        &self,
        items: &[MISSION_ITEM_INT_DATA],
        home: Option<Home>,
    ) -> Result<(), Refused> {
        let Led::Mission(mission) = &self.led else {
            return Err(no_mission());
        };
        let unknown = || {
            let why = "where on earth the vehicle is is not known yet";
            (MavMissionResult::MAV_MISSION_DENIED, why.to_owned())
        };
        let start = mission.start.unwrap_or_default();
        let (numbers, items) = mission.converted(items, home.ok_or_else(unknown)?, start)?;
        let made = mission.run.mission(&items);
        made.map(|_| ()).map_err(|e| of_item(&e, &numbers))
    }

    /// Goes to the item of this number, of those that were uploaded.
    pub fn go_to(&mut self, number: usize) {
        if let Led::Mission(mission) = &mut self.led {
            let item = mission.numbers.iter().position(|of| *of >= number);
            mission.run.go_to(item.unwrap_or(mission.numbers.len()));
        }
    }

    /// The number of the item that is flown.
    pub fn item(&self) -> usize {
        let Led::Mission(mission) = &self.led else {
            return 0;
        };
        let item = mission.last.map_or(0, |said| said.progress.item.into());
        let past = mission.numbers.last().map_or(0, |last| last + 1);
        mission.numbers.get(item).copied().unwrap_or(past)
    }

    /// The items of the mission, none on a path, and where they are counted from in the autopilot's frame, once that is known.
    pub fn items(&self) -> &[Item] {
        match &self.led {
            Led::Mission(mission) => mission.run.items(),
            _ => &[],
        }
    }

    /// See [`items`](Self::items).
    pub fn start(&self) -> Option<Ned> {
        match &self.led {
            Led::Mission(mission) => mission.start,
            _ => None,
        }
    }

    /// What of the mission cannot be done as asked.
    pub fn remark(&self) -> Option<&'static str> {
        match &self.led {
            Led::Mission(mission) => Some(mission.last?.remark?.name()),
            _ => None,
        }
    }

    fn mission_mut(&mut self) -> Result<&mut OnMission, Refused> {
        match &mut self.led {
            Led::Mission(mission) => Ok(mission),
            _ => Err(no_mission()),
        }
    }

    /// What is to be flown now of a path or over the link.
    fn asked(&mut self, told: &Told) -> Asked {
        if self.nudge.is_some() {
            return Asked {
                target: Target::default(),
                placed: true,
                age: 0.0,
            };
        }
        let Led::Path(path) = &mut self.led else {
            let Some((asked, age)) = &told.asked else {
                // Until something is asked for: stay.
                return Asked {
                    target: Target::default(),
                    placed: true,
                    age: 0.0,
                };
            };
            let target = Target {
                position: double(asked.position.unwrap_or(told.position)),
                velocity: double(asked.velocity),
                acceleration: double(asked.acceleration),
                heading: None,
            };
            return Asked {
                target,
                placed: asked.position.is_some(),
                age: *age,
            };
        };
        let (last, time_scale) = self.last;
        path.advance(last, (told.t - last).max(0.0), |_| time_scale);
        let mut time_scale = 1.0;
        let target = path.advance(told.t, 0.0, |target| {
            let error = double(told.position) - target.position;
            let controller = &self.controller;
            time_scale = controller
                .time_scale(ned(error), ned(target.velocity))
                .into();
            time_scale
        });
        self.last = (told.t, time_scale);
        Asked {
            target,
            placed: true,
            age: 0.0,
        }
    }

    fn keep(
        &mut self,
        told: &Told,
        target: Target,
        input: Input,
        answer: Answer,
        mission: Option<MissionOutput>,
    ) {
        let q = told.orientation.to_quaternion(BodyAxes::NoseUp);
        let [w, x, y, z] = [q.w, q.x, q.y, q.z].map(f64::from);
        let force = told.specific_force.map(
            |Frd {
                 forward,
                 right,
                 down,
             }| V3::new(forward.into(), right.into(), down.into()).norm(),
        );
        let attitude = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        let truth = State {
            position: double(told.position),
            velocity: double(told.velocity),
            attitude,
            rates: V3::from(told.rates.map(f64::from)),
            thrust: answer.thrust.into(),
        };
        self.theta += wrap(truth.theta() - self.theta);
        let step = Step {
            t: told.t,
            truth,
            theta: self.theta,
            readings: Vec::new(),
            wind: told.air.wind(told.velocity).map_or_else(V3::zeros, double),
            load_factor: force.map_or(f64::NAN, |f| f / self.gravity),
            asked_speed: target.velocity.norm(),
            target,
            measured_attitude: attitude,
            input,
            answer,
            mission,
            model_theta: None,
            candidates: Vec::new(),
        };
        if self.record.last().is_none_or(|last| step.t > last.t) {
            self.record.push(step);
        }
    }
}

fn no_mission() -> Refused {
    let why = "a path is flown, and no mission".to_owned();
    (MavMissionResult::MAV_MISSION_DENIED, why)
}

/// What the vehicle cannot fly, by the number of the uploaded item.
fn of_item(error: &MissionError, numbers: &[usize]) -> Refused {
    type Code = MavMissionResult;
    let code = match (error.problem, error.field) {
        (ItemProblem::TooMany, _) => Code::MAV_MISSION_NO_SPACE,
        (_, "pass" | "until") => Code::MAV_MISSION_INVALID_PARAM1,
        (_, "speed") => Code::MAV_MISSION_INVALID_PARAM2,
        (_, "radius") => Code::MAV_MISSION_INVALID_PARAM3,
        (_, "place" | "centre") => Code::MAV_MISSION_INVALID_PARAM5_X,
        (_, "height" | "down") => Code::MAV_MISSION_INVALID_PARAM7,
        _ => Code::MAV_MISSION_INVALID,
    };
    let number = numbers.get(error.item).copied().unwrap_or(error.item);
    let text = error.to_string();
    let (_, what) = text.split_once(": ").unwrap_or(("", &text));
    (code, format!("item {number}: {what}"))
}

/// An item elsewhere, by this much.
fn displaced(item: Item, by: Ned) -> Item {
    match item {
        Item::Waypoint { place, pass } => Item::Waypoint {
            place: place + by,
            pass,
        },
        Item::Loiter {
            centre,
            radius,
            until,
        } => Item::Loiter {
            centre: centre + by,
            radius,
            until,
        },
        Item::Altitude { down } => Item::Altitude {
            down: down + by.down,
        },
        Item::Land { place } => Item::Land {
            place: place.map(|place| place + by),
        },
        other => other,
    }
}

impl OnMission {
    /// The core's items of those uploaded, counted from `start`, each with its number.
    fn converted(
        &self,
        items: &[MISSION_ITEM_INT_DATA],
        home: Home,
        start: Ned,
    ) -> Result<(Vec<usize>, Vec<Item>), Refused> {
        type Code = MavMissionResult;
        let items: Vec<MavItem> = items.iter().map(of_message).collect();
        let made = items_flown(&items, home).map_err(|(number, error)| {
            let code = match &*error.field {
                "command" => Code::MAV_MISSION_UNSUPPORTED,
                "frame" => Code::MAV_MISSION_UNSUPPORTED_FRAME,
                "params[0]" => Code::MAV_MISSION_INVALID_PARAM1,
                "params[1]" => Code::MAV_MISSION_INVALID_PARAM2,
                "params[2]" => Code::MAV_MISSION_INVALID_PARAM3,
                "params[4]" => Code::MAV_MISSION_INVALID_PARAM5_X,
                "params[5]" => Code::MAV_MISSION_INVALID_PARAM6_Y,
                "params[6]" => Code::MAV_MISSION_INVALID_PARAM7,
                _ => Code::MAV_MISSION_INVALID,
            };
            (code, format!("item {number}: {error}"))
        })?;
        let by = Ned::ZERO - start;
        Ok(made
            .into_iter()
            .map(|(n, item)| (n, displaced(item, by)))
            .unzip())
    }

    /// The flight begins in the air, at `start` in the autopilot's frame; without items it stays there.
    fn begin(&mut self, start: Ned) {
        self.start = Some(start);
        if let Some((items, home)) = self.uploaded.take() {
            let made = self.converted(&items, home, start).ok();
            let made = made.and_then(|(_, items)| self.run.mission(&items).ok());
            if let Some(made) = made {
                self.run.replace(made, 0);
            }
            self.uploaded = Some((items, home));
        }
        if self.run.items().is_empty() {
            let stay = Item::Waypoint {
                place: Ned::ZERO,
                pass: Pass::Hover(1e6),
            };
            if let Ok(made) = self.run.mission(&[stay]) {
                self.run.replace(made, 0);
            }
        }
        self.run.go_to(0);
    }
}

/// The item of a message: its place is in 1e-7 of a degree.
fn of_message(m: &MISSION_ITEM_INT_DATA) -> MavItem {
    let number = |x: f32| Some(f64::from(x));
    let degrees = |x: i32| Some(f64::from(x) * 1e-7);
    MavItem {
        command: m.command as i64,
        frame: m.frame as i64,
        params: [
            number(m.param1),
            number(m.param2),
            number(m.param3),
            number(m.param4),
            degrees(m.x),
            degrees(m.y),
            number(m.z),
        ],
    }
}

impl Pilot for OnPath {
    fn begin(&mut self, told: &Told, heading: f32, last: Command) {
        self.axes = Axes::new(self.heading.unwrap_or(heading));
        let told = self.axes.told(told);
        if told.velocity.norm_squared() > SLOW * SLOW {
            // At speed the thrust of hover is none to go on with: the guidance begins from the motion there is.
            self.nudge = None;
            return;
        }
        let rates = BodyAxes::NoseUp.vector(last.rates);
        self.controller
            .take_over(&told.orientation, last.thrust, rates);
    }

    fn is_over(&self) -> bool {
        self.refuses && !is_go(&self.findings)
    }

    fn answer(&mut self, told: &Told, dt: f32) -> Result<Command, End> {
        let mut told = self.axes.told(told);
        let t = f64::from(told.t as f32);
        if let Some(nudge) = self.nudge.take_if(|_| t > Nudge::DURATION) {
            self.nudged = told.t as f32;
            self.findings = nudge.findings();
        }
        told.t -= f64::from(self.nudged);
        let told = &told;
        let sample = GuidanceInput::default()
            .velocity(told.velocity)
            .orientation(told.orientation)
            .state_age(told.age)
            .air(told.air)
            .specific_force(told.specific_force);
        if let Led::Mission(mission) = &mut self.led {
            if mission.start.is_none() {
                mission.begin(told.start);
            }
            let unknown = Ned::new(f32::NAN, f32::NAN, f32::NAN);
            let asked = mission.run.ask(
                &MissionInput::default()
                    .position(told.position)
                    .velocity(told.velocity)
                    .wind(told.air.wind(told.velocity).unwrap_or(unknown))
                    .airspeed(told.air.airspeed())
                    .orientation(told.orientation)
                    .thrust(mission.thrust)
                    .armed(true),
                dt,
            );
            let was = mission.last.replace(asked);
            let landed = asked.activity == Activity::Grounded;
            if landed && was.is_some_and(|was| was.activity == Activity::Touched) {
                return Err(End::Finished);
            }
            let target = Target {
                position: double(told.position - asked.position_error),
                velocity: double(asked.reference.velocity),
                acceleration: double(asked.reference.acceleration),
                heading: None,
            };
            let input = Input {
                sample: asked.asked_of(sample),
                feed_forward: None,
            };
            let answer = match asked.gate {
                Gate::Off => Ok(GuidanceOutput::default().into()),
                _ => self.controller.answer(&input, dt),
            };
            let answer = passed(asked.gate, answer.map_err(|_| End::Pilot)?);
            mission.thrust = answer.thrust;
            self.keep(told, target, input, answer, Some(asked));
            return Ok(Command {
                thrust: answer.thrust,
                rates: BodyAxes::NoseUp.components(answer.rates),
            });
        }
        let Asked {
            target,
            placed,
            age: reference_age,
        } = self.asked(told);
        let error = told.position - ned(target.position);
        let heading = target.heading.map_or(f32::NAN, |h| h as f32);
        let sample = sample
            .position_error(placed.then_some(error))
            .reference(Reference {
                velocity: ned(target.velocity),
                acceleration: ned(target.acceleration),
                heading: Heading::from_angle(heading),
            })
            .reference_age(reference_age);
        let input = Input {
            sample,
            feed_forward: None,
        };
        let answer = self.controller.answer(&input, dt).map_err(|_| End::Pilot)?;
        let mut rates = BodyAxes::NoseUp.components(answer.rates);
        let mut thrust = answer.thrust;
        match &mut self.nudge {
            Some(nudge) => {
                for (rate, besides) in rates.iter_mut().zip(Nudge::asked(t)) {
                    *rate += besides;
                }
                thrust *= 1.0 + Nudge::thrust(t);
                let force = told.specific_force.map(|felt| felt.forward);
                nudge.take(t, [rates, told.rates], thrust, force);
            }
            None => self.keep(told, target, input, answer, None),
        }
        Ok(Command { thrust, rates })
    }
}
