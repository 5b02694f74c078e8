"""What every load on the rack is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np


class LoadError(ValueError):
    """A load that does not exist, or a value that it cannot have."""


@dataclass(frozen=True)
class Load:
    """A rack force, linear in the bicycle's states and the rack displacement, plus a given one.

    ``moves``: the vehicle runs at the data sheet's speed; otherwise it stands still.
    """

    kind: ClassVar[str]
    moves: ClassVar[bool] = False
    # Read where a schema library validates these dataclasses: unknown names are refused there too.
    __pydantic_config__: ClassVar[dict[str, str]] = {"extra": "forbid"}

    def force_gains(self, p: Mapping[str, float]) -> np.ndarray:
        """Return the rack force [N] per sideslip, curvature and rack displacement, shape (3,).

        ``p``: the data sheet's group ``vehicle``.
        """
        return np.zeros(3)

    def external(self, t: np.ndarray) -> np.ndarray:
        """Return the given rack force [N] at times ``t`` [s], whatever the rack does."""
        return np.zeros(np.shape(t))
