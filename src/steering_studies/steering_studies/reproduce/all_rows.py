"""Every row of the reproduction, in the order of the source."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import Executor

from steering_bringup.errors import BenchError
from steering_core.naming import unknown
from steering_studies.reproduce import (
    energy,
    open_centre,
    results,
    rig,
    servo,
    steering_loop,
    valve,
)
from steering_studies.reproduce.row import Maker, Row

ROWS: dict[str, Maker] = {
    f"{module.__name__.rsplit('.', 1)[-1]}.{maker.__name__}": maker
    for module in (rig, open_centre, valve, steering_loop, servo, results, energy)
    for maker in module.ROWS
}
"""Row's name to what makes it. A new module of rows is registered here, and only here."""


def make(
    names: Iterable[str] = (),
    executor: Executor | None = None,
    progress: Callable[[float, str], None] | None = None,
) -> list[Row]:
    """Return the rows called ``names``, all by default, in the order of the source.

    BenchError names an unknown one.
    """
    chosen = list(names) or list(ROWS)
    for name in chosen:
        if name not in ROWS:
            raise BenchError(unknown("row", name, ROWS))
    made = executor.map(_make, chosen) if executor else map(_make, chosen)
    rows = []
    for done, row in enumerate(made, start=1):
        rows.append(row)
        if progress is not None:
            progress(done / len(chosen), row.figure)
    return sorted(rows, key=lambda row: row.place)


def _make(name: str) -> Row:
    return ROWS[name]()
