"""Least squares with intervals that hold where the errors of neighbouring samples are alike."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import butter, sosfiltfilt

from steering_bringup.errors import BenchError

RATE_HZ = 1000.0
COVERAGE = 1.96
"""Standard deviations of a 95 % interval."""

TORQUE_GAIN, FORCE_GAIN, PRESSURE_GAIN, POSITION_GAIN = 0.005, 0.005, 0.003, 0.002
"""Two standard deviations of a usual sensor's gain: what calibration leaves open."""


@dataclass(frozen=True)
class Estimate:
    """A parameter's value with its 95 % interval, SI. source: how it was found."""

    value: float
    low: float
    high: float
    unit: str
    source: str = ""

    @property
    def deviation(self) -> float:
        """Standard deviation."""
        return (self.high - self.low) / (2.0 * COVERAGE)


def smooth(values: np.ndarray, cut_off_hz: float) -> np.ndarray:
    """Return values (n,) at 1 kHz low-passed without phase (Butterworth, fourth order twice)."""
    return sosfiltfilt(butter(4, cut_off_hz, fs=RATE_HZ, output="sos"), values)


def rate(values: np.ndarray, cut_off_hz: float) -> np.ndarray:
    """Return the time derivative of smoothed values, (n,)."""
    return np.gradient(smooth(values, cut_off_hz), 1.0 / RATE_HZ)


def fit(
    residual: Callable[[np.ndarray], np.ndarray],
    start: Sequence[float],
    units: Sequence[str],
    *,
    lags: int,
    source: str,
    calibration: float = 0.0,
    least: float = 1e-9,
) -> list[Estimate]:
    """Return the parameters that make ``residual`` (n,) smallest, with 95 % intervals.

    The covariance is a sandwich with the residual's correlation over ``lags`` samples (Newey and
    West, Econometrica 55, 1987). calibration: two standard deviations, relative, by which the
    sensors' gains may be off; it is added. Every parameter is kept above ``least`` times its start.
    BenchError where the data do not fix them.
    """
    import statsmodels.api as sm

    scale = np.asarray(start, dtype=np.float64)
    found = least_squares(
        lambda p: residual(p * scale),
        np.ones(len(scale)),
        bounds=(least, np.inf),
        x_scale=1.0,
        method="trf",
    )
    if np.linalg.matrix_rank(found.jac) < len(scale):
        raise BenchError(f"{source}: the record does not fix the parameters; it moves too little")
    made = sm.OLS(found.fun, found.jac).fit(
        cov_type="HAC", cov_kwds={"maxlags": lags, "use_correction": True}
    )
    deviations = np.sqrt(np.diag(made.cov_params())) * scale
    deviations = np.hypot(deviations, 0.5 * calibration * found.x * scale)
    return [
        Estimate(float(v), float(v - COVERAGE * s), float(v + COVERAGE * s), unit, source)
        for v, s, unit in zip(found.x * scale, deviations, units, strict=True)
    ]
