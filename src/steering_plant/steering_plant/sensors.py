"""The plant's sensors: gain, offset, noise, resolution and delay of every measured channel.

Ideal by default. The noise is a fixed function of seed, channel and tick, so a run repeats to the
bit and does not depend on how many values were drawn before.
"""

from __future__ import annotations

import math

import numpy as np

from steering_core.compiled import kernel
from steering_core.parameters import ParameterError, ParameterSet

CHANNELS = (
    "steering_wheel_angle",
    "steering_wheel_speed",
    "torsion_bar_torque",
    "left_pressure",
    "right_pressure",
    "supply_pressure",
    "rack_position",
    "rack_speed",
    "rack_force",
)
SENSOR_OF_CHANNEL = (
    "angle_sensor",
    "angle_sensor",
    "torque_sensor",
    "left_pressure_sensor",
    "right_pressure_sensor",
    "supply_pressure_sensor",
    "rack_position_sensor",
    "rack_position_sensor",
    "rack_force_sensor",
)
SPEED_CHANNELS = (1, 7)
"""Rates of a sensor's signal: its gain and delay hold, its offset, noise and resolution do not."""

LONGEST_DELAY = 64
"""Ticks of history kept for delays."""

GAIN, OFFSET, NOISE, RESOLUTION, DELAY = range(5)


def sensor_table(parameters: ParameterSet) -> np.ndarray:
    """Return the sensors' table, shape (9, 5): gain, offset, noise, resolution, delay in ticks.

    Raises ParameterError for a delay that is no whole number of ticks or too long.
    """
    table = np.empty((len(CHANNELS), 5))
    for row, sensor in enumerate(SENSOR_OF_CHANNEL):
        group = parameters.group(sensor)
        ticks = _ticks(f"{sensor}.delay", group["delay"])
        table[row] = (group["gain"], group["offset"], group["noise"], group["resolution"], ticks)
        if row in SPEED_CHANNELS:
            table[row, [OFFSET, NOISE, RESOLUTION]] = 0.0
    return table


def _ticks(name: str, delay: float) -> int:
    ticks = round(delay * 1000.0)
    if abs(ticks - delay * 1000.0) > 1e-6 or ticks > LONGEST_DELAY - 1:
        raise ParameterError(
            f"{name} must be a whole number of milliseconds up to {LONGEST_DELAY - 1} ms, "
            f"got {delay * 1000.0:g} ms"
        )
    return ticks


@kernel
def mixed(value):
    """Return a 64-bit hash of a 64-bit number (the finaliser of SplitMix64)."""
    value = (value ^ (value >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    value = (value ^ (value >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return value ^ (value >> np.uint64(31))


@kernel
def normal(seed, channel, tick):
    """Return a standard normal number that is a function of its arguments (Box-Muller)."""
    start = mixed(np.uint64(seed) + np.uint64(0x9E3779B97F4A7C15))
    start = mixed(start + np.uint64(channel))
    first = mixed(start + np.uint64(2 * tick))
    second = mixed(start + np.uint64(2 * tick + 1))
    radius = (np.float64(first >> np.uint64(11)) + 1.0) * 2.0**-53
    turn = np.float64(second >> np.uint64(11)) * 2.0**-53
    return math.sqrt(-2.0 * math.log(radius)) * math.cos(2.0 * math.pi * turn)


@kernel
def measure(sensors, seed, history, tick, true, out):
    """Fill ``out`` with what the sensors report of the ``true`` values at ``tick``.

    sensors: table of shape (9, 5). history: shape (64, 9), ring of true values by tick; before
    the first tick the first values hold.
    """
    for i in range(out.shape[0]):
        history[tick % LONGEST_DELAY, i] = true[i]
        past = max(tick - int(sensors[i, DELAY]), 0)
        value = sensors[i, GAIN] * history[past % LONGEST_DELAY, i] + sensors[i, OFFSET]
        if sensors[i, NOISE] > 0.0:
            value += sensors[i, NOISE] * normal(seed, i, tick)
        if sensors[i, RESOLUTION] > 0.0:
            value = sensors[i, RESOLUTION] * math.floor(value / sensors[i, RESOLUTION] + 0.5)
        out[i] = value
