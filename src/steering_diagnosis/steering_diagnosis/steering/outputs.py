"""The outputs of the replay: what is predicted of each channel, and the balance it tells of."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from steering_core.parameters import ParameterSet
from steering_diagnosis.data.channels import CHANNELS
from steering_diagnosis.engine.model import Effects, Output
from steering_diagnosis.steering.drive import RUN_UP, Drive
from steering_diagnosis.steering.kernels.load import friction_along
from steering_diagnosis.steering.simulation import Trace, as_measured
from steering_diagnosis.steering.smoothing import bridged
from steering_diagnosis.steering.tyres import tyre_force

LOAD_FRICTION, TYRES = "load_cylinder_friction", "tyre_relaxation"


@dataclass(frozen=True)
class Run:
    """One simulation with what it was made with."""

    drive: Drive
    parameters: ParameterSet
    effects: Effects
    trace: Trace


def acting(drive: Drive, effects: Effects) -> Effects:
    """Return the effects that act in the replay: not what is behind a load cell that drives it."""
    if drive.load != "cell":
        return effects
    return {name: values for name, values in effects.items() if name != LOAD_FRICTION}


@dataclass(frozen=True)
class Predicted:
    """An output, its residual (measured minus predicted, (n,)), and whether a record has it."""

    output: Output
    there: Callable[[Drive], bool]
    residual: Callable[[Run], np.ndarray]


def driver_torque_error(run: Run) -> np.ndarray:
    """Return the column's torque balance [N m]: the driver's torque less all that resists it.

    The torsion bar's torque is the measured one, where it is measured. Both sides are low-passed
    alike: the acceleration comes from the smooth wheel angle, so the rest is smoothed as well.
    """
    drive, trace = run.drive, run.trace
    given = bridged(drive.record["driver_torque"])
    given = 0.5 * (given + np.concatenate([given[:1], given[:-1]]))
    inertia = run.parameters["mechanics.steering_wheel_inertia"]
    resisting = -inertia * trace.rate("steering_wheel_speed")
    if "torsion_bar_torque" in drive.curves:
        resisting += drive.felt_raw("torsion_bar_torque", run.parameters) - trace.torque
    acceleration = drive.felt("steering_wheel_angle", run.parameters, 2)[RUN_UP:]
    if drive.curves["steering_wheel_angle"].low_passed:
        return (
            drive.as_smooth_as("steering_wheel_angle", given - resisting) - inertia * acceleration
        )
    return drive.as_smooth_as("steering_wheel_angle", given - resisting - inertia * acceleration)


def rack_force_error(run: Run) -> np.ndarray:
    """Return the load's balance [N]: the load cell less the command and the cylinder's friction."""
    drive = run.drive
    assert drive.command is not None
    position = drive.felt("rack_position", run.parameters)[RUN_UP:]
    force = drive.command.measured(position)
    friction = run.effects.get(LOAD_FRICTION)
    if friction is not None:
        added = np.empty(len(force))
        friction_along(position, friction["level"], friction["displacement"], added)
        force = force + added
    return drive.record["rack_force"] - as_measured(force, run.parameters, "rack_force")


def load_force_error(run: Run) -> np.ndarray:
    """Return the tyres' balance [N]: the load's command less the vehicle model's force."""
    drive = run.drive
    assert drive.command is not None
    position = drive.curves["rack_position"].values[RUN_UP:]
    return drive.command.force(0) - tyre_force(position, run.parameters, run.effects.get(TYRES))


def _channel(
    name: str,
    balance: str,
    take: Callable[[Trace], np.ndarray],
    known: Callable[[Drive], bool] = lambda drive: True,
) -> Predicted:
    """Return a measured channel as an output. known: whether all that it follows from is."""

    def residual(run: Run) -> np.ndarray:
        measured = run.drive.record[name]
        return measured - as_measured(take(run.trace), run.parameters, name)

    def there(drive: Drive) -> bool:
        return name in drive.record and name not in drive.inputs() and known(drive)

    return Predicted(Output(name, CHANNELS[name].unit, balance), there, residual)


def _made(
    name: str,
    balance: str,
    residual: Callable[[Run], np.ndarray],
    there: Callable[[Drive], bool],
) -> Predicted:
    return Predicted(Output(name, CHANNELS[name].unit, balance), there, residual)


def _has_load_balance(drive: Drive) -> bool:
    return drive.load == "cell" and drive.command is not None


def _has_tyres(drive: Drive) -> bool:
    return drive.command is not None and drive.record.vehicle_load == "bicycle"


OUTPUTS = (
    _channel("torsion_bar_torque", "torsion bar", lambda trace: trace.torque),
    _channel("rack_position", "rack force", lambda trace: trace["rack_position"]),
    _channel("rack_speed", "rack force", lambda trace: trace["rack_speed"]),
    _channel("left_pressure", "left chamber continuity", lambda trace: trace["left_pressure"]),
    _channel("right_pressure", "right chamber continuity", lambda trace: trace["right_pressure"]),
    _channel("supply_pressure", "supply", lambda trace: trace.supply, lambda drive: drive.valves),
    _made(
        "driver_torque",
        "column torque",
        driver_torque_error,
        lambda drive: "driver_torque" in drive.record,
    ),
    _made("rack_force", "load", rack_force_error, _has_load_balance),
    _made("load_force", "load", load_force_error, _has_tyres),
)
"""All outputs; a replay has those that its record allows."""


def outputs_of(drive: Drive) -> tuple[Predicted, ...]:
    """Return the outputs that a record allows."""
    return tuple(predicted for predicted in OUTPUTS if predicted.there(drive))
