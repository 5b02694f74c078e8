"""The compensator G(s) of (6.6), sampled, and the resonance that it is to give the loop.

G(s) = w_k^2 (s^2/w_0^2 + 2 d_0 s/w_0 + 1)/(s (s + a)), a = k w_k^2 = 2 d_k w_k, in partial
fractions

    G = D + r_1/s + f a/(s + a),    D = (w_k/w_0)^2,  r_1 = w_k^2/a = w_k/(2 d_k),
    f = -(w_k/a)^2 (a^2/w_0^2 - 2 d_0 a/w_0 + 1),

all divided by the valve's static gain K_s, so that the loop is w_k^2/(s (s + a)) for any K_s.

The integrator adds up r_1 e, so all that depends on the schedule stands behind the low-pass or in
front of the integrator: a change of the schedule moves the output by as much as there is control
error, and not at all in the steady state.
"""

from __future__ import annotations

import math
from typing import Any

from steering_core.compiled import kernel
from steering_core.ticks import TICK_PERIOD


@kernel
def desired_resonance(p: Any, resonance: float, load_pressure: float) -> float:
    """Return w_k [rad/s] where the open-centre valve would hold ``load_pressure`` [Pa].

    resonance [rad/s]: w_k at zero load pressure. The boost curve grows steeper with pressure,
    and the steering loop's gain with it, while the open-centre valve grows slower. So w_k falls
    to one half at resonance_fall_pressure, but not below slowest_resonance, where its lag would
    cost more than its gain.
    """
    falling = resonance / (1.0 + p.resonance_fall_rate * abs(load_pressure))
    return max(falling, min(resonance, p.slowest_resonance))


@kernel
def compensator_gains(
    w_k: float, d_k: float, w_0: float, d_0: float, static_gain: float
) -> tuple[float, float, float, float]:
    """Return (D, f, integral weight r_1 T, error weight 1 - exp(-a T)) of one tick, G/K_s.

    w_k [rad/s], d_k: wanted of the loop. w_0 [rad/s], d_0, static_gain (K_s): of the valve. The
    states take in the present error before they are used: that is ahead of the trapezoidal rule
    by half a sample, as much as the held output lags behind.
    """
    corner = 2.0 * d_k * w_k
    ratio = corner / w_0
    direct = (w_k / w_0) ** 2 / static_gain
    filtered = -(ratio * ratio - 2.0 * d_0 * ratio + 1.0) / (4.0 * d_k * d_k * static_gain)
    integral_weight = 0.5 * w_k / (d_k * static_gain) * TICK_PERIOD
    return direct, filtered, integral_weight, -math.expm1(-corner * TICK_PERIOD)
