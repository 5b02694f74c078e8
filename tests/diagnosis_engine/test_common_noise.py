"""A slow error that passes for coloured noise: what its cause gains in one noise for all models."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy import signal

from steering_diagnosis.engine.fit import assess
from steering_diagnosis.engine.noise import Noise, fit_noise, usable

SAMPLES, ORDER, FLOOR = 6000, 8, np.array([1e-3])
ROWS = usable(np.ones((SAMPLES, 1), bool), ORDER)


def problem(common: Noise | None) -> Any:
    return SimpleNamespace(
        common=common,
        noise=lambda residual: fit_noise(residual, ROWS, FLOOR, ORDER, 1.0),
        weights=lambda: ROWS.astype(float),
    )


def misfit(residual: np.ndarray, common: Noise | None) -> float:
    return assess(problem(common), np.zeros(0), {}, residual).misfit


@pytest.fixture(scope="module")
def residuals() -> tuple[np.ndarray, np.ndarray]:
    """Return what the model with the cause leaves, white noise, and the one without."""
    rng = np.random.default_rng(2)
    white = rng.standard_normal((SAMPLES, 1))
    slow = signal.lfilter(*signal.butter(2, 0.02), rng.standard_normal(SAMPLES))[:, None]
    return white, white + 1.2 * slow / slow.std()


def test_in_its_own_noise_a_slow_error_costs_less_than_half(residuals):
    full, without = residuals
    assert misfit(without, None) - misfit(full, None) < 0.5 * 1.44 * SAMPLES


def test_in_the_noise_that_its_cause_leaves_it_costs_what_it_is(residuals):
    full, without = residuals
    common = problem(None).noise(full)
    gain = misfit(without, common) - misfit(full, common)
    assert gain == pytest.approx(1.44 * SAMPLES, rel=0.1)


def test_one_noise_orders_models_by_their_energy_in_it(residuals):
    full, without = residuals
    for residual in (full, without):
        common = problem(None).noise(residual)
        assert misfit(full, common) < misfit(0.5 * (full + without), common)
        assert misfit(0.5 * (full + without), common) < misfit(without, common)
