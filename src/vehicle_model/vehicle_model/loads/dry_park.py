"""The load of a standing car on dry ground: the tyres are twisted like springs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from vehicle_model.loads.base import Load


@dataclass(frozen=True)
class DryPark(Load):
    """A spring from straight ahead; the vehicle stands still."""

    kind: ClassVar[str] = "dry_park"

    def force_gains(self, p: Mapping[str, float]) -> np.ndarray:
        """Return the rack force [N] per sideslip, curvature and rack displacement, shape (3,)."""
        return np.array([0.0, 0.0, p["dry_park_stiffness"]])
