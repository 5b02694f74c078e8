"""What is played of a bag's time: its stretches one after the other, without the silences. Pure."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from itertools import pairwise

SECOND = 1_000_000_000
DAY = 86_400 * SECOND
EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
Span = tuple[int, int]


@dataclass(frozen=True)
class Course:
    """``spans``: (first ns, first ns that is not played) of each stretch, in order.

    ``offsets``: ns that have been played when a stretch begins; ``length``: ns of them all, from
    the first message to the last one.
    """

    spans: tuple[Span, ...]
    offsets: tuple[int, ...]
    length: int

    @classmethod
    def of(cls, spans: Sequence[Span]) -> Course:
        """Return the whole course of stretches given by their first and last message."""
        offsets, length = [], 0
        for first, last in spans:
            offsets.append(length)
            length += last - first
        return cls(tuple((first, last + 1) for first, last in spans), tuple(offsets), length)

    @property
    def lengths(self) -> list[int]:
        """How long each stretch takes, ns."""
        return [b - a for a, b in pairwise((*self.offsets, self.offsets[0] + self.length))]

    def part(self, start: int, stop: int) -> Course:
        """Return what lies from ``start``, which is in the course, to before ``stop`` ns of it."""
        spans, offsets = [], []
        for (first, end), offset in zip(self.spans, self.offsets, strict=True):
            begin, end = max(first, first + start - offset), min(end, first + stop - offset)
            if begin < end:
                spans.append((begin, end))
                offsets.append(max(offset, start))
        return Course(tuple(spans), tuple(offsets), min(self.length, stop) - start)

    def played(self, recorded: int) -> int:
        """Return how much of the course, in ns, lies before a time of the recording."""
        place = max(0, bisect_right(self.spans, recorded, key=lambda span: span[0]) - 1)
        return self.offsets[place] - self.offsets[0] + recorded - self.spans[place][0]

    def silences(self) -> list[str]:
        """Return a line for each silence that is left out."""
        return [
            f"nothing was recorded for {_length(following - end)} after {_date(end)}: "
            "not waited for"
            for (_, end), (following, _) in pairwise(self.spans)
        ]


def _length(nanoseconds: int) -> str:
    days = nanoseconds / DAY
    return f"{days / 365.2425:.1f} years" if days > 730 else f"{days:.1f} days"


def _date(nanoseconds: int) -> str:
    try:
        return (EPOCH + timedelta(seconds=nanoseconds // SECOND)).strftime("%Y-%m-%d %H:%M:%S")
    except OverflowError:
        return f"{nanoseconds / SECOND:g} s"
