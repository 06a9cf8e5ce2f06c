//! A flight that somebody steers: the experiment's vehicle, weather and controller, with goals in place of its path.

use std::rc::Rc;

use alula::guidance::{Goal, GoalState, Goals, Preferences};
use alula::mission::{
    Item, Mission, MissionInput, MissionParameters, MissionState, Missions, Pass, Responses,
};
use alula::ned::Ned;
use alula_sim::controllers::Controller;
use alula_sim::experiment::{Experiment, Target, double, ned};
use alula_sim::scene::Scene;
use alula_sim::simulate::{Diverged, Flight};
use anyhow::{bail, ensure};

/// How goals are flown to.
fn preferences() -> Preferences {
    Preferences::default().acceleration(3.0)
}

/// A flight that somebody steers.
pub struct Steered {
    experiment: Rc<Experiment>,
    flight: Flight<Rc<Experiment>>,
    controller: Box<dyn Controller>,
    goals: Goals,
    goal: Goal,
    state: GoalState,
    /// What is flown in the place of the goal.
    mission: Option<Square>,
    /// Where the vehicle was measured last \[m\].
    place: Ned,
}

/// The square that is flown as a mission.
struct Square {
    missions: Missions,
    mission: Mission,
    state: MissionState,
}

/// Airspeed of the mission [m/s], and the side of its square \[m\].
const CRUISE: f32 = 20.0;
const SIDE: f32 = 250.0;

impl Steered {
    /// The flight of `experiment` at its beginning, whose goal is to hover where it begins.
    pub fn new(experiment: Experiment) -> anyhow::Result<Self> {
        let experiment = Rc::new(experiment);
        Ok(Self {
            flight: Flight::new(Rc::clone(&experiment))?,
            controller: experiment.controller()?,
            experiment,
            goals: Goals::new(preferences())?,
            goal: Goal::Hover(Ned::ZERO),
            state: GoalState::default(),
            mission: None,
            place: Ned::ZERO,
        })
    }

    /// The goal from now on.
    pub fn aim(&mut self, kind: u32, [north, east, down]: [f64; 3]) -> anyhow::Result<()> {
        let target = Ned::new(north as f32, east as f32, down as f32);
        ensure!(
            [target.north, target.east, target.down]
                .iter()
                .all(|x| x.is_finite()),
            "a goal must be finite"
        );
        self.mission = None;
        self.goal = match kind {
            1 => Goal::Hover(target),
            2 => Goal::Stop,
            3 => Goal::Velocity(target),
            4 => {
                self.mission = Some(self.square()?);
                return Ok(());
            }
            _ => bail!("{kind} is no kind of goal"),
        };
        Ok(())
    }

    /// A mission: a square of waypoints from here, and hover where it began.
    fn square(&self) -> anyhow::Result<Square> {
        let experiment = &self.experiment;
        let vehicle = &experiment.vehicle;
        let vehicle = vehicle.limited(experiment.thrust_limits(None, vehicle.weight()))?;
        let parameters = MissionParameters::cruising_at(CRUISE);
        let missions = Missions::new(&vehicle, &parameters, Responses::default())?;
        let corner = |north: f32, east: f32, pass| Item::Waypoint {
            place: self.place + Ned::new(north, east, 0.0),
            pass,
        };
        let mission = missions.mission(&[
            corner(SIDE, 0.0, Pass::By),
            corner(SIDE, SIDE, Pass::By),
            corner(0.0, SIDE, Pass::By),
            corner(0.0, 0.0, Pass::Hover(0.0)),
        ])?;
        Ok(Square {
            missions,
            mission,
            state: MissionState::default(),
        })
    }

    /// Goes on by `steps`; what is seen of them.
    pub fn step(&mut self, steps: u32) -> anyhow::Result<Scene> {
        let dt = (1.0 / self.experiment.control_rate_hz) as f32;
        let mut scene = Scene::default();
        for i in 0..steps {
            let (goals, goal, state) = (&self.goals, &self.goal, &mut self.state);
            let (mission, place) = (&mut self.mission, &mut self.place);
            let wind = ned(self.experiment.weather.steady());
            let controller = self.controller.as_mut();
            let step = self.flight.ask_for(controller, |measured| {
                let (position, velocity) = (ned(measured.position), ned(measured.velocity));
                *place = position;
                let (reference, error, options) = match mission {
                    Some(Square {
                        missions,
                        mission,
                        state,
                    }) => {
                        let input = MissionInput::default()
                            .position(position)
                            .velocity(velocity)
                            .wind(wind)
                            .orientation(measured.orientation())
                            .armed(true);
                        let asked = missions.step(state, mission, &input, dt);
                        (asked.reference, asked.position_error, asked.planner_options)
                    }
                    None => {
                        let wanted = goals.step(state, goal, position, velocity, dt);
                        (
                            wanted.reference,
                            wanted.position_error,
                            wanted.planner_options,
                        )
                    }
                };
                let target = Target {
                    position: measured.position - double(error),
                    velocity: double(reference.velocity),
                    acceleration: double(reference.acceleration),
                    heading: None,
                };
                (target, options)
            })?;
            Diverged::at(&step)?;
            scene.push(&self.experiment, &step, i + 1 == steps);
            self.flight.advance(&step.answer);
        }
        Ok(scene)
    }
}
