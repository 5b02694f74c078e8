"""Loss of supply, of a sensor or of a valve: what the driver feels, and the legal effort."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from steering_plant.plant import Plant
from steering_studies.beyond.drawing import over_time
from steering_studies.beyond.loop import Record, closed_loop
from steering_studies.beyond.study import Answer, Study, Table

LOST_AT_S = 6.0
WHEEL_RADIUS_M = 0.19
"""Of a usual steering wheel; turns torque into effort at the rim."""

LEGAL_EFFORT_N = 300.0
"""UN Regulation 79, steering effort with a failure, vehicles of category M1."""

DRIVE: dict[str, Any] = {
    "duration": 14.0,
    "node_set": "closed_centre",
    "manoeuvre": {"kind": "weave", "amplitude_deg": 25.0, "frequency_hz": 0.25},
    "parameters": {"vehicle.speed": 13.9},
}
"""Curves at 50 km/h; the regulation turns at 10 km/h, where the tyres' forces are smaller."""


def _no_supply(tick: int, plant: Plant) -> None:
    """Let the supply pressure fall to 1 bar within 0.2 s."""
    past = tick * 1e-3 - LOST_AT_S
    if past > 0.0:
        plant.par["supply_pressure"][0] = max(2e7 * (1.0 - past / 0.2), 1e5)


def _no_torque(tick: int, values: list[float]) -> list[float]:
    """Let the torque sensor say zero."""
    if tick * 1e-3 > LOST_AT_S:
        values[2] = 0.0
    return values


def _stuck_pressure(tick: int, values: list[float]) -> list[float]:
    """Let the left pressure sensor stick at 30 bar."""
    if tick * 1e-3 > LOST_AT_S:
        values[3] = 3e6
    return values


def _open_left(tick: int, left: float, right: float) -> tuple[float, float]:
    """Cut the current of the left valve: its spring opens the chamber to the tank."""
    return (0.0 if tick * 1e-3 > LOST_AT_S else left), right


def _full_left(tick: int, left: float, right: float) -> tuple[float, float]:
    """Let the left solenoid push with 30 N whatever is asked."""
    return (30.0 if tick * 1e-3 > LOST_AT_S else left), right


def _both_off(tick: int, left: float, right: float) -> tuple[float, float]:
    """Cut the current of both valves, as a supervisor does on a fault: both chambers to tank."""
    return (0.0, 0.0) if tick * 1e-3 > LOST_AT_S else (left, right)


LOSSES: dict[str, dict[str, Callable[..., Any]]] = {
    "none": {},
    "supply": {"before": _no_supply},
    "torque sensor reads zero": {"sensed": _no_torque},
    "left pressure sensor stuck at 30 bar": {"sensed": _stuck_pressure},
    "left valve without current": {"acted": _open_left},
    "left valve stuck at 30 N": {"acted": _full_left},
    "left valve stuck, both switched off": {"acted": _both_off},
}


SHOWN = ("none", "supply", "torque sensor reads zero", "left valve stuck at 30 N")
"""What the figure draws."""


def effort(record: Record) -> float:
    """Return the largest effort at the rim after the loss has settled [N]."""
    late = record.time > LOST_AT_S + 1.0
    return float(np.max(np.abs(record.driver[late]))) / WHEEL_RADIUS_M


def kick(record: Record, sound: Record) -> float:
    """Return the largest change of torsion-bar torque within half a second of the loss [N m]."""
    near = (record.time > LOST_AT_S) & (record.time < LOST_AT_S + 0.5)
    return float(np.max(np.abs(record.measured[near, 2] - sound.measured[near, 2])))


def answer(parameters: dict[str, float]) -> Answer:
    """Lose one thing after the other in a curve, and measure what the driver feels."""
    runs = {name: closed_loop(DRIVE, parameters, **hooks) for name, hooks in LOSSES.items()}
    sound = runs["none"]
    numbers = {
        name: {"effort_N": effort(run), "kick_Nm": kick(run, sound)} for name, run in runs.items()
    }
    rows = [
        (
            name,
            f"{found['effort_N']:.0f}",
            "kept" if found["effort_N"] <= LEGAL_EFFORT_N else "exceeded",
            f"{found['kick_Nm']:.2f}",
        )
        for name, found in numbers.items()
    ]
    manual = numbers["supply"]["effort_N"]
    worst = max(numbers, key=lambda name: numbers[name]["effort_N"])
    hardest = max(numbers, key=lambda name: numbers[name]["kick_Nm"])
    return Answer(
        f"Without hydraulics the rim takes {manual:.0f} N (legal limit {LEGAL_EFFORT_N:.0f} N); "
        f"the largest effort, {numbers[worst]['effort_N']:.0f} N, follows '{worst}', the hardest "
        f"kick, {numbers[hardest]['kick_Nm']:.1f} N m, '{hardest}'.",
        numbers,
        [
            over_time(
                "Torsion-bar torque; lost at 6 s",
                {
                    "torque [N m]": {
                        name: (run.time, run.measured[:, 2])
                        for name, run in runs.items()
                        if name in SHOWN
                    }
                },
                340,
            )
        ],
        [
            Table(
                ("Lost", "Largest effort at the rim [N]", "Legal limit", "Kick [N m]"),
                rows,
            )
        ],
        (
            "Effort: the driver's torque over a rim radius of 0.19 m, from 1 s after the loss on.",
            "Kick: largest change of torsion-bar torque within half a second of the loss.",
        ),
    )


STUDY = Study("losses", "What does the driver feel when supply, sensor or valve is lost?", answer)
