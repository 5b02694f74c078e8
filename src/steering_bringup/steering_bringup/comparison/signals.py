"""The signals that two runs are compared by, and where a bag has them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from steering_bringup.bags import Trace
from steering_lockstep.signals import PLACES

Take = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Signal:
    """One compared signal. `take` makes it, in SI, from its topic's rows; it needs their `fields`.

    Shown as value x `scale` in `shown_unit`; `digits` is what a table prints after the point, None
    for as many as a number of unknown size needs.
    """

    key: str
    title: str
    topic: str
    take: Take
    unit: str
    shown_unit: str
    scale: float
    digits: int | None
    fields: tuple[str, ...]


def _field(name: str) -> Take:
    return lambda rows: rows[name].astype(float)


def _load_pressure(rows: np.ndarray) -> np.ndarray:
    return np.asarray(rows["right"] - rows["left"])


_SHOWN = {
    "N m": ("N m", 1.0),
    "Pa": ("bar", 1e-5),
    "rad": ("deg", 180.0 / np.pi),
    "rad/s": ("deg/s", 180.0 / np.pi),
    "m": ("mm", 1e3),
    "m/s": ("mm/s", 1e3),
    "N": ("N", 1.0),
}
"""SI unit to the one that is shown, and the factor to it."""

_PRESSURE = "/steering/pressure"


def _signal(key: str, title: str, unit: str, digits: int) -> Signal:
    """A signal that is one field of a topic, found by its name."""
    topic, field = PLACES[{"steering_wheel_torque": "driver_torque"}.get(key, key)]
    return Signal(key, title, topic, _field(field), unit, *_SHOWN[unit], digits, (field,))


_ASSISTANCE = Signal(
    "assistance_pressure",
    "Assistance pressure",
    _PRESSURE,
    _load_pressure,
    "Pa",
    *_SHOWN["Pa"],
    2,
    ("left", "right"),
)

SIGNALS: tuple[Signal, ...] = (
    _signal("steering_wheel_torque", "Steering wheel torque", "N m", 3),
    _signal("torsion_bar_torque", "Torsion bar torque", "N m", 3),
    _ASSISTANCE,
    _signal("left_pressure", "Left chamber", "Pa", 2),
    _signal("right_pressure", "Right chamber", "Pa", 2),
    _signal("supply_pressure", "Supply pressure", "Pa", 1),
    _signal("steering_wheel_angle", "Steering wheel angle", "rad", 3),
    _signal("steering_wheel_speed", "Steering wheel speed", "rad/s", 2),
    _signal("rack_position", "Rack position", "m", 4),
)
"""What two runs of the bench are compared by."""

FURTHER: tuple[Signal, ...] = (
    _signal("rack_speed", "Rack speed", "m/s", 2),
    _signal("rack_force", "Rack force", "N", 1),
    _signal("left_reference_pressure", "Left reference pressure", "Pa", 2),
    _signal("right_reference_pressure", "Right reference pressure", "Pa", 2),
    _signal("left_solenoid_force", "Left solenoid force", "N", 2),
    _signal("right_solenoid_force", "Right solenoid force", "N", 2),
)
"""What else measured data of a steering gear may share."""


def is_run(trace: Trace) -> bool:
    """Whether a trace is a run of the bench that says what it was made with."""
    return any(key in trace.run for key in ("scenario", "node_set"))


def has(trace: Trace, signal: Signal) -> bool:
    """Whether a trace holds the topic of a signal, with ticks and its fields."""
    if signal.topic not in trace:
        return False
    names = trace[signal.topic].dtype.names or ()
    return all(name in names for name in ("tick", *signal.fields))


def considered(traces: tuple[Trace, Trace]) -> list[Signal]:
    """Signals that two traces may be compared by, those that both have and those that one has.

    Runs of the bench: SIGNALS. Where one is none, every numeric field on a tick as well.
    """
    if all(is_run(trace) for trace in traces):
        return list(SIGNALS)
    known = [*SIGNALS, *FURTHER]
    named = {(signal.topic, name) for signal in known for name in signal.fields}
    places = {
        (topic, name)
        for trace in traces
        for topic, rows in trace.topics.items()
        if "tick" in (rows.dtype.names or ())
        for name in rows.dtype.names or ()
        if name not in ("tick", "stamp") and not rows.dtype[name].shape
    }
    own = [_unknown(topic, name) for topic, name in sorted(places - named)]
    return known + own


def _unknown(topic: str, name: str) -> Signal:
    """A field of a topic that the bench does not know: its unit is its own."""
    title = f"{topic} {name}"
    return Signal(title, title, topic, _field(name), "", "", 1.0, None, (name,))


def valve_system(trace: Trace) -> str:
    """ "open-centre" for a run without valve commands, else "closed-centre" or "servo-valve".

    What measured data's mapping says for those; "" where nobody says it.
    """
    if not is_run(trace):
        measured = trace.run.get("measured") or {}
        return str(measured.get("valve_system", "")).replace("_", "-")
    if "/valve/left/command" not in trace:
        return "open-centre"
    servo = (trace.run.get("node_set") or {}).get("valve_system") == "servo_valve"
    return "servo-valve" if servo else "closed-centre"
