"""A node in lock step: inputs of its tick in, one step, one message per output."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from math import isfinite
from typing import Any

from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter

from steering_lockstep.barrier import Barrier, Input, not_finite
from steering_lockstep.endpoints import message_class, qos
from steering_lockstep.errors import LockstepError
from steering_lockstep.graph import NodeSpec
from steering_lockstep.settings import RunSettings
from steering_lockstep.stall import Report
from steering_lockstep.subscriptions import PlainSubscription
from steering_lockstep.topics import topic, wire

Emit = Callable[[int, Sequence[float]], None]


class LockstepNode(Node):
    """Base of all nodes.

    ``core``: has ``step(tick, *values) -> float64 array`` whose numbers fill the fields of the
    outputs one after the other. A subclass with other outputs overrides ``publish``. When the
    node has done the last of its ticks it calls ``on_finished``; an error in a callback goes to
    ``on_error``. Both are set by whoever spins the node.
    """

    def __init__(
        self,
        context: Context,
        spec: NodeSpec,
        run: RunSettings,
        parameters: Mapping[str, Any] | None = None,
        core: Any = None,
    ) -> None:
        self._plain: list[PlainSubscription] = []
        super().__init__(
            spec.name,
            context=context,
            use_global_arguments=False,
            enable_rosout=False,
            start_parameter_services=False,
            automatically_declare_parameters_from_overrides=True,
            parameter_overrides=_overrides(parameters or {}),
        )
        self.spec = spec
        self.run = run
        self.core = core
        self.busy = False
        self.finished = False
        self.published: dict[str, int] = {}
        self.on_finished: Callable[[], None] = _nothing
        self.on_error: Callable[[LockstepError], None] = _raise
        self.barrier = Barrier(spec.name, run.inputs(spec), spec.period)
        self._publishers_of: dict[str, Any] = {}
        self.emit = {name: self._emitter(name) for name in spec.outputs if topic(name).lockstep}
        self._split = _split(spec.outputs)
        for index, name in enumerate(spec.inputs):
            self._subscribe(name, self.barrier.receiver(index, self._complete))

    @property
    def subscriptions(self) -> Iterator[Any]:
        """The node's subscriptions, our raw ones in the form that the executor reads fast."""
        plain = {p.real: p for p in self._plain}
        for subscription in super().subscriptions:
            yield plain.get(subscription, subscription)

    def publish(self, tick: int, out: Sequence[float]) -> None:
        """Publish the numbers of ``out``, split over the outputs in their order."""
        for emit, start, stop in self._split_emitters():
            emit(tick, out[start:stop])

    def report(self) -> Report:
        """Return what this node works on and waits for."""
        if self.finished:
            return Report(self.run.ticks)
        return Report(self.barrier.tick, self.lacking(), self.busy)

    def lacking(self) -> tuple[str, ...]:
        """Return the topics that the node waits for."""
        return self.barrier.lacking()

    def result(self) -> dict[str, Any]:
        """Return what the supervisor is told at the end; ``lost``: gaps seen, by topic."""
        return {"published": dict(self.published)}

    def unmatched(self) -> list[str]:
        """Return what is still missing before the first tick, in both directions."""
        missing = [
            f"{name}: {publisher.get_subscription_count()} of {self.run.readers(name)} readers"
            for name, publisher in self._publishers_of.items()
            if publisher.get_subscription_count() < self.run.readers(name)
        ]
        return missing + [
            f"{plain.real.topic_name}: no publisher"
            for plain in self._plain
            if plain.real.handle.get_publisher_count() < 1
        ]

    def close(self) -> None:
        """Release what the node holds besides its ROS entities; called once at the end."""

    def _complete(self) -> None:
        """Do every tick whose inputs are there."""
        barrier, step, last = self.barrier, self.core.step, self.run.ticks
        while True:
            tick = barrier.tick
            self.busy = True
            out = step(tick, *barrier.values()).tolist()
            self.publish(tick, out)
            self.busy = False
            ready = barrier.advance()
            if barrier.tick >= last:
                self._finish()
                return
            if not ready:
                return

    def _finish(self) -> None:
        self.finished = True
        self.on_finished()

    def _subscribe(self, name: str, receive: Callable[[bytes], None]) -> None:
        def guarded(data: bytes) -> None:
            try:
                receive(data)
            except LockstepError as error:
                self.on_error(error)
            except Exception as error:
                self.on_error(self._core_error(error))

        real = self.create_subscription(message_class(name), name, guarded, qos(), raw=True)
        self._plain.append(PlainSubscription(real, guarded))

    def _core_error(self, error: Exception) -> LockstepError:
        text = f"{type(error).__name__}: {error}"
        return LockstepError("core", self.spec.name, None, self.barrier.tick, text)

    def _emitter(self, name: str) -> Emit:
        """Return the function that packs, checks and publishes one message of topic ``name``."""
        publisher = self.create_publisher(message_class(name), name, qos())
        self._publishers_of[name] = publisher
        handle = publisher.handle
        handle.__enter__()  # kept in use for the node's life instead of once a message
        send, layout, counts, node = handle.publish_raw, wire(name), self.published, self.spec.name
        pack, entry = layout.pack, Input(name, layout)
        counts[name] = 0

        def emit(tick: int, values: Sequence[float]) -> None:
            if not isfinite(sum(values)):
                raise not_finite(node, entry, tick, values)
            send(pack(tick, values))
            counts[name] += 1

        return emit

    def _split_emitters(self) -> list[tuple[Emit, int, int]]:
        return [(self.emit[name], start, stop) for name, start, stop in self._split]


def _split(outputs: Sequence[str]) -> list[tuple[str, int, int]]:
    """Return which numbers of a core's output go to which topic: (topic, start, stop)."""
    parts, start = [], 0
    for name in outputs:
        if topic(name).lockstep:
            stop = start + len(wire(name).fields)
            parts.append((name, start, stop))
            start = stop
    return parts


def _overrides(parameters: Mapping[str, Any]) -> list[Parameter]:
    return [Parameter(name, value=value) for name, value in parameters.items()]


def _nothing() -> None:
    return None


def _raise(error: LockstepError) -> None:
    raise error
