"""The plant's sensors: gain, offset, noise, resolution, delay and lag of every measured channel.

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
"""Rates of a sensor's signal: gain, delay and lag hold, offset, noise and resolution do not."""

TICK = 1e-3
"""Time between two samples [s]."""

LONGEST_DELAY = 64
"""Ticks of history kept for delays."""

HISTORY_ROWS = LONGEST_DELAY + 1
"""Rows of the history: the ring, and the true values of the tick before."""

GAIN, OFFSET, NOISE, RESOLUTION, DELAY, DECAY, DIRECT = range(7)


def sensor_table(parameters: ParameterSet) -> np.ndarray:
    """Return the sensors' table, shape (9, 7).

    Columns: gain, offset, noise, resolution, delay in ticks, and of the first-order lag the decay
    over a tick and the weight of the present value. Raises ParameterError for a delay too long.
    """
    table = np.empty((len(CHANNELS), 7))
    for row, sensor in enumerate(SENSOR_OF_CHANNEL):
        group = parameters.group(sensor)
        ticks = _ticks(f"{sensor}.delay", group["delay"])
        table[row, :DECAY] = (*(group[n] for n in ("gain", "offset", "noise", "resolution")), ticks)
        table[row, DECAY:] = _lag(group["lag"])
        if row in SPEED_CHANNELS:
            table[row, [OFFSET, NOISE, RESOLUTION]] = 0.0
    return table


def _ticks(name: str, delay: float) -> float:
    """Return a delay in ticks; what is a whole number but for rounding is made one."""
    ticks, whole = delay * 1000.0, round(delay * 1000.0)
    ticks = whole if abs(ticks - whole) < 1e-6 else ticks
    if ticks > LONGEST_DELAY - 1:
        raise ParameterError(
            f"{name} must be at most {LONGEST_DELAY - 1} ms, got {delay * 1000.0:g} ms"
        )
    return ticks


def _lag(time_constant: float) -> tuple[float, float]:
    """Return decay and direct weight of tau y' = x - y for an x that is linear within a tick."""
    if time_constant <= 0.0:
        return 0.0, 1.0
    ratio = TICK / time_constant
    return math.exp(-ratio), 1.0 + math.expm1(-ratio) / ratio


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

    sensors: table of shape (9, 7). history: shape (65, 9), ring of what the sensing elements felt
    by tick, and the true values of the tick before; before the first tick the first values hold.
    Between two ticks a delayed value is interpolated.
    """
    for i in range(out.shape[0]):
        history[tick % LONGEST_DELAY, i] = felt(sensors[i], history, tick, i, true[i])
        history[LONGEST_DELAY, i] = true[i]
        value = sensors[i, GAIN] * delayed(sensors[i, DELAY], history, tick, i)
        value += sensors[i, OFFSET]
        if sensors[i, NOISE] > 0.0:
            value += sensors[i, NOISE] * normal(seed, i, tick)
        if sensors[i, RESOLUTION] > 0.0:
            value = sensors[i, RESOLUTION] * math.floor(value / sensors[i, RESOLUTION] + 0.5)
        out[i] = value


@kernel
def felt(sensor, history, tick, i, true):
    """Return what the sensing element of channel ``i`` feels of ``true``: a first-order lag."""
    if sensor[DECAY] <= 0.0 or tick <= 0:
        return true
    before, felt_before = history[LONGEST_DELAY, i], history[(tick - 1) % LONGEST_DELAY, i]
    return before + sensor[DECAY] * (felt_before - before) + sensor[DIRECT] * (true - before)


@kernel
def delayed(ticks, history, tick, i):
    """Return what channel ``i`` felt ``ticks`` ago, linear between ticks."""
    whole = int(ticks)
    value = history[max(tick - whole, 0) % LONGEST_DELAY, i]
    if ticks > whole:
        earlier = history[max(tick - whole - 1, 0) % LONGEST_DELAY, i]
        value += (ticks - whole) * (earlier - value)
    return value
