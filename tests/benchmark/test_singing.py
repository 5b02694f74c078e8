"""A specimen that oscillates by itself makes no case."""

import numpy as np
import pytest

from steering_diagnosis.benchmark.truth import states as s
from steering_diagnosis.benchmark.truth.run import Signals
from steering_diagnosis.benchmark.truth.singing import sings

TIME = np.arange(15_000) * 1e-3


def run(speed):
    true = np.zeros((len(TIME), s.CHANNELS))
    true[:, s.RACK_SPEED_OUT] = speed
    return Signals(true, true, true, true, true, true, true)


@pytest.mark.parametrize(("share", "expected"), [(0.0, False), (0.03, False), (0.3, True)])
def test_a_line_beyond_all_manoeuvres_is_singing(share, expected):
    moved = np.sin(2.0 * np.pi * 1.3 * TIME)
    assert sings(run(moved + np.sqrt(share) * np.sin(2.0 * np.pi * 74.0 * TIME))) is expected
