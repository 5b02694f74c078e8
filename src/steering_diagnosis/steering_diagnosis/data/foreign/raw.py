"""What a reader of another tool's file returns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, repr=False)
class Raw:
    """A channel as the file has it. time: (n,) in the file's own unit, None where it has none."""

    values: np.ndarray
    time: np.ndarray | None = None
    unit: str = ""
