"""A gap stays a gap, wherever a logger's clock began."""

import numpy as np
import pytest

from steering_diagnosis.data.resample import on_grid, sampled


@pytest.mark.parametrize("start", [0.0, 2872.345454, 1.7e9])
def test_a_gap_is_not_bridged_late_on_a_clock(start):
    time = np.arange(3000) * 1e-3
    there = (time < 1.0) | (time >= 1.05)
    channel = sampled("rack_force", start + time[there], np.sin(time[there]))
    values = on_grid(channel, start, 3000)
    assert 48 <= np.count_nonzero(~np.isfinite(values)) <= 50
    assert np.flatnonzero(~np.isfinite(values))[0] == pytest.approx(1000, abs=1)
