"""Smooth building blocks of the manoeuvres. All work element by element on arrays of times [s]."""

from __future__ import annotations

import numpy as np


def smooth_step(t: np.ndarray, start: float, rise: float) -> np.ndarray:
    """Return 0 before ``start``, 1 from ``start + rise`` on, and a quintic between them.

    Speed and acceleration are zero at both ends, so that neither the driver's lead nor the
    torsion bar is excited by a corner. The largest speed is 1.875 / rise.
    """
    u = np.clip((t - start) / rise, 0.0, 1.0)
    return u**3 * (10.0 - 15.0 * u + 6.0 * u**2)


def smooth_ramp(t: np.ndarray, start: float, blend: float) -> np.ndarray:
    """Return the time integral [s] of ``smooth_step``: a ramp of slope 1 with a rounded foot."""
    u = np.clip((t - start) / blend, 0.0, 1.0)
    return blend * u**4 * (2.5 - 3.0 * u + u**2) + np.maximum(t - start - blend, 0.0)


def linear_sweep(t: np.ndarray, initial: float, final: float, duration: float) -> np.ndarray:
    """Return the cycles done at ``t`` while the frequency [Hz] rises linearly over ``duration``.

    Afterwards the final frequency goes on.
    """
    inside = np.minimum(t, duration)
    rise = (final - initial) / (2.0 * duration)
    return (initial + rise * inside) * inside + final * np.maximum(t - duration, 0.0)


def logarithmic_sweep(t: np.ndarray, initial: float, final: float, duration: float) -> np.ndarray:
    """Return the cycles done at ``t`` while the frequency [Hz] grows exponentially.

    After ``duration`` the final frequency goes on. ``initial`` must be greater than zero.
    """
    if final == initial:
        return initial * t
    rate = np.log(final / initial) / duration
    inside = np.minimum(t, duration)
    return initial / rate * np.expm1(rate * inside) + final * np.maximum(t - duration, 0.0)
