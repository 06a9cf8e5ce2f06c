"""An environment of gymnasium over the simulation: an experiment, flown by commands of one's own.

    import gymnasium
    env = gymnasium.make("alula.environment:alula/Flight-v0", experiment="round-trip")

It needs `pip install './python[gymnasium]'`, from a clone. A step is one control step of the experiment: 100 a second in those that are built in. The
agent takes the guidance's place, between the reference and the vehicle's rate loop.

The action is four numbers from -1 to 1:

| | stands for | unit |
|---|---|---|
| 0 | thrust along the nose, from the vehicle's least to its greatest; without limits, from 0 to twice the weight | N |
| 1, 2, 3 | rates about nose, right wing and belly, from -`RATE` to `RATE` | rad/s |

The observation is twenty numbers. Vectors are (north, east, down):

| | is | unit |
|---|---|---|
| 0–2 | position less that of the reference | m |
| 3–5 | velocity less that of the reference | m/s |
| 6–8 | velocity over ground | m/s |
| 9–11 | velocity of the reference | m/s |
| 12–15 | attitude (w, x, y, z), from nose, right wing and belly to north-east-down, w not negative | |
| 16–18 | rates about nose, right wing and belly | rad/s |
| 19 | thrust over weight | |

The reward of a step is its time times exp(-(velocity error / `TOLERANCE`)): the return is at most the time of the flight [s]. A flight
ends (`terminated`) where the vehicle is more than `LOST` from its reference, or tumbles beyond what the simulation can follow, and is
cut (`truncated`) at the end of the experiment.
"""

import gymnasium
import numpy as np

from ._alula import Experiment, Simulation

# Greatest rate of rotation that is asked for [rad/s], velocity error at which the reward has fallen to 1/e [m/s], distance at which a
# vehicle is lost [m].
RATE, TOLERANCE, LOST = 6.0, 2.0, 50.0

# What a number of the observation may be at most: a vehicle that is lost is a step farther than `LOST`.
BOUNDS = np.repeat([2 * LOST, 1e3, 1e3, 1e3, 1.001, 1e3, 1e3], [3, 3, 3, 3, 4, 3, 1]).astype(np.float32)


class Flight(gymnasium.Env):
    """A flight. `experiment` and `set` are as `alula.Experiment` takes them; the seed of `reset` draws its noise and gusts."""

    metadata = {"render_modes": []}
    render_mode = None

    def __init__(self, experiment="round-trip", set=None):
        given = experiment if isinstance(experiment, Experiment) else Experiment(experiment)
        self.simulation = Simulation(given, set)
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (4,), np.float32)
        self.observation_space = gymnasium.spaces.Box(-BOUNDS, BOUNDS, dtype=np.float32)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.simulation.reset(int(self.np_random.integers(2**63)))
        now = self.simulation.now
        return self._observation(now), self._info(now)

    def step(self, action):
        least, most = self.simulation.thrust_limits_n
        action = np.clip(np.asarray(action, np.float64), -1.0, 1.0)
        thrust = least + 0.5 * (action[0] + 1.0) * (most - least)
        now = self.simulation.step(thrust, RATE * action[1:])
        period = self.simulation.period_s
        observation = self._observation(now)
        off, error = np.linalg.norm(observation[:3]), np.linalg.norm(observation[3:6])
        terminated = bool(not self.simulation.sound or off > LOST)
        truncated = bool(now.time_s > self.simulation.duration_s - 0.5 * period)
        return observation, float(period * np.exp(-error / TOLERANCE)), terminated, truncated, self._info(now)

    def _observation(self, now):
        velocity, reference = np.array(now.velocity_m_s), np.array(now.reference_velocity_m_s)
        quaternion = np.array(now.quaternion) * (1.0 if now.quaternion[0] >= 0.0 else -1.0)
        position = np.subtract(now.position_m, now.reference_position_m)
        parts = [position, velocity - reference, velocity, reference, quaternion, now.rates_rad_s, [now.thrust_n / self.simulation.weight_n]]
        return np.clip(np.nan_to_num(np.concatenate(parts)), -BOUNDS, BOUNDS).astype(np.float32)

    def _info(self, now):
        """`answer`: the action by which the experiment's own controller would fly on, to compare with or to learn from."""
        least, most = self.simulation.thrust_limits_n
        thrust = 2.0 * (now.answer_thrust_n - least) / (most - least) - 1.0
        return {"time_s": now.time_s, "answer": np.array([thrust, *np.divide(now.answer_rates_rad_s, RATE)], np.float32)}


gymnasium.register("alula/Flight-v0", entry_point=Flight)
