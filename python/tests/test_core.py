"""Models, vehicles, laws, guidance and equilibria."""

import math
import threading
import time

import numpy as np
import pytest

import alula

PAPER = dict(mass_kg=10.0, k_a_kg_m=0.646, thrust_max_n=196.2)


STILL = dict(velocity=(0, 0, 0), quaternion=(1, 0, 0, 0), reference_velocity=(1, 0, 0))
PLANE = dict(velocity=(0, 0, 0), theta=0, reference_velocity=(1, 0, 0))


def states(n, seed=1):
    """Velocities, attitudes, reference velocities and accelerations, winds; nothing points to the east."""
    random = np.random.default_rng(seed)
    vectors = lambda size: random.uniform(-size, size, (n, 3)).astype(np.float32) * np.float32([1, 0, 1])
    return vectors(30), random.uniform(-3.1, 3.1, n).astype(np.float32), vectors(30), vectors(4), vectors(5)


def test_parameters_come_from_the_one_table():
    table = alula.parameters()
    rows = {row["name"]: row for row in table["Vehicle"]}
    assert rows["mass_kg"]["default"] is None and rows["gravity_m_s2"]["default"] == pytest.approx(9.81)
    vehicle = alula.Vehicle(**PAPER, delta_deg=10.0)
    assert set(vehicle.parameters) == set(rows)
    assert vehicle.parameters["delta_deg"] == pytest.approx(10.0) and vehicle.parameters["c_y"] == 0.0
    guidance = alula.Guidance(vehicle, damping=0.7)
    defaults = {row["name"]: row["default"] for row in table["Guidance"]}
    assert defaults | {"damping": 0.7} == guidance.parameters
    # By rule: 0.95 over the lag and one step, a fifth of cruise; what is given stays.
    ruled = alula.Guidance(vehicle, damping=0.7, for_vehicle=dict(rate_lag_s=0.3, thrust_lag_s=0.08, cruise_speed_m_s=18, control_rate_hz=50)).parameters
    assert ruled["natural_frequency_rad_s"] == pytest.approx(0.95 / 0.32)
    assert ruled["max_velocity_forward_m_s"] == pytest.approx(3.6)
    assert ruled["damping"] == pytest.approx(0.7) and set(ruled) == set(defaults)
    assert alula.Model.combined().parameters == {row["name"]: row["default"] for row in table["Combined model"]}
    assert alula.Vehicle(**PAPER).model == alula.Vehicle.load("paper").model == alula.Model.combined()


@pytest.mark.parametrize(
    ("make", "field", "problem"),
    [
        (lambda: alula.Vehicle(**{**PAPER, "mass_kg": -1}), "mass_kg", "positive"),
        (lambda: alula.Vehicle(k_a_kg_m=1, thrust_max_n=9), "mass_kg", "missing"),
        (lambda: alula.Vehicle(mass=2.2, k_a_kg_m=1, thrust_max_n=9), "mass", "did you mean `mass_kg`"),
        (lambda: alula.Vehicle(**PAPER, span_m=2), "span_m", "unknown"),
        (lambda: alula.Vehicle(**PAPER, delta_deg=200), "delta_deg", "must be"),
        (lambda: alula.Model.combined().coefficients([0.1, 12]), "alpha_rad", "12 is not from -3.142 to 3.142 rad: was this in degrees?"),
        (lambda: alula.Law(alula.Vehicle.load()).command((5, 0, 0), -90, (6, 0, 0)), "theta", "degrees?"),
        (lambda: alula.Law(alula.Vehicle.load()).commands((5, 0, 0), [0, -90], (6, 0, 0)), "theta", "degrees?"),
        (lambda: alula.Guidance(alula.Vehicle.load()).update(0.01, **STILL, heading=90), "heading", "degrees?"),
        (lambda: alula.Guidance(alula.Vehicle.load()).update_in_plane(0.01, velocity=(0, 0, 0), theta=-90, reference_velocity=(1, 0, 0)), "theta", "degrees?"),
        (lambda: alula.Fleet(alula.Vehicle.load(), 1).update(0.01, **STILL, heading=90), "heading", "degrees?"),
        (lambda: alula.Vehicle(**PAPER, thrust_min_n=300), "thrust_max_n", "must be above thrust_min"),
        (lambda: alula.Vehicle(**{**PAPER, "mass_kg": "ten"}), "mass_kg", "invalid type"),
        (lambda: alula.Model.combined(c2=0), "c2", "positive"),
        (lambda: alula.Model.combined(k_l=5e3), "k_l", "must"),
        (lambda: alula.Law(alula.Vehicle(**PAPER), gains={"k3": math.nan}), "gains.k3", "finite"),
        (lambda: alula.Law(alula.Vehicle(**PAPER), "robst"), "form", "unknown variant"),
        (lambda: alula.Guidance(alula.Vehicle(**PAPER), max_rate_rad_s=0), "max_rate_rad_s", "positive"),
        (lambda: alula.Guidance(alula.Vehicle(**PAPER), max_rate_rads=1), "max_rate_rads", "did you mean `max_rate_rad_s`"),
        (lambda: alula.Guidance(alula.Vehicle(**PAPER), for_vehicle=dict(rate_lag_s=0.1)), "for_vehicle.thrust_lag_s", "missing"),
        (lambda: alula.Guidance(alula.Vehicle(**{**PAPER, "thrust_max_n": 50})), "thrust_max_n", "must be above"),
        (lambda: alula.Fleet(alula.Vehicle(**PAPER), -1), "n", "from 1"),
        (lambda: alula.campaign("dispersed", flights=-1), "flights", "positive"),
        (lambda: alula.campaign("dispersed", flights=1, threads=-1), "threads", "positive"),
        (lambda: alula.Model.table([0, 90], [0, 0], [1, 1]), "alpha_deg", "row 2: at least five rows"),
        (lambda: alula.Model.table([0, 90], [0], [1, 1]), "cl", "1 rows"),
        (lambda: alula.Model.table([-180, -90, 0, 90, 180], [0, 0, math.nan, 0, 0], [1] * 5), "cl", "row 2: every number"),
        (lambda: alula.Model.table([-180, -90, 0, 90, 180], [0] * 5, [1, 1, 1, 0, 1]), "cd", "row 3: the drag"),
        (lambda: alula.Model.load("nope"), "source", "nope"),
        (lambda: alula.Vehicle.load("nope"), "source", "nope"),
        (lambda: alula.fly("nope"), "source", "nope"),
        (lambda: alula.campaign("nope"), "source", "nope"),
        (lambda: alula.compare("nope"), "source", "nope"),
        (lambda: alula.fly("round-trip", ["vehicle.mass_kg"]), "set", "PATH=VALUE"),
        (lambda: alula.campaign("dispersed", flights=2).refly(2), "number", "from 0 to 1"),
        (lambda: alula.envelope("paper", climb_deg=91), "climb_deg", "-90 to 90"),
        (lambda: alula.equilibria("paper", (math.nan, 0, 0)), "velocity", "finite"),
        (lambda: alula.equilibria("paper", (1, 2, 3, 4)), "velocity", "shape"),
        (lambda: alula.equilibria("paper", (12, 1, 0)), "velocity", "out of the vertical plane"),
        (lambda: alula.equilibria("paper", (1, 0, 0), wind="calm"), "wind", "calm"),
        (lambda: alula.Law(alula.Vehicle.load()).commands((1, 0, 0), [0, "x"], (1, 0, 0)), "theta", "x"),
        # Pairs [down, forward], as they were.
        (lambda: alula.equilibria("paper", (0, 12)), "velocity", "is now [forward, 0, down]"),
        (lambda: alula.Law(alula.Vehicle.load()).command((5, 0, 0), 0, (0, 6)), "reference_velocity", "is now [forward, 0, down]"),
        (lambda: alula.Law(alula.Vehicle.load()).commands((5, 0, 0), 0, np.zeros((4, 2))), "reference_velocity", "is now [forward, 0, down]"),
        (lambda: alula.Law(alula.Vehicle.load()).commands([(5, 0, 0), (5, 1, 0)], 0, (6, 0, 0)), "velocity", "out of the vertical plane"),
        (lambda: alula.Guidance(alula.Vehicle.load()).update_in_plane(0.01, **PLANE, wind=(0, 1)), "wind", "is now [forward, 0, down]"),
        (lambda: alula.Guidance(alula.Vehicle.load()).update_in_plane(0.01, **PLANE, specific_force=(0, 1, 0)), "specific_force", "out of the vertical plane"),
    ],
)
def test_what_is_refused_is_named(make, field, problem):
    with pytest.raises(alula.FieldError) as refused:
        make()
    assert refused.value.field == field and problem in refused.value.problem


def test_everything_says_what_it_is():
    vehicle = alula.Vehicle(**PAPER)
    flown = alula.campaign("dispersed", flights=3)
    for thing, words in [
        (vehicle, ["10 kg", "0.646", "196.2 N"]),
        (alula.Model.combined(), ["c0 0.014", "alpha_bar_deg 11"]),
        (alula.Model.load(alula.polars()[0]), [alula.polars()[0], "rows"]),
        (alula.Law(vehicle, "full"), ["full"]),
        (alula.Guidance(vehicle, damping=0.7), ["damping 0.7", "vehicle"]),
        (alula.Fleet(vehicle, 7), ["7 vehicles"]),
        (alula.envelope(vehicle), ["folds", "points"]),
        (alula.equilibria(vehicle, (12, 0, 0))[0], ["alpha_rad"]),
        (alula.Experiment("round-trip"), ["round-trip: Hover to cruise and back"]),
        (alula.fly("hover-to-cruise", {"duration_s": 1.0}), ["hover-to-cruise: 1.0 s, 1001 steps"]),
        (flown, ["dispersed: 3 flights, "]),
        (alula.Simulation("round-trip"), ["round-trip: 0.00 of"]),
        (alula.Simulation("round-trip").now, ["0.00 s: at (0.0, "]),
    ]:
        assert all(word in repr(thing) for word in words), repr(thing)


def test_models_are_those_of_the_printed_equations():
    alpha = np.linspace(-math.pi, math.pi, 1001)
    plate = alula.Model.large_angle(c0=0.02, c1=0.9).coefficients(alpha)
    # Roundings of numbers up to 2, and of angles up to 4.
    assert np.allclose(plate["cl"], 0.9 * np.sin(2 * alpha), atol=2e-6)
    assert np.allclose(plate["cd"], 0.02 + 1.8 * np.sin(alpha) ** 2, atol=2e-6)
    assert np.allclose(plate["dcl"], 1.8 * np.cos(2 * alpha), atol=2e-6)
    table = alula.Model.load(alula.polars()[0])
    assert table.parameters is None and len(table.coefficients(0.1)) == 1


def test_a_measured_table_goes_through_its_rows():
    alpha = np.array([0, 10, 45, 90, 135, 180.0])
    cl, cd = np.array([0, 0.9, 1, 0, -1, 0.0]), np.array([0.02, 0.1, 0.9, 1.8, 0.9, 0.02])
    found = alula.Model.table(alpha, cl, cd).coefficients(np.radians(alpha))
    # Single precision of the angle, times slopes of 6.
    assert np.allclose(found["cl"], cl, atol=3e-6) and np.allclose(found["cd"], cd, atol=3e-6)


@pytest.mark.parametrize("form", ["robust", "full"])
def test_the_law_over_arrays_is_the_law(form):
    law = alula.Law(alula.Vehicle.load("paper-belief"), form)
    given = states(200)
    many = law.commands(*given)
    assert sum(many["status"] == "ok") > 190
    for k in range(200):
        arguments = given[0][k], float(given[1][k]), *(v[k] for v in given[2:])
        if many["status"][k] != "ok":
            # The full law alone, where it divides by zero.
            with pytest.raises(alula.Fault) as fault:
                law.command(*arguments)
            assert (fault.value.name, form) == (many["status"][k], "full")
            continue
        one = law.command(*arguments)
        for name in many.names[:-1]:
            assert many[name][k] == np.float32(getattr(one, name)), (k, name)


def test_rows_may_be_one_for_all_of_any_type_and_layout():
    law = alula.Law(alula.Vehicle.load("paper"))
    velocity, theta, reference, *_ = states(50)
    expected = law.commands(velocity, theta, np.tile(reference[0], (50, 1)))
    strided = np.zeros((50, 6), np.float64)
    strided[:, ::2] = velocity
    found = law.commands(strided[:, ::2], theta.tolist(), tuple(reference[0]))
    assert all(np.array_equal(found[name], expected[name]) for name in found.names)
    with pytest.raises(alula.FieldError) as refused:
        law.commands(velocity, theta[:-1], reference)
    assert refused.value.field == "theta" and "49 rows" in refused.value.problem
    with pytest.raises(alula.FieldError, match="wind"):
        law.commands(velocity, theta, reference, wind=np.zeros((50, 4)))


def test_a_fault_is_raised_by_one_and_told_by_many():
    law = alula.Law(alula.Vehicle.load("paper"))
    velocity, theta, reference, *_ = states(4)
    velocity[1, 0], theta[2], reference[3, 1] = np.nan, np.inf, np.nan
    many = law.commands(velocity, theta, reference)
    assert list(many["status"]) == ["ok", "velocity", "attitude", "reference_velocity"]
    assert not many["thrust_n"][1:3].any() and not many["rate_rad_s"][1:3].any() and many["thrust_n"][0] != 0.0
    with pytest.raises(alula.Fault, match="velocity is not finite") as fault:
        law.command(velocity[1], 0.0, (0, 0, 0))
    assert (fault.value.name, fault.value.field) == ("velocity", "velocity")
    with pytest.raises(alula.Fault) as fault:
        law.command((5, 0, 0), math.nan, (6, 0, 0))
    assert (fault.value.name, fault.value.field) == ("attitude", "theta")


def test_feed_forward_and_gains_count():
    vehicle = alula.Vehicle.load("paper")
    state = dict(velocity=(9.0, 0.0, 1.0), theta=-1.0, reference_velocity=(10.0, 0.0, 0.0))
    plain = alula.Law(vehicle).command(**state)
    assert alula.Law(vehicle, gains={}).command(**state).rate_rad_s == plain.rate_rad_s
    assert alula.Law(vehicle, gains={"k3": 3.0}).command(**state).rate_rad_s != plain.rate_rad_s
    assert alula.Law(vehicle, bandwidth={"damping": 0.7}).command(**state).rate_rad_s != plain.rate_rad_s
    fed = alula.Law(vehicle).command(**state, air_acceleration=(2.0, 0.0, 0.0))
    assert fed.rate_rad_s != plain.rate_rad_s and fed.thrust_n == plain.thrust_n


def test_a_million_states_take_less_than_two_seconds_and_leave_python_free():
    law = alula.Law(alula.Vehicle.load("paper-belief"))
    given = states(1_000_000)
    turns, done = 0, threading.Event()

    def other():
        nonlocal turns
        while not done.is_set():
            turns += 1
            time.sleep(1e-3)

    thread = threading.Thread(target=other)
    thread.start()
    begin, used = time.perf_counter(), time.thread_time()
    before = turns
    commands = law.commands(*given)
    during, used = turns - before, time.thread_time() - used
    done.set()
    thread.join()
    print(f"{used:.3f} s of one core, {time.perf_counter() - begin:.3f} s in all")
    assert len(commands) == 1_000_000 and used < 2.0
    # One turn may fall between the lock and the count.
    assert during > 3


def test_the_guidance_gives_the_commands_of_a_flight():
    """What a flight's guidance was told, told to one made here: the same thrusts and rates."""
    experiment = alula.Experiment("round-trip", {"duration_s": 12})
    record = experiment.fly().record
    table = experiment.get("controller.guidance")
    belief = table.pop("vehicle", None)
    vehicle = alula.Vehicle.load(belief if isinstance(belief, str) else "round-trip")
    table.setdefault("thrust_n", experiment.get("plant.thrust_n"))
    guidance = alula.Guidance(vehicle, **table, max_lateral_acceleration_g=0)
    vector = lambda name, unit: np.column_stack([record[f"told_{name}_{axis}_{unit}"] for axis in ("north", "east", "down")])
    told = {"velocity": vector("v", "m_s"), "reference_velocity": vector("vr", "m_s")}
    told["reference_acceleration"] = vector("ar", "m_s2")
    told["position_error"] = vector("x_error", "m")
    told["specific_force"] = np.column_stack([record[f"told_f_{axis}_m_s2"] for axis in ("forward", "right", "down")])
    told["quaternion"] = np.column_stack([record[f"told_attitude_{part}"] for part in "wxyz"])
    air = {"velocity": ("air_velocity", vector("va", "m_s")), "wind": ("wind", vector("wind", "m_s"))}
    for k, (thrust, rate) in enumerate(zip(record["thrust_n"], record["command_pitch_rad_s"])):
        arguments = {name: rows[k] for name, rows in told.items() if not np.isnan(rows[k]).any()}
        name, rows = air[record["told_air"][k]]
        guided = guidance.update(0.01, **arguments, **{name: rows[k]})
        assert (guided.thrust_n, guided.rates_rad_s[1]) == (thrust, rate), k
        assert guided.mode == record["mode"][k]
    assert guided.mode == "flying" and guided.rates_rad_s[0] == guided.rates_rad_s[2] == 0.0


def test_a_fleet_is_stepped_as_its_vehicles_are_one_by_one():
    """To the bit, over steps in which each goes its own way; what is given once stands for all."""
    vehicle, n = alula.Vehicle(**PAPER), 7
    fleet = alula.Fleet(vehicle, n, damping=0.7)
    alone = [alula.Guidance(vehicle, damping=0.7) for _ in range(n)]
    assert len(fleet) == n
    random = np.random.default_rng(3)
    velocity, error = np.zeros((n, 3)), random.normal(0, 1, (n, 3))
    heading = np.where(np.arange(n) % 2 == 0, np.nan, 0.5)
    told = dict(quaternion=(1, 0, 0, 0), axes="nose-up", reference_velocity=(5, 0, 0), wind=(0, 2, 0))
    for step in range(30):
        frame = fleet.update(0.01, velocity=velocity, position_error=error, heading=heading, **told)
        assert len(frame["thrust_n"]) == n
        for k, guidance in enumerate(alone):
            free = None if np.isnan(heading[k]) else float(heading[k])
            guided = guidance.update(0.01, velocity=velocity[k], position_error=error[k], heading=free, **told)
            rates = [frame[f"rate_{axis}_rad_s"][k] for axis in "xyz"]
            assert (frame["thrust_n"][k], *rates) == (np.float32(guided.thrust_n), *map(np.float32, guided.rates_rad_s)), (step, k)
            assert frame["mode"][k] == guided.mode and frame["status"][k] == "|".join(guided.status)
        velocity = velocity + random.normal(0, 0.1, (n, 3))
    assert guided.mode == "flying" and len(set(frame["thrust_n"])) == n
    fleet.reset()
    assert set(fleet.update(0.01, velocity=(math.nan, 0, 0), **told)["mode"]) == {"safe"}
    with pytest.raises(alula.FieldError, match="velocity: has 3 rows, there are 7 vehicles"):
        fleet.update(0.01, velocity=np.zeros((3, 3)), **told)
    with pytest.raises(alula.FieldError, match="n: must be"):
        alula.Fleet(vehicle, 0)


def test_the_guidance_in_space_hovers_and_remembers():
    guidance = alula.Guidance(alula.Vehicle(**PAPER))
    hover = dict(velocity=(0, 0, 0), quaternion=(1, 0, 0, 0), reference_velocity=(0, 0, 0), wind=(0, 0, 0), axes="nose-up")
    for _ in range(20):
        guided = guidance.update(0.01, **hover)
    # Roundings of 98.1 N.
    assert guided.mode == "flying" and abs(guided.thrust_n - 98.1) < 1e-3
    # Asked to move north, in the fixed-wing axes of the same attitude: nose over, about the right wing.
    upright = dict(quaternion=(math.sqrt(0.5), 0, math.sqrt(0.5), 0), axes="nose-forward")
    state = guidance.state
    north = guidance.update(0.01, **{**hover, **upright, "reference_velocity": (3, 0, 0), "reference_acceleration": (2, 0, 0)})
    assert north.rates_rad_s[1] < 0.0 and north.rate_rad_s == north.rates_rad_s[1]
    guidance.state = state
    again = guidance.update(0.01, **{**hover, **upright, "reference_velocity": (3, 0, 0), "reference_acceleration": (2, 0, 0)})
    assert again.rates_rad_s == north.rates_rad_s
    # A bad frame is bridged, then safe.
    bad = guidance.update(0.01, **{**hover, "velocity": (math.nan, 0, 0)})
    assert bad.mode == "holding" and bad.reject_reason == "velocity"
    guidance.reset()
    assert guidance.update(0.01, **hover).mode == "safe"
    with pytest.raises(alula.FieldError, match="axes"):
        guidance.update(0.01, **{**hover, "axes": "tail-first"})
    with pytest.raises(alula.FieldError, match="wind: cannot go with air_velocity"):
        guidance.update(0.01, **hover, air_velocity=(0, 0, 0))
    with pytest.raises(alula.FieldError, match="state: must be"):
        guidance.state = b"short"


def test_equilibria_hold_their_reference():
    vehicle = alula.Vehicle(**PAPER)
    law = alula.Law(vehicle)
    found = alula.equilibria(vehicle, (12.0, 0.0, 0.0), acceleration=(1.0, 0.0, 0.0), wind=(-2.0, 0.0, 0.0))
    assert [e.alpha_rad for e in found] == sorted(e.alpha_rad for e in found) and len(found) >= 2
    for e in found:
        command = law.command((12.0, 0.0, 0.0), e.theta_rad, (12.0, 0.0, 0.0), (1.0, 0.0, 0.0), (-2.0, 0.0, 0.0))
        # Roundings of the angle, 2e-7 rad, times forces of 200 N.
        assert command.thrust_n == pytest.approx(e.thrust_n, abs=1e-3)
        assert (abs(command.theta_tilde_rad) < 0.01) == (e.branch == "0")


def test_the_envelope_of_the_paper_and_of_the_same_vehicle_by_hand():
    envelope = alula.envelope("paper")
    # `the_combined_model_folds_where_theory_says`: level flight folds near 16° and 11°.
    folds = envelope.summary["folds"]
    assert len(folds) == 2 and len(envelope.curve) > 1000
    own = alula.envelope(alula.Vehicle(**PAPER)).summary
    for a, b in zip(folds, own["folds"]):
        # Single precision of the parameters.
        assert a["speed_m_s"] == pytest.approx(b["speed_m_s"], rel=1e-6)
    # At a fold the set that the flight computer finds changes its number by two.
    speed = folds[0]["speed_m_s"]
    count = lambda v: len(alula.equilibria("paper", (v, 0.0, 0.0)))
    assert abs(count(1.001 * speed) - count(0.999 * speed)) == 2
