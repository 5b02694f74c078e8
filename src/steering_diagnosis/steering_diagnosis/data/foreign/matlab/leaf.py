"""One array of a MAT file, with what the file says of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, repr=False)
class Clock:
    """Instants of the samples beside it, (n,). scale: s per unit, None where it is not said."""

    times: np.ndarray
    scale: float | None = None


@dataclass(frozen=True, repr=False)
class About:
    """What holds for all that lies below one place of the file."""

    clock: Clock | None = None
    unit: str = ""
    label: str = ""


@dataclass(frozen=True, repr=False)
class Leaf:
    """An array of numbers of any shape, or why there is none at this place.

    scale: s per unit, where the numbers are instants or durations.
    """

    array: np.ndarray | None
    about: About
    why_not: str = ""
    scale: float | None = None

    @property
    def is_vector(self) -> bool:
        """Whether it has one dimension longer than one."""
        return self.array is not None and np.squeeze(self.array).ndim == 1
