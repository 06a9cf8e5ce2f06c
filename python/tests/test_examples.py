"""The examples run, and print what they say."""

import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[1] / "examples"


@pytest.mark.parametrize(
    ("script", "arguments", "lines"),
    [
        ("paper_flight.py", [], ["velocity error, peak             0.8626 m/s", "apparent force, smallest: 2.6 N at 8.185 s", "fold at 15.6° and 16.6 m/s"]),
        ("own_polar.py", [], ["fold at", "jump_up: ", "jump_down: ", "12 m/s: α"]),
        ("campaign.py", ["60"], ["<alula.Campaign dispersed", "widest band: ", "again: "]),
    ],
)
def test_an_example_runs(script, arguments, lines, tmp_path):
    run = subprocess.run([sys.executable, EXAMPLES / script, *arguments], capture_output=True, text=True, cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    for line in lines:
        assert line in run.stdout, run.stdout


def test_the_mission_of_the_readme_is_flown(capsys):
    [block] = [text for text in (EXAMPLES.parent / "README.md").read_text().split("```python\n")[1:] if "alula.Mission(" in text]
    exec(compile(block.split("```")[0], "README.md", "exec"), {})
    assert "at item 3" in capsys.readouterr().out


def test_every_example_is_run():
    tested = {"paper_flight.py", "own_polar.py", "campaign.py"}
    assert {path.name for path in EXAMPLES.glob("*.py")} == tested
