"""A solenoid model (lag, moving mass, hysteresis) and what it costs in performance."""

from __future__ import annotations

from typing import Any

import numpy as np

from steering_bringup.direct.runner import DirectTrace
from steering_core.errors import BenchError
from steering_studies.beyond.drawing import over_time
from steering_studies.beyond.study import Answer, Study, Table, simulate
from steering_studies.linear.systems import CYCLE_RIPPLE, ripple

DRIVE: dict[str, Any] = {
    "duration": 12.0,
    "manoeuvre": {
        "kind": "on_centre",
        "amplitude_deg": 30.0,
        "final_frequency_hz": 2.0,
        "duration_s": 12.0,
    },
}
RESONANCES = (1200.0, 850.0, 600.0, 420.0, 300.0, 210.0, 150.0)
"""Of the controller, tried from the data sheet's downwards [rad/s]: the first calm one is taken."""

LAG = {"solenoid_lag": {"time_constant": 1e-3}}
HYSTERESIS = {"solenoid_hysteresis": {"width": 1.0}}
CORE = {"pressure_control_valve.spool_mass": 0.030}
"""The core's 20 g on top of the spool's 10."""

DAMPED = CORE | {"pressure_control_valve.damping_orifice_diameter": 5.0e-5}
"""With a damping orifice of a third of the area: 0.5 of the restrictor criterion (5.28)."""

CASES: dict[str, tuple[dict[str, Any], dict[str, float]]] = {
    "ideal": ({}, {}),
    "lag of 1 ms": (LAG, {}),
    "lag of 2 ms": ({"solenoid_lag": {"time_constant": 2e-3}}, {}),
    "hysteresis of 1 N": (HYSTERESIS, {}),
    "core of 20 g": ({}, CORE),
    "core of 20 g, smaller orifice": ({}, DAMPED),
    "all three (1 ms, 1 N, 20 g)": (LAG | HYSTERESIS, CORE),
    "all three, smaller orifice": (LAG | HYSTERESIS, DAMPED),
}
"""Name to effects and parameters."""


def calm_run(
    effects: dict[str, Any], changed: dict[str, float]
) -> tuple[float, DirectTrace] | None:
    """Return the largest calm resonance [rad/s] and its run; None if none is calm."""
    for resonance in RESONANCES:
        document = {**DRIVE, "node_set": "closed_centre", "effects": effects}
        try:
            trace = simulate(document, {**changed, "valve_controller.resonance": resonance})
        except BenchError:  # the controller refuses what its own check finds unstable
            continue
        if ripple(trace) < CYCLE_RIPPLE:
            return resonance, trace
    return None


def answer(parameters: dict[str, float]) -> Answer:
    """Compare each case with the open-centre system on centre."""
    plain = simulate({**DRIVE, "node_set": "open_centre"}, parameters)
    target = plain.pressure[:, 1] - plain.pressure[:, 0]
    numbers: dict[str, Any] = {}
    rows, torques = [], {}
    time = np.arange(len(target)) * 1e-3
    for name, (effects, changed) in CASES.items():
        made = calm_run(effects, {**changed, **parameters})
        if made is None:
            numbers[name] = None
            rows.append((name, "none is calm", "", ""))
            continue
        resonance, trace = made
        torque = trace.torque[:, 2] - plain.torque[:, 2]
        pressure = trace.pressure[:, 1] - trace.pressure[:, 0] - target
        found = float(np.max(np.abs(torque))), float(np.max(np.abs(pressure)))
        numbers[name] = {
            "resonance_rad_s": resonance,
            "torque_difference_Nm": found[0],
            "load_pressure_difference_Pa": found[1],
        }
        rows.append((name, f"{resonance:.0f}", f"{found[0]:.3f}", f"{found[1] * 1e-5:.2f}"))
        torques[name] = (time, torque)
    return Answer(
        "Largest torque difference to the open centre on centre, each with the quickest calm "
        "controller: " + "; ".join(f"{name} {_told(numbers[name])}" for name in TOLD) + ".",
        numbers,
        [
            over_time(
                "Torque difference to the open centre",
                {"torque difference [N m]": {n: torques[n] for n in TOLD if n in torques}},
                320,
            )
        ],
        [
            Table(
                (
                    "Solenoid",
                    "Largest calm resonance [rad/s]",
                    "Torque difference [N m]",
                    "Pressure difference [bar]",
                ),
                rows,
            )
        ],
        (
            (
                "Lag and hysteresis leave the controller as it is. The core's mass makes the "
                "valve itself ring (5.28); a smaller damping orifice gives back most of the speed."
            ),
            (
                "Hysteresis makes the integrating controller hunt at some 10 Hz where the wheel "
                "hardly moves: that is most of its torque difference. Only faster ripple counts "
                "against calm."
            ),
            (
                "Calm: the pressures' second difference has a standard deviation below "
                f"{CYCLE_RIPPLE:.0f} Pa, and the controller's own check does not refuse it."
            ),
        ),
    )


TOLD = (
    "ideal",
    "lag of 1 ms",
    "hysteresis of 1 N",
    "core of 20 g, smaller orifice",
    "all three, smaller orifice",
)


def _told(found: dict[str, float] | None) -> str:
    return "none" if found is None else f"{found['torque_difference_Nm']:.2f} N m"


STUDY = Study("solenoid", "What do a real solenoid's lag, mass and hysteresis cost?", answer)
