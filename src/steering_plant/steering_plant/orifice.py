"""Turbulent orifice flow in both directions, laminar near zero pressure drop."""

from __future__ import annotations

import math

from steering_core.compiled import kernel


@kernel
def orifice_flow(conductance, drop, transition):
    """Return the flow [m3/s] for a pressure drop [Pa] of either sign.

    conductance: C_q A sqrt(2/rho) [m3/(s sqrt(Pa))]. transition: pressure drop [Pa] below which
    the square-root law goes over to a linear one. The form is smooth everywhere and tends to
    conductance sqrt(drop) (eq. 5.2, 5.3).
    """
    return conductance * drop / math.sqrt(math.sqrt(drop * drop + transition * transition))


@kernel
def orifice_flow_gain(conductance, drop, transition):
    """Return the derivative of ``orifice_flow`` with respect to the drop [m3/(s Pa)]."""
    square = drop * drop + transition * transition
    return (
        conductance
        * (0.5 * drop * drop + transition * transition)
        / (square * math.sqrt(math.sqrt(square)))
    )
