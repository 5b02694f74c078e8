"""What the documentation shows does work."""

import re
import shlex
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from driver_model.manoeuvres import Manoeuvre
from driver_model.manoeuvres.shapes import smooth_step
from steering_bringup.cli import COMMANDS, run
from steering_bringup.cli import _parser as parser_of
from steering_bringup.scenario_files import load_scenario

ROOT = Path(__file__).parents[2]
CURVE = "torsion_bar_torque_Nm,load_pressure_Pa\n" + "".join(
    f"{torque},{1e5 * torque**3}\n" for torque in range(-6, 7)
)


def blocks(name: str, language: str) -> list[str]:
    """Return the code blocks of a Markdown file."""
    text = (ROOT / name).read_text(encoding="utf-8")
    return re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)


def test_the_readme_s_scenario_is_valid(tmp_path):
    (text,) = blocks("README.md", "yaml")
    (tmp_path / "mine.yaml").write_text(text)
    assert load_scenario(str(tmp_path / "mine.yaml")).duration == yaml.safe_load(text)["duration"]


def test_the_manoeuvre_of_the_guide_turns_the_wheel_and_comes_back():
    code = blocks("docs/extending.md", "python")[0]
    head = "from dataclasses import dataclass\nfrom typing import ClassVar\n"
    names: dict[str, Any] = {
        "np": np,
        "Manoeuvre": Manoeuvre,
        "smooth_step": smooth_step,
        "__name__": "guide",
    }
    exec(head + code, names)
    angle = names["DoubleStep"](angle_deg=20.0).angle(np.array([0.0, 1.2, 5.0]))
    assert angle == pytest.approx(np.radians([0.0, 20.0, 0.0]))


def run_examples() -> list[str]:
    """Return the arguments of the examples of ``steer run`` that need no recorded bag."""
    pages = ("README.md", "docs/commands.md", "docs/extending.md")
    text = "\n".join((ROOT / page).read_text(encoding="utf-8") for page in pages)
    lines = text.replace("\\\n", " ")
    found = re.findall(r"(?:`\./|^  )steer run((?: [^`\n|]*)?)", lines, re.MULTILINE)
    examples = {example.split("  ")[0] if "'" not in example else example for example in found}
    return sorted(e for e in examples if not re.search(r"--from-bag|\[|FILE|double_step", e))


@pytest.mark.parametrize("example", run_examples())
def test_every_example_of_a_run_can_be_planned(example, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (scenario,) = blocks("README.md", "yaml")
    Path("mine.yaml").write_text(
        scenario if "--node-set" not in example else shipped_closed_centre(), encoding="utf-8"
    )
    Path("next.yaml").write_text(scenario, encoding="utf-8")
    Path("changes.yaml").write_text("mechanics: {rack_mass: 30}\n", encoding="utf-8")
    Path("measured.csv").write_text(CURVE, encoding="utf-8")
    options = parser_of(["run"]).parse_args(["run", *shlex.split(example)])
    assert run.plans_of(options, run.scenario_of(options), tmp_path)


def shipped_closed_centre() -> str:
    """Return the node set that the guide says to copy."""
    path = "src/steering_bringup/steering_bringup/nodesets/closed_centre.yaml"
    return (ROOT / path).read_text(encoding="utf-8")


@pytest.mark.parametrize("command", COMMANDS)
def test_every_option_is_in_the_reference(command):
    text = (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")
    section = text.split(f"## steer {command}\n")[1].split("\n## ")[0]
    commands: Any = next(a for a in parser_of([command])._actions if a.dest == "command")
    for action in commands.choices[command]._actions:
        for name in action.option_strings:
            assert name in section


@pytest.mark.parametrize("file", ["README.md", "docs/extending.md"])
def test_every_link_leads_somewhere(file):
    path = ROOT / file
    links = re.findall(r"\]\(([^)#:]+)\)", path.read_text(encoding="utf-8"))
    assert links
    missing = [link for link in links if not (path.parent / link).exists()]
    assert not missing
