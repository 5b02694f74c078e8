"""One node alone in a process, without a supervisor: started by hand, or on another computer.

    plant_node --graph graph.json --ros-args -p valve_system:=open_centre

Every node of the graph is started like this, in any order and on any computer of the ROS domain.
They begin once each of them has said that all its connections are matched.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from signal import SIGINT, Signals
from time import monotonic
from typing import Any

import rclpy
import yaml
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args

from steering_core.errors import BenchError
from steering_lockstep.ending import Ending
from steering_lockstep.errors import LockstepError
from steering_lockstep.graph import Graph, GraphError, NodeSpec
from steering_lockstep.graph_file import read_run
from steering_lockstep.kinds import factory
from steering_lockstep.middleware import ros_environment
from steering_lockstep.names import relative
from steering_lockstep.node import LockstepNode
from steering_lockstep.rosout import Rosout
from steering_lockstep.settings import RunSettings
from steering_lockstep.spinner import Spinner
from steering_lockstep.urgency import hurry

READY = "/lockstep/ready"
WAIT, TIMEOUT = 60.0, 10.0
"""s for all nodes of the graph to come up, and without a tick."""
MATCHING_STEP = 0.02
COMPLAIN_AFTER = 2.0
LINGER = Duration(seconds=2.0)
SIGNALLED = 128
"""Exit status of a process that a signal ended: this and the signal's number."""
Make = Callable[..., LockstepNode]
EPILOG = """The file is what 'steer graph SCENARIO --out FILE' writes: the graph, its length and the
parameters of every node. What follows --ros-args is ROS's and comes before the file: parameters
(-p NAME:=VALUE, --params-file), namespace (-r __ns:=/car1) and names (-r driver/torque:=other)."""


def spin_alone(kind: str | None) -> int:
    """Run the node of ``kind`` (None: of any) that the command line names; return the status.

    0 where the node did all its ticks and closed well, or was told to end by SIGINT: so a launch
    that is interrupted takes it for what it is, an orderly end.
    """
    options = _options(kind)
    try:
        run, parameters = read_run(options.graph, options.ticks, options.real_time)
        spec = _spec(run.graph, kind, options.name)
        make = factory(spec.kind)
        with _arguments(parameters.get(spec.name, {})) as words:
            status = run_alone(make, spec, run, None, options.wait, options.timeout, words)
    except (GraphError, BenchError, KeyError, AttributeError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    return 0 if status == SIGNALLED + SIGINT else status


def run_alone(
    make: Make,
    spec: NodeSpec,
    run: RunSettings,
    parameters: Mapping[str, Any] | None,
    wait: float = WAIT,
    timeout: float = TIMEOUT,
    words: Sequence[str] = (),
) -> int:
    """Run one node in this process to its last tick; return 0 only if it did and closed well.

    ``parameters``: ROS parameters; None: from the command line ``words``. ``wait`` [s]: for all
    nodes of the graph to come up, ``timeout`` [s]: without a tick; the error says who is missing.
    SIGINT and SIGTERM end it in order; the status is then 128 and the signal's number.
    """
    os.environ.update(ros_environment(os.environ))
    context = Context()
    own = SignalHandlerOptions.NO
    args = list(words) if parameters is None else None
    rclpy.init(args=args, context=context, signal_handler_options=own)
    try:
        node = make(context, spec, run, parameters)
    except Exception as error:
        print(f"error: node '{spec.name}' cannot start: {error}", file=sys.stderr)
        context.try_shutdown()
        return 1
    ending = Ending()  # before, there was nothing to end in order
    spinner: Spinner | None = None
    try:
        spinner = Spinner(context, [node])
        rosout = Rosout([node])
        watch = _Watch(spinner, node, ending, timeout)
        threading.Thread(target=watch.watch, daemon=True).start()
        if _start(spinner, node, wait):
            watch.started.set()
            rosout.started()
            if run.urgent:
                hurry([spec.kind])
            spinner.run()
        rosout.ended(spinner.error)
        return _end(spinner, node, watch)
    finally:
        ending.ignore()
        if spinner is not None:
            spinner.close()
        node.destroy_node()
        context.try_shutdown()


def ready_qos() -> QoSProfile:
    """Return the quality of service of READY: kept for whoever comes up later."""
    return QoSProfile(
        depth=100,
        reliability=ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL,
    )


def _options(kind: str | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=f"One {kind or 'node'} of a bench's graph.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = parser.add_argument
    add("--graph", required=True, metavar="FILE", help="the graph as JSON")
    add("--name", metavar="NODE", help="node of the graph, where several are of this kind")
    add("--ticks", type=int, metavar="N", help="another length of the run in ms than the file's")
    add("--real-time", action="store_true", help="the plant paces the ticks to the wall clock")
    add("--wait", type=float, metavar="S", default=WAIT, help="for all nodes to come up")
    add("--timeout", type=float, metavar="S", default=TIMEOUT, help="without a tick")
    return parser.parse_args(remove_ros_args(sys.argv)[1:])


@contextmanager
def _arguments(parameters: Mapping[str, Any]) -> Iterator[list[str]]:
    """Give the command line with the file's parameters before those that are written there."""
    with tempfile.TemporaryDirectory(prefix="steering-node-") as folder:
        file = Path(folder, "parameters.yaml")
        content = {"/**": {"ros__parameters": dict(parameters)}}
        file.write_text(yaml.safe_dump(content), encoding="utf-8")
        first = ["--ros-args", "--params-file", str(file), "--"] if parameters else []
        yield [sys.argv[0], *first, *sys.argv[1:]]


def _spec(graph: Graph, kind: str | None, name: str | None) -> NodeSpec:
    of_kind = [n for n in graph.nodes if kind in (None, n.kind)]
    fitting = [n for n in of_kind if name in (None, n.name)]
    if len(fitting) != 1:
        names = ", ".join(n.name for n in of_kind) or "none"
        raise GraphError(f"--name must name one {kind or 'node'} of the graph; there is: {names}")
    return fitting[0]


def _start(spinner: Spinner, node: LockstepNode, wait: float) -> bool:
    """Start when every node has all its connections. False when told to stop before."""
    others = Others(node, node.run.graph)
    deadline = monotonic() + wait
    while spinner.alive() and spinner.unmatched():
        spinner.spin_for(MATCHING_STEP)
        if monotonic() > deadline:
            spinner.fail(_not_ready(node, spinner.unmatched(), wait))
    if spinner.alive():
        others.tell([node.spec.name])
    while spinner.alive() and others.missing:
        spinner.spin_for(MATCHING_STEP)
        if monotonic() > deadline:
            spinner.fail(_not_ready(node, [f"{n}: not ready" for n in others.missing], wait))
    spinner.start()
    return spinner.alive()


class Others:
    """Who of a graph's nodes has all its connections: each says so on READY."""

    def __init__(self, node: LockstepNode, graph: Graph) -> None:
        from std_msgs.msg import String

        self.missing = sorted({n.name for n in graph.nodes} - {node.spec.name})
        self._string = String
        node.create_subscription(String, relative(READY), self._note, ready_qos())
        self._publisher = node.create_publisher(String, relative(READY), ready_qos())

    def tell(self, names: Iterable[str]) -> None:
        """Say that the nodes called ``names`` are ready."""
        for name in names:
            self._publisher.publish(self._string(data=name))

    def _note(self, message: Any) -> None:
        self.missing = [name for name in self.missing if name != message.data]


def _not_ready(node: LockstepNode, what: Iterable[str], wait: float) -> LockstepError:
    text = f"not ready after {wait:g} s: {'; '.join(what)}"
    return LockstepError("start", node.spec.name, None, None, text)


class _Watch:
    """Stops on a signal; says on stderr what the node waits for when nothing moves, then gives up.

    ``told``: the number of the signal that came.
    """

    def __init__(
        self, spinner: Spinner, node: LockstepNode, ending: Ending, timeout: float
    ) -> None:
        self.started = threading.Event()
        self.told: int | None = None
        self._spinner, self._node, self._ending, self._timeout = spinner, node, ending, timeout

    def watch(self) -> None:
        """Watch until a signal comes or the time is over."""
        spinner, node, timeout = self._spinner, self._node, self._timeout
        before, moved = -1, monotonic()
        while True:
            self.told = self._ending.wait(min(COMPLAIN_AFTER, timeout))
            if self.told is not None:
                spinner.stop()
                return
            report = node.report()
            idle = node.finished or not self.started.is_set() or getattr(node, "preparing", False)
            if report.tick != before or idle:
                before, moved = report.tick, monotonic()
                continue
            publishers = node.run.graph.publisher
            lacking = [f"{name} of node '{publishers[name]}'" for name in report.lacking]
            what = f"tick {report.tick} waits for {', '.join(lacking) or 'nothing'}"
            if monotonic() - moved >= timeout:
                text = f"nothing for {timeout:g} s; {what}"
                spinner.fail(LockstepError("timeout", node.spec.name, None, report.tick, text))
                return
            print(f"{node.spec.name}: {what}", file=sys.stderr)


def _end(spinner: Spinner, node: LockstepNode, watch: _Watch) -> int:
    """Let what was published arrive, close the node, and return the exit status."""
    if spinner.error is not None:
        print(f"error: {spinner.error}", file=sys.stderr)
    elif spinner.finished:
        for publisher in node.publishers:
            publisher.wait_for_all_acked(LINGER)
    node.close()
    if spinner.error is None and not spinner.finished and watch.told is not None:
        name, tick = Signals(watch.told).name, node.barrier.tick
        where = f"at tick {tick} of {node.run.ticks}" if watch.started.is_set() else "before tick 0"
        print(f"{node.spec.name}: told to end by {name} {where}", file=sys.stderr)
        return SIGNALLED + watch.told
    return 0 if spinner.finished and spinner.error is None else 1
