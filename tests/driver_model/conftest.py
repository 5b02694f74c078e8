from types import SimpleNamespace

import numpy as np
import pytest
from scipy.linalg import expm

INERTIA, STIFFNESS, DAMPING = 0.058, 60.734, 0.06
PERIOD = 0.001


def sampled_wheel() -> tuple[np.ndarray, np.ndarray]:
    """Return A (2, 2) and B (2,) of [angle, speed] over one tick with the torque held."""
    extended = np.zeros((3, 3))
    extended[0, 1] = 1.0
    extended[1] = [-STIFFNESS / INERTIA, -DAMPING / INERTIA, 1.0 / INERTIA]
    solved = expm(extended * PERIOD)
    return solved[:2, :2], solved[:2, 2]


def drive(driver, ticks: int, delay: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Return angles and torques of ``driver`` at the wheel; torques act ``delay`` ticks late."""
    transition, by_torque = sampled_wheel()
    wheel = np.zeros(2)
    angles, torques = np.zeros(ticks), np.zeros(ticks)
    for tick in range(ticks):
        angles[tick] = wheel[0]
        torques[tick] = driver.step(tick, wheel[0], wheel[1], STIFFNESS * wheel[0])[0]
        applied = torques[tick - delay] if tick >= delay else 0.0
        wheel = transition @ wheel + by_torque * applied
    return angles, torques


@pytest.fixture
def wheel() -> SimpleNamespace:
    """Return an independent steering wheel: on a torsion bar with a held rack, no friction."""
    matrices = dict(zip(("transition", "by_torque"), sampled_wheel(), strict=True))
    return SimpleNamespace(stiffness=STIFFNESS, period=PERIOD, drive=drive, **matrices)
