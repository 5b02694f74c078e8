"""A node of the graph replaced by its recording: the barrier, the order and the bytes stay."""

import pytest
from bench_process import Bench

from steering_bringup.bags import first_difference, read_bag

pytest.importorskip("rclpy")
pytestmark = pytest.mark.ros

WORDS = ("run", "on_centre", "--node-set", "closed_centre", "--duration", "1.2")
LAYOUTS = ("one", "each")
NODES = ("driver", "vehicle", "valve_left", "plant", "driver valve_right")


@pytest.fixture(scope="module")
def original(tmp_path_factory):
    folder = tmp_path_factory.mktemp("original")
    status, _, err = Bench(*WORDS, "--direct", "--out", "out", folder=folder).finish()
    assert status == 0, err
    return folder / "out" / "closed_centre"


def run(folder, *words):
    status, out, err = Bench(*WORDS, *words, "--out", "out", folder=folder).finish()
    assert status == 0, err
    assert " 0 lost" in out
    return out, folder / "out" / "closed_centre"


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("nodes", NODES)
def test_its_own_recording_gives_the_same_bytes(nodes, layout, original, tmp_path):
    words = [word for node in nodes.split() for word in ("--from-bag", f"{node}={original}")]
    out, bag = run(tmp_path, *words, "--processes", layout)
    assert first_difference(read_bag(original), read_bag(bag)) is None
    for node in nodes.split():
        assert f"node '{node}' was replayed from '{original}'" in out


def test_another_driver_drives_and_the_run_can_be_repeated(original, tmp_path):
    change = ("--set", "manoeuvre.amplitude_deg=20", "--from-bag", f"driver={original}")
    _, bag = run(tmp_path, *change)
    assert first_difference(read_bag(original), read_bag(bag)) is None
    for words in ((), ("--direct",)):
        status, out, err = Bench("repeat", str(bag), *words, folder=tmp_path).finish()
        assert status == 0, err
        assert "the same, bit for bit" in out


def test_delayed_connections_get_the_recorded_messages_as_late(original, tmp_path):
    delays = ("--delay", "/driver/torque->plant=2", "--delay", "/steering/torque->driver=3")
    for folder in ("plain", "replayed"):
        (tmp_path / folder).mkdir()
    _, plain = run(tmp_path / "plain", *delays)
    _, replayed = run(tmp_path / "replayed", *delays, "--from-bag", f"driver={plain}")
    assert first_difference(read_bag(plain), read_bag(replayed)) is None
    assert first_difference(read_bag(original), read_bag(plain)) is not None


def test_a_bag_that_is_too_short_starts_nothing(original, tmp_path):
    words = ("--duration", "1.5", "--from-bag", f"driver={original}")
    status, _, err = Bench(*WORDS, *words, folder=tmp_path).finish()
    assert status == 1
    assert "/driver/torque ends at tick 1199" in err
    assert "--duration 1.2" in err
    assert not (tmp_path / "results").exists()
