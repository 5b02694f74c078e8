"""Rigs as shipped, and one whose load cell alone tells of the load: what may have no name.

The emulator's file has noise, a late load cell, a late command and a specimen within tolerance.
"""

import pytest
from rig_bag import write_rig_bag

from steering_diagnosis.data.bag import record_from_bag
from steering_diagnosis.steering.diagnose_record import diagnose_record

DURATION = 8.0


def test_a_rig_within_its_tolerances_has_no_cause(tmp_path):
    bag = write_rig_bag(tmp_path / "clean", duration=DURATION, lost=frozenset({2000, 2001, 5000}))
    report = diagnose_record(record_from_bag(bag)).report
    assert report.verdict == "clean", report.sentence


@pytest.mark.slow
def test_a_load_cell_alone_tells_of_the_load(tmp_path):
    """The open-centre rig: its cell drives the replay, and is late, which only its file knows."""
    hidden = {"parameters": {"mechanics.rack_friction": 120.0}}
    bag = write_rig_bag(tmp_path / "oc", "open_centre_rig", duration=DURATION, hidden=hidden)
    (cause,) = diagnose_record(record_from_bag(bag)).report.causes
    assert cause.effect == "rack_friction_level"
    assert cause.parameters["factor"].value == pytest.approx(120.0 / 60.0, rel=0.15)
