"""``steer play`` and plain subscribers in another process."""

import fcntl
import json
import os
import pty
import re
import signal
import struct
import subprocess
import sys
import termios
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from bench_process import Bench, wait_for
from foreign_bags import FLOAT, STEP, T0, TEXT, numbers, profile, text, write_mcap
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from steering_bringup.bags import BagWriter, read_bag
from steering_bringup.bags.encode import encode
from steering_lockstep.domain import claim_domain

rclpy = pytest.importorskip("rclpy")
from rclpy.context import Context  # noqa: E402
from rclpy.executors import SingleThreadedExecutor  # noqa: E402
from rclpy.qos import DurabilityPolicy, QoSProfile  # noqa: E402
from std_msgs.msg import String  # noqa: E402

pytestmark = pytest.mark.ros

LISTENER = Path(__file__).parents[1] / "support" / "topic_listener.py"
TOPICS = {
    "/driver/torque": ("steering_msgs/msg/DriverTorque", "steering_wheel"),
    "/steering/rack": ("steering_msgs/msg/RackState", "rack"),
}
CLOCK = "rosgraph_msgs/msg/Clock"
TICKS = 600


@pytest.fixture
def domain():
    claim = claim_domain()
    yield str(claim.number)
    claim.release()


@pytest.fixture(scope="module")
def bag(tmp_path_factory):
    """0.6 s of two topics at 1 kHz with random numbers."""
    folder, ticks = tmp_path_factory.mktemp("play") / "bag", np.arange(TICKS)
    random = np.random.default_rng(7)
    with BagWriter(folder, {topic: kind for topic, (kind, _) in TOPICS.items()}) as writer:
        payloads = {
            topic: encode(kind, ticks * 10**6, {"tick": ticks, name: random.normal(size=TICKS)}, f)
            for (topic, (kind, f)), name in zip(TOPICS.items(), ("torque", "force"), strict=True)
        }
        writer.write_block(ticks * 10**6, payloads)
    return folder


class Listener:
    """The plain program, with the user's default middleware settings."""

    def __init__(self, folder, domain, count, topics):
        self.out = folder / "heard.json"
        environment = {
            **os.environ,
            "ROS_DOMAIN_ID": domain,
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "PYTHONPATH": os.pathsep.join(p for p in sys.path if p),
        }
        words = [f"{topic}={kind}" for topic, kind in topics.items()]
        self.process = subprocess.Popen(
            [sys.executable, str(LISTENER), str(self.out), str(count), "40", *words],
            env=environment,
            stdout=subprocess.PIPE,
            text=True,
        )
        assert self.process.stdout is not None
        assert self.process.stdout.readline() == "ready\n"

    def heard(self):
        self.process.communicate(timeout=60)
        return json.loads(self.out.read_text())


def types():
    return {topic: kind for topic, (kind, _) in TOPICS.items()}


def play(folder, domain, *words):
    status, out, err = Bench("play", *map(str, words), "--domain", domain, folder=folder).finish()
    assert status == 0, err
    return out


def seen(heard, topic):
    return [bytes.fromhex(data) for _, data in heard[topic]]


def assert_took(times, seconds):
    """Never faster; how much slower is the load's affair. Pacing itself is tested on its own."""
    assert seconds - 0.1 < (times[-1] - times[0]) * 1e-9 < seconds + 2.0


@pytest.mark.parametrize("rate", ["0.5x", "1", "max"])
def test_a_subscriber_gets_every_recorded_byte(rate, bag, domain, tmp_path):
    listener = Listener(tmp_path, domain, TICKS, {**types(), "/clock": CLOCK})
    waits = [word for topic in TOPICS for word in ("--wait-for", topic)]
    out = play(tmp_path, domain, bag, "--rate", rate, *waits)
    heard, recorded = listener.heard(), read_bag(bag)
    for topic in TOPICS:
        assert seen(heard, topic) == [row.tobytes() for row in recorded.payloads[topic]]
    assert f"{2 * TICKS} messages on 2 topics" in out
    times = [t for t, _ in heard["/driver/torque"]]
    if rate != "max":
        assert_took(times, 0.599 / float(rate.rstrip("x")))
    assert len(heard["/clock"]) >= 20


def test_a_part_again_and_again_under_another_name(bag, domain, tmp_path):
    """From 0.1 s to 0.2 s, three times over: the same hundred messages without a seam."""
    listener = Listener(tmp_path, domain, 300, {"/mine": TOPICS["/driver/torque"][0]})
    words = ["play", str(bag), "--loop", "--from", "0.1", "--to", "0.2", "--domain", domain]
    words += ["--topics", "/driver/torque", "--remap", "/driver/torque:=/mine"]
    bench = Bench(*words, "--wait-for", "/mine", folder=tmp_path)
    heard = listener.heard()
    bench.process.send_signal(signal.SIGINT)
    status, out, _ = bench.finish()
    assert status == 130
    assert "passes" in out
    rows = read_bag(bag).payloads["/driver/torque"][100:200]
    assert seen(heard, "/mine")[:300] == [row.tobytes() for row in rows] * 3
    times = [t for t, _ in heard["/mine"]]
    assert_took(times[:300], 0.299)
    assert bench.left_over() == []


def foreign(folder):
    """A bag of another tool: a standard type, one that is not installed, and one that differs."""
    store = get_typestore(Stores.ROS2_JAZZY)
    other = {"rig_msgs/msg/Gauge": "float32 strain\n", TOPICS["/driver/torque"][0]: "int8 gear\n"}
    for name, definition in other.items():
        store.register(get_types_from_msg(definition, name))
    topics = {"/text": "std_msgs/msg/String", "/gauge": "rig_msgs/msg/Gauge"}
    topics["/driver/torque"] = TOPICS["/driver/torque"][0]
    with Writer(folder / "rig", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        made = {t: writer.add_connection(t, kind, typestore=store) for t, kind in topics.items()}
        for k in range(20):
            message = store.types["std_msgs/msg/String"](data=f"text {k}")
            data = store.serialize_cdr(message, "std_msgs/msg/String")
            writer.write(made["/text"], 10**18 + k * 10**7, data)
            writer.write(made["/gauge"], 10**18 + k * 10**7, b"\0\1\0\0abcd")
            writer.write(made["/driver/torque"], 10**18 + k * 10**7, b"\0\1\0\0a")
    return folder / "rig"


def test_what_is_not_installed_is_said_and_left_out(domain, tmp_path):
    listener = Listener(tmp_path, domain, 20, {"/text": "std_msgs/msg/String"})
    out = play(tmp_path, domain, foreign(tmp_path), "--wait-for", "/text")
    assert [data[8:].decode().rstrip("\0") for data in seen(listener.heard(), "/text")] == [
        f"text {k}" for k in range(20)
    ]
    assert "/gauge: its type rig_msgs/msg/Gauge is not installed" in out
    assert "/driver/torque: the bag's steering_msgs/msg/DriverTorque has other fields" in out


def test_every_installed_type_is_that_of_a_bag():
    """Also those with char, which other tools hash as another type; another field is told."""
    from steering_bringup.bags.sources import TopicInfo
    from steering_bringup.playback.installed import NotPlayable, message_class

    store, seen = get_typestore(Stores.ROS2_JAZZY), 0
    packages = ("std_msgs", "sensor_msgs", "geometry_msgs", "nav_msgs", "visualization_msgs")
    for name in store.fielddefs:
        if name.startswith(packages):
            text, digest = store.generate_msgdef(name, ros_version=2)[0], store.hash_rihs01(name)
            made = message_class(TopicInfo("/a", name, 1, "cdr", text, digest))
            assert made.__name__ == name.rpartition("/")[2]
            seen += 1
    assert seen > 80
    assert message_class(TopicInfo("/a", "std_srvs/srv/SetBool_Event", 1)) is not None
    odd = [("std_msgs/msg/Char", "int8 data\n", "'data' is int8 there, uint8 here")]
    odd += [("", "", "no schema"), ("std_msgs/msg/Chart", "", "not installed"), ("x", "", "not in")]
    for name, text, why in odd:
        with pytest.raises(NotPlayable, match=why):
            message_class(TopicInfo("/a", name, 1, "cdr", text))


def test_what_cannot_be_played_costs_no_other(domain, tmp_path):
    char = ("std_msgs/msg/Char", "ros2msg", "char data # one\n")
    channels: list[tuple[Any, ...]] = [
        ("/good", FLOAT, numbers()),
        ("/good", TEXT, [(T0, b"\0\1\0\0\1\0\0\0\0")]),
        ("/usb-cam/torque", FLOAT, numbers()),
        ("/lidar/192_168", FLOAT, numbers()),
        ("no_slash", FLOAT, numbers()),
        ("/bare", None, numbers()),
        ("/json", ("x", "jsonschema", "{}"), numbers(), ("json", {})),
        ("/letter", char, [(T0, b"\0\1\0\0a")]),
    ]
    bag = write_mcap(tmp_path / "rig.mcap", channels)
    listener = Listener(tmp_path, domain, 20, {"/good": FLOAT[0], "/letter": char[0]})
    rename = ("--remap", "/lidar/192_168:=/lidar/range")
    waits = ("--wait-for", "/good", "--wait-for", "/letter", "--json", tmp_path / "played.json")
    out = play(tmp_path, domain, bag, *waits, *rename)
    heard = listener.heard()
    assert seen(heard, "/good") == [data for _, data in numbers()]
    assert [data[4:5] for data in seen(heard, "/letter")] == [b"a"]
    assert "/usb-cam/torque: no legal topic name: rename it" in out
    assert "'/usb-cam/torque:=/usb_cam/torque' (20 messages)" in out
    assert "/bare: the bag does not tell its type, it has no schema (20 messages)" in out
    assert "/json: its messages are encoded as 'json', not as cdr (20 messages)" in out
    assert f"cdr): /good is played as {FLOAT[0]} (1 messages)" in out
    counts = json.loads((tmp_path / "played.json").read_text())["counts"]
    assert counts == {"/good": 20, "/lidar/192_168": 20, "no_slash": 20, "/letter": 1}


def test_late_subscribers_get_what_was_kept_before_from(domain, tmp_path):
    """The crash took metadata.yaml; the file itself tells that the topic is transient local."""
    told = {"offered_qos_profiles": yaml.safe_dump([profile()])}
    words = [(T0, text("old")), (T0 + STEP, text("new"))]
    channels = [("/rig", TEXT, words, ("cdr", told)), ("/good", FLOAT, numbers(6000))]
    bag = write_mcap(tmp_path / "rig.mcap", channels)
    bench = Bench("play", str(bag), "--from", "1", "--domain", domain, folder=tmp_path)
    context = Context()
    rclpy.init(context=context, domain_id=int(domain))
    node, heard = rclpy.create_node("late", context=context), []
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    try:
        wait_for(lambda: node.count_publishers("/rig"))
        time.sleep(1.0)  # what comes first has been published
        qos = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        node.create_subscription(String, "/rig", lambda message: heard.append(message.data), qos)
        deadline = time.monotonic() + 20.0
        while not heard and time.monotonic() < deadline:
            executor.spin_once(timeout_sec=0.1)
    finally:
        bench.process.send_signal(signal.SIGINT)
        _, out, _ = bench.finish()
        executor.shutdown()
        node.destroy_node()
        context.try_shutdown()
    assert heard == ["new"]
    assert "1 kept messages from before --from come first" in out


def test_a_cut_off_bag_plays_what_is_there(bag, domain, tmp_path):
    data = next(bag.glob("*.mcap")).read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(data[: len(data) // 2])
    out = play(tmp_path, domain, cut, "--rate", "max")
    assert "note         cut.mcap is not complete" in out
    assert 100 < int(re.findall(r"(\d+) messages on", out)[0]) < 2 * TICKS


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (("--topics", "/driver/torqe"), "'/driver/torque'"),
        (("--from", "5"), "0.599 s long"),
        (("--from", "0.3", "--to", "0.2"), "not after"),
        (("--rate", "0"), "--rate 0"),
        (("--remap", "/driver/torque:=/a b"), "no topic name"),
        (("--domain", "999"), "0 to 232"),
        (("--clock", "-1"), "--clock"),
    ],
)
def test_slips_are_explained(words, text, bag, tmp_path):
    status, _, err = Bench("play", str(bag), *words, folder=tmp_path).finish()
    assert status == 1
    assert text in err
    assert "Traceback" not in err


def test_a_terminal_is_put_back_when_the_playing_is_ended(bag, domain, tmp_path):
    ours, theirs = pty.openpty()
    before = termios.tcgetattr(theirs)
    words = ["play", str(bag), "--loop", "--domain", domain]
    path = os.pathsep.join(p for p in sys.path if p)
    program = (
        "import fcntl, sys, termios; fcntl.ioctl(0, termios.TIOCSCTTY, 0);"
        "from steering_bringup.cli import main; sys.exit(main(sys.argv[1:]))"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", program, *words],
        cwd=tmp_path,
        stdin=theirs,
        env={**os.environ, "PYTHONPATH": path},
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    try:
        wait_for(lambda: termios.tcgetattr(theirs) != before)
        time.sleep(1.0)
    finally:
        process.terminate()
        out, _ = process.communicate(timeout=30)
    assert process.returncode == 128 + signal.SIGTERM
    assert "messages on 2 topics" in out
    assert termios.tcgetattr(theirs) == before
    os.close(ours)
    os.close(theirs)


class Terminal:
    """The command on a terminal of its own, as a person has it."""

    def __init__(self, folder, *words):
        path = os.pathsep.join(p for p in sys.path if p)
        pid, self.descriptor = pty.fork()
        if not pid:
            os.chdir(folder)
            command = [sys.executable, "-m", "steering_bringup.cli", *words]
            os.execve(sys.executable, command, {**os.environ, "PYTHONPATH": path})
        self.pid, self.shown = pid, b""
        fcntl.ioctl(self.descriptor, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 110, 0, 0))

    def press(self, keys):
        os.write(self.descriptor, keys)

    def read_until(self, text):
        def look():
            os.set_blocking(self.descriptor, False)
            try:
                self.shown += os.read(self.descriptor, 65536)
            except BlockingIOError:
                pass
            except OSError:
                return True  # the other side is closed
            return text in self.shown

        return wait_for(look)

    def finish(self):
        self.read_until(b"\0nothing says this\0")
        _, status = os.waitpid(self.pid, 0)
        os.close(self.descriptor)
        return os.waitstatus_to_exitcode(status), self.shown.decode()


def test_keys_pause_step_and_end(bag, domain, tmp_path):
    """Paused at once, three steps: three stamps of two topics have been published."""
    terminal = Terminal(tmp_path, "play", str(bag), "--domain", domain, "--json", "out.json")
    terminal.press(b" ")
    terminal.read_until(b"paused")
    time.sleep(0.2)
    terminal.press(b"s\x1b[Cs")
    time.sleep(0.4)
    terminal.press(b"q")
    status, shown = terminal.finish()
    assert status == 0, shown
    counts = json.loads((tmp_path / "out.json").read_text())["counts"]
    assert counts == {"/driver/torque": 3, "/steering/rack": 3}
