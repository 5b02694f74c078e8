"""Leakage out of the right chamber to the tank."""

from __future__ import annotations

from steering_core.compiled import kernel
from steering_plant.effects.base import Effect, Parameter


@kernel
def right_flow(value, right, leakage):
    """Return the flow into the right chamber [m3/s]."""
    return value - leakage * right


EFFECT = Effect(
    name="external_leakage_right",
    summary="oil leaks out of the right chamber to the tank",
    sees="pushing left takes more flow or gives less pressure than pushing right",
    equation="q = c p_right, laminar, out of the right chamber",
    source="H. E. Merritt, Hydraulic Control Systems (1967), chapter 6: power elements",
    balance="right chamber continuity",
    excitation="pressure above 20 bar in the right chamber",
    separating="hold the rack under load to the left, then to the right, 20 to 80 bar",
    parameters={"leakage": Parameter("laminar conductance", "m3/(s Pa)", 0, 0, 1e-11, 1e-12)},
    slots={"right_flow": right_flow},
)
