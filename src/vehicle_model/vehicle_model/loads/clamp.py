"""The rack held fast, as on a rig that measures boost curve and stiffness (source, section 3.2)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from vehicle_model.loads.base import Load, LoadError


@dataclass(frozen=True)
class Clamp(Load):
    """A clamp that holds the rack in the middle; the vehicle stands still."""

    kind: ClassVar[str] = "clamp"

    stiffness_n_m: float = 2e9

    def __post_init__(self) -> None:
        if not 0.0 < self.stiffness_n_m <= 1e10:
            raise LoadError(f"clamp: stiffness_n_m must be up to 1e10, got {self.stiffness_n_m:g}")

    def force_gains(self, p: Mapping[str, float]) -> np.ndarray:
        """Return the rack force [N] per sideslip, curvature and rack displacement, shape (3,)."""
        return np.array([0.0, 0.0, self.stiffness_n_m])
