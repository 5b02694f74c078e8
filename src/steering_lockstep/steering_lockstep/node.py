"""A node in lock step: inputs of its tick in, one step, one message per output."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from math import isfinite
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor
from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter

from steering_lockstep.barrier import Barrier, Input, not_finite
from steering_lockstep.core_parameters import description
from steering_lockstep.endpoints import message_class, qos
from steering_lockstep.errors import LockstepError
from steering_lockstep.graph import Graph, NodeSpec
from steering_lockstep.in_process import Outbox, Take
from steering_lockstep.names import relative
from steering_lockstep.ports import Ports, parts, picker
from steering_lockstep.settings import RunSettings
from steering_lockstep.stall import Report
from steering_lockstep.subscriptions import PlainSubscription
from steering_lockstep.topics import topic, wire

ROS_PARAMETERS = ("use_sim_time", "start_type_description_service")
Emit = Callable[[int, Sequence[float]], None]


class LockstepNode(Node):
    """Base of all nodes.

    ``build``: makes the core from the node's parameter values. A core has ``step(tick, *values)``
    and leaves its results in the float64 array ``out``; ``ports`` says which fields they are, and
    ``collector`` gathers the inputs. A subclass with further outputs overrides ``publish``. When
    the node has done the last of its ticks it calls ``on_finished``; an error in a callback goes
    to ``on_error``. Both are set by whoever spins the node.
    """

    ports = Ports()
    collector: type[Barrier] = Barrier

    def __init__(
        self,
        context: Context,
        spec: NodeSpec,
        run: RunSettings,
        parameters: Mapping[str, Any] | None = None,
        build: Callable[[Mapping[str, Any]], Any] | None = None,
    ) -> None:
        self.in_events_executor = True
        self.outbox = Outbox()
        self.takers: dict[str, Take] = {}
        self.outlets: dict[str, Take] = {}
        self._plain: dict[str, PlainSubscription] = {}
        self._followers: set[PlainSubscription] = set()
        super().__init__(
            spec.name,
            context=context,
            cli_args=run.names.arguments(),
            use_global_arguments=parameters is None,
            enable_rosout=False,
            # A supervised run has no use for them, and pays for each endpoint as it starts.
            start_parameter_services=parameters is None,
            automatically_declare_parameters_from_overrides=True,
            parameter_overrides=_overrides(parameters or {}),
        )
        self._describe_parameters()
        self.spec = spec
        self.run = run
        self.busy = False
        self.finished = False
        self.published: dict[str, int] = {}
        self.on_finished: Callable[[], None] = _nothing
        self.on_error: Callable[[LockstepError], None] = _raise
        self.barrier = self.collector(spec.name, run.inputs(spec), spec.period)
        self._pick = picker(spec, self.ports)
        self.core: Any = None if build is None else self._warm(build)
        self._publishers_of: dict[str, Any] = {}
        self.emit = {name: self._emitter(name) for name in spec.outputs if topic(name).lockstep}
        self._parts = [(self.emit[n], i, j) for n, i, j in parts(spec, self.ports)]
        for index, name in enumerate(spec.inputs):
            self._subscribe(name, self.receiver(index))
        for leader, followers in companions(spec, run.graph).items():
            if leader in self._plain:
                self._lead(leader, followers)

    @property
    def subscriptions(self) -> Iterator[Any]:
        """The node's subscriptions, our raw ones in the form that the executor reads fast."""
        plain = {p.real: p for p in self._plain.values()}
        for subscription in super().subscriptions:
            entry = plain.get(subscription, subscription)
            if entry not in self._followers:
                yield entry if self.in_events_executor else subscription

    def start(self) -> None:
        """Do the ticks that need no message; called once when every endpoint is matched.

        Without it a node whose inputs are all delayed would wait for a message to wake it up.
        """
        if self.spec.inputs and not self.barrier.missing:
            self.guarded(self._complete)

    def guarded(self, action: Callable[[], None]) -> None:
        """Do ``action``; what it raises goes to ``on_error``."""
        try:
            action()
        except LockstepError as error:
            self.on_error(error)
        except Exception as error:
            self.on_error(self._core_error(error))

    def publish(self, tick: int, out: Sequence[float]) -> None:
        """Publish the numbers of ``out``, each message with its own."""
        for emit, start, stop in self._parts:
            emit(tick, out[start:stop])

    def forward(self, name: str, data: bytes) -> None:
        """Give the bytes of a message to all who take topic ``name``."""
        self.outlets[name](data)
        self.published[name] += 1

    def receiver(self, index: int) -> Callable[[bytes], None]:
        """Return the function that takes the bytes of input ``index``."""
        return self.barrier.receiver(index, self._complete)

    @property
    def raw(self) -> Mapping[str, PlainSubscription]:
        """The subscriptions of the node's inputs by topic."""
        return self._plain

    def wake_for(self, names: Sequence[str]) -> None:
        """Have the executor wake the node for these inputs only; the others it takes by itself."""
        self._followers = {entry for name, entry in self._plain.items() if name not in names}

    def values(self) -> dict[str, Any]:
        """Return the values of the node's parameters by name."""
        return {
            name: parameter.value
            for name, parameter in self._parameters.items()
            if name not in ROS_PARAMETERS
        }

    def description(self, name: str) -> str:
        """Return what the node's parameter ``name`` is, its unit at the end; empty if unknown."""
        return description(name)

    def report(self) -> Report:
        """Return what this node works on and waits for."""
        if self.finished:
            return Report(self.run.ticks)
        return Report(self.barrier.tick, self.lacking(), self.busy)

    def lacking(self) -> tuple[str, ...]:
        """Return the topics that the node waits for."""
        return self.barrier.lacking()

    def result(self) -> dict[str, Any]:
        """Return what the supervisor is told at the end; ``published``: messages by topic."""
        return {"published": dict(self.published)}

    def unmatched(self) -> list[str]:
        """Return what is still missing before the first tick, in both directions."""
        missing = [
            f"{name}: {count} of {needed} readers"
            for name, publisher in self._publishers_of.items()
            if (count := publisher.get_subscription_count())
            < (needed := self.run.awaited_readers(name))
        ]
        return missing + [
            f"{name}: no publisher"
            for name, plain in self._plain.items()
            if plain.real.handle.get_publisher_count() < 1
        ]

    def destroy_node(self) -> None:
        """Leave the ROS graph: others shall not take the node for alive until its lease is over."""
        for publisher in self._publishers_of.values():
            publisher.handle.__exit__(None, None, None)
        super().destroy_node()

    def close(self) -> None:
        """Release what the node holds besides its ROS entities; called once at the end."""

    def _complete(self) -> None:
        """Do every tick whose inputs are there."""
        barrier, core, last = self.barrier, self.core, self.run.ticks
        if self.finished:
            return  # delayed inputs go on arriving: they belong to ticks that are not run
        while True:
            tick = barrier.tick
            self.busy = True
            core.step(tick, *self._pick(barrier.values()))
            self.publish(tick, core.out.tolist())
            self.busy = False
            ready = barrier.advance()
            if barrier.tick >= last:
                self._finish()
                return
            if not ready:
                return

    def _describe_parameters(self) -> None:
        """Give each parameter its description; the core is built from them once, so they stay."""
        for name in self.values():
            descriptor = ParameterDescriptor(
                description=self.description(name), read_only=True, dynamic_typing=True
            )
            self.set_descriptor(name, descriptor)

    def _warm(self, build: Callable[[Mapping[str, Any]], Any]) -> Any:
        """Build the core; a twin does a step first, so that no kernel is compiled in the run."""
        values = self.values()
        twin = build(values)
        with contextlib.suppress(ArithmeticError, RuntimeError):
            count = sum(len(entry.wire.fields) for entry in self.barrier.inputs)
            twin.step(0, *self._pick([0.0] * count))
        return build(values)

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

        self.takers[name] = guarded
        if self.spec in self.run.handed(name):
            return
        kind, quality = message_class(name), qos()
        real = self.create_subscription(kind, relative(name), guarded, quality, raw=True)
        self._plain[name] = PlainSubscription(real, guarded)

    def _lead(self, leader: str, followers: Sequence[str]) -> None:
        """Take the ``followers``' messages when the ``leader``'s arrives: one wake-up for all.

        They were published before it by the same node, so as a rule they are there already. One
        that is not (its datagram was lost and comes again) is woken for from then on.
        """
        first, receive = self._plain[leader], self._plain[leader].callback
        waiting = [self._plain[name] for name in followers]
        self._followers.update(waiting)

        def receive_all(data: bytes) -> None:
            executor: Any = self.executor
            for follower in waiting:
                if follower in self._followers:
                    taken = follower.handle.take_message(follower.msg_type, True)
                    if taken is None:
                        self._followers.discard(follower)
                        executor.wake()
                    else:
                        follower.callback(taken[0])
            receive(data)

        first.callback = first.real.callback = receive_all

    def _core_error(self, error: Exception) -> LockstepError:
        text = f"{type(error).__name__}: {error}"
        return LockstepError("core", self.spec.name, None, self.barrier.tick, text)

    def _emitter(self, name: str) -> Emit:
        """Return the function that packs, checks and forwards one message of topic ``name``."""
        publisher = self.create_publisher(message_class(name), relative(name), qos())
        self._publishers_of[name] = publisher
        handle = publisher.handle
        handle.__enter__()  # kept in use for the node's life instead of once a message
        self.outlets[name] = handle.publish_raw
        self.published[name] = 0
        forward, layout, node = self.forward, wire(name), self.spec.name
        pack, entry, any_number = layout.pack, Input(name, layout), not topic(name).finite

        def emit(tick: int, values: Sequence[float]) -> None:
            if not (isfinite(sum(values)) or any_number):
                raise not_finite(node, entry, tick, values)
            forward(name, pack(tick, values))

        return emit


def companions(spec: NodeSpec, graph: Graph) -> dict[str, list[str]]:
    """Return the inputs that come from one node: {its last output: those before it}."""
    groups: dict[str, list[str]] = {}
    for name in spec.inputs:
        if topic(name).every == 1:
            groups.setdefault(graph.publisher[name], []).append(name)
    led = {}
    for source, names in groups.items():
        *followers, leader = sorted(names, key=graph.node(source).outputs.index)
        if followers:
            led[leader] = followers
    return led


def _overrides(parameters: Mapping[str, Any]) -> list[Parameter]:
    return [Parameter(name, value=value) for name, value in parameters.items()]


def _nothing() -> None:
    return None


def _raise(error: LockstepError) -> None:
    raise error
