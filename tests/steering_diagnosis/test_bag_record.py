"""Bags as records: what is taken from them, and that the truth in them is not."""

import numpy as np
import pytest

from steering_bringup.bags import BagWriter, read_bag
from steering_bringup.direct_run import run_direct
from steering_bringup.plans import Manner, make_plan
from steering_bringup.scenario_files import load_node_set, load_scenario
from steering_core.errors import BenchError
from steering_diagnosis.data.bag import record_from_bag
from steering_diagnosis.data.channels import CHANNELS, MEASURED

TICKS = 600


@pytest.fixture(scope="module")
def bag(tmp_path_factory):
    scenario = load_scenario("on_centre")
    update = {
        "duration": TICKS * 1e-3,
        "parameters": {**scenario.parameters, "mechanics.rack_mass": 25.0},
        "effects": {"rack_viscous_damping": {"added": 300.0}},
    }
    path = tmp_path_factory.mktemp("bags") / "run"
    node_set = load_node_set("closed_centre")
    run_direct(make_plan(scenario.model_copy(update=update), node_set, Manner("direct"), path))
    return path


def rewritten(bag, path, keep=lambda topic, tick: True, change=lambda topic, rows: rows):
    """Write a bag again with other messages."""
    trace = read_bag(bag)
    topics = {t: kind for t, kind in trace.types.items() if keep(t, 0) is not None}
    with BagWriter(path, topics, trace.run) as writer:
        for topic in topics:
            rows, stamps = change(topic, trace.payloads[topic].copy()), trace[topic]["stamp"]
            for stamp, row in zip(stamps.tolist(), rows, strict=True):
                if keep(topic, round(stamp / 1e6)):
                    writer.write(topic, stamp, row.tobytes())
    return path


def same(first, second):
    assert first.channels.keys() == second.channels.keys()
    for name, values in first.channels.items():
        assert np.array_equal(values, second[name]), name
    assert first.nominal == second.nominal
    assert (first.notes, first.valve_system) == (second.notes, second.valve_system)


def falsified(topic, rows):
    """Return the messages with every number of the truth set to another one."""
    if topic.startswith("/truth"):
        rows[:, -64:] = np.random.default_rng(1).integers(0, 255, (len(rows), 64), dtype=np.uint8)
    return rows


def test_all_channels_and_the_parameters_are_there(bag):
    record = record_from_bag(bag)
    assert set(record.channels) == set(CHANNELS)
    assert len(record) == TICKS
    assert record.valve_system == "closed_centre"
    assert record.vehicle_load == "bicycle"
    assert record.nominal["mechanics.rack_mass"] == 25.0
    assert record.excluded is None
    measured = read_bag(bag)["/steering/rack"]["position"]
    assert np.array_equal(record["rack_position"], measured)


def test_the_truth_is_not_read(bag, tmp_path):
    assert "/truth/plant" in read_bag(bag)
    record = record_from_bag(bag)
    false = rewritten(bag, tmp_path / "false", change=falsified)
    assert not np.array_equal(read_bag(false)["/truth/plant"], read_bag(bag)["/truth/plant"])
    same(record, record_from_bag(false))
    without = rewritten(
        bag, tmp_path / "without", keep=lambda topic, _: None if "truth" in topic else True
    )
    assert "/truth/plant" not in read_bag(without)
    same(record, record_from_bag(without))


def test_the_effects_in_the_metadata_are_not_read(bag):
    """They are the truth as well: the nominal parameters do not hold them."""
    assert read_bag(bag).run["effects"] or read_bag(bag).run["scenario"]["effects"]
    assert record_from_bag(bag).nominal["mechanics.rack_damping"] == 250.0


def test_missing_ticks_are_noted_and_not_judged(bag, tmp_path):
    lost = {*range(100, 120), 300}
    torn = rewritten(
        bag, tmp_path / "torn", keep=lambda t, tick: t != "/steering/rack" or tick not in lost
    )
    record = record_from_bag(torn)
    assert record.excluded is not None
    assert set(np.flatnonzero(record.excluded)) == lost
    assert np.isnan(record["rack_force"][110])
    assert any("21 of 600 ticks are missing in 2 gaps" in note for note in record.notes)


def test_what_was_not_measured_is_said(bag, tmp_path):
    bare = rewritten(
        bag, tmp_path / "bare", keep=lambda topic, _: None if "pressure" in topic else True
    )
    record = record_from_bag(bare)
    assert set(MEASURED) - set(record.channels) == {
        "left_pressure",
        "right_pressure",
        "supply_pressure",
    }
    assert any("not measured: left_pressure" in note for note in record.notes)


def test_a_bag_of_something_else_is_refused(bag, tmp_path):
    other = rewritten(
        bag, tmp_path / "other", keep=lambda topic, _: True if topic == "/clock" else None
    )
    with pytest.raises(BenchError, match="no bag of a steering gear"):
        record_from_bag(other)
