"""A heavy vehicle: 150 bar at 10 N m (fig 2.3), a larger cylinder, a larger pump."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from steering_bringup.pages import Axes, Curve, Figure
from steering_core.parameters import ParameterSet, load_parameters
from steering_plant.boost_curve import FORMULA, static_pressures
from steering_plant.plant import plant_record
from steering_studies.beyond.study import Answer, Study, Table, simulate

SET = "heavy_vehicle"
DRIVING: dict[str, Any] = {
    "duration": 15.0,
    "parameter_set": SET,
    "manoeuvre": {
        "kind": "on_centre",
        "amplitude_deg": 40.0,
        "final_frequency_hz": 1.0,
        "duration_s": 15.0,
    },
}
PARKING: dict[str, Any] = {
    **DRIVING,
    "manoeuvre": {"kind": "weave", "amplitude_deg": 70.0, "frequency_hz": 0.2},
    "load": {"kind": "dry_park"},
}


def answer(parameters: dict[str, float]) -> Answer:
    """Compare both valve systems on the heavy vehicle's set."""
    sheet = load_parameters(SET).with_values(parameters)
    torque, boost = boost_curve(sheet)
    driving, parking = (_compared(document, parameters) for document in (DRIVING, PARKING))
    at_ten = float(abs(boost[-1]))
    return Answer(
        f"The boost curve reaches {at_ten * 1e-5:.0f} bar at 10 N m (fig 2.3: 150 bar). On centre "
        f"the closed system stays within {driving.pressure * 1e-5:.1f} bar and "
        f"{driving.torque:.2f} N m of the open one, parking at {parking.largest * 1e-5:.0f} bar "
        f"within {parking.pressure * 1e-5:.1f} bar and {parking.torque:.2f} N m.",
        {
            "boost_at_10_Nm_Pa": at_ten,
            **{
                f"{name}_{what}": value
                for name, made in (("driving", driving), ("parking", parking))
                for what, value in (
                    ("load_pressure_difference_Pa", made.pressure),
                    ("torque_difference_Nm", made.torque),
                    ("largest_load_pressure_Pa", made.largest),
                )
            },
        },
        [_boost_figure(torque, boost), driving.figure("On-centre"), parking.figure("Parking")],
        [
            Table(
                ("Parameter that differs", "Unit", "Heavy vehicle", "Passenger car"),
                [
                    (name, sheet.info(name).unit, f"{value:g}", f"{load_parameters()[name]:g}")
                    for name, value in load_parameters(SET).changed().items()
                ],
            )
        ],
    )


def boost_curve(parameters: ParameterSet) -> tuple[np.ndarray, np.ndarray]:
    """Return torque [N m] from -10 to 10 and static load pressure [Pa], (201,) each."""
    torque = np.linspace(-10.0, 10.0, 201)
    p = plant_record(parameters, "open_centre")[0]
    boost = np.array([np.subtract(*static_pressures(p, FORMULA, t, 0.0)) for t in torque])
    return torque, boost


@dataclass(frozen=True)
class Compared:
    """Both systems' load pressures [Pa] and the torque difference [N m], (n,); largest sizes."""

    loads: dict[str, np.ndarray]
    difference: np.ndarray

    @property
    def pressure(self) -> float:
        """Largest difference of load pressure [Pa]."""
        return float(np.max(np.abs(self.loads["closed_centre"] - self.loads["open_centre"])))

    @property
    def torque(self) -> float:
        """Largest difference of torsion-bar torque [N m]."""
        return float(np.max(np.abs(self.difference)))

    @property
    def largest(self) -> float:
        """Largest load pressure of the open centre [Pa]."""
        return float(np.max(np.abs(self.loads["open_centre"])))

    def figure(self, title: str) -> Figure:
        """Return load pressures above, torque difference below."""
        time = np.arange(len(self.difference)) * 1e-3
        curves = [
            Curve(time, self.loads[system] * 1e-5, system.replace("_", " "), colour)
            for system, colour in (("open_centre", "#b3261e"), ("closed_centre", "#1f5fa8"))
        ]
        return Figure(
            title,
            [
                [Axes("time [s]", "load pressure [bar]", curves, link="t")],
                [
                    Axes(
                        "time [s]",
                        "torque difference [N m]",
                        [Curve(time, self.difference)],
                        link="t",
                    )
                ],
            ],
            height=240,
        )


def _compared(document: dict[str, Any], parameters: dict[str, float]) -> Compared:
    traces = {
        system: simulate({**document, "node_set": system}, parameters)
        for system in ("open_centre", "closed_centre")
    }
    loads = {name: t.pressure[:, 1] - t.pressure[:, 0] for name, t in traces.items()}
    torque = traces["closed_centre"].torque[:, 2] - traces["open_centre"].torque[:, 2]
    return Compared(loads, torque)


def _boost_figure(torque: np.ndarray, boost: np.ndarray) -> Figure:
    curve = Curve(torque, np.abs(boost) * 1e-5, over_time=False)
    axes = Axes("torsion bar torque [N m]", "assistance pressure [bar]", [curve])
    return Figure("Boost curve (fig 2.3)", [[axes]])


STUDY = Study(
    SET,
    "Does the closed-centre system serve a heavy vehicle, with 150 bar at 10 N m?",
    answer,
)
