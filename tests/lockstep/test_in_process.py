"""Nodes of one process: the same messages in the same order, by a call or later on the topic."""

from contextlib import suppress
from dataclasses import dataclass, field

import pytest

from steering_lockstep.graph import CREDIT, NodeSpec, check_graph
from steering_lockstep.in_process import Outbox, introduce
from steering_lockstep.settings import RunSettings

LEFT, RIGHT, TORQUE = "/valve/left/command", "/valve/right/command", "/steering/torque"
GRAPH = check_graph(
    [
        NodeSpec("plant", "plant", {LEFT: 0, RIGHT: 0}, (TORQUE, "/clock")),
        NodeSpec("left", "node", {TORQUE: 0}, (LEFT,)),
        NodeSpec("right", "node", {TORQUE: 0}, (RIGHT,)),
        NodeSpec("recorder", "module:own", {TORQUE: 0, LEFT: 0, RIGHT: 0, "/clock": 0}, (CREDIT,)),
    ]
)


@dataclass
class Made:
    """Answers each message at once, as the nodes of a tick do; the clock is not answered."""

    spec: NodeSpec
    log: list
    outbox: Outbox = field(default_factory=Outbox)
    outlets: dict = field(default_factory=dict)

    def __post_init__(self):
        self.outlets = {n: self.noting("topic", n) for n in self.spec.outputs}
        self.takers = {n: self.taking(n) for n in self.spec.inputs}

    def noting(self, *what):
        return lambda data: self.log.append((*what, data))

    def taking(self, name):
        def take(data):
            self.log.append((self.spec.name, name, data))
            if self.spec.name in ("left", "right"):
                self.outlets[self.spec.outputs[0]](data + b"!")

        return take


def neighbours(*names):
    log: list = []
    nodes = {name: Made(GRAPH.node(name), log) for name in names}
    introduce(list(nodes.values()), RunSettings(GRAPH, 10, together=frozenset(names)))
    return nodes, log


def test_the_answers_are_there_before_anything_is_published():
    nodes, log = neighbours("plant", "left", "right", "recorder")
    with nodes["plant"].outbox.held():
        nodes["plant"].outlets[TORQUE](b"0")
        nodes["plant"].outlets["/clock"](b"0")
        log.append("answer")
    assert log == [
        ("left", TORQUE, b"0"),
        ("plant", LEFT, b"0!"),
        ("right", TORQUE, b"0"),
        ("plant", RIGHT, b"0!"),
        "answer",
        ("topic", TORQUE, b"0"),
        ("topic", LEFT, b"0!"),
        ("topic", RIGHT, b"0!"),
        ("topic", "/clock", b"0"),
    ]


def test_what_a_node_elsewhere_waits_for_is_published_first():
    nodes, log = neighbours("plant", "left")
    with nodes["plant"].outbox.held():
        nodes["plant"].outlets[TORQUE](b"0")
    assert [entry[:2] for entry in log] == [
        ("topic", TORQUE),
        ("left", TORQUE),
        ("plant", LEFT),
        ("topic", LEFT),
    ]


def test_without_the_clock_nothing_is_handed_over_here_or_held():
    nodes, log = neighbours("left", "right")
    nodes["left"].outlets[LEFT](b"0")
    assert log == [("topic", LEFT, b"0")]


def test_what_is_held_is_published_after_an_error_too():
    nodes, log = neighbours("plant", "left", "right")
    give = nodes["plant"].outlets["/clock"]
    with suppress(ValueError), nodes["plant"].outbox.held():
        give(b"0")
        raise ValueError("made up")
    assert log == [("topic", "/clock", b"0")]
    give(b"1")
    assert log[-1] == ("topic", "/clock", b"1")


@pytest.mark.parametrize(
    ("together", "handed", "readers", "awaited"),
    [
        ((), [], 3, True),
        (("plant", "left"), ["left"], 2, True),
        (("plant", "left", "right"), ["left", "right"], 1, False),
        (("plant", "left", "right", "recorder"), ["left", "right"], 1, False),
        (("left", "right"), [], 3, True),
    ],
)
def test_each_reader_gets_a_topic_once(together, handed, readers, awaited):
    run = RunSettings(GRAPH, 10, together=frozenset(together))
    assert [node.name for node in run.handed(TORQUE)] == handed
    assert run.readers(TORQUE) == readers
    assert run.awaited(TORQUE) is awaited
