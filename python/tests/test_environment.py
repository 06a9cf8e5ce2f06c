"""The environment of gymnasium."""

import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import alula
import alula.environment
from alula.environment import LOST, RATE, TOLERANCE, Flight


# Hover, and most of the way to cruise.
SHORT = {"duration_s": 25.0}


def flown(env, act, seed=1):
    observation, info = env.reset(seed=seed)
    total, observations, over = 0.0, [observation], False
    while not over:
        observation, reward, terminated, truncated, info = env.step(act(observation, info))
        assert env.observation_space.contains(observation)
        total, over = total + reward, terminated or truncated
        observations.append(observation)
    return total, np.array(observations), terminated


def test_gymnasium_finds_nothing_wrong():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make("alula/Flight-v0", experiment="mission-turbulence").unwrapped)


def test_the_guidance_as_an_agent_flies_the_flight():
    total, observations, lost = flown(Flight("round-trip", SHORT), lambda _, info: info["answer"])
    flight = alula.fly("round-trip", SHORT)
    record = flight.record
    assert not lost and len(observations) == len(record)
    # Actions are told in single precision of their range.
    errors = record["velocity_error_m_s"]
    assert np.allclose(np.linalg.norm(observations[:, 3:6], axis=1), errors, atol=5e-3)
    period = record["t_s"][1]
    assert total == pytest.approx(period * np.exp(-errors[1:] / TOLERANCE).sum(), rel=1e-3)


def test_who_does_nothing_falls():
    total, observations, lost = flown(Flight("round-trip", SHORT), lambda *_: np.array([-1.0, 0, 0, 0]))
    assert lost and np.linalg.norm(observations[-1, :3]) > LOST and observations[-1, 8] > 10
    # It takes half a second and more to lose the thrust, and some three to fall by `LOST`.
    assert 2.5 < 0.01 * len(observations) < 5.5 and total < 2.0


@pytest.mark.parametrize("axis", range(3))
def test_an_action_turns_about_its_axis(axis):
    env = Flight("start-hover")
    env.reset(seed=1)
    action = np.array([0.0, 0, 0, 0])
    action[1 + axis] = 1.0 / RATE
    for _ in range(50):
        observation, *_ = env.step(action)
    assert np.argmax(np.abs(observation[16:19])) == axis and observation[16 + axis] > 0.5


def test_a_seed_is_a_flight():
    ends = [flown(Flight("mission-turbulence", {"duration_s": 3.0}), lambda _, info: info["answer"], seed)[1][-1] for seed in (1, 1, 2)]
    assert np.array_equal(ends[0], ends[1]) and not np.array_equal(ends[0], ends[2])
