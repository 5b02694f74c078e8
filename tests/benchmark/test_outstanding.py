"""What is not in the catalogue is visible where it stands above the noise, whatever imitates it."""

import numpy as np
import pytest

from steering_diagnosis.benchmark.visibility import COLUMNS, Sensitivity

CHANNELS = len(COLUMNS)
ROWS = 400
RANDOM = np.random.default_rng(1)
SIDE = RANDOM.standard_normal(CHANNELS * ROWS)
RIVAL = RANDOM.standard_normal(CHANNELS * ROWS)


def one_channel(channel, size):
    """Return a difference of a root mean square in one channel, (rows,)."""
    found = np.zeros((CHANNELS, ROWS))
    found[channel] = size * np.resize([1.0, -1.0], ROWS)
    return found.ravel()


def seen(unknown):
    effects = {"unknown": unknown, "rival": RIVAL}
    return Sensitivity(effects, {"unknown": 1.0, "rival": 1.0}, SIDE[:, None])


@pytest.mark.parametrize("size", [0.3, 1.0, 4.0])
def test_it_is_counted_in_the_channel_that_shows_most(size):
    unknown = one_channel(3, size)
    assert seen(unknown).outstanding("unknown", unknown) == pytest.approx(size, rel=0.05)


def test_what_a_tolerance_or_a_rival_imitates_does_not_stand_out():
    unknown = one_channel(3, 0.5)
    imitated = unknown + 3.0 * RIVAL + 0.5 * SIDE
    assert seen(imitated).outstanding("unknown", imitated) < 0.7
    assert np.sqrt(np.mean(imitated**2)) > 2.0
