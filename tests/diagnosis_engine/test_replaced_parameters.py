"""A cause that is a nominal parameter's own value is estimated against the nominal one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

from steering_diagnosis.engine.diagnose import begin, diagnose
from steering_diagnosis.engine.fit import refit
from steering_diagnosis.engine.model import Hypothesis, HypothesisParameter, Nuisance, Output

FACTOR = Hypothesis(
    "stiffer",
    "a stiffer spring",
    "spring",
    (HypothesisParameter("factor", "1", 1.0, 0.1, 20.0, 2.0),),
    competes=("stiffness",),
    replaces=("stiffness",),
)
RANDOM = np.random.default_rng(3)
LENGTH = RANDOM.standard_normal(4000)
NOISE = 1e-4 * RANDOM.standard_normal(4000)
TRUE = 7.0


@dataclass(frozen=True)
class Spring:
    """A spring measured so well that nominal stiffness times factor is known to a millionth."""

    true: float = TRUE
    outputs: ClassVar = (Output("force", "N", "spring"),)
    nuisances: ClassVar = (Nuisance("stiffness", "N/m", 10.0, 2.0), Nuisance("zero", "N", 0.0, 1.0))
    hypotheses: ClassVar = {"stiffer": FACTOR}
    period_s: float = 1e-3

    def residuals(self, nuisances, effects):
        factor = effects.get("stiffer", {}).get("factor", 1.0)
        force = nuisances.get("stiffness", 10.0) * factor * LENGTH + nuisances.get("zero", 0.0)
        return (10.0 * self.true * LENGTH + NOISE - force)[:, None]

    def shaken(self, nuisances, effects):
        return np.zeros((len(LENGTH), 1))

    def noise(self):
        return np.zeros(1)

    def states(self):
        return {"length": LENGTH}


@pytest.mark.parametrize("z", [-2.0, 0.0, 2.0])
def test_a_fit_does_not_share_a_value_between_the_cause_and_the_tolerance(z):
    search, _ = begin(Spring())
    start = {"stiffer": np.array([TRUE / (1.0 + 0.1 * z)])}
    found = refit(search.problem, np.array([z, 0.0]), start)
    assert found.z[0] == pytest.approx(0.0, abs=1e-6)
    assert found.values["stiffer"][0] == pytest.approx(TRUE, rel=1e-3)


def test_the_interval_is_that_of_the_law_and_not_of_the_tolerance():
    (cause,) = diagnose(Spring()).causes
    estimate = cause.parameters["factor"]
    assert estimate.value == pytest.approx(TRUE, rel=1e-3)
    assert 0.5 * (estimate.high - estimate.low) < 0.15 * (TRUE - 1.0)


@pytest.mark.parametrize("true", [0.82, 1.0, 1.18])
def test_within_tolerance_it_is_no_cause(true):
    assert not diagnose(Spring(true)).causes
