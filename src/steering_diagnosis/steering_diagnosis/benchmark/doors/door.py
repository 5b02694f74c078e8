"""A door: the kind of file, the channels that lack in it, and the logger; drawn from a seed."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from steering_core.errors import BenchError
from steering_core.naming import unknown
from steering_diagnosis.benchmark.doors.channel_sets import checked, draw_lacking
from steering_diagnosis.benchmark.doors.files import WRITERS
from steering_diagnosis.benchmark.doors.logger import Logger, draw_logger

BAG = "bag"
KINDS = (BAG, *WRITERS)
DRAWN = "all"
PLAIN = Logger()
STREAM = 16
"""Of random numbers of its own: a specimen does not depend on its door."""


@dataclass(frozen=True)
class Door:
    """How a case comes in. lacking: groups of channels (doors.channel_sets). way: of writing."""

    kind: str = BAG
    lacking: tuple[str, ...] = ()
    logger: Logger = PLAIN
    way: int = 0

    @property
    def label(self) -> str:
        """Return a short name for files; "" for a bag with all channels."""
        if self == ALL_IN_A_BAG:
            return ""
        without = ["without", *self.lacking] if self.lacking else []
        return ".".join(
            [self.kind, "_".join(without) or "all", "_".join(self.logger.ways) or "plain"]
        )


ALL_IN_A_BAG = Door()
"""The bench's own record."""


def draw_door(
    seed: int,
    kind: str = DRAWN,
    lacking: Iterable[str] | None = None,
    plain: bool = False,
) -> Door:
    """Return the door of a case.

    kind, lacking: force them, the rest stays as drawn; a forced bag has all channels unless
    ``lacking`` says otherwise. plain: with a logger that does nothing to the samples.
    """
    if kind not in (DRAWN, *KINDS):
        raise BenchError(unknown("door", kind, (DRAWN, *KINDS)))
    random = [np.random.default_rng([seed, STREAM, i]) for i in range(4)]
    drawn = str(random[0].choice(KINDS))
    groups = draw_lacking(random[1]) if lacking is None else checked(lacking)
    if kind == BAG and lacking is None:
        groups = ()
    kind = drawn if kind == DRAWN else kind
    logger = PLAIN if plain or kind == BAG else draw_logger(random[2])
    return Door(kind, groups, logger, 0 if kind == BAG else int(random[3].integers(4)))
