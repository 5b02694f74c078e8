"""Message files: header and tick first, then numbers with a unit and a sign or meaning."""

import re
from pathlib import Path

import pytest

FOLDER = Path(__file__).resolve().parents[2] / "src" / "steering_msgs" / "msg"
FILES = sorted(FOLDER.glob("*.msg"))
UNITS = ("rad", "rad/s", "N m", "N", "N/m", "Pa", "m", "m/s", "m/s^2", "m^3/s", "J", "1")
SIGN = re.compile(r"positive|negative|K_T|supply port|load")


def fields(file: Path) -> list[tuple[str, str, str]]:
    """Type, name and comment of every field."""
    rows = []
    for line in file.read_text().splitlines():
        if line and not line.startswith("#"):
            declaration, _, comment = line.partition("#")
            kind, name = declaration.split()
            rows.append((kind, name, comment.strip()))
    return rows


def test_all_messages_are_there():
    names = {file.stem for file in FILES}
    assert names >= {
        "SteeringTorque", "ChamberPressure", "RackState", "DriverTorque", "ValveCommand",
        "RackForce", "PlantTruth", "TickReport",
    }  # fmt: skip


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_header_and_tick_come_first(file):
    kinds = [(kind, name) for kind, name, _ in fields(file)]
    assert kinds[:2] == [("std_msgs/Header", "header"), ("uint64", "tick")]
    assert {kind for kind, _ in kinds[2:]} <= {"float64", "uint32", "bool", "string"}


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_every_number_names_unit_and_sign(file):
    for kind, name, comment in fields(file)[2:]:
        if kind in ("bool", "string"):
            assert comment, name
            continue
        unit = re.match(r"[\w/^ ]+?(?=,| on | at | gauge| \w{3,}|$)", comment)
        assert unit is not None, name
        assert unit.group() in UNITS, (name, comment)
        assert SIGN.search(comment), (name, comment)
