"""From a scenario to the ROS parameters of its nodes."""

from __future__ import annotations

from typing import Any

from steering_bringup.rig_runs import RIG_KIND
from steering_bringup.schema import NodeSet, Scenario
from steering_core.parameters import load_parameters


def curve_points(scenario: Scenario) -> dict[str, Any]:
    """Return the points of a measured boost curve by column; empty where the formula is used."""
    return {} if scenario.boost_curve is None else scenario.boost_curve.model_dump()


def node_parameters(scenario: Scenario, node_set: NodeSet) -> dict[str, dict[str, Any]]:
    """Return the ROS parameters of each node, by node name.

    Data sheet values travel under their own names where they differ from the nominal set, which a
    node takes by itself.
    """
    shared = changed_values(scenario)
    return {
        name: shared | _own(scenario, node_set, entry.kind) | dict(entry.parameters)
        for name, entry in node_set.nodes.items()
        if entry.kind != RIG_KIND  # a rig is what it is
    }


def changed_values(scenario: Scenario) -> dict[str, float]:
    """Return the parameters that differ from the nominal set."""
    nominal = load_parameters().flat()
    used = scenario.parameter_values().flat()
    return {name: value for name, value in used.items() if value != nominal[name]}


def _own(scenario: Scenario, node_set: NodeSet, kind: str) -> dict[str, Any]:
    """Return what a kind of node takes beside the data sheet's values."""
    curve = {f"boost_curve.{name}": list(values) for name, values in curve_points(scenario).items()}
    effects = {
        f"effects.{effect}.{name}": value
        for effect, values in scenario.effects.items()
        for name, value in values.items()
    }
    cylinder = {"has_load_cylinder": True} if node_set.load_cylinder else {}
    own: dict[str, dict[str, Any]] = {
        "plant": {"valve_system": node_set.valve_system, **cylinder, **curve, **effects},
        "valve_controller": curve,
        "driver": _nested("manoeuvre", scenario.manoeuvre),
        "vehicle": {**_nested("load", scenario.load), **effects},
    }
    return own.get(kind, {})


def _nested(prefix: str, choice: Any) -> dict[str, Any]:
    values = {"kind": choice.kind, **choice.values()}
    return {
        f"{prefix}.{name}": list(value) if isinstance(value, tuple) else value
        for name, value in values.items()
    }
