"""Measured channels by name, from a bag or from a direct run: what every study works on."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from steering_bringup.bags import Trace
from steering_bringup.direct.runner import DirectTrace
from steering_bringup.errors import BenchError
from steering_core.naming import unknown
from steering_lockstep.signals import PLACES

Channels = Mapping[str, np.ndarray]
"""Name to (n,) float64 at 1 kHz, SI, signs of docs/signs_and_units."""

DIRECT: dict[str, tuple[str, int]] = {
    "steering_wheel_angle": ("torque", 0),
    "steering_wheel_speed": ("torque", 1),
    "torsion_bar_torque": ("torque", 2),
    "left_pressure": ("pressure", 0),
    "right_pressure": ("pressure", 1),
    "supply_pressure": ("pressure", 2),
    "rack_position": ("rack", 0),
    "rack_speed": ("rack", 1),
    "rack_force": ("rack", 2),
    "driver_torque": ("driver", 0),
    "reference_angle": ("driver", 1),
}
"""Channel to its array of a direct run and column."""


def from_bag(trace: Trace) -> dict[str, np.ndarray]:
    """Return the channels that a bag holds, (n,) each; shorter ones decide n."""
    found = {
        name: np.asarray(trace.column(*PLACES[name]), np.float64)
        for name in DIRECT
        if PLACES[name][0] in trace
    }
    if not found:
        raise BenchError(f"'{trace.name}' holds no channel of the bench")
    length = min(len(values) for values in found.values())
    return {name: values[:length] for name, values in found.items()}


def from_direct(trace: DirectTrace) -> dict[str, np.ndarray]:
    """Return the channels of a direct run, (n,) each."""
    return {name: getattr(trace, array)[:, at] for name, (array, at) in DIRECT.items()}


def require(channels: Channels, *names: str) -> tuple[np.ndarray, ...]:
    """Return the named channels; BenchError names one that is missing."""
    for name in names:
        if name not in channels:
            raise BenchError(
                f"the record lacks what is needed: {unknown('channel', name, channels)}"
            )
    return tuple(channels[name] for name in names)
