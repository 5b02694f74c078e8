"""Rack friction from slow loops at several pressures (source section 3.2, fig 3.6)."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from steering_bringup.errors import BenchError
from steering_core.parameters import ParameterSet
from steering_studies.channels import Channels, require
from steering_studies.identification.estimate import (
    FORCE_GAIN,
    PRESSURE_GAIN,
    Estimate,
    fit,
    rate,
    smooth,
)

CUT_OFF_HZ = 1.5
"""Noise of the position must not look like motion where the rack turns round."""
SETTLED_S = 3.0
EVERY = 10
MIDDLE = 0.5
SOURCE = "rack friction test"


def rack_friction(runs: Iterable[Channels], parameters: ParameterSet) -> dict[str, Estimate]:
    """Return level [N] and slope on the sum of the chamber pressures [N/Pa].

    With the column off: F_friction = p_L A_p - M x'' - b x' - F_rack, and half a loop's height is
    level + slope (p_left + p_right). Only the middle of each stroke counts, where the element
    slides: near the ends it is loosened by the pressures' own small vibration. Piston area, mass
    and damping are the given ones; at 2 mm/s they hardly matter. Raises BenchError.
    """
    loops = [_sliding(channels, parameters) for channels in runs]
    if len(loops) < 2:
        raise BenchError(f"{SOURCE}: loops at two pressures at least are needed, got {len(loops)}")
    force, direction, total = (np.concatenate(parts) for parts in zip(*loops, strict=True))
    loop = np.repeat(np.arange(len(loops)), [len(f) for f, _, _ in loops])
    if np.ptp([total.mean() for _, _, total in loops]) < 5e5:
        raise BenchError(f"{SOURCE}: all loops are at the same pressure; the slope is not fixed")
    offsets = np.array([0.5 * (f[d > 0].mean() + f[d < 0].mean()) for f, d, _ in loops])
    friction = (force - offsets[loop]) * direction

    def residual(values: np.ndarray) -> np.ndarray:
        return friction - values[0] - values[1] * total

    group = parameters.group("mechanics")
    start = (group["rack_friction"], group["rack_friction_pressure_slope"])
    gain = FORCE_GAIN + PRESSURE_GAIN
    level, slope = fit(residual, start, ("N", "N/Pa"), lags=200, source=SOURCE, calibration=gain)
    return {
        "mechanics.rack_friction": level,
        "mechanics.rack_friction_pressure_slope": slope,
    }


def _sliding(
    channels: Channels, parameters: ParameterSet
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return friction force, direction of motion and sum of pressures where the rack slides."""
    x, friction, total = _loop(channels, parameters)
    speed = np.gradient(x)
    reach = np.max(np.abs(x))
    middle = (np.abs(x) < MIDDLE * reach) & (np.abs(speed) > 0.3 * np.max(np.abs(speed)))
    part = np.flatnonzero(middle)[::EVERY]
    return friction[part], np.sign(speed[part]), total[part]


def _loop(
    channels: Channels, parameters: ParameterSet
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return position, friction force and sum of pressures, (n,), after the start."""
    x, force, left, right = require(
        channels, "rack_position", "rack_force", "left_pressure", "right_pressure"
    )
    p = parameters.group("mechanics")
    speed = rate(x, CUT_OFF_HZ)
    acceleration = np.gradient(speed, 1e-3)
    friction = (smooth(right, CUT_OFF_HZ) - smooth(left, CUT_OFF_HZ)) * p["piston_area"]
    friction -= p["rack_mass"] * acceleration + p["rack_damping"] * speed
    friction -= smooth(force, CUT_OFF_HZ)
    part = slice(round(SETTLED_S * 1e3), -500)
    total = smooth(left + right, CUT_OFF_HZ)
    return smooth(x, CUT_OFF_HZ)[part], friction[part], total[part]


def loop_friction(channels: Channels, parameters: ParameterSet) -> float:
    """Return the friction of one loop [N]: half the height in the middle of the stroke."""
    force, direction, _ = _sliding(channels, parameters)
    return float(0.5 * (force[direction > 0].mean() - force[direction < 0].mean()))
