from dataclasses import fields
from pathlib import Path

import pytest

from driver_model.manoeuvres import MANOEUVRES
from steering_core.parameters import load_parameters

ROOT = Path(__file__).parents[2]
DRIVER = (ROOT / "src/driver_model/README.md").read_text(encoding="utf-8").splitlines()
VEHICLE = (ROOT / "src/vehicle_model/README.md").read_text(encoding="utf-8").splitlines()


@pytest.mark.parametrize("kind", [kind for kind in MANOEUVRES if kind != "table"])
def test_states_every_manoeuvre_with_its_defaults(kind):
    line = next(text for text in DRIVER if text.startswith(f"| `{kind}` |"))
    for field in fields(MANOEUVRES[kind]):
        shown = f"{field.default:g}" if isinstance(field.default, float) else field.default
        assert f"`{field.name}` {shown}" in line


@pytest.mark.parametrize(("group", "readme"), [("driver", DRIVER), ("vehicle", VEHICLE)])
def test_states_every_parameter_with_default_and_unit(group, readme):
    for name, value in load_parameters().group(group).items():
        full = f"{group}.{name}"
        unit = load_parameters().info(full).unit
        line = next(text for text in readme if text.startswith(f"| `{full}` |"))
        shown, shown_unit = (cell.strip() for cell in line.split("|")[2:4])
        assert float(shown) == value
        assert shown_unit == unit
