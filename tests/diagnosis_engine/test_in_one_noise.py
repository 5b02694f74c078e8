"""A slow error that passes for coloured noise: what its cause gains in the noise it leaves."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy import signal

from steering_diagnosis.engine.ambiguity import ahead
from steering_diagnosis.engine.evidence import gain_in_its_noise
from steering_diagnosis.engine.fit import Fit
from steering_diagnosis.engine.noise import fit_noise, usable

SAMPLES, ORDER, FLOOR = 6000, 8, np.array([1e-3])
VALID = np.ones((SAMPLES, 1), bool)
PROBLEM: Any = SimpleNamespace(
    valid=VALID,
    runs=SimpleNamespace(grid=SimpleNamespace(density=1.0)),
    weights=lambda: usable(VALID, ORDER).astype(float),
)


def _fit(residual: np.ndarray) -> Fit:
    noise = fit_noise(residual[:, None], usable(VALID, ORDER), FLOOR, ORDER, 1.0)
    white = noise.whiten(residual[:, None]) * PROBLEM.weights()
    misfit = float(np.sum(white**2) + SAMPLES * np.log(noise.sd[0] ** 2))
    return Fit(np.zeros(0), {}, residual[:, None], noise, misfit)


@pytest.fixture(scope="module")
def fits() -> tuple[Fit, Fit]:
    """Return the model with the cause, which leaves white noise, and the one without."""
    rng = np.random.default_rng(2)
    white = rng.standard_normal(SAMPLES)
    slow = signal.lfilter(*signal.butter(2, 0.02), rng.standard_normal(SAMPLES))
    return _fit(white), _fit(white + 1.2 * slow / slow.std())


def test_coloured_noise_swallows_most_of_a_slow_error(fits: tuple[Fit, Fit]) -> None:
    full, without = fits
    whole = 1.44 * SAMPLES
    assert without.misfit - full.misfit < 0.5 * whole
    assert gain_in_its_noise(PROBLEM, without, full) == pytest.approx(whole, rel=0.1)


def test_the_model_with_the_cause_is_ahead_in_either_noise(fits: tuple[Fit, Fit]) -> None:
    full, without = fits
    assert 0.0 < ahead(PROBLEM, full, without) < gain_in_its_noise(PROBLEM, without, full)
    assert ahead(PROBLEM, without, full) < 0.0
    assert ahead(PROBLEM, full, full) == 0.0
