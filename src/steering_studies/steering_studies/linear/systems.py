"""Runs of the whole closed loop for the studies: closed-centre against open-centre."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from driver_model.driver import Driver
from driver_model.manoeuvres import make_manoeuvre
from pressure_control.controller import ValveController
from steering_bringup.direct.runner import Cores, DirectTrace, run
from steering_core.parameters import ParameterSet
from steering_plant.plant import Plant, PlantError
from vehicle_model.loads import make_load
from vehicle_model.vehicle import Vehicle

TICKS = 10_000
"""Ticks of the sweep of +-30 degrees up to 2 Hz (section 6.3)."""

SIDES: tuple[Literal["left", "right"], ...] = ("left", "right")

COMMANDS = ("/valve/left/command->plant", "/valve/right/command->plant")
"""Connections that carry the valves' commands."""

CYCLE_RIPPLE = 3e3
"""Standard deviation of the pressures' second difference [Pa] beyond which a run counts as a limit
cycle. Quiet runs keep below 600 on-centre and 1500 parking."""


def drive(
    parameters: ParameterSet,
    valve_system: str,
    load: str = "bicycle",
    *,
    ticks: int = TICKS,
    delays: Mapping[str, int] | None = None,
    controllers: Sequence[ValveController] | None = None,
) -> DirectTrace:
    """Drive the source's on-centre sweep with a valve system and load; return the trace.

    controllers: left and right, fresh; by default those of the same parameters.
    """
    closed = valve_system == "closed_centre"
    if closed and controllers is None:
        controllers = [ValveController(parameters, side) for side in SIDES]
    left, right = controllers if closed and controllers else (None, None)
    cores = Cores(
        Plant(parameters, valve_system),
        Driver(parameters, make_manoeuvre("on_centre"), ticks),
        Vehicle(parameters, make_load(load), ticks),
        left,
        right,
    )
    return run(cores, ticks, delays, truth=True)


def late_commands(ticks: int) -> dict[str, int]:
    """Return the delays of both valves' commands for ``direct.run``."""
    return dict.fromkeys(COMMANDS, ticks) if ticks else {}


@dataclass(frozen=True)
class Comparison:
    """Both systems through the same manoeuvre; largest differences in N m and Pa (figs 8.2-8.6).

    ripple [Pa]: largest of both chambers' second differences, standard deviation.
    """

    opened: DirectTrace
    closed: DirectTrace
    driver_torque: float
    torsion_bar_torque: float
    load_pressure: float
    chamber_pressure: float
    largest_torque: float
    largest_load_pressure: float
    ripple: float

    @property
    def cycles(self) -> bool:
        """Whether the closed-centre system is in a limit cycle."""
        return self.ripple > CYCLE_RIPPLE

    def numbers(self) -> dict[str, float]:
        """Return the figures of merit in N m and bar."""
        return {
            "driver_torque_difference_Nm": self.driver_torque,
            "torsion_bar_torque_difference_Nm": self.torsion_bar_torque,
            "assistance_difference_bar": self.load_pressure / 1e5,
            "chamber_difference_bar": self.chamber_pressure / 1e5,
            "largest_driver_torque_Nm": self.largest_torque,
            "largest_assistance_bar": self.largest_load_pressure / 1e5,
            "ripple_Pa": self.ripple,
        }


def compare(
    parameters: ParameterSet, load: str = "bicycle", *, delay: int = 0, ticks: int = TICKS
) -> Comparison:
    """Drive both systems and compare them; delay: ticks on both valves' commands."""
    opened = drive(parameters, "open_centre", load, ticks=ticks)
    closed = drive(parameters, "closed_centre", load, ticks=ticks, delays=late_commands(delay))
    by_load = assistance_pressure(closed) - assistance_pressure(opened)
    return Comparison(
        opened,
        closed,
        float(np.max(np.abs(closed.driver[:, 0] - opened.driver[:, 0]))),
        float(np.max(np.abs(closed.torque[:, 2] - opened.torque[:, 2]))),
        float(np.max(np.abs(by_load))),
        float(np.max(np.abs(closed.pressure[:, :2] - opened.pressure[:, :2]))),
        float(np.max(np.abs(closed.driver[:, 0]))),
        float(np.max(np.abs(assistance_pressure(closed)))),
        ripple(closed),
    )


def assistance_pressure(trace: DirectTrace) -> np.ndarray:
    """Return the load pressure right less left [Pa], (n,)."""
    return trace.pressure[:, 1] - trace.pressure[:, 0]


def ripple(trace: DirectTrace) -> float:
    """Return the larger standard deviation of the chambers' second differences [Pa]."""
    return float(np.std(np.diff(trace.pressure[:, :2], 2, axis=0), axis=0).max())


def limit_cycle(parameters: ParameterSet, *, delay: int = 0, ticks: int = TICKS) -> bool:
    """Return whether the closed-centre system cycles, or breaks off, on-centre.

    The controllers are made with a stable resonance and set to the wanted one afterwards: their own
    check would refuse what is to be tried.
    """
    name = "resonance"
    stable = parameters.with_values({f"valve_controller.{name}": 50.0})
    sides = [ValveController(stable, side) for side in SIDES]
    for side in sides:
        side.par[name] = parameters[f"valve_controller.{name}"]
    late = late_commands(delay)
    try:
        trace = drive(parameters, "closed_centre", ticks=ticks, delays=late, controllers=sides)
    except PlantError:
        return True
    return ripple(trace) > CYCLE_RIPPLE
