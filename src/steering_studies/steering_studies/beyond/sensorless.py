"""Control without pressure sensors: the valve's own static accuracy is all there is."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.interpolate import RegularGridInterpolator

from pressure_control.linear_valve import linearise
from pressure_control.valve_static import holding_demand
from steering_core.parameters import ParameterSet, load_parameters
from steering_studies.beyond.drawing import over_time
from steering_studies.beyond.loop import Record, closed_loop
from steering_studies.beyond.study import Answer, Study, Table

CYCLES: dict[str, dict[str, Any]] = {
    "on-centre": {
        "duration": 12.0,
        "node_set": "closed_centre",
        "manoeuvre": {
            "kind": "on_centre",
            "amplitude_deg": 30.0,
            "final_frequency_hz": 2.0,
            "duration_s": 12.0,
        },
    },
    "parking": {
        "duration": 12.0,
        "node_set": "closed_centre",
        "manoeuvre": {"kind": "weave", "amplitude_deg": 28.0, "frequency_hz": 0.25},
        "load": {"kind": "dry_park"},
    },
}
LAG_S = 0.005
"""Of the references. Without a pressure loop nothing else rounds the step from torque to force, and
the steering loop, torque to pressure to torque, would oscillate."""

PRESSURES = np.array([2, 3, 5, 8, 12, 20, 35, 60, 100, 150]) * 1e5
FLOWS = np.linspace(-4.5, 4.5, 37) / 6e4
"""Grid of the valve's static map: chamber pressure [Pa] and flow out of the valve [m3/s]."""

VALVES: dict[str, dict[str, dict[str, float]]] = {
    "as designed": {},
    "off": {"solenoid_hysteresis": {"width": 0.5}, "orifice_flow_coefficient": {"factor": 0.95}},
}
"""Effects by which the plant's valve differs from the one that the controllers know."""


class OpenLoop:
    """Solenoid forces from the valve's static balance alone: reference pressure and load flow.

    The controllers still compute the references; their forces, which need the chamber pressures,
    are replaced. The load flow is the wheel's speed through gear ratio and piston area, as in the
    controllers' own feed-forward (docs/valve_controller.md).
    """

    def __init__(self, parameters: ParameterSet) -> None:
        self.parameters = parameters
        self.area = parameters["mechanics.piston_area"]
        self.ratio = parameters["mechanics.gear_ratio"]
        self.preload = parameters["pressure_control_valve.spring_preload"]
        self.valve_area = (
            0.25 * np.pi * parameters["pressure_control_valve.pressure_area_diameter"] ** 2
        )
        self.demand = RegularGridInterpolator(
            (PRESSURES, FLOWS),
            np.array([[self._demand(p, q) for q in FLOWS] for p in PRESSURES]),
            bounds_error=False,
            fill_value=None,
        )
        self.flow = 0.0
        self.references: tuple[float, float] | None = None

    def _demand(self, pressure: float, flow: float) -> float:
        return holding_demand(self.parameters, linearise(self.parameters, pressure, flow=flow))

    def sensed(self, tick: int, values: list[float]) -> list[float]:
        """Read the wheel's speed on its way to the controllers."""
        self.flow = self.area * values[1] / self.ratio
        return values

    def after(self, tick: int, left: float, right: float) -> None:
        """Follow what the controllers ask for [Pa], slowly enough for the steering loop."""
        if self.references is None:
            self.references = (left, right)
        share = 1e-3 / (LAG_S + 1e-3)
        old_left, old_right = self.references
        self.references = (
            old_left + share * (left - old_left),
            old_right + share * (right - old_right),
        )

    def acted(self, tick: int, left: float, right: float) -> tuple[float, float]:
        """Return the forces [N] that hold the references at the load flow, by the valve's map."""
        assert self.references is not None
        points = [(self.references[0], -self.flow), (self.references[1], self.flow)]
        wanted = self.valve_area * self.demand(points) + self.preload
        return tuple(np.maximum(wanted, 0.0).tolist())


def without_sensors(document: dict[str, Any], parameters: dict[str, float]) -> Record:
    """Run a scenario whose valves are driven without any pressure sensor."""
    blind = OpenLoop(load_parameters().with_values(parameters))
    return closed_loop(
        document, parameters, sensed=blind.sensed, after=blind.after, acted=blind.acted
    )


def answer(parameters: dict[str, float]) -> Answer:
    """Compare with and without sensors, on the nominal valve and on one off by its tolerances.

    The plant is off; the controllers keep the nominal valve's parameters.
    """
    rows, numbers, curves = [], {}, {}
    for name, document in CYCLES.items():
        for valve, effects in VALVES.items():
            whole = {**document, "effects": effects}
            for sensors, run in (("with", closed_loop), ("without", without_sensors)):
                made = run(whole, parameters)
                asked = made.references[:, 1] - made.references[:, 0]
                error = made.load_pressure - asked
                largest = float(np.max(np.abs(error)))
                rms = float(np.sqrt(np.mean(error**2)))
                key = f"{name}, {valve}, {sensors} sensors"
                numbers[key] = {"largest_error_Pa": largest, "rms_error_Pa": rms}
                rows.append((name, valve, sensors, f"{largest * 1e-5:.2f}", f"{rms * 1e-5:.2f}"))
                if name == "parking":
                    curves[f"{valve}, {sensors} sensors"] = (made.time, error * 1e-5)
    near = numbers["parking, as designed, without sensors"]["rms_error_Pa"]
    far = numbers["parking, off, without sensors"]["rms_error_Pa"]
    sensed = numbers["parking, off, with sensors"]["rms_error_Pa"]
    return Answer(
        f"Without pressure sensors the load pressure is off by {near * 1e-5:.1f} bar (rms, "
        f"parking) where the valve is as designed and by {far * 1e-5:.1f} bar with 0.5 N of "
        f"hysteresis and 5 % less flow; with sensors by {sensed * 1e-5:.1f} bar.",
        numbers,
        [over_time("Error of the load pressure, parking", {"error [bar]": curves}, 340)],
        [
            Table(
                ("Cycle", "Valve", "Sensors", "Largest error [bar]", "Rms error [bar]"),
                rows,
            )
        ],
        (
            (
                "A valve that is off has 0.5 N of hysteresis and passes 5 % less flow than the "
                "controllers know. Errors are to the reference of the load pressure."
            ),
        ),
    )


STUDY = Study("sensorless", "How exact is the valve without pressure sensors?", answer)
