"""Keep the wheel straight ahead."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from driver_model.manoeuvres.base import Manoeuvre


@dataclass(frozen=True)
class Hold(Manoeuvre):
    """Straight ahead, hands on the wheel."""

    kind: ClassVar[str] = "hold"

    def angle(self, t: np.ndarray) -> np.ndarray:
        """Return zeros [rad], one for each of the times ``t`` [s]."""
        return np.zeros(np.shape(t))
