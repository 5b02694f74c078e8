"""What a bag must hold to stand for a node, and what the direct runner makes of it."""

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from steering_bringup.bags import BagWriter, first_difference, read_bag
from steering_bringup.bags.encode import encode
from steering_bringup.direct_run import run_direct
from steering_bringup.errors import BenchError
from steering_bringup.plans import Manner, make_plan
from steering_bringup.repeating import plan_from_bag
from steering_bringup.replays import load_replay, parse_replay
from steering_bringup.scenario_files import load_node_set, load_scenario
from steering_lockstep.graph import NodeSpec, check_graph
from steering_lockstep.settings import RunSettings

TICKS = 300
TOPIC = "/driver/torque"
TYPE = "steering_msgs/msg/DriverTorque"
FRAME = "steering_wheel"
MEASURED = ("/steering/torque", "/steering/pressure", "/steering/rack", "/clock")
PLANT = NodeSpec("plant", "plant", {TOPIC: 0}, MEASURED)


def driver(period=1):
    return NodeSpec("driver", "replay", {"/steering/torque": 0}, (TOPIC,), period)


def load(bag, ticks=10, period=1):
    spec = driver(period)
    return load_replay(spec, RunSettings(check_graph([PLANT, spec]), ticks), bag)


def write(folder: Path, ticks, *, msgtype=TYPE, frame=FRAME, topic=TOPIC, **values) -> Path:
    """Write a bag of one topic with messages of ``ticks``."""
    ticks = np.asarray(ticks)
    payloads = encode(msgtype, ticks * 1_000_000, values, frame)
    with BagWriter(folder / "bag", {topic: msgtype}) as writer:
        writer.write_block(ticks * 1_000_000, {topic: payloads})
    return folder / "bag"


def written(folder, ticks, **options):
    """The same with the tick's field in place."""
    ticks = np.asarray(ticks)
    options = {"tick": ticks, "torque": 0.5 * ticks} | options
    return write(folder, ticks, **options)


def test_every_message_of_the_run_is_found(tmp_path):
    replay = load(written(tmp_path, range(25)), ticks=10)
    assert replay.columns()[TOPIC][:, 0].tolist() == [0.5 * k for k in range(10)]


def test_a_slower_node_takes_its_ticks_out_of_a_faster_bag(tmp_path):
    replay = load(written(tmp_path, range(25)), ticks=21, period=10)
    assert replay.columns()[TOPIC][:, 0].tolist() == [0.0, 5.0, 10.0]


BAD: dict[str, tuple[Any, dict[str, Any], str]] = {
    "ends too early": (range(9), {}, r"ends at tick 8.*needs tick 9.*--duration 0\.009"),
    "begins too late": (range(3, 20), {}, "no message of tick 0 .3 of 10"),
    "has a gap": ([0, 1, 2, 5, 6, 7, 8, 9], {}, "no message of tick 3 .2 of 10"),
    "repeats": ([0, 1, 2, 2, 3, 4, 5, 6, 7, 8, 9], {}, "tick 2 a second time"),
    "runs back": ([0, 1, 2, 3, 4, 0, 1, 2, 3, 4], {}, "tick 0 a second time"),
    "has another type": (
        range(10),
        {"msgtype": "steering_msgs/msg/RackForce", "torque": None},
        "is steering_msgs/msg/RackForce there, not steering_msgs/msg/DriverTorque",
    ),
    "has another frame": (range(10), {"frame": "wheel"}, "another layout.*'steering_wheel'"),
    "has a frame as long": (range(10), {"frame": "steering-wheel"}, "another layout"),
    "has a NaN": (range(10), {"torque": [0.0] * 4 + [np.nan] * 6}, "not finite at tick 4"),
    "has ticks beside the time": (range(10), {"tick": range(1, 11)}, "message 0: its stamp"),
    "has another topic": (range(10), {"topic": "/other"}, "/driver/torque is not in it"),
}


@pytest.mark.parametrize("case", BAD)
def test_a_bag_that_cannot_stand_for_the_node_is_refused(case, tmp_path):
    ticks, options, text = BAD[case]
    values = {name: value for name, value in options.items() if value is not None}
    if "torque" in options and options["torque"] is None:
        bag = write(tmp_path, ticks, tick=np.asarray(ticks), **values)
    else:
        bag = written(tmp_path, ticks, **values)
    with pytest.raises(BenchError, match=f"node 'driver' .*bag.*{text}"):
        load(bag)


@pytest.mark.parametrize("text", ["driver", "=bag", "driver="])
def test_a_slip_on_the_command_line_is_explained(text):
    with pytest.raises(BenchError, match="write NODE=BAG"):
        parse_replay(text)


def plan(bag, node_set="closed_centre", amplitude=30.0, **from_bag):
    scenario = load_scenario("on_centre")
    manoeuvre = scenario.manoeuvre.model_copy(update={"amplitude_deg": amplitude})
    update = {"duration": TICKS * 1e-3, "manoeuvre": manoeuvre}
    scenario = scenario.model_copy(update=update)
    return make_plan(scenario, load_node_set(node_set), Manner("direct"), bag, from_bag)


@pytest.fixture(scope="module")
def original(tmp_path_factory):
    bag = tmp_path_factory.mktemp("original") / "bag"
    run_direct(plan(bag))
    return bag


@pytest.mark.parametrize("node", ["driver", "vehicle", "valve_left", "valve_right", "plant"])
def test_a_run_s_own_node_gives_its_bytes_again(node, original, tmp_path):
    run_direct(plan(tmp_path / "bag", **{node: original}))
    assert first_difference(read_bag(original), read_bag(tmp_path / "bag")) is None


def test_another_run_s_driver_drives(original, tmp_path):
    """The driver of ±20 degrees would turn less; the recorded one of ±30 degrees does not."""
    run_direct(plan(tmp_path / "plain", amplitude=20.0))
    run_direct(plan(tmp_path / "driven", amplitude=20.0, driver=original))
    first, driven = read_bag(original), read_bag(tmp_path / "driven")
    assert first_difference(first, read_bag(tmp_path / "plain")) is not None
    assert first_difference(first, driven) is None
    replayed = driven.run["replayed"]["driver"]
    assert replayed["bag"] == str(original)
    assert replayed["topics"] == ["/driver/torque"]
    assert replayed["started"] == first.run["started"]


def test_a_recorded_plant_leaves_the_controllers_in_the_open_loop(original, tmp_path):
    made = plan(tmp_path / "bag", amplitude=10.0, plant=original)
    run_direct(made)
    first, other = read_bag(original), read_bag(tmp_path / "bag")
    closed = ["/steering/torque", "/truth/plant", "/valve/left/command", "/vehicle/rack_force"]
    assert first_difference(first, other, closed) is None
    assert first_difference(first, other, ["/driver/torque"]) is not None


def test_a_replayed_run_is_repeated_from_its_own_bag(original, tmp_path):
    made = plan(tmp_path / "first", amplitude=20.0, driver=original)
    run_direct(made)
    first = read_bag(tmp_path / "first")
    run_direct(plan_from_bag(first, tmp_path / "second"))
    second = read_bag(tmp_path / "second")
    assert first_difference(first, second) is None
    before, after = (trace.run["replayed"]["driver"]["sha256"] for trace in (first, second))
    assert before == after


def test_a_bag_that_a_crash_cut_off_serves_as_far_as_it_goes(original, tmp_path):
    cut = tmp_path / "cut"
    shutil.copytree(original, cut)
    (file,) = cut.glob("*.mcap")
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    (cut / "metadata.yaml").unlink()
    with pytest.raises(BenchError, match=r"/driver/torque ends at tick .*--duration") as caught:
        plan(None, driver=cut)
    last = int(str(caught.value).split("ends at tick ")[1].split(",")[0])
    replay = load(cut, ticks=last + 1)
    whole = load(original, ticks=last + 1)
    assert np.array_equal(replay.payloads[TOPIC], whole.payloads[TOPIC])


def test_a_node_that_is_not_there_is_named(original):
    with pytest.raises(BenchError, match=r"'drivr'.*'driver'"):
        plan(None, drivr=original)
    with pytest.raises(BenchError, match=r"open_centre.*valve_left"):
        plan(None, node_set="open_centre", valve_left=original)
