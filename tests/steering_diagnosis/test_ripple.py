"""The pump's ripple: found by its line, above the engine's band too."""

import numpy as np
import pytest
from bench_records import NOISE, bench_record

from steering_diagnosis.engine.catalogue import Catalogue
from steering_diagnosis.engine.model import Hypothesis, HypothesisParameter
from steering_diagnosis.steering.replay import SteeringReplay
from steering_diagnosis.steering.ripple import EFFECT, Line, at_line, find_line
from steering_plant.effects import EFFECTS


@pytest.mark.parametrize("hz", [45.0, 163.37])
def test_a_line_is_found_and_explained(hz):
    given = {"amplitude": 0.04, "frequency": hz, "phase": 1.1}
    record = bench_record("open_centre", duration=8.0, effects={EFFECT: given}, noise=NOISE)
    replay = SteeringReplay(record)
    found = {p.name: p for p in replay.hypotheses[EFFECT].parameters}
    assert found["frequency"].typical == pytest.approx(hz, abs=0.02)
    assert found["amplitude"].typical == pytest.approx(0.04, rel=0.1)
    assert found["phase"].typical == pytest.approx(1.1, abs=0.3)
    shifted = [o.name for o in replay.outputs if "_hz_" in o.name]
    assert len(shifted) == (2 if hz > 60.0 else 0)
    with_it = replay.residuals({}, {EFFECT: given})
    without = replay.residuals({}, {})
    for j in range(len(replay.outputs) - len(shifted), len(replay.outputs)):
        mean = abs(np.nanmean(without[:, j]))
        assert abs(np.nanmean(with_it[:, j])) < max(0.1 * mean, 300.0)


def test_a_clean_record_has_no_line():
    replay = SteeringReplay(bench_record("open_centre", duration=8.0, noise=NOISE))
    assert EFFECT not in replay.hypotheses
    assert EFFECT in {u.hypothesis for u in replay.undecidable}


def test_noise_has_no_line():
    noise = np.random.default_rng(5).standard_normal((20, 12_000))
    assert all(find_line(each) is None for each in noise)


def test_a_harmonic_that_stands_out_more_does_not_hide_its_line():
    random = np.random.default_rng(6)
    time = np.arange(12_000) * 1e-3
    falling = np.cumsum(random.standard_normal(len(time))) + 0.05 * random.standard_normal(
        len(time)
    )
    line = 2.0 * np.sin(2.0 * np.pi * 137.2 * time) + 1.6 * np.sin(2.0 * np.pi * 274.4 * time)
    found = find_line(falling + line)
    assert found is not None
    assert found.hz == pytest.approx(137.2, abs=0.05)


@pytest.mark.parametrize("hz", [25.2, 449.9])
@pytest.mark.parametrize("phase", [-3.1, 3.1])
def test_what_is_fitted_is_a_value_that_the_effect_takes(hz, phase):
    """A phase is fitted through a turn's end and told within one turn; a frequency has bounds."""
    effect = EFFECTS[EFFECT]
    parameters = tuple(
        HypothesisParameter(n, p.unit, p.neutral, p.low, p.high, p.typical, p.shape)
        for n, p in effect.parameters.items()
    )
    plain = Hypothesis(EFFECT, "", "supply", parameters)
    made = at_line(plain, Line(hz, 0.2), 0.05, phase)
    book = Catalogue((), {EFFECT: made})
    for pick in ("low", "high", "typical"):
        values = np.array([getattr(p, pick) for p in made.parameters])
        call = book.call(np.zeros(0), {EFFECT: values})
        given = call.effects[EFFECT]
        assert effect.values(given) == given
        assert np.exp(1j * given["phase"]) == pytest.approx(np.exp(1j * values[2]))
