"""What the two runs cost: hydraulic energy of the supply, and the driver's work."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

TRUTH = "/truth/plant"


@dataclass(frozen=True)
class Energy:
    """Energy over the compared time. None where the bag does not say.

    supply [J]: hydraulic energy delivered by the supply; mean_power [W]; driver_work [J]: net work
    of the driver on the steering wheel; duration [s].
    """

    supply: float | None
    driver_work: float | None
    duration: float

    @property
    def mean_power(self) -> float | None:
        """Mean hydraulic power of the supply [W]."""
        return None if self.supply is None or not self.duration else self.supply / self.duration


def energy(
    time: np.ndarray,
    supply_energy: np.ndarray | None,
    torque: np.ndarray | None,
    speed: np.ndarray | None,
) -> Energy:
    """Energy from signals (n,): supplied energy since the start [J], torque [N m], speed [rad/s].

    The driver's torque is held from a tick to the next, the speed moves between: trapezoid.
    """
    supply = None if supply_energy is None else float(supply_energy[-1] - supply_energy[0])
    work = None
    if torque is not None and speed is not None:
        mean_speed = 0.5 * (speed[1:] + speed[:-1])
        work = float(np.sum(torque[:-1] * mean_speed * np.diff(time)))
    return Energy(supply, work, float(time[-1] - time[0]))
