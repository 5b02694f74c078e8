"""The plant as a node: the clock of the bench.

Parameters: any of the data sheet, ``valve_system`` (open_centre, closed_centre or servo_valve),
``has_load_cylinder`` (whether the rig's load cylinder stands in for the ideal rack force),
``boost_curve.COLUMN`` (points of a measured curve in place of the formula: the columns
``torsion_bar_torque_Nm`` and ``load_pressure_Pa``), ``effects.EFFECT.PARAMETER``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from rclpy.context import Context

from steering_lockstep.clock_node import ClockNode
from steering_lockstep.core_parameters import check_own, effects_of, parameter_set
from steering_lockstep.graph import NodeSpec
from steering_lockstep.ports import Ports, section
from steering_lockstep.settings import RunSettings
from steering_lockstep.topics import LOAD_COMMAND
from steering_plant.effects import EFFECTS
from steering_plant.effects.base import description as effect_description
from steering_plant.measured_boost_curve import boost_table
from steering_plant.plant import Plant

TRUTH = "/truth/plant"


class PlantNode(ClockNode):
    """Publishes what is measured at each tick and, where the node set asks, the true states."""

    ports = Ports(
        takes=(
            ("/driver/torque", "torque"),
            ("/valve/left/command", "solenoid_force"),
            ("/valve/right/command", "solenoid_force"),
            ("/vehicle/rack_force", "force"),
            ("/vehicle/rack_force", "stiffness"),
            ("/vehicle/rack_force", "position"),
            (LOAD_COMMAND, "valve_opening"),
        ),
        gives=("/steering/torque", "/steering/pressure", "/steering/rack", "/clock"),
        optional=frozenset(
            {"/valve/left/command", "/valve/right/command", "/vehicle/rack_force", LOAD_COMMAND}
        ),
    )

    def publish(self, tick: int, out: Sequence[float]) -> None:
        """Publish the measurements and the true states of ``tick``."""
        if TRUTH in self.emit:
            self.emit[TRUTH](tick, self.core.truth(tick).tolist())
        super().publish(tick, out)

    def description(self, name: str) -> str:
        """Return what the node's parameter ``name`` is, its unit at the end."""
        return super().description(name) or effect_description(name, EFFECTS)


def build_plant(values: Mapping[str, Any]) -> Plant:
    """Return the plant of a node's parameter values."""
    check_own(values, ("valve_system", "has_load_cylinder"), ("boost_curve", "effects"))
    table = boost_table(section(values, "boost_curve"))
    valve_system = values.get("valve_system", "closed_centre")
    effects, cylinder = effects_of(values), bool(values.get("has_load_cylinder", False))
    return Plant(parameter_set(values), valve_system, table, effects, cylinder)


def make(
    context: Context, spec: NodeSpec, run: RunSettings, parameters: Mapping[str, Any] | None
) -> PlantNode:
    """Return the plant's node for a run."""
    return PlantNode(context, spec, run, parameters, build_plant)
