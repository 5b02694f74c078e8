"""The valve controllers of a node set: of which kind they are, and whether they fit its valves."""

from __future__ import annotations

import sys
from types import ModuleType
from typing import Any

import numpy as np

from pressure_control.controller import CONTROLLERS
from steering_bringup.schema import NodeEntry, NodeSet
from steering_core.naming import unknown
from steering_core.parameters import ParameterSet

DEFAULTS = {"closed_centre": "pressure_control_valve", "servo_valve": "servo_valve"}
"""Kind of controller that drives a valve system."""


def controller_kinds(node_set: NodeSet) -> dict[str, str]:
    """Return the kind of controller by side; empty for the open-centre system.

    A side whose node is of one's own has the valve system's usual kind, for its state of rest.
    ValueError names what is unknown or drives other valves.
    """
    if node_set.valve_system not in DEFAULTS:
        return {}
    kinds = dict.fromkeys(("left", "right"), DEFAULTS[node_set.valve_system])
    for name, entry in node_set.nodes.items():
        if entry.kind == "valve_controller":
            kinds[str(entry.parameters.get("side", "left"))] = _checked(name, entry, node_set)
    return kinds


def _checked(name: str, entry: NodeEntry, node_set: NodeSet) -> str:
    kind = str(entry.parameters.get("controller", DEFAULTS["closed_centre"]))
    if kind not in CONTROLLERS:
        raise ValueError(f"node '{name}': {unknown('controller', kind, CONTROLLERS)}")
    drives = getattr(CONTROLLERS[kind], "valve_system", node_set.valve_system)
    if drives != node_set.valve_system:
        raise ValueError(
            f"node '{name}': controller '{kind}' drives {drives}, but the node set's valve_system "
            f"is {node_set.valve_system}: write parameters: "
            f"{{controller: {DEFAULTS[node_set.valve_system]}}}"
        )
    return kind


def valve_controllers(
    node_set: NodeSet, parameters: ParameterSet, table: np.ndarray
) -> tuple[Any, Any]:
    """Return the left and the right controller, None for the open-centre system."""
    kinds = controller_kinds(node_set)
    if not kinds:
        return None, None
    left, right = (CONTROLLERS[kinds[s]](parameters, s, table) for s in ("left", "right"))
    return left, right


def control_modules(controller: Any) -> tuple[ModuleType, ...]:
    """Return the module whose ``controller_step`` the direct loop calls; none for its own."""
    return () if controller is None else (sys.modules[type(controller).__module__],)


def check_delayed_stability(
    node_set: NodeSet, parameters: ParameterSet, table: np.ndarray, delay: int
) -> None:
    """Raise ControllerError where a controller cannot work with so many ticks of delay."""
    for kind in set(controller_kinds(node_set).values()):
        CONTROLLERS[kind].check_stability(parameters, table, delay)
