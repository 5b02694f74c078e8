"""Filter and gaps on the way to the decimated grid, against scipy and numpy."""

import numpy as np
import pytest
from scipy import signal

from steering_diagnosis.engine.sampling import Sampling, low_passed


@pytest.mark.parametrize("shape", [(3000,), (3000, 2), (2500, 2, 3)])
@pytest.mark.parametrize(("order", "frequency", "edge"), [(6, 0.2, None), (3, 0.03, 300)])
def test_the_low_pass_is_scipys_to_the_bit(shape, order, frequency, edge):
    values = np.random.default_rng(0).standard_normal(shape).cumsum(axis=0)
    sections = signal.butter(order, frequency, output="sos")
    expected = signal.sosfiltfilt(sections, values, axis=0, padlen=edge)
    assert np.array_equal(low_passed(values, order, frequency, edge), expected)


def test_gaps_are_bridged_by_straight_lines_and_stay_unknown():
    random = np.random.default_rng(1)
    values = random.standard_normal((2000, 3)).cumsum(axis=0)
    known = np.ones(values.shape, bool)
    known[:30], known[800:850, 0], known[1200], known[-20:, 1] = False, False, False, False
    known[:, 2] = False
    bridged = np.zeros_like(values)
    index = np.arange(len(values))
    for j in (0, 1):
        bridged[:, j] = np.interp(index, index[known[:, j]], values[known[:, j], j])
    grid = Sampling(1e-3, 5, 80.0)
    found = grid.reduce(np.where(known, values, np.nan))
    expected = grid.reduce(bridged)
    clear = np.isfinite(found)
    assert clear.any(axis=0).tolist() == [True, True, False]
    assert np.array_equal(found[clear], expected[clear])
    assert not clear[np.arange(0, 30) // 5].any()
    assert not clear[160:170, 0].any()
