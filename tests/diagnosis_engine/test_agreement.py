"""Two records of one specimen ask for the same parameters; of two specimens they do not."""

from __future__ import annotations

import numpy as np
import pytest
from sled import record

from steering_diagnosis.engine.agreement import BLUR, INFLATION, Estimate, disagreement
from steering_diagnosis.engine.diagnose import diagnose

PARAMETERS = 6


def _estimate(rng: np.random.Generator, specimen: np.ndarray) -> Estimate:
    """Return the best estimate from noise that is larger than its model by the inflation."""
    root = 3.0 * rng.standard_normal((PARAMETERS, 2 * PARAMETERS))
    information = root @ root.T
    noise = np.sqrt(INFLATION) * root @ rng.standard_normal(2 * PARAMETERS)
    # What the estimator knows is what disagreement() takes the noise for.
    known = information / INFLATION
    slope = (information @ specimen + noise) / INFLATION
    return Estimate(np.linalg.solve(known + np.eye(PARAMETERS), slope), information)


def test_the_same_specimen_scatters_as_expected() -> None:
    """Second route: many draws. Their mean is 1 but for the blur, which is expected as well."""
    rng = np.random.default_rng(5)
    found = []
    for _ in range(400):
        specimen = rng.standard_normal(PARAMETERS)
        found.append(disagreement(_estimate(rng, specimen), _estimate(rng, specimen))[0])
    assert 0.5 < np.mean(found) < 1.0 + BLUR


def test_opposite_estimates_are_no_specimen() -> None:
    sure = 1e4 * np.eye(PARAMETERS)
    z = np.zeros(PARAMETERS)
    z[2] = 2.0
    square, each = disagreement(Estimate(z, sure), Estimate(-z, sure))
    assert square > 10.0
    assert int(np.argmax(np.abs(each))) == 2


def test_what_a_record_does_not_tell_cannot_disagree() -> None:
    blind = Estimate(np.zeros(PARAMETERS), np.zeros((PARAMETERS, PARAMETERS)))
    sure = Estimate(np.full(PARAMETERS, 1.0), 1e4 * np.eye(PARAMETERS))
    assert disagreement(blind, sure)[0] < 2.0


@pytest.mark.parametrize(("spread", "verdict"), [(0.0, "clean"), (1.0, "unexplained")])
def test_records_of_two_specimens_are_not_clean_together(spread: float, verdict: str) -> None:
    """Each alone is within tolerance; without spread both are the nominal one."""
    found = diagnose(record(10, spread=spread), record(11, spread=spread))
    assert found.causes == ()
    assert found.verdict == verdict
    if verdict == "unexplained":
        assert "ask for different values" in found.unexplained[0].region
