"""The open-centre valve's middle is not at zero torque.

The boost curve of the closed-centre system lies in its controllers, outside of the plant: there
the same fault is the torque sensor's (torque_sensor_offset).
"""

from __future__ import annotations

from steering_core.compiled import kernel
from steering_plant.effects.base import Effect, Parameter


@kernel
def valve_torque(value, offset):
    """Return the torque at which the valve stands [N m]."""
    return value + offset


EFFECT = Effect(
    name="boost_curve_offset",
    summary="the open-centre valve's middle is not at zero torque",
    sees="assistance to one side without torque; the boost curve is shifted sideways",
    equation="A_1, A_2 = areas(T + offset)",
    source="section 4.2 of the source: the bridge's areas by the torsion bar's torque",
    balance="valve flow",
    excitation="torsion-bar torque through zero to above 2 N m in both directions",
    separating="slow triangles of torque against a blocked rack, both directions",
    valve_systems=("open_centre",),
    parameters={"offset": Parameter("torque that the valve adds", "N m", 0, -2, 2, 0.15)},
    slots={"valve_torque": valve_torque},
)
