"""A further cause shows more than a leftover of the first one, and in several moments."""

from dataclasses import replace

import numpy as np
import pytest
from sled import record

from steering_diagnosis.engine.diagnose import begin
from steering_diagnosis.engine.evidence import Evidence, HeldOut, certainty
from steering_diagnosis.engine.noise import fit_noise
from steering_diagnosis.engine.sampling import moments
from steering_diagnosis.engine.search import leftover
from steering_diagnosis.engine.settings import Settings


def gaining(*gains):
    return Evidence(sum(gains), np.array(gains), 0.0, -100.0, 5.0, 1.0, 1.0, "")


FIRST = gaining(2e6, 1e4, 0.0)
"""A large cause, by its gain in three outputs."""


@pytest.mark.parametrize(
    ("gains", "expected"),
    [
        ((1.2e3, 0.0, 0.0), True),
        ((3e3, 0.0, 0.0), False),
        ((0.0, 0.0, 500.0), False),
        ((800.0, 0.0, 900.0), False),
        ((900.0, 8.0, 500.0), True),
    ],
    ids=["a leftover", "large enough", "in an output of its own", "mostly there", "elsewhere too"],
)
def test_a_leftover_gains_where_another_cause_gains_far_more(gains, expected):
    assert leftover(gaining(*gains), [Settings().leaves * FIRST.gains]) is expected
    assert not leftover(gaining(*gains), [])


def test_a_gain_in_a_few_moments_is_certain_and_one_spike_is_not():
    settings = Settings()
    moment = moments(3000, 5e-3, settings)
    assert np.bincount(moment).max() * 5e-3 == pytest.approx(settings.moment_s, abs=5.1e-3)
    gain = np.zeros(moment[-1] + 1)
    gain[40] = 4000.0
    assert certainty(gain) < settings.held_out_sigmas
    gain[40:44] = 1000.0
    assert certainty(gain) > settings.held_out_sigmas


@pytest.mark.parametrize("outputs", [1, 4])
def test_one_event_is_certain_where_several_outputs_feel_it(outputs):
    settings, shape = Settings(), (3000, 6)
    moment = moments(shape[0], 5e-3, settings)
    known = np.ones(shape, bool)
    known[:, 5] = False
    held = HeldOut(None, known, moment, known, moment)
    after = np.random.default_rng(1).standard_normal(shape) * known
    before = after.copy()
    before[np.flatnonzero(moment == 40)[3:15], :outputs] += 9.0
    noise = fit_noise(after, known, np.full(6, 1e-3), 1, 1.0)
    gain = held.scores(noise, before) - held.scores(noise, after)
    assert gain.shape == (5 * (moment[-1] + 1),)
    assert (certainty(gain) > settings.held_out_sigmas) == (outputs > 1)


@pytest.mark.parametrize(("place", "expected"), [("sled", True), ("spring", False)])
def test_the_formula_of_a_law_leaves_more_in_its_own_balance(place, expected):
    search, _ = begin(record(5))
    hypotheses = dict(search.problem.book.hypotheses)
    hypotheses["stribeck"] = replace(hypotheses["stribeck"], balance=place)
    book = replace(search.problem.book, hypotheses=hypotheses)
    search.problem = replace(search.problem, book=book)
    found = {"drag": FIRST, "stribeck": gaining(4e3, 0.0, 0.0)}
    assert leftover(found["stribeck"], search._leave(found, "stribeck")) is expected
