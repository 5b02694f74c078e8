"""What a reader of another tool's file returns."""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from dataclasses import dataclass

import numpy as np

from steering_core.errors import BenchError


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


def check_own(places: Iterable[tuple[str, str, Hashable]], where: str) -> None:
    """Raise BenchError where two channels are one place in the file.

    places: of each channel its name, what the mapping calls it in the file, and its place there.
    """
    owners: dict[Hashable, str] = {}
    for name, source, place in places:
        owner = owners.setdefault(place, name)
        if owner != name:
            raise BenchError(
                f"{where}: {name}: '{source}' is {owner} already: each channel has its own"
            )
