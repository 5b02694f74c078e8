"""One specimen through two doors with the same channels: one verdict, one cause, one size."""

import pytest

from steering_core.parameters import load_parameters
from steering_diagnosis.benchmark.cases import draw_case, system_of
from steering_diagnosis.benchmark.doors.door import Door
from steering_diagnosis.benchmark.doors.logger import Logger
from steering_diagnosis.benchmark.doors.write import paths, write_mapping, write_through
from steering_diagnosis.data.read import read_record
from steering_diagnosis.steering import suspects
from steering_diagnosis.steering.diagnose_record import diagnose_record
from steering_plant.effects import EFFECTS

NOMINAL = load_parameters()
SECONDS = 3.0
LACKING = ("load_command", "speeds", "driver_torque")
PLAIN = Door("bag", LACKING)
CSV = Door("csv", LACKING, Logger(start=1712.25, drift=4e-5, jitter=2e-5), way=1)
MDF = Door("mdf", LACKING, Logger(start=3.5, drift=-3e-5, other=(0.1, 2e-5)))
KNOWN = (
    "torque_sensor_offset",
    "torque_sensor_gain",
    "rack_friction_level",
    "cross_piston_leakage",
    "pressure_sensor_offset_left",
    "pump_flow_level",
)
"""Enough of the catalogue to be wrong; all of it takes minutes."""


@pytest.fixture(autouse=True)
def small_catalogue(monkeypatch):
    monkeypatch.setattr(suspects, "EFFECTS", {name: EFFECTS[name] for name in KNOWN})


def reports(kind, seed, effect, doors, folder):
    """Return a specimen's report through each door."""
    assert system_of(kind, seed, effect) == "open_centre"
    drawn = draw_case(kind, seed, effect, seconds=SECONDS)
    for door in doors:
        at = paths(door, folder, f"record-{door.kind}")
        system, load = drawn.sealed.valve_system, drawn.sealed.load
        write_through(door, at.record, drawn.signals, NOMINAL, system, load)
        if at.mapping is not None:
            write_mapping(door, at.mapping, drawn.signals, system)
        yield drawn.sealed, diagnose_record(read_record(at.record, at.mapping)).report


@pytest.mark.parametrize(
    ("kind", "seed", "effect", "doors"),
    [
        ("clean", 840110, None, (PLAIN, MDF)),
        ("visible", 840110, "torque_sensor_offset", (PLAIN, CSV)),
    ],
)
def test_the_same_is_said_of_the_same_specimen(kind, seed, effect, doors, tmp_path):
    (sealed, one), (_, two) = reports(kind, seed, effect, doors, tmp_path)
    assert one.verdict == two.verdict == ("clean" if effect is None else "named")
    assert [c.effect for c in one.causes] == [c.effect for c in two.causes] == list(sealed.hidden)
    for first, second in zip(one.causes, two.causes, strict=True):
        assert first.parameters.keys() == second.parameters.keys()
        for name, here in first.parameters.items():
            there = second.parameters[name]
            assert here.low <= there.value <= here.high
            assert there.low <= here.value <= there.high
