"""Goals, missions, and the simulation that goes on step by step."""

import json

import numpy as np
import pytest

import alula

ITEMS = [
    {"take-off": {"height_m": 20}},
    {"waypoint": {"north_m": 60, "east_m": 0, "height_m": 30, "hover_s": 2}},
    "return",
]
# The guidance of the experiment itself.
RULES = dict(rate_lag_s=0.1, thrust_lag_s=0.05, cruise_speed_m_s=20)


def told(now):
    return dict(velocity=now.velocity_m_s, quaternion=now.quaternion, wind=now.wind_m_s)


def test_a_simulation_by_its_own_controller_is_the_flight():
    changed = {"duration_s": 8.0}
    simulation = alula.Simulation(alula.Experiment("mission", changed))
    record = alula.fly("mission", changed).record
    places = []
    while simulation.now.time_s < simulation.duration_s - 1e-9:
        places.append(simulation.now.position_m)
        simulation.step()
    places.append(simulation.now.position_m)
    assert np.array_equal(np.array(places), np.stack([record["north_m"], record["east_m"], record["down_m"]], axis=1))
    # The same answer as a command of one's own.
    simulation.reset()
    for _ in range(100):
        now = simulation.now
        simulation.step(now.answer_thrust_n, now.answer_rates_rad_s)
    assert np.allclose(simulation.now.position_m, places[100], atol=1e-6)
    assert simulation.now.quaternion == pytest.approx([np.sqrt(0.5), 0, np.sqrt(0.5), 0], abs=0.05)


def test_rates_are_about_nose_wing_and_belly():
    for axis in range(3):
        simulation = alula.Simulation("start-hover")
        rates = np.zeros(3)
        rates[axis] = 1.0
        for _ in range(40):
            now = simulation.step(simulation.weight_n, rates)
        assert np.argmax(np.abs(now.rates_rad_s)) == axis and now.rates_rad_s[axis] > 0.5, (axis, now.rates_rad_s)


def test_a_seed_draws_the_wind():
    def end(seed):
        simulation = alula.Simulation("mission-turbulence")
        simulation.reset(seed)
        for _ in range(50):
            simulation.step()
        return simulation.now.wind_m_s

    assert end(1) == end(1) != end(2)


def test_goals_are_flown_to():
    simulation, vehicle = alula.Simulation("mission"), alula.Vehicle.load("mission")
    guidance = alula.Guidance(vehicle, for_vehicle=RULES)
    goals = alula.Goals(speed_m_s=15, climb_m_s=3, acceleration_m_s2=2)
    goals.hover((150, 40, -20))
    for _ in range(4000):
        now = simulation.now
        asked = goals.step(simulation.period_s, position=now.position_m, velocity=now.velocity_m_s)
        command = guidance.update(simulation.period_s, **told(now), **asked)
        simulation.step(command.thrust_n, command.rates_rad_s)
    assert goals.reached and np.linalg.norm(np.subtract(simulation.now.position_m, (150, 40, -20))) < 1.0
    assert "hover at" in repr(goals)
    goals.stop()
    stop = goals.step(0.01, position=(0, 0, 0), velocity=(9, 0, 0))
    assert not goals.reached and stop["hold_altitude_only"] and not asked["hold_altitude_only"]


def test_a_mission_is_flown_in_a_loop_of_ones_own():
    simulation, vehicle = alula.Simulation("delivery", {"mission.items": ITEMS}), alula.Vehicle.load("delivery")
    mission, guidance = alula.Mission(vehicle, ITEMS, cruise_speed_m_s=20), alula.Guidance(vehicle, for_vehicle=RULES)
    highest, done = 0.0, []
    while not mission.done and simulation.now.time_s < 120:
        now = simulation.now
        step = mission.step(simulation.period_s, position=now.position_m, thrust_n=now.thrust_n, **told(now))
        thrust, rates = 0.0, (0.0, 0.0, 0.0)
        if step.gate != "off":
            command = guidance.update(simulation.period_s, **told(now), **step.asked)
            thrust, rates = step.passed(command.thrust_n, command.rates_rad_s)
        now = simulation.step(thrust, rates)
        highest = max(highest, -now.position_m[2])
        done += [step.activity] * (not done or done[-1] != step.activity)
    assert mission.done and 29 < highest < 32, simulation
    # The first step finds out what is to be done.
    assert done == ["grounded", "spooling", "rising", "hovering", "descending", "touched", "grounded"]
    assert np.linalg.norm(simulation.now.position_m[:2]) < 2.0
    mission.go_to(1)
    assert not mission.done and len(mission) == 3 and mission.items == ITEMS and "take-off, waypoint, return" in repr(mission)


def test_a_plan_is_read(tmp_path):
    def item(command, *params, **place):
        return {"type": "SimpleItem", "command": command, "frame": 3, "params": list(params)}

    plan = {
        "fileType": "Plan",
        "mission": {
            "plannedHomePosition": [47.4, 8.5, 400],
            "cruiseSpeed": 20,
            "items": [item(22, 0, 0, 0, None, 47.4, 8.5, 30), item(16, 0, 0, 0, None, 47.403, 8.5, 50), item(20, 0, 0, 0, 0, 0, 0, 0)],
        },
    }
    file = tmp_path / "short.plan"
    file.write_text(json.dumps(plan))
    vehicle = alula.Vehicle.load("survey")
    mission = alula.Mission.load(file, vehicle)
    assert mission.items[0] == {"take-off": {"height_m": 30.0}} and mission.items[-1] == "return"
    assert mission.items[-2]["waypoint"]["north_m"] == pytest.approx(333.5, abs=1.0)
    experiment = alula.Experiment(file, vehicle="survey")
    assert experiment.get("mission.items") == mission.items and experiment.name == "short"
    assert len(alula.Mission.load("delivery", vehicle)) == 6


@pytest.mark.parametrize(
    ("make", "field", "problem"),
    [
        (lambda v: alula.Mission(v, [{"loiter": dict(north_m=0, east_m=0, height_m=9, radius_m=5)}], cruise_speed_m_s=22), "items[0].radius", "turns on"),
        (lambda v: alula.Mission(v, ["retrun"], cruise_speed_m_s=22), "items[0]", "did you mean `return`"),
        (lambda v: alula.Mission(v, ITEMS), "cruise_speed_m_s", "missing"),
        (lambda v: alula.Mission(v, ITEMS, cruise_speed=22), "cruise_speed", "did you mean `cruise_speed_m_s`"),
        (lambda v: alula.Mission(v, ITEMS, cruise_speed_m_s=22, responses={"link": "home"}), "responses.link", "unknown variant"),
        (lambda v: alula.Mission.load("mission", v), "mission", "has no mission"),
        (lambda v: alula.Mission(v, ITEMS, cruise_speed_m_s=22).step(0.01, velocity=(0, 0, 0), quaternion=(1, 0, 0, 0), troubles=["lnk"]), "troubles", "lnk"),
        (lambda v: alula.Goals(0, 1, 1), "speed_m_s", "must be"),
        (lambda v: alula.Goals(9, 1, 1, braking_climb_m=-1), "braking_climb_m", "must be"),
        (lambda v: alula.Goals(9, 1, 1, altitude_band_m=-1), "altitude_band_m", "must be"),
        (lambda v: alula.Goals(9, 1, 1).hover((0, 0, np.nan)), "place", "finite"),
        (lambda v: alula.Simulation("mission").step(np.nan), "thrust_n", "finite"),
        (lambda v: alula.Simulation("mission").step(1, (0, 0)), "rates_rad_s", "shape"),
        (lambda v: alula.Simulation("nope"), "source", "nope"),
        (lambda v: alula.Experiment("x.plan"), "vehicle", "is missing"),
        (lambda v: alula.Experiment("mission", vehicle="paper"), "vehicle", "has its own"),
    ],
)
def test_what_is_refused_is_named(make, field, problem):
    with pytest.raises(alula.FieldError) as refused:
        make(alula.Vehicle.load("delivery"))
    assert refused.value.field == field and problem in refused.value.problem, (refused.value.field, refused.value.problem)
