//! A flight that somebody steers: the experiment's vehicle, weather and controller, with goals in place of its path.

use alula::guidance::{Goal, GoalState, Goals, PlannerOptions, Preferences};
use alula::ned::Ned;
use alula_sim::controllers::Controller;
use alula_sim::experiment::{Experiment, Target, double, ned};
use alula_sim::scene::Scene;
use alula_sim::simulate::Flight;
use anyhow::{bail, ensure};

/// How goals are flown to.
fn preferences() -> Preferences {
    Preferences {
        speed: 20.0,
        climb: 3.0,
        acceleration: 3.0,
        planner_options: PlannerOptions::default(),
    }
}

/// A flight that somebody steers.
pub struct Steered {
    experiment: &'static Experiment,
    flight: Flight<'static>,
    controller: Box<dyn Controller>,
    goals: Goals,
    goal: Goal,
    state: GoalState,
}

impl Steered {
    /// The flight of `experiment` at its beginning, whose goal is to hover where it begins.
    pub fn new(experiment: Experiment) -> anyhow::Result<Self> {
        // Some kilobytes per flight that is begun, as long as the page is open.
        let experiment: &'static Experiment = Box::leak(Box::new(experiment));
        Ok(Self {
            experiment,
            flight: Flight::new(experiment)?,
            controller: experiment.controller()?,
            goals: Goals::new(preferences())?,
            goal: Goal::Hover(Ned::ZERO),
            state: GoalState::default(),
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
        self.goal = match kind {
            1 => Goal::Hover(target),
            2 => Goal::Stop,
            3 => Goal::Velocity(target),
            _ => bail!("{kind} is no kind of goal"),
        };
        Ok(())
    }

    /// Goes on by `steps`; what is seen of them.
    pub fn step(&mut self, steps: u32) -> anyhow::Result<Scene> {
        let dt = (1.0 / self.experiment.control_rate_hz) as f32;
        let mut scene = Scene::default();
        for i in 0..steps {
            let (goals, goal, state) = (&self.goals, &self.goal, &mut self.state);
            let step = self
                .flight
                .ask_for(self.controller.as_mut(), |position, velocity| {
                    let wanted = goals.step(state, goal, ned(position), ned(velocity), dt);
                    let target = Target {
                        position: position - double(wanted.position_error),
                        velocity: double(wanted.reference.velocity),
                        acceleration: double(wanted.reference.acceleration),
                        heading: None,
                    };
                    (target, wanted.planner_options)
                })?;
            ensure!(step.truth.is_sound(), "diverged at {:.2} s", step.t);
            scene.push(self.experiment, &step, i + 1 == steps);
            self.flight.advance(&step.answer);
        }
        Ok(scene)
    }
}
