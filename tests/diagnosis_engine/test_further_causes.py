"""A further cause shows more than a leftover of the first one, and in several moments."""

import numpy as np
import pytest

from steering_diagnosis.engine.evidence import Evidence, certainty
from steering_diagnosis.engine.sampling import moments
from steering_diagnosis.engine.search import leftover
from steering_diagnosis.engine.settings import Settings

FIRST = np.array([2e6, 1e4, 0.0])
"""Gain of a large cause in three outputs."""


def gaining(*gains):
    return Evidence(sum(gains), np.array(gains), 0.0, -100.0, 5.0, 1.0, 1.0, "")


@pytest.mark.parametrize(
    ("gains", "expected"),
    [
        ((1.2e4, 0.0, 0.0), True),
        ((3e4, 0.0, 0.0), False),
        ((0.0, 0.0, 1.2e4), False),
        ((5e3, 1e4, -30.0), False),
        ((1.2e4, 500.0, 0.0), True),
    ],
    ids=["a leftover", "more than that", "in an output of its own", "mostly elsewhere", "hardly"],
)
def test_a_leftover_gains_where_another_cause_gains_far_more(gains, expected):
    assert leftover(gaining(*gains), Settings().least_next * FIRST) is expected


def test_a_gain_in_a_few_moments_is_certain_and_one_spike_is_not():
    settings = Settings()
    moment = moments(3000, 5e-3, settings)
    assert np.bincount(moment).max() * 5e-3 == pytest.approx(settings.moment_s, abs=5.1e-3)
    gain = np.zeros(moment[-1] + 1)
    gain[40] = 4000.0
    assert certainty(gain) < settings.held_out_sigmas
    gain[40:44] = 1000.0
    assert certainty(gain) > settings.held_out_sigmas
