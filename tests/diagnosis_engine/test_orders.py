"""What comes again with every turn of a shaft is structure; noise of the same size is none."""

import numpy as np
import pytest

from steering_diagnosis.engine.model import Output
from steering_diagnosis.engine.structure import Remains, structures

SAMPLES = 4000
TIME = np.arange(SAMPLES) * 5e-3
ANGLE = 6.0 * np.sin(0.9 * TIME)


def found(residual):
    remains = Remains(
        (Output("torque", "N m", "column"),),
        residual[:, None],
        np.ones((SAMPLES, 1), bool),
        np.arange(SAMPLES) * 16 // SAMPLES,
        {"angle [rad]": ANGLE},
        np.array([0.02]),
        8,
        1.0,
        np.zeros((SAMPLES, 1)),
        np.zeros(1),
    )
    return structures(remains)


@pytest.mark.parametrize("teeth", [7, 24, 36])
def test_cogging_is_found_though_it_has_a_hundred_periods_over_the_angle(teeth):
    noise = 0.2 * np.random.default_rng(3).standard_normal(SAMPLES)
    ripple = 0.25 * np.sin(teeth * ANGLE + 0.4)
    (structure,) = found(noise + ripple)
    assert structure.energy == pytest.approx(np.mean(ripple**2), rel=0.3)
    assert np.corrcoef(structure.part, ripple)[0, 1] > 0.9


def test_noise_is_silent():
    assert found(0.27 * np.random.default_rng(4).standard_normal(SAMPLES)) == []
