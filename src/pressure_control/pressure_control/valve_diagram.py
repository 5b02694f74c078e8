"""The pressure control valve as the source's block diagrams (fig 5.2 and fig 5.3).

The general one has everything that ``linear_valve.state_space`` has, in the source's blocks. With
the restrictor of (5.28) the spool's own resonance goes over into that of the oil locked in the
control chamber (5.29), both of them fast; what remains is the simplified one (5.30 to 5.34).
Responses are complex, shape of s, in SI units.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pressure_control.linear_valve import LinearValve


@dataclass(frozen=True)
class Corners:
    """Corner frequencies of the blocks [rad/s] and their dampings.

    w_c: control chamber against the restrictor. w_m, d_m: spool on spring and flow force. w_h,
    d_h: spool on the oil of the control chamber (5.29), met only where (5.28) holds.
    """

    w_c: float
    w_m: float
    d_m: float
    w_h: float
    d_h: float


def corners(valve: LinearValve) -> Corners:
    """Return the blocks' corners."""
    w_c = valve.beta * valve.K_1 / valve.V_c
    w_m = math.sqrt(valve.K_e / valve.mass)
    d_m = 0.5 * valve.damping / math.sqrt(valve.K_e * valve.mass)
    w_h = math.sqrt(valve.A_c**2 * valve.beta / valve.V_c / valve.mass)
    return Corners(w_c, w_m, d_m, w_h, 0.5 * w_c / w_h)


def spool_block(valve: LinearValve, s: np.ndarray) -> np.ndarray:
    """Return X_v over the pressure on the spool [m/Pa] (5.27), control chamber included."""
    k = corners(valve)
    mechanical = (s / k.w_m) ** 2 + 2.0 * k.d_m * s / k.w_m + 1.0
    lag = 1.0 + s / k.w_c
    return valve.A_c / valve.K_e * lag / (lag * mechanical + s / valve.w_v)


def chamber_block(valve: LinearValve, s: np.ndarray) -> np.ndarray:
    """Return the chamber's pressure over the net flow [Pa s/m3], restrictor included."""
    k = corners(valve)
    through = valve.K_1 * (s / k.w_c) / (1.0 + s / k.w_c)
    return 1.0 / (valve.K_c * (1.0 + s / valve.w_s) + through)


def flow_block(valve: LinearValve, s: np.ndarray) -> np.ndarray:
    """Return the flow into the chamber over X_v [m2/s]: through the edges and pushed out by A_c."""
    return valve.K_q + valve.A_c * s / (1.0 + s / corners(valve).w_c)


def feedback_block(valve: LinearValve, s: np.ndarray) -> np.ndarray:
    """Return the share of the chamber's pressure that closes the valve."""
    return 1.0 / (1.0 + s / corners(valve).w_c) - valve.K_p / valve.A_c


def general_loop_gain(valve: LinearValve, s: np.ndarray) -> np.ndarray:
    """Return the loop gain of fig 5.2."""
    return (
        spool_block(valve, s)
        * flow_block(valve, s)
        * chamber_block(valve, s)
        * feedback_block(valve, s)
    )


def simplified_loop_gain(valve: LinearValve, s: np.ndarray) -> np.ndarray:
    """Return K_v/((1 + s/w_v)(1 + s/w_s)) (5.30)."""
    return valve.loop_gain / ((1.0 + s / valve.w_v) * (1.0 + s / valve.w_s))


def general_response(valve: LinearValve, s: np.ndarray) -> np.ndarray:
    """Return chamber pressure over reference pressure of fig 5.2."""
    forward = spool_block(valve, s) * flow_block(valve, s) * chamber_block(valve, s)
    return forward / (1.0 + forward * feedback_block(valve, s))
