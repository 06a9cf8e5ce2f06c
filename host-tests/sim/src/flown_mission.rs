//! A mission that is flown: what it asks for at a step, and what of the answer reaches the motors.

use alula::mission::{
    Gate, Item, Mission, MissionError, MissionInput, MissionOutput, MissionParameters,
    MissionState, Missions, Troubles,
};
use alula::ned::Ned;

use crate::controllers::{Answer, Input};
use crate::experiment::{
    Experiment, FieldError, Measured, MissionSpec, Target, TroubleKind, TroubleSpec, Vehicle,
    double, ned, refused,
};

/// A mission that is being flown.
pub struct FlownMission {
    missions: Missions,
    mission: Mission,
    state: MissionState,
    armed_s: f64,
    troubles: Vec<TroubleSpec>,
}

impl Experiment {
    /// The mission at its beginning, if one is flown.
    pub fn flown_mission(&self) -> Result<Option<FlownMission>, FieldError> {
        let Some(spec) = &self.mission else {
            return Ok(None);
        };
        let controller = self.spec()?;
        let belief = controller.belief().unwrap_or(&self.vehicle);
        let thrust = self.thrust_limits(None, belief.weight());
        let vehicle = belief.limited(thrust).map_err(|e| e.inside("vehicle"))?;
        let made = spec.missions(&vehicle);
        let (missions, mission) = made.map_err(|e| e.inside("mission"))?;
        Ok(Some(FlownMission {
            missions,
            mission,
            state: MissionState::default(),
            armed_s: spec.armed_s,
            troubles: spec.troubles.clone(),
        }))
    }
}

impl MissionSpec {
    /// The mission, checked against `vehicle`, and what flies it. Fields in errors are those of the mission's own table.
    pub fn missions(&self, vehicle: &Vehicle) -> Result<(Missions, Mission), FieldError> {
        let missions = Missions::new(vehicle, &self.parameters()?, self.responses);
        let missions = missions.map_err(refused::<MissionParameters>)?;
        let mut items = Vec::with_capacity(self.items.len());
        for (i, item) in self.items.iter().enumerate() {
            let item = item.item();
            let refused =
                |(field, problem)| FieldError::new(format!("items[{i}].{field}"), problem);
            items.push(item.map_err(refused)?);
        }
        let mission = missions.mission(&items).map_err(|e| {
            let text = e.to_string();
            let problem = text.splitn(3, ": ").last().unwrap_or(&text).to_owned();
            FieldError::new(format!("items[{}].{}", e.item, e.field), problem)
        })?;
        Ok((missions, mission))
    }
}

impl FlownMission {
    /// What is asked at `t` \[s\] of a vehicle that measures this, in a level `wind` [m/s] as an estimator tells it, `dt` \[s\] after the last.
    pub fn step(
        &mut self,
        t: f64,
        dt: f64,
        measured: &Measured,
        wind: Ned,
        last: Option<&Answer>,
    ) -> MissionOutput {
        let fails = |kind| {
            let mut all = self.troubles.iter();
            all.any(|of| of.kind == kind && (of.t_s..of.t_s + of.lasts_s).contains(&t))
        };
        let mut troubles = Troubles::empty();
        troubles.set(Troubles::LINK, fails(TroubleKind::Link));
        troubles.set(Troubles::AIR, fails(TroubleKind::Air));
        troubles.set(Troubles::BATTERY, fails(TroubleKind::Battery));
        troubles.set(Troubles::ABORT, fails(TroubleKind::Abort));
        let input = MissionInput::default()
            .position((!fails(TroubleKind::Position)).then(|| ned(measured.position)))
            .velocity(ned(measured.velocity))
            .wind(wind)
            .airspeed(measured.air.airspeed())
            .orientation(measured.orientation())
            .thrust(last.map_or(0.0, |answer| answer.thrust))
            .armed(t >= self.armed_s)
            .troubles(troubles);
        self.ask(&input, dt as f32)
    }

    /// What is asked, `dt` \[s\] after the last.
    pub fn ask(&mut self, input: &MissionInput, dt: f32) -> MissionOutput {
        *self
            .missions
            .step(&mut self.state, &self.mission, input, dt)
    }

    /// The items as a mission of this vehicle.
    pub fn mission(&self, items: &[Item]) -> Result<Mission, MissionError> {
        self.missions.mission(items)
    }

    /// Another mission, from an item on. In the air there is no take-off: an item that is one is passed.
    pub fn replace(&mut self, mission: Mission, item: usize) {
        self.mission = mission;
        self.go_to(item);
    }

    /// Goes to an item, in the air.
    pub fn go_to(&mut self, item: usize) {
        let ahead = self.mission.items().iter().skip(item);
        let passed = ahead.take_while(|item| matches!(item, Item::TakeOff { .. }));
        self.state.go_to(item + passed.count());
    }

    /// Its items.
    pub fn items(&self) -> &[Item] {
        self.mission.items()
    }
}

/// What is to be flown, for a record: the place on the path nearest to where the vehicle was measured.
pub fn target(asked: &MissionOutput, measured: &Measured) -> Target {
    Target {
        position: measured.position - double(asked.position_error),
        velocity: double(asked.reference.velocity),
        acceleration: double(asked.reference.acceleration),
        heading: None,
    }
}

/// The input with what the mission asks for.
pub fn asked_of(asked: &MissionOutput, input: &mut Input) {
    let heading = asked.reference.heading;
    input.sample = asked.asked_of(input.sample);
    input.sample.reference.heading = heading;
}

/// What of an answer reaches the motors.
pub fn passed(gate: Gate, answer: Answer) -> Answer {
    let (thrust, rates) = gate.pass(answer.thrust, answer.rates);
    Answer {
        thrust,
        rates,
        ..answer
    }
}
