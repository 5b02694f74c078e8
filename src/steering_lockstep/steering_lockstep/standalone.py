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
from collections.abc import Callable
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.utilities import remove_ros_args

from steering_lockstep.graph import Graph, NodeSpec
from steering_lockstep.graph_file import read_graph
from steering_lockstep.middleware import ros_environment
from steering_lockstep.node import LockstepNode
from steering_lockstep.settings import RunSettings
from steering_lockstep.spinner import Spinner

READY = "/lockstep/ready"
MATCHING_STEP = 0.02
COMPLAIN_AFTER = 2.0
LINGER = Duration(seconds=2.0)


def spin_alone(kind: str, make: Callable[..., LockstepNode]) -> None:
    """Run the node of ``kind`` that the command line names, and end the process.

    Status 0 only if the node did all its ticks and closed well.
    """
    options = _options(kind)
    os.environ.update(ros_environment(os.environ))
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGTERM})
    graph = read_graph(options.graph)
    context = Context()
    rclpy.init(args=sys.argv, context=context)
    spec = _spec(graph, kind, options.name)
    node = make(context, spec, RunSettings(graph, options.ticks), None)
    try:
        spinner = Spinner(context, [node])
        threading.Thread(target=_watch, args=(spinner, node), daemon=True).start()
        if _start(spinner, node):
            spinner.run()
        status = _end(spinner, node)
    finally:
        node.destroy_node()
        context.try_shutdown()
    raise SystemExit(status)


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
    return parser.parse_args(remove_ros_args(sys.argv)[1:])


def _spec(graph: Graph, kind: str, name: str | None) -> NodeSpec:
    fitting = [n for n in graph.nodes if n.kind == kind and name in (None, n.name)]
    if len(fitting) != 1:
        names = ", ".join(n.name for n in graph.nodes if n.kind == kind) or "none"
        raise SystemExit(f"--name must name one {kind} of the graph; there is: {names}")
    return fitting[0]


def _start(spinner: Spinner, node: LockstepNode) -> bool:
    """Start when every node has all its connections. False when told to stop before."""
    from std_msgs.msg import String

    others = {n.name for n in node.run.graph.nodes} - {node.spec.name}

    def note(message: Any) -> None:
        others.discard(message.data)

    node.create_subscription(String, READY, note, ready_qos())
    publisher = node.create_publisher(String, READY, ready_qos())
    while spinner.alive() and spinner.unmatched():
        spinner.spin_for(MATCHING_STEP)
    publisher.publish(String(data=node.spec.name))
    while spinner.alive() and others:
        spinner.spin_for(MATCHING_STEP)
    spinner.start()
    return spinner.alive()


def _watch(spinner: Spinner, node: LockstepNode) -> None:
    """Stop on SIGTERM; say on stderr what the node waits for when nothing moves."""
    before = -1
    while True:
        if signal.sigtimedwait({signal.SIGTERM}, COMPLAIN_AFTER) is not None:
            spinner.stop()
            return
        report = node.report()
        if report.tick == before and not node.finished:
            what = ", ".join(report.lacking) or "nothing"
            print(f"{node.spec.name}: tick {report.tick} waits for {what}", file=sys.stderr)
        before = report.tick


def _end(spinner: Spinner, node: LockstepNode) -> int:
    """Let what was published arrive, close the node, and return the exit status."""
    if spinner.error is not None:
        print(f"error: {spinner.error}", file=sys.stderr)
    elif spinner.finished:
        for publisher in node.publishers:
            publisher.wait_for_all_acked(LINGER)
    node.close()
    return 0 if spinner.finished and spinner.error is None else 1
