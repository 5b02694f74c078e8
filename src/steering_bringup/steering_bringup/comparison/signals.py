"""The signals that two runs are compared by, and where a bag has them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from steering_bringup.bags import Trace

Take = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Signal:
    """One compared signal. `take` makes it, in SI, from its topic's rows.

    Shown as value x `scale` in `shown_unit`; `digits` is what a table prints after the point.
    """

    key: str
    title: str
    topic: str
    take: Take
    unit: str
    shown_unit: str
    scale: float
    digits: int


def _field(name: str) -> Take:
    return lambda rows: rows[name].astype(float)


def _load_pressure(rows: np.ndarray) -> np.ndarray:
    return np.asarray(rows["right"] - rows["left"])


_DEGREE = 180.0 / np.pi
_TORQUE, _PRESSURE, _RACK = "/steering/torque", "/steering/pressure", "/steering/rack"

SIGNALS: tuple[Signal, ...] = (
    Signal(
        "steering_wheel_torque",
        "Steering wheel torque",
        "/driver/torque",
        _field("torque"),
        "N m",
        "N m",
        1.0,
        3,
    ),
    Signal(
        "torsion_bar_torque",
        "Torsion bar torque",
        _TORQUE,
        _field("torsion_bar_torque"),
        "N m",
        "N m",
        1.0,
        3,
    ),
    Signal(
        "assistance_pressure",
        "Assistance pressure",
        _PRESSURE,
        _load_pressure,
        "Pa",
        "bar",
        1e-5,
        2,
    ),
    Signal("left_pressure", "Left chamber", _PRESSURE, _field("left"), "Pa", "bar", 1e-5, 2),
    Signal("right_pressure", "Right chamber", _PRESSURE, _field("right"), "Pa", "bar", 1e-5, 2),
    Signal("supply_pressure", "Supply pressure", _PRESSURE, _field("supply"), "Pa", "bar", 1e-5, 1),
    Signal(
        "steering_wheel_angle",
        "Steering wheel angle",
        _TORQUE,
        _field("steering_wheel_angle"),
        "rad",
        "deg",
        _DEGREE,
        3,
    ),
    Signal(
        "steering_wheel_speed",
        "Steering wheel speed",
        _TORQUE,
        _field("steering_wheel_speed"),
        "rad/s",
        "deg/s",
        _DEGREE,
        2,
    ),
    Signal("rack_position", "Rack position", _RACK, _field("position"), "m", "mm", 1e3, 4),
)

BY_KEY = {signal.key: signal for signal in SIGNALS}


def has(trace: Trace, signal: Signal) -> bool:
    """Whether a trace holds the topic of a signal, with ticks."""
    return signal.topic in trace and "tick" in (trace[signal.topic].dtype.names or ())


def valve_system(trace: Trace) -> str:
    """ "open-centre" for a run without valve commands, else "closed-centre" or "servo-valve"."""
    if "/valve/left/command" not in trace:
        return "open-centre"
    servo = (trace.run.get("node_set") or {}).get("valve_system") == "servo_valve"
    return "servo-valve" if servo else "closed-centre"
