"""The effects that can be added to the model, by name. Register a new one here, and only here."""

from __future__ import annotations

from steering_plant.effects import (
    cross_piston_leakage,
    entrained_air,
    solenoid_lag,
    torque_sensor_gain,
    tyre_relaxation,
)
from steering_plant.effects.base import Effect

EFFECTS: dict[str, Effect] = {
    module.EFFECT.name: module.EFFECT
    for module in (
        cross_piston_leakage,
        entrained_air,
        solenoid_lag,
        torque_sensor_gain,
        tyre_relaxation,
    )
}
