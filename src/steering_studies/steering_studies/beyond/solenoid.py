"""A solenoid model (lag, moving mass, hysteresis) and what it costs in performance."""

from __future__ import annotations

from typing import Any

import numpy as np

from steering_studies.beyond.drawing import over_time
from steering_studies.beyond.study import Answer, Study, Table, simulate

DRIVE: dict[str, Any] = {
    "duration": 12.0,
    "manoeuvre": {
        "kind": "on_centre",
        "amplitude_deg": 30.0,
        "final_frequency_hz": 2.0,
        "duration_s": 12.0,
    },
}
RESONANCE = {"valve_controller.resonance": 350.0}
"""What a lag of a millisecond still allows at 1 kHz."""

HEAVY = {"valve_controller.resonance": 180.0, "pressure_control_valve.spool_mass": 0.030}
"""With the core's 20 g on the spool the sampled loop is stable up to some 200 rad/s."""

CASES: dict[str, tuple[dict[str, Any], dict[str, float]]] = {
    "ideal": ({}, {}),
    "ideal, 350 rad/s": ({}, RESONANCE),
    "ideal, 180 rad/s": ({}, {"valve_controller.resonance": 180.0}),
    "lag 1 ms": ({"solenoid_lag": {"time_constant": 1e-3}}, RESONANCE),
    "lag 2 ms": ({"solenoid_lag": {"time_constant": 2e-3}}, RESONANCE),
    "core of 20 g": ({}, HEAVY),
    "hysteresis of 1 N": ({"solenoid_hysteresis": {"width": 1.0}}, RESONANCE),
    "all of them": (
        {"solenoid_lag": {"time_constant": 1e-3}, "solenoid_hysteresis": {"width": 1.0}},
        HEAVY,
    ),
}
"""Name to effects and parameters."""


def answer(parameters: dict[str, float]) -> Answer:
    """Compare each case with the open-centre system on centre."""
    plain = simulate({**DRIVE, "node_set": "open_centre"}, parameters)
    target = plain.pressure[:, 1] - plain.pressure[:, 0]
    numbers, rows, torques = {}, [], {}
    time = np.arange(len(target)) * 1e-3
    for name, (effects, changed) in CASES.items():
        trace = simulate(
            {**DRIVE, "node_set": "closed_centre", "effects": effects}, {**changed, **parameters}
        )
        torque = trace.torque[:, 2] - plain.torque[:, 2]
        pressure = trace.pressure[:, 1] - trace.pressure[:, 0] - target
        found = float(np.max(np.abs(torque))), float(np.max(np.abs(pressure)))
        numbers[name] = {"torque_difference_Nm": found[0], "load_pressure_difference_Pa": found[1]}
        rows.append((name, f"{found[0]:.3f}", f"{found[1] * 1e-5:.2f}"))
        torques[name] = (time, torque)
    worst, slowed = numbers["all of them"], numbers["ideal, 180 rad/s"]
    return Answer(
        f"With lag, moving mass and hysteresis together the torque differs from the open centre by "
        f"up to {worst['torque_difference_Nm']:.2f} N m and the pressure by "
        f"{worst['load_pressure_difference_Pa'] * 1e-5:.1f} bar, with an ideal solenoid by "
        f"{numbers['ideal']['torque_difference_Nm']:.2f} N m. The price is the slower controller: "
        f"slowed as much, the ideal one gives {slowed['torque_difference_Nm']:.2f} N m.",
        numbers,
        [
            over_time(
                "Torque difference to the open centre",
                {
                    "torque difference [N m]": {
                        name: torques[name] for name in ("ideal", "lag 1 ms", "all of them")
                    }
                },
                320,
            )
        ],
        [Table(("Solenoid", "Torque difference [N m]", "Pressure difference [bar]"), rows)],
        (
            (
                "The controller is slowed from 1200 to 350 rad/s for lag and hysteresis, to 180 "
                "rad/s for the core's mass and for all of them; it would be unstable otherwise."
            ),
        ),
    )


STUDY = Study("solenoid", "What do a real solenoid's lag, mass and hysteresis cost?", answer)
