"""A rig that differs from the data sheet in ways that only its own file knows: they are found.

The emulator's file has noise, a late load cell, a late command and a specimen within tolerance too:
nothing of that may be given a name.
"""

from typing import Any

import numpy as np
import pandas as pd
import pytest
import yaml
from asammdf import MDF, Signal
from rig_bag import write_rig_bag

from steering_diagnosis.data.bag import record_from_bag
from steering_diagnosis.data.channels import CHANNELS
from steering_diagnosis.data.read import read_record
from steering_diagnosis.steering.diagnose_record import diagnose_record

FRICTION, OFFSET = 120.0, 2.5e5
HIDDEN = {
    "parameters": {"mechanics.rack_friction": FRICTION},
    "sensors": {"left_pressure": {"noise": 5e3, "offset": OFFSET}},
}
FACTOR = FRICTION / 60.0
DURATION = 8.0
LOST = frozenset({2000, 2001, 5000})


@pytest.fixture(scope="module")
def bag(tmp_path_factory):
    path = tmp_path_factory.mktemp("rig") / "hidden"
    return write_rig_bag(path, duration=DURATION, hidden=HIDDEN, lost=LOST)


def test_what_only_the_rigs_own_file_knows_is_found(bag):
    report = diagnose_record(record_from_bag(bag)).report
    assert report.verdict == "named", report.sentence
    causes = {cause.effect: cause.parameters for cause in report.causes}
    assert set(causes) == {"rack_friction_level", "pressure_sensor_offset_left"}
    factor = causes["rack_friction_level"]["factor"]
    offset = causes["pressure_sensor_offset_left"]["offset"]
    assert factor.value == pytest.approx(FACTOR, rel=0.15)
    assert factor.low < FACTOR < factor.high
    assert offset.value == pytest.approx(OFFSET, rel=0.15)
    assert offset.low < OFFSET < offset.high


UNITS = {
    "left_pressure": ("bar", 1e5),
    "right_pressure": ("bar", 1e5),
    "rack_position": ("mm", 1e-3),
}
"""Of the exported file, where it has other ones than SI."""


def exported(bag, folder, kind):
    """Write a rig's bag as another tool would, and the mapping; return both paths."""
    record = record_from_bag(bag)
    columns = {}
    mapping: dict[str, Any] = {
        "schema": 1,
        "valve_system": record.valve_system,
        "parameters": {"valve_controller.resonance": 300.0},
        "channels": {},
    }
    for name, values in record.channels.items():
        unit, size = UNITS.get(name, (CHANNELS[name].unit, 1.0))
        columns[name] = values / size
        mapping["channels"][name] = {"from": name, "unit": unit}
    path = folder / f"run.{kind}"
    if kind == "csv":
        mapping["time"] = "t"
        pd.DataFrame({"t": record.time, **columns}).dropna().to_csv(path, index=False)
    else:
        with MDF() as file:
            file.append([Signal(v, record.time, name=n) for n, v in columns.items()])
            file.save(path)
    (folder / "mapping.yaml").write_text(yaml.safe_dump(mapping))
    return path, folder / "mapping.yaml"


@pytest.mark.parametrize("kind", ["csv", "mf4"])
def test_a_file_of_another_tool_holds_the_same_record(kind, bag, tmp_path):
    from_bag, from_file = record_from_bag(bag), read_record(*exported(bag, tmp_path, kind))
    assert from_file.channels.keys() == from_bag.channels.keys()
    # What a bag does not judge, a file has bridged by itself, in a table the whole row.
    known = np.all([np.isfinite(v) for v in from_bag.channels.values()], axis=0)[:-1]
    for name, values in from_bag.channels.items():
        assert from_file[name][: len(known)][known] == pytest.approx(values[:-1][known], rel=1e-6)
