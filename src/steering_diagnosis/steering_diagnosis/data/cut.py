"""A part of a record, and what is left of one that is too long to be judged whole."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from steering_core.errors import BenchError
from steering_diagnosis.data.record import PERIOD_S, Record

LONGEST_S = 120.0
"""More adds time to the search and hardly anything to what is known."""

SHORTEST_S = 2.0
MOVES_BY = ("steering_wheel_speed", "steering_wheel_angle", "rack_position", "torsion_bar_torque")


def cut(record: Record, start: float | None, stop: float | None) -> Record:
    """Return the record from ``start`` to ``stop`` [s]; BenchError where little is left of it.

    Without both, a record longer than two minutes is cut to the two minutes that move most, and
    a note says so.
    """
    length = len(record) * PERIOD_S
    _check(record, start, stop)
    if start is None and stop is None and length > LONGEST_S:
        first = _liveliest(record, round(LONGEST_S / PERIOD_S))
        note = (
            f"the record lasts {length:.0f} s; judged are the {LONGEST_S:.0f} s from "
            f"{first * PERIOD_S:.1f} s on, which move most (choose others with --from and --to)"
        )
        return _part(record, first, first + round(LONGEST_S / PERIOD_S), (note,))
    first = round((start or 0.0) / PERIOD_S)
    last = len(record) if stop is None else min(round(stop / PERIOD_S), len(record))
    if (last - first) * PERIOD_S < SHORTEST_S:
        raise BenchError(
            f"'{record.name}' lasts {length:.3g} s; from {start or 0.0:g} to "
            f"{length if stop is None else stop:g} s less than {SHORTEST_S:g} s are left"
        )
    return record if (first, last) == (0, len(record)) else _part(record, first, last, ())


def _check(record: Record, start: float | None, stop: float | None) -> None:
    """Raise BenchError for instants that are none of the record's, or in the wrong order."""
    length = len(record) * PERIOD_S
    for option, value in (("--from", start), ("--to", stop)):
        if value is not None and not (0.0 <= value < math.inf):
            raise BenchError(f"{option} must be in s from the record's beginning, got {value:g}")
    if start is not None and stop is not None and stop <= start:
        raise BenchError(f"--to {stop:g} is not after --from {start:g}")
    if start is not None and start >= length:
        raise BenchError(f"--from {start:g}: '{record.name}' lasts {length:.3f} s")


def _part(record: Record, first: int, last: int, notes: tuple[str, ...]) -> Record:
    part = slice(first, last)
    return replace(
        record,
        channels={name: values[part] for name, values in record.channels.items()},
        excluded=None if record.excluded is None else record.excluded[part],
        notes=(*record.notes, *notes),
    )


def _liveliest(record: Record, length: int) -> int:
    """Return the first sample of the stretch of ``length`` with the most motion."""
    name = next((name for name in MOVES_BY if name in record), next(iter(record.channels)))
    motion = np.abs(np.diff(np.nan_to_num(record[name]), prepend=0.0))
    sums = np.concatenate([[0.0], np.cumsum(motion)])
    return int(np.argmax(sums[length:] - sums[:-length]))
