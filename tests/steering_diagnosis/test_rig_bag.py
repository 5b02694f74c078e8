"""Bags of a rig as records: what acted and was measured, by what the bag's metadata tell."""

import numpy as np
import pytest
from rig_bag import write_rig_bag

from steering_bringup.bags import note_in_bag, read_bag
from steering_diagnosis.data.bag import record_from_bag

LOST = frozenset({300, 301, 600})


@pytest.fixture(scope="module")
def bag(tmp_path_factory):
    return write_rig_bag(tmp_path_factory.mktemp("rig") / "run", duration=0.8, lost=LOST)


@pytest.fixture
def again(bag):
    """Give a way to change the bridge's report in the bag; it is as before afterwards."""
    run = read_bag(bag).run
    yield lambda **report: note_in_bag(bag, {"rig_run": {**run["rig_run"], **report}})
    note_in_bag(bag, {"rig_run": run["rig_run"]})


def test_commands_act_when_they_did(bag):
    record, trace = record_from_bag(bag), read_bag(bag)
    for name, topic, field in (
        ("driver_torque", "/driver/torque", "torque"),
        ("left_solenoid_force", "/valve/left/command", "solenoid_force"),
    ):
        recorded = trace[topic][field]
        assert np.array_equal(record[name][1:], recorded[:-1])
    assert any("1 ms later" in note for note in record.notes)
    # The load's command is also the vehicle model's output at its own tick.
    assert np.array_equal(record["load_position"], trace["/vehicle/rack_force"]["position"])


def test_lost_frames_are_not_judged(bag):
    record = record_from_bag(bag)
    assert record.excluded is not None
    assert set(np.flatnonzero(record.excluded)) == LOST
    assert np.isnan(record["rack_force"][sorted(LOST)]).all()


def test_the_safe_state_is_not_judged(bag, again):
    again(changes=[{"tick": 500, "to": "safe"}, {"tick": 700, "to": "running"}])
    record = record_from_bag(bag)
    assert record.excluded is not None
    assert set(np.flatnonzero(record.excluded)) == LOST | set(range(500, 700))
    assert not record["left_solenoid_force"][501:701].any()


def test_commands_are_those_that_the_guard_let_through(bag, again):
    unlimited = record_from_bag(bag)["driver_torque"]
    run = read_bag(bag).run
    rig = run["rig"]
    largest = float(np.abs(unlimited).max()) / 2.0
    rig["content"]["channels"]["driver_torque"]["range"] = [-largest, largest]
    note_in_bag(bag, {"rig": rig})
    again(limited_commands=1)
    assert np.abs(record_from_bag(bag)["driver_torque"]).max() == largest


def test_a_load_cylinders_reference_is_no_load(tmp_path):
    record = record_from_bag(write_rig_bag(tmp_path / "run", "open_centre_rig", duration=0.1))
    assert "rack_force" in record
    assert "load_force" not in record
    assert any("load cylinder" in note for note in record.notes)
