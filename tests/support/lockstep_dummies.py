"""Nodes with small made-up cores, well behaved and not, for tests of the lock step."""

from __future__ import annotations

import hashlib
import time

import numpy as np

from steering_lockstep.clock_node import ClockNode
from steering_lockstep.graph import NodeSpec, check_graph
from steering_lockstep.node import LockstepNode
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


class Digest:
    """Adds the digest of all that the core has seen to a node's result."""

    def result(self):
        return {**super().result(), "digest": self.core.seen.hexdigest()}


class Plant(Digest, ClockNode):
    pass


class Node(Digest, LockstepNode):
    pass


class Troubled(Node):
    """Does something wrong at tick 50: what its parameter ``trouble`` says."""

    def publish(self, tick, out):
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


def _size(spec):
    return sum(len(wire(name).fields) for name in spec.outputs)


def plant(context, spec, run, parameters):
    return Plant(context, spec, run, parameters, lambda values: Mix(_size(spec), 1))


def node(context, spec, run, parameters):
    return Node(context, spec, run, parameters, lambda values: Mix(_size(spec), len(spec.name)))


def troubled(context, spec, run, parameters):
    return Troubled(context, spec, run, parameters, lambda values: Mix(_size(spec), 5))


def refusing(context, spec, run, parameters):
    raise ValueError("no such spring")


def endless(context, spec, run, parameters):
    time.sleep(1000.0)


def graph(delays=None, periods=None, driver="node", extra=()):
    """Return a graph like the closed-centre bench; ``delays``: {(topic, node): ticks}."""
    delays, periods = delays or {}, periods or {}

    def inputs(name, *topics):
        return {t: delays.get((t, name), 0) for t in topics}

    def spec(name, kind, topics, *outputs):
        period = periods.get(name, 1)
        return NodeSpec(name, f"{HERE}:{kind}", inputs(name, *topics), outputs, period)

    commands = ("/driver/torque", "/valve/left/command", "/valve/right/command")
    return check_graph(
        [
            spec("plant", "plant", (*commands, "/vehicle/rack_force"), *MEASURED, "/clock"),
            spec("left", "node", MEASURED, "/valve/left/command"),
            spec("right", "node", MEASURED, "/valve/right/command"),
            spec("driver", driver, MEASURED[:1], "/driver/torque"),
            spec("vehicle", "node", MEASURED[2:], "/vehicle/rack_force"),
            *extra,
        ]
    )


def reference(checked, ticks):
    """Return each node's digest from a plain loop without ROS, barrier or messages."""
    cores = {n.name: Mix(_size(n), 1 if n is checked.clock else len(n.name)) for n in checked.nodes}
    published = {name: {} for name in checked.publisher}

    def publish(spec, tick):
        start = 0
        for name in spec.outputs:
            stop = start + len(wire(name).fields)
            published[name][tick] = cores[spec.name].out[start:stop].tolist()
            start = stop

    def seen(spec, tick):
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
