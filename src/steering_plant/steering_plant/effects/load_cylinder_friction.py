"""Friction in the load cylinder, between the load's command and the rack, beyond what is modelled.

The load cell sits on the rack's side: it measures the force that really acts on the rack.
"""

from __future__ import annotations

from steering_core.compiled import kernel
from steering_plant.effects.base import Effect, Parameter, State
from steering_plant.model.friction import friction_rate


@kernel
def load_force(value, friction):
    """Return the force on the rack [N]."""
    return value + friction


@kernel
def piston_limit(value, level):
    """Return the limit of the friction on the piston of a modelled load cylinder [N]."""
    return value + level


@kernel
def rate(friction, level, rack_speed, displacement):
    """Return the rate of the load cylinder's friction [N/s]."""
    return friction_rate(friction, level, rack_speed, displacement)


EFFECT = Effect(
    name="load_cylinder_friction",
    summary="the load cylinder's friction adds to the load on the rack",
    sees="measured rack force against its command is a loop; jumps at the rack's reversals",
    equation="F = F_command + F_f, F_f' = (level v - F_f |v|)/displacement",
    source="M. Jelali and A. Kroll, Hydraulic Servo-systems (2003), chapter on friction",
    balance="load",
    excitation="reversals of the rack, and the commanded load recorded",
    separating="a constant commanded load while the rack moves slowly to and fro",
    parameters={
        "level": Parameter("sliding friction", "N", 0, 0, 2000, 100),
        "displacement": Parameter("to 63 % of it", "m", 1e-4, 1e-5, 1e-3, 1e-4, shape=True),
    },
    slots={"load_force": load_force, "load_cylinder_friction_limit": piston_limit},
    states={"friction": State(0.0, rate, tolerance=1e-2)},
)
