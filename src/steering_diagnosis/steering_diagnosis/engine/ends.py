"""Nominal parameters that a record presses against the end of their physical range.

Such a value is no tolerance and no cause: a load cell that would have to be early, a friction below
none. The model stays at the end, and what the record asks for beyond it is told.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from steering_diagnosis.engine.catalogue import FURTHEST
from steering_diagnosis.engine.equations import bounded
from steering_diagnosis.engine.findings import Region
from steering_diagnosis.engine.fit import Fit, normal_equations
from steering_diagnosis.engine.noise import mean_square
from steering_diagnosis.engine.screen import NEAR, active_columns
from steering_diagnosis.engine.search import Search
from steering_diagnosis.engine.structure import band

REACH = 10.0 * FURTHEST
"""How far beyond an end a record is asked for what it would have [standard deviations]."""


@dataclass(frozen=True)
class Pressed:
    """A nominal parameter at an end. text: what the record asks for. region: where that shows."""

    text: str
    region: Region


def pressed(search: Search, best: Fit) -> list[Pressed]:
    """Return the nominal parameters that would explain clearly more beyond their physical range.

    Clearly is significant over the catalogue, and a share of an output's whole error that would be
    reported as structure.
    """
    p, book = search.problem, search.problem.book
    low = (best.z < book.lowest + NEAR) & (book.least > -FURTHEST)
    high = (best.z > book.highest - NEAR) & (book.most < FURTHEST)
    found = []
    for i in np.flatnonzero(low | high):
        gain, step = _beyond(search, best, int(i), -1.0 if low[i] else 1.0)
        if gain <= search.critical:
            continue
        n = book.nuisances[i]
        end, way = (n.low, "less") if low[i] else (n.high, "more")
        text = (
            f"{n.name} is held at {end:.3g} {n.unit}, the end of what is possible, and the "
            f"record asks for {way}"
        )
        region = _region(search, best, p.nuisance[..., i] * step, text)
        if region.share > p.settings.least_unexplained:
            found.append(Pressed(text, region))
    return found


def _beyond(search: Search, best: Fit, i: int, way: float) -> tuple[float, float]:
    """Return what one nuisance would gain beyond its end, and its step [standard deviations]."""
    p, book = search.problem, search.problem.book
    columns = np.concatenate([p.nuisance, active_columns(best)], axis=-1)
    gram, slope, _ = normal_equations(p, best, columns)
    count = len(best.z)
    gram[np.arange(count), np.arange(count)] += 1.0
    slope[:count] -= best.z
    # Causes may take up what they like: what only beyond the end explains is asked for.
    open_ended = np.full(columns.shape[-1] - count, np.inf)
    low = np.r_[book.lowest - best.z - NEAR, -open_ended]
    high = np.r_[book.highest - best.z + NEAR, open_ended]
    inside = bounded(gram, slope, low, high)
    low[i], high[i] = min(low[i], way * REACH), max(high[i], way * REACH)
    outside = bounded(gram, slope, low, high)
    gains = [2.0 * slope @ x - x @ gram @ x for x in (inside, outside)]
    return float(gains[1] - gains[0]), float(outside[i])


def _region(search: Search, best: Fit, part: np.ndarray, text: str) -> Region:
    """Return where a step beyond an end would take most off the error. part: (n, outputs)."""
    p = search.problem
    before = mean_square(best.residual, p.valid)
    gone = before - mean_square(best.residual + part, p.valid)
    j = int(np.argmax(gone / np.maximum(before, p.floor**2)))
    output = p.runs.replay.outputs[j]
    share = float(np.clip(gone[j] / max(before[j], 1e-300), 0.0, 1.0))
    where = band(part[:, j], p.runs.grid.step_s)
    return Region(output.balance, output.name, where, text, share, "fitted record")
