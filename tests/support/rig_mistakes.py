"""What rigs get wrong, done to a record: each kind returns the record with the mistake in it."""

# mypy: allow-untyped-defs

from dataclasses import replace

import numpy as np
from scipy import signal

PERIOD_S = 1e-3
POUND, GRAVITY = 4.4482216152605, 9.80665
PRESSURES = ("left_pressure", "right_pressure", "supply_pressure")


def changed(record, **channels):
    """Return the record with some channels replaced."""
    return replace(record, channels={**record.channels, **channels})


def scaled(factor, *channels):
    """Return the mistake that channels are too large by a factor."""
    return lambda r: changed(r, **{c: factor * r[c] for c in channels if c in r})


def magnitude(channel):
    """Return the mistake that a channel's sign is on another one."""
    return lambda r: changed(r, **{channel: np.abs(r[channel])})


def late(seconds, channel):
    """Return the mistake that a channel is late."""

    def mistake(r):
        ticks = round(seconds / PERIOD_S)
        return changed(r, **{channel: np.r_[np.full(ticks, r[channel][0]), r[channel][:-ticks]]})

    return mistake


def coupled(seconds, channel):
    """Return the mistake that a channel is AC-coupled with a time constant."""
    keep = seconds / (seconds + PERIOD_S)
    return lambda r: changed(
        r, **{channel: signal.lfilter([keep, -keep], [1.0, -keep], r[channel] - r[channel][0])}
    )


def copied(from_, to):
    """Return the mistake that a channel holds another one's signal."""
    return lambda r: changed(r, **{to: r[from_].copy()})


def exchanged(first, second):
    """Return the mistake that two channels are in each other's place."""
    return lambda r: changed(r, **{first: r[second], second: r[first]})


def wrapped(period, channel, start=0.0):
    """Return the mistake that a channel is told within one period."""
    return lambda r: changed(r, **{channel: (r[channel] - start) % period + start})


def quantised(step, channel):
    """Return the mistake that a channel is told in coarse steps."""
    return lambda r: changed(r, **{channel: np.round(r[channel] / step) * step})


def saturated(share, channel):
    """Return the mistake that a channel ends at a share of what it reaches."""
    return lambda r: changed(
        r, **{channel: np.clip(r[channel], *(share * np.quantile(r[channel], [0.0, 1.0])))}
    )


def held(start, stop, channel):
    """Return the mistake that a channel holds its value from one time to another [s]."""

    def mistake(r):
        values = r[channel].copy()
        values[round(start / PERIOD_S) : round(stop / PERIOD_S)] = values[round(start / PERIOD_S)]
        return changed(r, **{channel: values})

    return mistake


def shifted(offset, *channels):
    """Return the mistake that channels were never zeroed."""
    return lambda r: changed(r, **{c: r[c] + offset for c in channels})


RIG = (
    "steering_wheel_angle",
    "torsion_bar_torque",
    *PRESSURES,
    "rack_position",
    "rack_force",
)


def rig(record):
    """Return the record with a rig's seven channels alone."""
    return replace(record, channels={n: record[n] for n in RIG}, vehicle_load="")
