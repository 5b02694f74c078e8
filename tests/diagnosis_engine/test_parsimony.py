"""A cause with two sizes keeps those that the record asks for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import pytest
from sled import HYPOTHESES, SledReplay, record

from steering_diagnosis.engine.diagnose import diagnose
from steering_diagnosis.engine.model import Hypothesis, HypothesisParameter

BOTH = Hypothesis(
    "asymmetry",
    "friction by direction",
    "sled",
    (
        HypothesisParameter("dry", "N", 0.0, -30.0, 30.0, 10.0),
        HypothesisParameter("viscous", "N s/m", 0.0, -100.0, 100.0, 40.0),
    ),
)
PARTS = {"dry": "friction_asymmetry", "viscous": "viscous_asymmetry"}


@dataclass(frozen=True)
class TwoSizes(SledReplay):
    """The sled whose friction's direction is one hypothesis with a dry and a viscous size."""

    hypotheses: Mapping[str, Hypothesis] = field(
        default_factory=lambda: {
            **{
                n: h
                for n, h in HYPOTHESES.items()
                if n not in PARTS.values() and n != "load_offset"
            },
            BOTH.name: BOTH,
        }
    )

    def residuals(
        self, nuisances: Mapping[str, float], effects: Mapping[str, Mapping[str, float]]
    ) -> np.ndarray:
        given = {n: v for n, v in effects.items() if n != BOTH.name}
        for size, value in effects.get(BOTH.name, {}).items():
            given[PARTS[size]] = {"size": value}
        return super().residuals(nuisances, given)


def test_a_size_that_adds_nothing_is_none() -> None:
    made = record(5, friction_asymmetry=8.0)
    (cause,) = diagnose(TwoSizes(made.drive, made.load, made.measured)).causes
    assert cause.hypothesis.name == BOTH.name
    assert cause.parameters["dry"].value == pytest.approx(8.0, rel=0.15)
    assert cause.parameters["viscous"].value == 0.0
    assert cause.parameters["viscous"].high - cause.parameters["viscous"].low < 1e-3
