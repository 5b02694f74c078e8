"""Which guest gives its place to a new one, as there are only so many."""

from __future__ import annotations

import numpy as np

from pressure_control.overlay.sources import HEARD, MESSAGE_TICK, PRIORITY, SEEN, SILENT

MOST_GUESTS = 64
"""A publisher that invents names must not fill the memory, nor keep others out for good."""


def place_to_give(
    kept: np.ndarray, requests: np.ndarray, served: int, priority: float
) -> int | None:
    """Return the number (from 0) of the guest whose place a new one gets; None: of nobody.

    First one who is silent, or of whom nothing was ever accepted: who has said nothing for longest.
    Else the one of least priority, not the one who is served, and only for a greater priority.

    kept (n, 6), requests (n, 3): of the guests, see ``sources``. served: number of the guest who is
    served, negative if none of them is. priority: the new one's; NaN where its message is refused.
    """
    quiet = (kept[:, SILENT] == 1.0) | ((kept[:, HEARD] < 0.0) & (kept[:, SEEN] >= 0.0))
    if quiet.any():
        return int(np.argmin(np.where(quiet, requests[:, MESSAGE_TICK], np.inf)))
    ranks = np.nan_to_num(requests[:, PRIORITY], nan=-np.inf)
    if served >= 0:
        ranks[served] = np.inf
    least = int(np.argmin(ranks))
    return least if ranks[least] < priority else None
