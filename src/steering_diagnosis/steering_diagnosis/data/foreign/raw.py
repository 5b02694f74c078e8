"""What a reader of another tool's file returns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, repr=False)
class Raw:
    """A channel as the file has it; NaN where it has no number.

    time: (n,) in the file's own unit, None where it has none. time_unit: that unit, "" where the
    file does not say. lines: (n,) line of each value in a text file. lost: why values are NaN, a
    few words. about: what is to be said of the whole file, sentences. read_as: how the file was
    read, a few words. notes: what was lost or taken for granted in this channel, sentences without
    its name.
    """

    values: np.ndarray
    time: np.ndarray | None = None
    unit: str = ""
    time_unit: str = ""
    lines: np.ndarray | None = None
    lost: str = ""
    about: tuple[str, ...] = ()
    read_as: str = ""
    notes: tuple[str, ...] = ()
