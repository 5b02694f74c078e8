"""The spools of the pressure control valves stick."""

from __future__ import annotations

from steering_core.compiled import kernel
from steering_plant.effects.base import Effect, Parameter, State
from steering_plant.model.friction import friction_rate


@kernel
def left_spool_force(value, left_friction):
    """Return the resisting force on the left spool [N]."""
    return value + left_friction


@kernel
def right_spool_force(value, right_friction):
    """Return the resisting force on the right spool [N]."""
    return value + right_friction


@kernel
def left_rate(left_friction, level, left_spool_speed, displacement):
    """Return the rate of the left spool's friction [N/s]."""
    return friction_rate(left_friction, level, left_spool_speed, displacement)


@kernel
def right_rate(right_friction, level, right_spool_speed, displacement):
    """Return the rate of the right spool's friction [N/s]."""
    return friction_rate(right_friction, level, right_spool_speed, displacement)


EFFECT = Effect(
    name="valve_spool_stiction",
    summary="the spools of the pressure control valves stick",
    sees="pressure at the same command differs with the direction in which load flow changes",
    equation="F' = (level v - F |v|)/displacement, opposing the spool's motion",
    source="H. E. Merritt, Hydraulic Control Systems (1967), chapter 5: control valves",
    balance="valve spool",
    excitation="load flow that changes by more than 1 l/min, to and fro",
    separating="a held command while the rack is moved to and fro at 20 mm/s",
    valve_systems=("closed_centre",),
    parameters={
        "level": Parameter("sliding friction of each spool", "N", 0, 0, 10, 0.5),
        "displacement": Parameter("to 63 % of it", "m", 2e-6, 1e-6, 2e-5, 2e-6, shape=True),
    },
    slots={"left_spool_force": left_spool_force, "right_spool_force": right_spool_force},
    states={
        "left_friction": State(0.0, left_rate, tolerance=1e-3),
        "right_friction": State(0.0, right_rate, tolerance=1e-3),
    },
)
