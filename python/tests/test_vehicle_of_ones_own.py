"""`new`: what the command line makes, as objects."""

import json
import os
import subprocess

import pytest

import alula

KNOWN = dict(mass_kg=3.0, wing_m2=0.35, section="naca-0012", thrust_to_weight=1.6, thrust_lag_s=0.08, rate_lag_s=0.06, cruise_m_s=18.0, turn_rad_s2=300.0, actuators="both")


def without(name, **others):
    return {key: value for key, value in KNOWN.items() if key != name} | others


@pytest.mark.parametrize(
    ("known", "field", "problem"),
    [
        (without("mass_kg"), "mass_kg", "is missing"),
        (without("mass_kg", mass=3.0), "mass", "did you mean `mass_kg`"),
        (KNOWN | {"mass_kg": 3000.0}, "mass_kg", "were these g? Then it is 3"),
        (KNOWN | {"cruise_m_s": "fast"}, "cruise_m_s", "invalid type"),
    ],
)
def test_what_is_refused_is_named(known, field, problem):
    with pytest.raises(alula.FieldError) as refused:
        alula.new("mine", **known)
    assert (refused.value.field, problem in refused.value.problem) == (field, True), refused.value.problem
    assert "--" not in refused.value.problem


def test_it_is_flown_as_its_files_are(tmp_path):
    # Of a finite wing: the polar is a file beside the vehicle's.
    mine = alula.new("mine", **KNOWN, aspect_ratio=6.0)
    assert mine.outcome != "fails" and mine.verdict in repr(mine)
    assert mine.vehicle.parameters["mass_kg"] == 3.0 and mine.vehicle.name == "mine"
    guidance = alula.Guidance(mine.vehicle, **mine.parameters)
    assert guidance.parameters == mine.parameters
    own = mine.write(tmp_path / "mine")
    assert sorted(path.name for path in own.parent.iterdir()) == sorted(mine.files)
    assert alula.fly(own).figures == mine.flight.figures == mine.experiment.fly().figures
    with pytest.raises(FileExistsError, match="force=True"):
        mine.write(tmp_path / "mine")
    mine.write(tmp_path / "mine", force=True)


@pytest.mark.skipif("ALULA_SIL" not in os.environ, reason="ALULA_SIL names no program")
def test_the_command_line_says_the_same(tmp_path):
    flags = [word for key, value in KNOWN.items() for word in ("--" + key.replace("_", "-"), str(value))]
    run = subprocess.run([os.environ["ALULA_SIL"], "new", "mine", "--json", *flags], capture_output=True, text=True, cwd=tmp_path, check=True)
    told = json.loads(run.stdout)
    assert told["verdict"]["outcome"] == "as-asked"
    mine = alula.new("mine", **KNOWN)
    assert mine.outcome == "as-asked"
    assert (told["story"], told["warnings"], told["performance"], told["margins"]) == (mine.story, mine.warnings, mine.performance, mine.margins)
    assert told["first_flight"] == mine.flight.figures
    assert {path.name: path.read_text() for path in (tmp_path / "mine").iterdir() if path.name in mine.files} == mine.files
