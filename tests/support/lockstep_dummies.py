"""Nodes with small made-up cores, well behaved and not, for tests of the lock step."""

from __future__ import annotations

import errno
import hashlib
import time
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from steering_lockstep.clock_node import ClockNode
from steering_lockstep.free_clock import FreeClock
from steering_lockstep.graph import Graph, NodeSpec, check_graph
from steering_lockstep.node import LockstepNode
from steering_lockstep.outside import Status
from steering_lockstep.topics import wire

MEASURED = ("/steering/torque", "/steering/pressure", "/steering/rack")
HERE = "lockstep_dummies"


class Mix:
    """A nonlinear filter of all that comes in: any wrong value or tick changes all that follows."""

    def __init__(self, size: int, seed: int) -> None:
        self.weights = np.random.default_rng(seed).normal(size=size)
        self.state = 0.1
        self.out = 0.01 * self.weights
        self.seen = hashlib.sha256()

    def step(self, tick: int, *values: float) -> np.ndarray:
        total = 0.3 * self.state + 1e-3 * tick
        for index, value in enumerate(values):
            total += 0.01 * (index + 1) * value
        self.state = total / (1.0 + abs(total))
        self.out[:] = self.weights * self.state
        self.seen.update(np.array([tick, *values, *self.out]).tobytes())
        return self.out


class Plant(ClockNode):
    """A clock that tells the digest of all that its core has seen."""

    def result(self) -> dict[str, Any]:
        return {**super().result(), "digest": self.core.seen.hexdigest()}


class Hardware:
    """Made-up hardware that begins a period when it has the answer to the one before."""

    preparing = False
    failure: str | None = None

    def __init__(self, core: Mix, ticks: int) -> None:
        self.core = core
        self.last = ticks - 1
        self.answered = True

    @property
    def answer_by(self) -> int:
        return time.monotonic_ns() + 60_000_000_000

    def open(self) -> None:
        """There is nothing to open."""

    def receive(self, most: int) -> list[tuple[float, ...]]:
        rows = [tuple(self.core.out.tolist())] if self.answered else []
        self.answered = False
        return rows

    def answer(
        self, tick: int, values: Sequence[float], age: int, late: str | None, ahead: int
    ) -> None:
        assert age == 0, late
        assert ahead == 0
        self.answered = True
        if tick < self.last:
            self.core.step(tick, *values)

    def status(self) -> Status:
        return Status("ok", "running")

    def numbers(self) -> dict[str, str]:
        return {}

    def report(self) -> dict[str, Any]:
        return {}

    def close(self) -> None:
        """There is nothing to close."""


class Piles(Hardware):
    """Made-up hardware that stands still now and then: periods come three at a time."""

    def __init__(self, core: Mix, ticks: int) -> None:
        super().__init__(core, ticks)
        self.answers: list[tuple[int, int]] = []

    def receive(self, most: int) -> list[tuple[float, ...]]:
        return (3 * super().receive(most))[:most]

    def answer(
        self, tick: int, values: Sequence[float], age: int, late: str | None, ahead: int
    ) -> None:
        assert age == 0, late
        self.answers.append((tick, ahead))
        self.answered = ahead == 0


class Rig(FreeClock):
    """A clock that nobody holds up, before hardware that waits for the nodes all the same."""

    core: Hardware

    def result(self) -> dict[str, Any]:
        return {**super().result(), "digest": self.core.core.seen.hexdigest()}


class PiledRig(Rig):
    """The same before hardware whose periods come in piles; tells what was answered."""

    core: Piles

    def result(self) -> dict[str, Any]:
        return {**super().result(), "answers": self.core.answers}


class Node(LockstepNode):
    """A node that tells the digest of all that its core has seen."""

    def result(self) -> dict[str, Any]:
        return {**super().result(), "digest": self.core.seen.hexdigest()}


class Listener(Node):
    """A node that also listens to what the clock tells about itself."""

    def __init__(self, *args: Any) -> None:
        from diagnostic_msgs.msg import DiagnosticArray

        self.told: list[tuple[str, int]] = []
        super().__init__(*args)
        self.create_subscription(DiagnosticArray, "/diagnostics", self.hear, 10)

    def hear(self, message: Any) -> None:
        stamp = message.header.stamp
        tick = stamp.sec * 1000 + stamp.nanosec // 1_000_000
        self.told += [(status.message, tick) for status in message.status]

    def result(self) -> dict[str, Any]:
        return {**super().result(), "told": self.told}


class Troubled(Node):
    """Does something wrong at tick 50, or as it leaves: what its parameter ``trouble`` says."""

    def destroy_node(self) -> None:
        if self.values()["trouble"] == "stay":
            time.sleep(1000.0)
        super().destroy_node()

    def publish(self, tick: int, out: Any) -> None:
        trouble = self.values()["trouble"] if tick == 50 else None
        name = self.spec.outputs[0]
        if trouble == "hang":
            time.sleep(1000.0)
        elif trouble == "nan":
            out = [float("nan"), *out[1:]]
        elif trouble == "raise":
            raise ValueError("made up")
        elif trouble == "twice":
            super().publish(tick, out)
        elif trouble == "short":
            self._publishers_of[name].publish(b"\0" * 9)
            return
        elif trouble == "skip":
            return
        super().publish(tick, out)


def _size(spec: NodeSpec) -> int:
    return sum(len(wire(name).fields) for name in spec.outputs)


def plant(context: Any, spec: NodeSpec, run: Any, parameters: Any) -> Any:
    return Plant(context, spec, run, parameters, lambda values: Mix(_size(spec), 1))


def rig(context: Any, spec: NodeSpec, run: Any, parameters: Any) -> Any:
    clock = Rig(context, spec, run, parameters)
    clock.core = Hardware(Mix(_size(spec), 1), run.ticks)
    return clock


def piled_rig(context: Any, spec: NodeSpec, run: Any, parameters: Any) -> Any:
    clock = PiledRig(context, spec, run, parameters)
    clock.core = Piles(Mix(_size(spec), 1), run.ticks)
    return clock


def node(context: Any, spec: NodeSpec, run: Any, parameters: Any) -> Any:
    return Node(context, spec, run, parameters, lambda values: Mix(_size(spec), len(spec.name)))


def troubled(context: Any, spec: NodeSpec, run: Any, parameters: Any) -> Any:
    return Troubled(context, spec, run, parameters, lambda values: Mix(_size(spec), 5))


def listener(context: Any, spec: NodeSpec, run: Any, parameters: Any) -> Any:
    return Listener(context, spec, run, parameters, lambda values: Mix(_size(spec), 5))


def refusing(context: Any, spec: NodeSpec, run: Any, parameters: Any) -> Any:
    raise ValueError("no such spring")


def endless(context: Any, spec: NodeSpec, run: Any, parameters: Any) -> Any:
    time.sleep(1000.0)


def slow_recorder(context: Any, spec: NodeSpec, run: Any, parameters: Any) -> Any:
    from steering_bringup.recorder_node import RecorderNode

    class Slow(RecorderNode):
        def drain(self) -> None:
            before = self.done
            super().drain()
            time.sleep(0.05 * (self.done - before) / 100)

    return Slow(context, spec, run, parameters)


def full_disk(context: Any, spec: NodeSpec, run: Any, parameters: Any) -> Any:
    """A recorder whose bag cannot grow any more at tick 500."""
    from steering_bringup.bags import BagError
    from steering_bringup.recorder_node import RecorderNode

    recorder = RecorderNode(context, spec, run, parameters)
    write = recorder.writer.write_block

    def fail(stamps: np.ndarray, payloads: Any) -> None:
        if stamps[-1] > 500_000_000:
            raise BagError(OSError(errno.ENOSPC, "No space left on device").strerror)
        write(stamps, payloads)

    recorder.writer.write_block = fail  # type: ignore[assignment,method-assign]
    return recorder


def graph(
    delays: Mapping[tuple[str, str], int] | None = None,
    periods: Mapping[str, int] | None = None,
    driver: str = "node",
    recorder: str | None = None,
    clock: str = "plant",
) -> Graph:
    """Return a graph like the closed-centre bench; ``delays``: {(topic, node): ticks}."""
    delays, periods = delays or {}, periods or {}

    def inputs(name: str, *topics: str) -> dict[str, int]:
        return {t: delays.get((t, name), 0) for t in topics}

    def spec(name: str, kind: str, topics: tuple[str, ...], *outputs: str) -> NodeSpec:
        period = periods.get(name, 1)
        return NodeSpec(name, f"{HERE}:{kind}", inputs(name, *topics), outputs, period)

    commands = ("/driver/torque", "/valve/left/command", "/valve/right/command")
    nodes = [
        spec("plant", clock, (*commands, "/vehicle/rack_force"), *MEASURED, "/clock"),
        spec("left", "node", MEASURED, "/valve/left/command"),
        spec("right", "node", MEASURED, "/valve/right/command"),
        spec("driver", driver, MEASURED[:1], "/driver/torque"),
        spec("vehicle", "node", MEASURED[2:], "/vehicle/rack_force"),
    ]
    if recorder is not None:
        topics = {name: 0 for node in nodes for name in node.outputs}
        nodes.append(NodeSpec("recorder", recorder, topics, ("/recorder/credit",)))
    return check_graph(nodes)


def reference(checked: Graph, ticks: int) -> dict[str, str]:
    """Return each node's digest from a plain loop without ROS, barrier or messages."""
    cores = {n.name: Mix(_size(n), 1 if n is checked.clock else len(n.name)) for n in checked.nodes}
    published: dict[str, dict[int, list[float]]] = {name: {} for name in checked.publisher}

    def publish(spec: NodeSpec, tick: int) -> None:
        start = 0
        for name in spec.outputs:
            stop = start + len(wire(name).fields)
            published[name][tick] = cores[spec.name].out[start:stop].tolist()
            start = stop

    def seen(spec: NodeSpec, tick: int) -> Iterator[float]:
        for name, delay in spec.inputs.items():
            past = [t for t in published[name] if t <= tick - delay]
            yield from published[name][max(past)] if past else [0.0] * len(wire(name).fields)

    for tick in range(ticks):
        publish(checked.clock, tick)
        for name in checked.order:
            spec = checked.node(name)
            if tick % spec.period == 0:
                cores[name].step(tick, *seen(spec, tick))
                publish(spec, tick)
        if tick + 1 < ticks:
            cores[checked.clock.name].step(tick, *seen(checked.clock, tick))
    return {name: core.seen.hexdigest() for name, core in cores.items()}
