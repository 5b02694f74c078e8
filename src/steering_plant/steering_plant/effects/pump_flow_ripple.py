"""The pump's flow pulsates with its vanes."""

from __future__ import annotations

import math

from steering_core.compiled import kernel
from steering_plant.effects.base import Effect, Parameter


@kernel
def pump_flow(value, time, amplitude, frequency, phase):
    """Return the pump's flow [m3/s]."""
    if amplitude == 0.0:
        return value
    return value * (1.0 + amplitude * math.sin(2.0 * math.pi * frequency * time + phase))


EFFECT = Effect(
    name="pump_flow_ripple",
    summary="the pump's flow pulsates with its vanes",
    sees="a line of constant frequency in all pressures, strongest at the pump",
    equation="q_p = q_0 (1 + amplitude sin(2 pi frequency t + phase))",
    source="J. and M. Ivantysynova, Hydrostatic Pumps and Motors (2001): flow pulsation",
    balance="supply",
    excitation="none: it is there at rest; pressures sampled at twice its frequency",
    separating="record at rest at two speeds of the pump",
    valve_systems=("open_centre",),
    parameters={
        "amplitude": Parameter("over the mean flow", "1", 0, 0, 0.3, 0.05),
        "frequency": Parameter("vanes times revolutions", "Hz", 150, 10, 450, 150, shape=True),
        "phase": Parameter("at the start", "rad", 0, -3.15, 3.15, 0, shape=True),
    },
    slots={"pump_flow": pump_flow},
    adds_energy=True,
)
