"""Flights and campaigns: the figures of the command line, records without copies, errors that name the field."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest

import alula

# What the harness's own test of the paper's flight asks for: value and tolerance.
PAPER = {
    "max_velocity_error_m_s": (0.863, 0.01),
    "max_velocity_error_time_s": (8.215, 0.03),
    "min_fp_n": (2.6, 0.6),
    "max_rate_command_rad_s": (12.1, 0.4),
    "final_velocity_error_m_s": (0.0132, 0.001),
    "final_alpha_deg": (4.02, 0.02),
    "final_theta_deg": (-85.97, 0.02),
    "final_thrust_to_weight": (0.0410, 0.0006),
}


def command_line(*arguments):
    """What the command line prints as JSON, and whether it is content. `.ci/run` says where it is."""
    program = os.environ.get("ALULA_SIL")
    if program is None:
        pytest.skip("ALULA_SIL does not name the program alula-sil")
    done = subprocess.run([program, *arguments, "--json"], capture_output=True, text=True)
    assert done.stdout, done.stderr
    return json.loads(done.stdout), done.returncode == 0


def test_the_papers_flight_has_its_eight_figures():
    figures = alula.fly("hover-to-cruise").figures
    for name, (value, tolerance) in PAPER.items():
        assert abs(figures[name] - value) < tolerance, name
    assert figures["min_k"] is None and figures["lost"] is False


@pytest.mark.parametrize("name", ["hover-to-cruise", "round-trip", "start-cruise"])
def test_the_figures_are_those_of_the_command_line(name, tmp_path):
    printed, _ = command_line("fly", name, "--set", "seed=3", "--out", str(tmp_path))
    flight = alula.fly(name, {"seed": 3})
    for key in ("experiment", "out", "segments", "bounds_kept"):
        printed.pop(key, None)
    assert printed == flight.figures
    trace = pd.read_csv(tmp_path / "trace.csv", dtype=str, keep_default_na=False)
    assert list(trace.columns) == flight.record.names
    for column in trace.columns:
        own = flight.record[column]
        if own.dtype.kind == "f":
            # The trace has the shortest text that reads back to the same bits.
            assert np.array_equal(trace[column].map(float).to_numpy(own.dtype), own, equal_nan=True), column
        else:
            assert list(trace[column]) == list(own), column


def test_records_are_handed_over_without_copies():
    record = alula.fly("round-trip", {"duration_s": 1}).record
    assert len(record) == 101 and "mode" in record and "nonesuch" not in record
    thrust = record["thrust_n"]
    assert thrust.dtype == np.float32 and record["t_s"].dtype == np.float64
    assert np.shares_memory(thrust, record["thrust_n"]) and np.shares_memory(thrust, record.numpy()["thrust_n"])
    frame, table = record.pandas(), record.arrow()
    assert isinstance(frame, pd.DataFrame) and isinstance(table, pa.Table)
    assert list(frame.columns) == table.column_names == record.names
    for name in ("thrust_n", "t_s"):
        assert np.shares_memory(frame[name].to_numpy(), record[name])
        assert table[name].chunk(0).buffers()[1].address == record[name].ctypes.data
    assert record["mode"][-1] == "flying"
    assert list(frame["mode"]) == list(record["mode"]) == table["mode"].to_pylist()
    assert isinstance(frame["mode"].dtype, pd.CategoricalDtype)
    with pytest.raises(KeyError, match="nonesuch"):
        record["nonesuch"]


def test_a_flight_in_space_tells_its_bounds():
    flight = alula.fly("circle-40", ["duration_s=3", "settle_time_s=1", "bounds.max_bank_deg=1e-3"])
    assert flight.segments == [] and {"north_m", "attitude_w", "phase"} <= set(flight.record.names)
    (bound,) = [b for b in flight.beyond if b.figure == "max_bank_deg"]
    assert bound.value == flight.figures["max_bank_deg"] and bound.bound == 1e-3
    assert "not kept" in str(flight)


def test_experiments_come_from_names_files_and_texts(tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text('base = "round-trip"\nduration_s = 2\n')
    changes = {"vehicle.mass_kg": np.float32(11), "weather.steady_m_s": np.array([-1.0, 0.0, 0.0]), "seed": np.int64(3)}
    experiment = alula.Experiment(file, changes)
    assert experiment.name == "mine" and experiment.get("duration_s") == 2
    assert experiment.get("vehicle.mass_kg") == 11.0 and experiment.get("weather.steady_m_s[0]") == -1.0
    assert experiment.get("plant.nonesuch") is None
    # The whole text says the same without its base.
    again = alula.Experiment.from_toml(experiment.toml)
    assert again.fly().figures == experiment.fly().figures
    assert "hover-to-cruise" in alula.experiments() and "eight" in alula.experiments()


@pytest.mark.parametrize(
    ("source", "set", "field", "problem"),
    [
        ("hover-to-cruise", {"vehicle.mass_kg": -1}, "vehicle.mass_kg", "positive"),
        ("hover-to-cruise", ["vehicle.mass_kg=-1"], "vehicle.mass_kg", "positive"),
        ("hover-to-cruise", "duration_s=-1", "duration_s", "positive"),
        ("hover-to-cruise", {"vehicle.span_m": 1}, "vehicle.span_m", "unknown field"),
        ("hover-to-cruise", {"plant.thrust_n[7]": 1}, "plant.thrust_n[7]", "no such item"),
        ("round-trip", {"controller.guidance.damping": 1e9}, "controller.guidance.damping", "from 0.01 to 100"),
        ("eight", {"plant.thrust_lag_s": 9}, "plant.thrust_lag_s", "from 0 to 2"),
        ("round-trip", {"vehicle.mass_kg": object()}, "vehicle.mass_kg", "object"),
    ],
)
def test_a_field_that_is_refused_is_named(source, set, field, problem):
    with pytest.raises(alula.FieldError) as refused:
        alula.fly(source, set)
    assert refused.value.field == field and problem in refused.value.problem
    assert field in str(refused.value)


def test_what_is_not_there_is_said():
    with pytest.raises(ValueError, match="nonesuch: neither a file nor a built-in experiment"):
        alula.fly("nonesuch")
    with pytest.raises(OSError, match="nonesuch.toml"):
        alula.fly(Path("nonesuch.toml"))
    with pytest.raises(alula.FieldError, match="threads"):
        alula.campaign("dispersed", flights=1, threads=0)


def test_a_campaign_is_the_command_lines_whatever_the_threads(tmp_path):
    flown = alula.campaign("dispersed", flights=60, threads=2)
    flights, samples = flown.flights, flown.samples
    assert len(flights) == 60 and len(samples) == 60 * 101
    assert flights["passed"].dtype == bool and list(flights["flight"]) == list(range(60))
    assert np.shares_memory(flights.pandas()["min_k"].to_numpy(), flights["min_k"])
    alone = alula.campaign("dispersed", flights=60, threads=1)
    assert alone.summary == flown.summary
    # Flown again, by its number.
    assert flown.refly(7).figures["min_k"] == flights["min_k"][7]
    printed, passed = command_line("campaign", "dispersed", "--flights", "60", "--out", str(tmp_path / "theirs"))
    assert printed == flown.summary and passed == flown.passed
    theirs = pd.read_parquet(tmp_path / "theirs" / "flights.parquet")
    pd.testing.assert_frame_equal(theirs, flights.pandas(), check_exact=True)


def test_an_interrupt_ends_a_campaign():
    # A shell that starts jobs in the background has them ignore the interrupt: Python takes that over.
    listen = "import alula, signal; signal.signal(signal.SIGINT, signal.default_int_handler)"
    code = f"{listen}; print('begun', flush=True); alula.campaign('dispersed', flights=1_000_000)"
    flying = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    flying.stdout.readline()
    time.sleep(0.5)
    flying.send_signal(signal.SIGINT)
    _, errors = flying.communicate(timeout=60)
    assert errors.strip().endswith("KeyboardInterrupt")


COMPARISON = """
description = "two variants"
base = "round-trip"
[[variants]]
name = "guidance"
title = "the guidance"
[[variants]]
name = "paper"
title = "the paper's law alone"
[variants.controller.law]
vehicle = "paper-belief"
gains = { k1 = 0.1529, k2 = 0.0234, k3 = 6.0, tau_n = 80.0 }
[[conditions]]
name = "still"
title = "no wind"
"""


def test_a_comparison_is_a_row_per_flight(tmp_path):
    file = tmp_path / "two.toml"
    file.write_text(COMPARISON)
    frame = alula.compare(file)
    table = frame.pandas().set_index("variant")
    assert list(table["outcome"]) == ["flies", "departs"] and list(table["condition"]) == ["still", "still"]
    # The same flight by itself.
    figures = alula.fly("round-trip").figures
    assert table.loc["guidance", "max_gain_back_m"] == figures["max_gain_back_m"]
    with pytest.raises(alula.FieldError) as refused:
        alula.compare(file, threads=0)
    assert refused.value.field == "threads"


def test_margins_are_the_command_lines(tmp_path):
    loops = alula.margins("round-trip", speeds=[0, 20])
    assert [loop["gains"] for loop in loops] == ["experiment", "paper"]
    told, _ = command_line("margins", "round-trip", "--speeds", "0,20", "--out", str(tmp_path))
    assert loops == told["loops"]
    hover = loops[0]["points"][0]
    assert hover["speed_m_s"] == 0 and abs(hover["theta_deg"]) < 1e-6
    # Without the rate loop's lag the command may be later.
    bare = alula.margins("round-trip", speeds=[0], bare=True)[0]["points"][0]
    assert bare["delay_s"] > hover["delay_s"]
    with pytest.raises(alula.FieldError) as refused:
        alula.margins("round-trip", speeds=[-1])
    assert refused.value.field == "speeds"


def test_a_sweep_is_the_command_lines_and_counts_its_bound(tmp_path):
    found = alula.sweep("round-trip")
    told, _ = command_line("sweep", "round-trip", "--out", str(tmp_path))
    assert found == {key: told[key] for key in found}
    # Every force is below a thousand kilonewtons, for the whole flight.
    all_low = alula.sweep("round-trip", min_fp_n=1e6)["low_fp"]
    assert [(low["from_s"], low["to_s"]) for low in all_low] == [(0, 115)] and found["low_fp"] != all_low
    with pytest.raises(alula.FieldError) as refused:
        alula.sweep("round-trip", min_fp_n=-1)
    assert refused.value.field == "min_fp_n"


def test_a_field_is_swept_in_a_loop():
    most = [alula.fly("round-trip", {"vehicle.mass_kg": mass}).figures["max_gain_back_m"] for mass in (9, 10, 11)]
    assert len(set(most)) == 3 and all(gain < 5 for gain in most)


def test_random_starts_in_space():
    flown = alula.campaign("attitudes", flights=3)
    assert flown.passed and len(flown.flights) == 6 and flown.samples.names == []
    frame = flown.flights.pandas()
    worst = frame.loc[frame["height_lost_m"].idxmax()]
    again = alula.fly(worst["experiment"], {"seed": worst["seed"]})
    assert -again.figures["altitude_least_m"] == worst["height_lost_m"]
    assert {"dispersed", "attitudes"} <= set(alula.campaigns())


def test_a_trace_replays_to_the_commands_flown(tmp_path):
    flight = alula.fly("round-trip", {"duration_s": 8})
    trace = tmp_path / "trace.csv"
    flight.record.pandas().to_csv(trace, index=False, na_rep="NaN")
    again = alula.replay(trace, "round-trip")
    assert again.notes == [] and np.array_equal(again.record["t_s"], flight.record["t_s"])
    for name in ("thrust_n", "command_pitch_rad_s", "margin_fold_rad"):
        assert np.array_equal(again.record[name], flight.record[name]), name
    assert np.isnan(again.record["true_thrust_n"]).all()
    with pytest.raises(OSError, match="nonesuch.ulg"):
        alula.replay("nonesuch.ulg")
