"""One node alone in a process, without a supervisor: started by hand, or on another computer.

    plant_node --graph graph.json --ticks 20000 --ros-args -p valve_system:=open_centre

Every node of the graph is started like this, in any order and on any computer of the ROS domain.
They begin once each of them has said that all its connections are matched.
"""

from __future__ import annotations

import argparse
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterable, Mapping
from time import monotonic
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.utilities import remove_ros_args

from steering_lockstep.errors import LockstepError
from steering_lockstep.graph import Graph, NodeSpec
from steering_lockstep.graph_file import read_graph
from steering_lockstep.middleware import ros_environment
from steering_lockstep.names import relative
from steering_lockstep.node import LockstepNode
from steering_lockstep.settings import RunSettings
from steering_lockstep.spinner import Spinner

READY = "/lockstep/ready"
WAIT, TIMEOUT = 60.0, 10.0
"""s for all nodes of the graph to come up, and without a tick."""
MATCHING_STEP = 0.02
COMPLAIN_AFTER = 2.0
LINGER = Duration(seconds=2.0)
Make = Callable[..., LockstepNode]


def spin_alone(kind: str, make: Make) -> None:
    """Run the node of ``kind`` that the command line names, and end the process.

    Status 0 only if the node did all its ticks and closed well.
    """
    options = _options(kind)
    graph = read_graph(options.graph)
    spec = _spec(graph, kind, options.name)
    run = RunSettings(graph, options.ticks)
    raise SystemExit(run_alone(make, spec, run, None, options.wait, options.timeout))


def run_alone(
    make: Make,
    spec: NodeSpec,
    run: RunSettings,
    parameters: Mapping[str, Any] | None,
    wait: float = WAIT,
    timeout: float = TIMEOUT,
) -> int:
    """Run one node in this process to its last tick; return 0 only if it did and closed well.

    ``parameters``: ROS parameters; None: from the command line. ``wait`` [s]: for all nodes of the
    graph to come up, ``timeout`` [s]: without a tick; the error says who is missing.
    """
    os.environ.update(ros_environment(os.environ))
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGTERM})
    context = Context()
    rclpy.init(args=sys.argv if parameters is None else None, context=context)
    node = make(context, spec, run, parameters)
    try:
        spinner = Spinner(context, [node])
        started = threading.Event()
        watch = (spinner, node, started, timeout)
        threading.Thread(target=_watch, args=watch, daemon=True).start()
        if _start(spinner, node, wait):
            started.set()
            spinner.run()
        return _end(spinner, node)
    finally:
        node.destroy_node()
        context.try_shutdown()


def ready_qos() -> QoSProfile:
    """Return the quality of service of READY: kept for whoever comes up later."""
    return QoSProfile(
        depth=100,
        reliability=ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL,
    )


def _options(kind: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=f"One {kind} of a bench's graph.")
    parser.add_argument("--graph", required=True, metavar="FILE", help="the graph as JSON")
    parser.add_argument("--ticks", type=int, required=True, help="length of the run in ms")
    parser.add_argument("--name", help="node of the graph, where several are of this kind")
    parser.add_argument("--wait", type=float, default=WAIT, help="s for all nodes to come up")
    parser.add_argument("--timeout", type=float, default=TIMEOUT, help="s without a tick")
    return parser.parse_args(remove_ros_args(sys.argv)[1:])


def _spec(graph: Graph, kind: str, name: str | None) -> NodeSpec:
    fitting = [n for n in graph.nodes if n.kind == kind and name in (None, n.name)]
    if len(fitting) != 1:
        names = ", ".join(n.name for n in graph.nodes if n.kind == kind) or "none"
        raise SystemExit(f"--name must name one {kind} of the graph; there is: {names}")
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


def _watch(spinner: Spinner, node: LockstepNode, started: threading.Event, timeout: float) -> None:
    """Stop on SIGTERM; say on stderr what the node waits for when nothing moves, then give up."""
    before, moved = -1, monotonic()
    while True:
        if signal.sigtimedwait({signal.SIGTERM}, min(COMPLAIN_AFTER, timeout)) is not None:
            spinner.stop()
            return
        report = node.report()
        if report.tick != before or node.finished or not started.is_set():
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


def _end(spinner: Spinner, node: LockstepNode) -> int:
    """Let what was published arrive, close the node, and return the exit status."""
    if spinner.error is not None:
        print(f"error: {spinner.error}", file=sys.stderr)
    elif spinner.finished:
        for publisher in node.publishers:
            publisher.wait_for_all_acked(LINGER)
    node.close()
    return 0 if spinner.finished and spinner.error is None else 1
