"""Kinds of nodes and where their programs are. A new kind of node is one line here."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from difflib import get_close_matches
from pkgutil import resolve_name
from typing import Any

FACTORIES = {
    "plant": "steering_plant.plant_node:make",
    "valve_controller": "pressure_control.controller_node:make",
    "load_force_controller": "pressure_control.load_force_node:make",
    "overlay_arbiter": "pressure_control.overlay.arbiter_node:make",
    "lane_keeper": "steering_bringup.lane_keeping.lane_keeper_node:make",
    "driver": "driver_model.driver_node:make",
    "vehicle": "vehicle_model.vehicle_node:make",
    "rig_bridge": "rig_bridge.bridge_node:make",
    "recorder": "steering_bringup.recorder_node:make",
    "replay": "steering_bringup.replay_node:make",
}


def location(kind: str) -> str:
    """Return "module:function" of ``kind``, which may itself be one; ``KeyError`` otherwise."""
    if ":" in kind:
        return kind
    if kind not in FACTORIES:
        near = get_close_matches(kind, FACTORIES, n=1, cutoff=0.0)
        raise KeyError(f"unknown kind of node '{kind}'; nearest: {near[0]}")
    return FACTORIES[kind]


def factory(kind: str) -> Callable[..., Any]:
    """Return the function ``make(context, spec, run, parameters)`` of ``kind``."""
    made: Callable[..., Any] = resolve_name(location(kind))
    return made


def programs(kinds: Iterable[str]) -> list[str]:
    """Return the modules of kinds of nodes, each once."""
    return sorted({location(kind).split(":")[0] for kind in kinds})
