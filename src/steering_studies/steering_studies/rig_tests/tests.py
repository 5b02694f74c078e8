"""Which rig tests there are, and the scenarios that make them up."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

FRICTION_PRESSURES_BAR = (5, 10, 20, 40, 60, 80)
"""In both chambers, source section 3.2."""

REST_BAR = 4.9
"""What the reference asks for in both chambers without torque; the raise comes on top."""

PUMP_OFF = {"open_centre.pump_flow": 1e-8}
"""Nothing pushes the clamped rack but the column [m3/s]."""

DISCONNECTED = {"mechanics.torsion_bar_stiffness": 1e-6}
"""The column taken off the valve's input shaft."""


@dataclass(frozen=True)
class RigTest:
    """One rig test. runs: name of a run to its scenario as data, without schema and name."""

    name: str
    purpose: str
    figure: str
    runs: Mapping[str, dict[str, Any]]


STROKE_M, SERVO_STIFFNESS = 0.004, 2.5e5
"""Amplitude of the rack, and the load cylinder's position servo [N/m]."""


def _friction(pressure_bar: float) -> dict[str, Any]:
    raised = max(pressure_bar - REST_BAR, 0.0) * 1e5
    # The servo gives way under the friction; as on a rig, its reference is set to reach 4 mm.
    given_way = (60.0 + 2.2e-5 * 2e5 * pressure_bar) / SERVO_STIFFNESS
    return {
        "node_set": "closed_centre",
        "duration": 28.0,
        "manoeuvre": {"kind": "hold"},
        "load": {
            "kind": "position_servo",
            "amplitude_m": STROKE_M + given_way,
            "stiffness_n_m": SERVO_STIFFNESS,
        },
        "parameters": {"valve_controller.common_pressure_raise": raised, **DISCONNECTED},
    }


RIG_TESTS: dict[str, RigTest] = {
    test.name: test
    for test in (
        RigTest(
            "boost_curve",
            "load pressure against torsion-bar torque, rack clamped: opening areas",
            "figs 3.4, 3.5",
            {
                "boost_curve": {
                    "node_set": "open_centre",
                    "duration": 42.0,
                    "manoeuvre": {
                        "kind": "weave",
                        "amplitude_deg": 4.7,
                        "frequency_hz": 0.05,
                        "entry_s": 2.0,
                    },
                    "load": {"kind": "clamp"},
                }
            },
        ),
        RigTest(
            "rack_friction",
            "force that moves the rack 4 mm at six pressures, column off: level and slope",
            "fig 3.6",
            {f"rack_friction_{bar}_bar": _friction(bar) for bar in FRICTION_PRESSURES_BAR},
        ),
        RigTest(
            "column_friction",
            "torque that turns the free wheel while the rack is moved 4 mm at 10 bar",
            "fig 3.7",
            {
                "column_friction": {
                    "node_set": "closed_centre",
                    "duration": 28.0,
                    "manoeuvre": {
                        "kind": "free_release",
                        "angle_deg": 0.0,
                        "start_s": 0.0,
                        "rise_s": 0.001,
                        "release_s": 0.001,
                    },
                    "load": {"kind": "position_servo", "stiffness_n_m": SERVO_STIFFNESS},
                    "parameters": {
                        "valve_controller.common_pressure_raise": (10.0 - REST_BAR) * 1e5
                    },
                }
            },
        ),
        RigTest(
            "stiffness",
            "torque against wheel angle, rack clamped: torsion bar and column in series",
            "fig 3.8",
            {
                "stiffness": {
                    "node_set": "open_centre",
                    "parameters": PUMP_OFF,
                    "duration": 22.0,
                    "manoeuvre": {
                        "kind": "weave",
                        "amplitude_deg": 7.0,
                        "frequency_hz": 0.1,
                        "entry_s": 2.0,
                    },
                    "load": {"kind": "clamp"},
                }
            },
        ),
        RigTest(
            "inertia",
            "the wheel is let go at 8 degrees, rack clamped: inertia and damping",
            "fig 3.9",
            {
                "inertia": {
                    "node_set": "open_centre",
                    "parameters": PUMP_OFF,
                    "duration": 6.0,
                    "manoeuvre": {
                        "kind": "free_release",
                        "angle_deg": 8.0,
                        "start_s": 0.2,
                        "rise_s": 0.5,
                        "release_s": 1.0,
                    },
                    "load": {"kind": "clamp"},
                }
            },
        ),
        RigTest(
            "system",
            "on-centre driving up to 400 deg/s at 70 km/h: for validation",
            "figs 3.10, 3.11",
            {
                "system": {
                    "node_set": "open_centre",
                    "duration": 20.0,
                    "manoeuvre": {
                        "kind": "on_centre",
                        "amplitude_deg": 30.0,
                        "final_frequency_hz": 2.12,
                        "duration_s": 20.0,
                    },
                    "load": {"kind": "bicycle"},
                }
            },
        ),
    )
}
"""Every rig test by name. Register a new one here, and only here."""


def scenario(test: str, run: str, parameters: Mapping[str, float], effects: Any) -> dict[str, Any]:
    """Return the scenario of one run as data; ``parameters`` [SI] are the gear's own."""
    document = dict(RIG_TESTS[test].runs[run])
    document["parameters"] = {**parameters, **document.get("parameters", {})}
    document["effects"] = effects
    return {"schema": 1, "name": run, **document}
