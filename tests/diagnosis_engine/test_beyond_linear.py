"""A cause far from linear leaves much in linear estimates: what is smaller shows after it."""

from __future__ import annotations

import pytest
from sled import record

from steering_diagnosis.engine.diagnose import diagnose


@pytest.mark.parametrize(
    "hidden",
    [
        {"backlash": 4e-3, "force_sensor_offset": 12.0},
        {"backlash": 4e-3, "drag": 500.0},
        {"friction_level": 70.0, "drag": 800.0},
    ],
    ids=lambda hidden: " and ".join(hidden),
)
def test_what_is_smaller_shows_once_the_large_cause_is_fitted(hidden):
    found = diagnose(record(5, 12.0, **hidden))
    sizes = {c.hypothesis.name: next(iter(c.parameters.values())).value for c in found.causes}
    assert sizes == pytest.approx(hidden, rel=0.2)
