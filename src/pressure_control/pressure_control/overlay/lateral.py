"""What an overlay does to the car: steady lateral acceleration per torque at a speed.

Hands off, the torsion bar is at rest in steady cornering, so the whole overlay torque T stands
against the tyres: with gear ratio R_T, rack displacement x and road wheel angle delta = x/arm

    T R_T = (k_tyre + k_0) x,   k_tyre = m b n S/(l arm^2),   a_y = S x/arm,
    S = v^2/(l + K_us v^2)      steady lateral acceleration per road wheel angle

for the linear bicycle (mass m, wheelbase l = a + b, trail n, understeer gradient K_us) and a
centring k_0 that does not grow with speed. Therefore a_y/T = g S/(S + S_0) with
g = R_T l arm/(m b n) and S_0 = k_0 l arm^2/(m b n). A hand on the wheel takes a part of the torque,
so this gain is the largest.
"""

from __future__ import annotations

import math
from typing import Any

from steering_core.compiled import kernel
from steering_core.parameters import ParameterSet

LARGEST_SPEED = 200.0
"""Largest speed [m/s] that is believed; one that is no number counts as this."""


@kernel
def lateral_gain(p: Any, speed: float) -> float:
    """Return the steady lateral acceleration per overlay torque [m/s2 per N m] at ``speed`` [m/s].

    ``p``: record of ``overlay_record``. The car may roll backwards.
    """
    v = min(abs(speed), LARGEST_SPEED) if math.isfinite(speed) else LARGEST_SPEED
    turning = p.wheelbase + p.understeer_gradient * v * v
    if p.stiffness_speed_gain == 0.0 or turning <= 0.0:
        return p.torque_gain  # the latter: beyond the critical speed of an oversteering car
    return p.torque_gain * v * v / (v * v + p.stiffness_speed_gain * turning)


def lateral_fields(parameters: ParameterSet) -> dict[str, float]:
    """Return the constants of ``lateral_gain`` from the data sheet's numbers of the vehicle.

    torque_gain g [m/s2 per N m], stiffness_speed_gain S_0 [m/s2 per rad], wheelbase [m],
    understeer_gradient [rad s2/m].
    """
    p = parameters.group("vehicle")
    front, rear = p["front_axle_distance"], p["rear_axle_distance"]
    wheelbase, arm = front + rear, p["steering_arm"]
    trail = p["pneumatic_trail"] + p["mechanical_trail"]
    moment = p["mass"] * rear * trail
    # without trail the tyres do not resist, and hardly any torque is safe
    per_force = wheelbase * arm / moment if moment > 0.0 else 1.0
    c_f, c_r = p["front_cornering_stiffness"], p["rear_cornering_stiffness"]
    understeer = p["mass"] * (rear * c_r - front * c_f) / (wheelbase * c_f * c_r)
    return {
        "torque_gain": parameters["mechanics.gear_ratio"] * per_force,
        "stiffness_speed_gain": parameters["overlay.centring_stiffness"] * per_force * arm,
        "wheelbase": wheelbase,
        "understeer_gradient": understeer,
    }
