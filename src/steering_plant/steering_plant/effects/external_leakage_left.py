"""Leakage out of the left chamber to the tank."""

from __future__ import annotations

from steering_core.compiled import kernel
from steering_plant.effects.base import Effect, Parameter


@kernel
def left_flow(value, left, leakage):
    """Return the flow into the left chamber [m3/s]."""
    return value - leakage * left


EFFECT = Effect(
    name="external_leakage_left",
    summary="oil leaks out of the left chamber to the tank",
    sees="pushing right takes more flow or gives less pressure than pushing left",
    equation="q = c p_left, laminar, out of the left chamber",
    source="H. E. Merritt, Hydraulic Control Systems (1967), chapter 6: power elements",
    balance="left chamber continuity",
    excitation="pressure above 20 bar in the left chamber",
    separating="hold the rack under load to the left, then to the right, 20 to 80 bar",
    parameters={"leakage": Parameter("laminar conductance", "m3/(s Pa)", 0, 0, 1e-11, 1e-12)},
    slots={"left_flow": left_flow},
)
