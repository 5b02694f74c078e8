"""The step of 2 N m on the torque signal, rack held, with both valve systems (fig 8.1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pressure_control.controller import ValveController
from steering_core.parameters import ParameterSet
from steering_plant.linear.open_centre import open_centre_point
from steering_plant.model import states
from steering_plant.model.integrator import OK, advance
from steering_plant.plant import Plant, PlantError, failure_text

TICK = 1e-3


@dataclass(frozen=True)
class TorqueStep:
    """Right chamber's pressure [Pa] of both systems at ``time`` [s] (n,), the step at 0."""

    time: np.ndarray
    opened: np.ndarray
    closed: np.ndarray

    def rise(self, pressure: np.ndarray) -> float:
        """Return the time [s] to 90 % of the rise."""
        share = (pressure - pressure[0]) / (pressure[-1] - pressure[0])
        return float(self.time[int(np.argmax(share >= 0.9))])


def torque_step(parameters: ParameterSet, torque: float = 2.0, ticks: int = 120) -> TorqueStep:
    """Step the torsion-bar torque [N m] from 0 with the rack held."""
    return TorqueStep(
        np.arange(ticks) * TICK,
        _open_centre(parameters, torque, ticks),
        _closed_centre(parameters, torque, ticks),
    )


def _closed_centre(parameters: ParameterSet, torque: float, ticks: int) -> np.ndarray:
    plant = Plant(parameters, "closed_centre")
    sides = [ValveController(parameters, "left"), ValveController(parameters, "right")]
    rows = np.empty(ticks)
    for tick in range(ticks):
        measured = plant.out.copy()
        measured[2] = torque
        rows[tick] = measured[4]
        left, right = (float(side.step(tick, *measured)[1]) for side in sides)
        plant.step(tick, 0.0, left, right, 0.0, 1e10, 0.0)
    return rows


def _open_centre(parameters: ParameterSet, torque: float, ticks: int) -> np.ndarray:
    """The wheel is held where its twist is the torque; rack and wheel are made immovable."""
    heavy = {"mechanics.rack_mass": 1e9, "mechanics.steering_wheel_inertia": 1e9}
    plant = Plant(parameters.with_values(heavy), "open_centre")
    y, u = plant.state, plant.inputs
    point = open_centre_point(parameters, 0.0)
    y[states.LEFT], y[states.RIGHT], y[states.PUMP] = point.left, point.right, point.pump
    y[states.ANGLE] = torque / parameters["mechanics.torsion_bar_stiffness"]
    rows = np.empty(ticks)
    for tick in range(ticks):
        rows[tick] = y[states.RIGHT]
        status = advance(
            plant.par[0],
            plant.table,
            plant.effects,
            plant.scale,
            tick * TICK,
            TICK,
            y,
            plant.inner_step,
            u,
            plant.work,
            plant.flows,
        )
        if status != OK:
            raise PlantError(failure_text(plant, tick, status))
    return rows
