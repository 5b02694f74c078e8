"""The plant's right-hand side along measured signals, with only hidden states integrated."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from steering_core.parameters import ParameterSet
from steering_diagnosis.data.record import PERIOD_S, Record
from steering_diagnosis.engine.model import Effects
from steering_diagnosis.steering.drive import RUN_UP, Drive, Driven
from steering_diagnosis.steering.full_model import full_model
from steering_diagnosis.steering.outputs import Run, acting
from steering_diagnosis.steering.simulation import Simulation, Trace
from steering_plant.model import states
from steering_plant.plant import plant_record

ANGLE, POSITION, TORQUE = "steering_wheel_angle", "rack_position", "torsion_bar_torque"
CHAMBERS = ("left_pressure", "right_pressure")

MOTION = (states.ANGLE, states.SPEED, states.POSITION, states.VELOCITY)

TWIST = np.linspace(-0.3, 0.3, 2401)
"""Twists [rad] at which the torsion bar's law is turned round."""


@dataclass(frozen=True)
class Clamped:
    """The right-hand side along measured signals; ``torque``: measured, or the model's own."""

    run: Run
    simulation: Simulation
    driven: Driven
    torque: np.ndarray | None

    def measured(self, channel: str, order: int = 0) -> np.ndarray:
        """Return a measured channel or a derivative, without the run-up, (n,)."""
        return self.run.drive.felt(channel, self.run.parameters, order)[RUN_UP:]

    def with_free_pressures(self) -> Trace:
        """Return the model with wheel and rack moved as measured, and its hydraulics left free."""
        motion = np.isin(self.driven.at, MOTION)
        driven = replace(
            self.driven,
            at=self.driven.at[motion],
            given=np.ascontiguousarray(self.driven.given[:, motion]),
            slopes=np.ascontiguousarray(self.driven.slopes[:, motion]),
        )
        return self.simulation.driven_by(driven, self.run.parameters, self.acting)

    @property
    def acting(self) -> Effects:
        """Effects that act in the plant under a measured load."""
        return acting(self.run.drive, self.run.effects)


def clamp(
    record: Record, cutoff_hz: float, nuisances: Mapping[str, float], effects: Effects
) -> Clamped:
    """Return the model along a record whose channels are low-passed alike at ``cutoff_hz``."""
    model = full_model(record.valve_system)
    parameters = record.nominal.with_values(nuisances) if nuisances else record.nominal
    parameters = model.changed(parameters, effects)
    drive = Drive(record, cutoff_hz)
    simulation = Simulation(drive)
    driven, torque = _prescribed(drive, simulation, parameters, acting(drive, effects))
    trace = simulation.driven_by(driven, parameters, acting(drive, effects))
    return Clamped(Run(drive, parameters, effects, trace), simulation, driven, torque)


def _prescribed(
    drive: Drive, simulation: Simulation, parameters: ParameterSet, effects: Effects
) -> tuple[Driven, np.ndarray | None]:
    """Return what prescribes all measured states, and the measured torsion-bar torque.

    The rack stands where wheel and torque say, which is finer than its own sensor.
    """
    curves = drive.curves
    inputs = {ANGLE: states.ANGLE}
    inputs |= {
        c: s for c, s in zip(CHAMBERS, (states.LEFT, states.RIGHT), strict=True) if c in curves
    }
    if drive.record.valve_system == "open_centre" and "supply_pressure" in curves:
        inputs["supply_pressure"] = states.PUMP
    by_torque = TORQUE in curves
    if POSITION in curves:
        inputs[POSITION] = states.POSITION
    driven = drive.driven(parameters, inputs)
    if not (by_torque and POSITION in curves):
        return driven, None
    torque = drive.felt(TORQUE, parameters)
    law = torques(simulation, parameters, effects, TWIST, np.zeros(len(TWIST)))
    twist = np.interp(torque, law, TWIST)
    position = (driven.given[:, 0] - twist) / parameters["mechanics.gear_ratio"]
    first = list(driven.at).index(states.POSITION)
    speed = np.gradient(position, PERIOD_S)
    driven.given[:, first], driven.given[:, first + 1] = position, speed
    driven.slopes[:, first], driven.slopes[:, first + 1] = speed, np.gradient(speed, PERIOD_S)
    return driven, torque[RUN_UP:]


def torques(
    simulation: Simulation,
    parameters: ParameterSet,
    effects: Effects,
    angle: np.ndarray,
    position: np.ndarray,
) -> np.ndarray:
    """Return the torsion bar's torque [N m] at angles [rad] and rack positions [m], (n,)."""
    model = full_model(simulation.valve_system)
    par = plant_record(parameters, simulation.valve_system, simulation.table)
    torque = np.empty(len(angle))
    room = np.zeros(len(simulation.names) + len(model.rests))
    model.kernel.torques(par, model.values(effects), room, angle, position, torque)
    return torque
