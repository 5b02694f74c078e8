"""Leakage past the piston seal, from one chamber into the other."""

from __future__ import annotations

from steering_core.compiled import kernel
from steering_plant.effects.base import Effect, Parameter


@kernel
def left_flow(value, left, right, leakage):
    """Return the flow into the left chamber [m3/s]."""
    return value + leakage * (right - left)


@kernel
def right_flow(value, left, right, leakage):
    """Return the flow into the right chamber [m3/s]."""
    return value - leakage * (right - left)


EFFECT = Effect(
    name="cross_piston_leakage",
    summary="oil leaks past the piston seal from chamber to chamber",
    sees="held load pressure costs supply flow; the rack creeps; pressure peaks are lower",
    equation="q = c (p_right - p_left), laminar, out of one chamber and into the other",
    source="H. E. Merritt, Hydraulic Control Systems (1967), chapter 6: power elements",
    balance="left chamber continuity",
    also=("right chamber continuity",),
    excitation="load pressure above 20 bar, or a held load",
    separating="hold the rack under load to the left, then to the right, 20 to 80 bar",
    parameters={"leakage": Parameter("laminar conductance", "m3/(s Pa)", 0, 0, 1e-11, 1e-12)},
    slots={"left_flow": left_flow, "right_flow": right_flow},
)
