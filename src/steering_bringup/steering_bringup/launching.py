"""The bench as launch actions: what the launch files of share/steering_bringup/launch are made of.

A launch argument stands for an option of ``steer graph``: scenarios, node sets and their checks are
those of the command line, and the nodes read the same file.
"""

from __future__ import annotations

import argparse
import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from launch import Action, LaunchContext, LaunchDescription
from launch.actions import (
    DeclareLaunchArgument,
    EmitEvent,
    ExecuteProcess,
    OpaqueFunction,
    RegisterEventHandler,
    Shutdown,
)
from launch.event_handlers import OnProcessIO
from launch.events import Shutdown as ShutdownEvent
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from steering_bringup.checks import free_folder
from steering_bringup.cli import graph
from steering_bringup.errors import BenchError
from steering_bringup.graph_run import write_graph_file
from steering_bringup.plans import Plan
from steering_lockstep.executables import executable
from steering_lockstep.graph import NodeSpec

ARGUMENTS = {
    "scenario": ("on_centre", "by name or file: see 'steer list'"),
    "node_set": ("", "by name or file (default: the scenario's, where it is one)"),
    "duration": ("", "s, simulated (default: the scenario's)"),
    "set": ("", "values, such as 'vehicle.speed=25 mechanics.rack_mass=30'"),
    "real_time": ("false", "pace the ticks to the wall clock"),
    "truth": ("", "true states of the plant too (default: as the scenario says)"),
    "record": ("true", "record a bag, with every message of every tick"),
    "out": ("", "folder of graph file and bag (default: results/SCENARIO-1, -2, ...)"),
    "wait_for": ("", "topics that somebody must listen to before tick 0"),
    "namespace": ("", "before the names of all nodes, topics and services"),
    "remap": ("", "other names of topics, such as 'driver/torque:=hand/torque'"),
    "params_file": ("", "ROS parameter file that every node reads"),
    "wait": ("60.0", "s for all nodes to come up"),
}
OF_A_RIG = {
    "rig": ("emulated", "by name or file: see 'steer list rigs'"),
    "rig_link": ("", "udp or can (default: as its file says)"),
    "rig_fault": ("end", "what the safe state does to the run: end it, or hold it until a reset"),
}
YES, NO = ("true", "1", "yes", "on"), ("false", "0", "no", "off")


def bench(defaults: Mapping[str, str] | None = None, *, rig: bool = False) -> LaunchDescription:
    """Return a launch description of the bench; ``defaults``: of arguments, where they differ.

    Every node is a process of its own. When one fails the others are ended; when all have done
    their last tick the launch is over.
    """
    known = ARGUMENTS | (OF_A_RIG if rig else {})
    chosen = {name: (defaults or {}).get(name, value) for name, (value, _) in known.items()}
    declared = [
        DeclareLaunchArgument(name, default_value=chosen[name], description=text)
        for name, (_, text) in known.items()
    ]
    return LaunchDescription([*declared, OpaqueFunction(function=_actions, args=[tuple(known)])])


def _actions(context: LaunchContext, names: Sequence[str]) -> list[Any]:
    values = {name: LaunchConfiguration(name).perform(context) for name in names}
    options = _options(values)
    plan = graph.plan_of(options)
    if plan.rig is None:
        write_graph_file(plan, options.out)
        return _nodes(plan, values, options.out)
    connection, command = plan.rig.launched()
    write_graph_file(plan, options.out, connection)
    nodes = _nodes(plan, values, options.out)
    return _after(command, nodes) if command else nodes


def _options(values: Mapping[str, str]) -> argparse.Namespace:
    """Return the options of ``steer graph`` that the launch arguments stand for."""
    name = Path(values["scenario"]).stem
    folder = Path(values["out"]) if values["out"] else free_folder(Path("results"), name)
    words = [values["scenario"], "--out", str(folder / "graph.json")]
    for option in ("node_set", "duration", "rig", "rig_link", "rig_fault"):
        if values.get(option):
            words += [f"--{option.replace('_', '-')}", values[option]]
    for option in ("set", "wait_for"):
        for word in shlex.split(values[option]):
            words += [f"--{option.replace('_', '-')}", word]
    words += ["--plant", "rig"] if "rig" in values else []
    words += ["--real-time"] if _truth("real_time", values) else []
    if values["truth"]:
        words.append("--truth" if _truth("truth", values) else "--no-truth")
    if _truth("record", values):
        words += ["--record", str(folder / "bag")]
    parser = _Parser()
    graph.arguments(parser)
    return parser.parse_args(words)


def _truth(name: str, values: Mapping[str, str]) -> bool:
    value = values[name].lower()
    if value not in (*YES, *NO):
        raise BenchError(f"{name}:={values[name]}: write true or false")
    return value in YES


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> Any:
        raise BenchError(message)


def _nodes(plan: Plan, values: Mapping[str, str], file: Path) -> list[Any]:
    together = Together(plan.graph.nodes)
    return [_node(node, values, file, together) for node in plan.graph.nodes]


def _node(spec: NodeSpec, values: Mapping[str, str], file: Path, together: Together) -> Node:
    package, program = executable(spec.kind)
    remaps = [tuple(rule.split(":=", 1)) for rule in shlex.split(values["remap"])]
    words = ["--graph", str(file.absolute()), "--name", spec.name, "--wait", values["wait"]]
    return Node(
        package=package,
        executable=program,
        name=spec.name,
        namespace=values["namespace"] or None,
        arguments=words,
        remappings=remaps,
        parameters=[values["params_file"]] if values["params_file"] else None,
        output="screen",
        on_exit=together.ended,
    )


class Together:
    """Ends all nodes when one fails, and the launch when all are through."""

    def __init__(self, nodes: Sequence[NodeSpec]) -> None:
        self._left = len(nodes)

    def ended(self, event: Any, context: LaunchContext) -> Action | None:
        """Tell what follows from the end of a node's process."""
        self._left -= 1
        if context.is_shutdown:
            return None
        if event.returncode:
            why = f"{event.process_name} ended with status {event.returncode}"
            return Shutdown(reason=why)
        return None if self._left else EmitEvent(event=ShutdownEvent(reason="the run is over"))


def _after(command: Sequence[str], nodes: list[Any]) -> list[Any]:
    """Start an emulated rig, and the nodes when it says that it is ready."""
    rig = ExecuteProcess(
        cmd=list(command), name="rig_emulator", output="screen", on_exit=Shutdown()
    )
    waiting = list(nodes)

    def said(event: Any) -> list[Any] | None:
        if b'"ready"' not in event.text:
            return None
        started, waiting[:] = list(waiting), []
        return started

    return [RegisterEventHandler(OnProcessIO(target_action=rig, on_stdout=said)), rig]
