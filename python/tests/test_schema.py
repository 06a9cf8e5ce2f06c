"""`alula-sil schema`: every built-in experiment fits it, and none with a slip in a name, a kind or a value does."""

import json
import os
import subprocess
import tomllib
from pathlib import Path

import jsonschema
import pytest

FILES = sorted((Path(__file__).parents[2] / "host-tests/experiments").glob("*.toml"))
pytestmark = pytest.mark.skipif("ALULA_SIL" not in os.environ, reason="ALULA_SIL names no program")


@pytest.fixture(scope="module")
def schema():
    printed = subprocess.run([os.environ["ALULA_SIL"], "schema"], capture_output=True, text=True, check=True).stdout
    schema = json.loads(printed)
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def slips(value):
    """`value` with a slip in the name of one field, at every place that has one."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield {(name + "x" if name == key else name): v for name, v in value.items()}
            if key != "set":
                yield from ({**value, key: changed} for changed in slips(inner))
    if isinstance(value, list):
        for k, inner in enumerate(value):
            yield from (value[:k] + [changed] + value[k + 1 :] for changed in slips(inner))


@pytest.mark.parametrize("file", FILES, ids=lambda path: path.stem)
def test_a_built_in_fits_and_with_a_slip_does_not(schema, file):
    document = tomllib.loads(file.read_text())
    assert [error.message for error in schema.iter_errors(document)] == []
    changed = list(slips(document))
    assert changed and [slip for slip in changed if schema.is_valid(slip)] == []


@pytest.mark.parametrize(
    "text",
    [
        "vehicle.mass_kg = 'ten'",
        "vehicle.mass_kg = -1",
        "duration_s = 0",
        "path.circle = { radius_m = -40.0, speed_m_s = 20.0 }",
        "sensors.velocity_m_s = { noise = -0.1 }",
        "plant.kind = 'glider'",
        "plant.rate_loop = 'ideel'",
        "sensors.air = 'wind'",
        "path.circle = { radius_m = 40 }\nreference = 3",
        "controller.guidance.damping = -1",
        "controller.guidance = {}\ncontroller.law = {}",
        "path.legs = [{ speed_m_s = 3 }]",
        "mission.items = ['retrun']",
        "mission.responses.link = 'home'",
        "bounds.altitude_m = 3",
        "weather.steady_m_s = [1, 2]",
    ],
)
def test_a_wrong_value_does_not_fit(schema, text):
    assert not schema.is_valid(tomllib.loads(text))


@pytest.mark.parametrize(
    "text",
    [
        "base = 'mission'\npath.circle = { radius_m = 40 }",
        "sensors = 'autopilot'\nplant = { kind = 'tail-sitter', vehicle = 'mapping', delay_s = 0.01 }",
        "controller.law = { vehicle = 'paper', gains = { k3 = 6 } }\nplant.rate_loop = 'ideal'",
        "[set]\n'vehicle.mass_kg' = 3",
    ],
)
def test_what_is_put_over_a_base_fits(schema, text):
    assert schema.is_valid(tomllib.loads(text))
