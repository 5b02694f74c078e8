"""The load of a car that drives: the front tyres' lateral force on their trail."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from vehicle_model.bicycle import rack_force_gains
from vehicle_model.loads.base import Load


@dataclass(frozen=True)
class Bicycle(Load):
    """Linear bicycle model at the data sheet's speed."""

    kind: ClassVar[str] = "bicycle"
    moves: ClassVar[bool] = True

    def force_gains(self, p: Mapping[str, float]) -> np.ndarray:
        """Return the rack force [N] per sideslip, curvature and rack displacement, shape (3,)."""
        return rack_force_gains(p)
