"""The valve's edges overlap more than the data sheet says.

Each edge opens later. A pressure control valve loses underlap, a
servo valve the opening at rest; of the open-centre valve's bridge,
each area is the one that belongs to a torque by which it is closed further.
"""

from __future__ import annotations

from steering_core.compiled import kernel
from steering_plant.effects.base import Effect, Parameter, taken_from


@kernel
def valve_overlap(value, torque):
    """Return the torque by which each edge of the bridge closes earlier [N m]."""
    return value + torque


EFFECT = Effect(
    name="valve_overlap",
    summary="the valve's edges overlap more",
    sees="closed centre: a dead zone about zero load flow; open centre: more pressure at rest",
    equation="underlap - overlap; A_1(T - torque), A_2(T + torque)",
    source="H. E. Merritt, Hydraulic Control Systems (1967), chapter 5: closed and open centre",
    balance="valve flow",
    excitation="load flow through zero: slow reversals of the rack",
    separating="slow triangles of angle without load",
    competes=("open_centre.centre_opening",),
    parameters={
        "overlap": Parameter(
            "of both edges of a spool", "m", 0, -1e-4, 2e-4, 2e-5, valve_systems=("closed_centre",)
        ),
        "torque": Parameter(
            "of the bridge's edges", "N m", 0, -0.5, 1.5, 0.4, valve_systems=("open_centre",)
        ),
        "bias": Parameter(
            "share of a servo valve's stroke",
            "1",
            0,
            -0.15,
            0.15,
            0.05,
            valve_systems=("servo_valve",),
        ),
    },
    slots={"valve_overlap": valve_overlap},
    sets={
        "overlap": taken_from("pressure_control_valve.underlap"),
        "bias": taken_from("servo_valve.bias_opening"),
    },
)
