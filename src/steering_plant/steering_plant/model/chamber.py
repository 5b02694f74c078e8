"""Continuity of a cylinder chamber, down to absolute zero pressure."""

from __future__ import annotations

from steering_core.compiled import kernel

from . import slots
from .states import POSITION


@kernel
def stiffness(p, pressure, y, e):
    """Return the effective bulk modulus [Pa] at a gauge pressure [Pa].

    Below atmospheric pressure the oil parts: a trace of free gas, atmospheric_pressure/bulk_modulus
    of the volume (1e-4), expands at constant temperature and takes up the missing volume, so the
    modulus falls with the square of the absolute pressure, which never reaches zero and comes back
    along the same path.
    """
    value = p.bulk_modulus
    if pressure < 0.0:
        ratio = (pressure + p.atmospheric_pressure) / p.atmospheric_pressure
        value *= ratio * ratio
    return slots.bulk_modulus(value, pressure, y, e)


@kernel
def left_volume(p, y, e):
    """Return the left chamber's volume [m3]: positive rack displacement makes it smaller."""
    return slots.left_volume(p.chamber_volume - p.piston_area * y[POSITION], y, e)


@kernel
def right_volume(p, y, e):
    """Return the right chamber's volume [m3]: positive rack displacement makes it larger."""
    return slots.right_volume(p.chamber_volume + p.piston_area * y[POSITION], y, e)
