"""From cells to time: numbers kept to their last digit, dates, and times of day."""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import datetime
from decimal import Decimal
from typing import NamedTuple

import numpy as np

from steering_core.errors import BenchError
from steering_diagnosis.data.foreign.csv_table.cells import is_missing, looks_instant, quoted

DATES = {
    "-": ("%Y-%m-%d", "%d-%m-%Y", "%m-%d-%Y", "%d-%b-%Y"),
    "/": ("%Y/%m/%d", "%d/%m/%Y", "%m/%d/%Y", "%d/%m/%y", "%m/%d/%y", "%y/%m/%d"),
    ".": ("%d.%m.%Y", "%d.%m.%y", "%Y.%m.%d"),
    " ": ("%d %b %Y",),
}
"""How dates are written, by the sign in them. With points, day and month are never exchanged."""

CLOCK = re.compile(
    r"(?P<date>[^:]*?)[T ,]*(?<![0-9])(?P<hour>[0-9]{1,3}):(?P<minute>[0-9]{2})"
    r"(?::(?P<second>[0-9]{2})(?:[.,](?P<part>[0-9]{1,9})|:(?P<millis>[0-9]{3}))?"
    r"|[.,](?P<tenths>[0-9]{1,9}))?"
    r"\s*(?:(?P<half>[AaPp])\.?[Mm]\.?)?\s*(?P<zone>Z|UTC|[+-][0-9]{2}:?[0-9]{2})?"
)
"""A time of day, a date before it or not. With ``tenths`` it is minutes and seconds."""

SAMPLE = 200
"""Cells by which a column of time is judged."""

SECOND_NS = 1_000_000_000
MINUTE_NS = 60 * SECOND_NS
HOUR_NS = 60 * MINUTE_NS
DAY_NS = 24 * HOUR_NS

LOST_DIGITS = 1e-6
"""Share of a step beyond which rounding to float64 is felt: time is then counted from the first."""


class Instants(NamedTuple):
    """Seconds from the first row, (n,) float64, NaN where there are none; rows of foreign texts."""

    time: np.ndarray
    foreign: list[int]


def are_instants(cells: Sequence[str]) -> bool:
    """Return whether a column holds dates or times of day, by most of its filled cells."""
    sample = cells[:: max(len(cells) // SAMPLE, 1)]
    filled = [cell for cell in sample if not is_missing(cell)]
    return sum(map(looks_instant, filled)) > 0.5 * len(filled)


def counted(texts: Sequence[str], values: np.ndarray) -> np.ndarray:
    """Return numbers as time, (n,): as they are, or from the first one where digits would be lost.

    Stamps in ns since 1970 have 19 digits, a float64 has 16.
    """
    finite = np.flatnonzero(np.isfinite(values)).tolist()
    if len(finite) < 2:
        return values
    step = np.median(np.abs(np.diff(values[finite])))
    if np.spacing(np.max(np.abs(values[finite]))) <= LOST_DIGITS * step:
        return values
    first = Decimal(texts[finite[0]])
    exact = np.full(len(values), np.nan)
    exact[finite] = [float(Decimal(texts[row]) - first) for row in finite]
    return exact


def instants(cells: Sequence[str], time_format: str | None) -> Instants:
    """Return dates or times of day as seconds from the first one.

    Without dates, a jump back by more than half a day has passed midnight (in minutes and seconds:
    half an hour, the hour). BenchError: no date known here, or one with two readings that differ.
    """
    if time_format is not None:
        ns, turn = _by_format(cells, time_format)
    else:
        ns, turn = _by_looks(cells)
    present = [row for row, at in enumerate(ns) if at is not None]
    if not present:
        raise BenchError(
            f"{quoted(cells[0])} is no time known here: say `time_format` in the mapping"
        )
    foreign = [row for row, at in enumerate(ns) if at is None and not is_missing(cells[row])]
    first = ns[present[0]] or 0
    since = np.array([at - first for at in ns if at is not None], dtype=np.int64)
    if turn:
        since += turn * np.cumsum(np.diff(since, prepend=0) < -turn // 2)
    time = np.full(len(cells), np.nan)
    time[present] = since / SECOND_NS
    return Instants(time, foreign)


def _by_format(cells: Sequence[str], time_format: str) -> tuple[list[int | None], int]:
    """Return ns by a strptime format, and after how many the time of day begins anew (0: never)."""
    import pandas

    try:
        read = pandas.to_datetime(
            pandas.Series([cell.strip() for cell in cells]),
            format=time_format,
            errors="coerce",
            utc=True,
        )
    except (ValueError, TypeError) as error:
        raise BenchError(f"time_format '{time_format}': {error}") from None
    stamps = read.dt.tz_localize(None).to_numpy().astype("datetime64[ns]").astype(np.int64)
    lost = read.isna().to_numpy()
    if lost.all():
        raise BenchError(f"time_format '{time_format}' does not fit {quoted(cells[0])}")
    with_date = any(sign in time_format for sign in ("%d", "%j", "%D", "%x", "%c"))
    ns = [None if gone else int(at) for at, gone in zip(stamps, lost, strict=True)]
    return ns, 0 if with_date else DAY_NS


def _by_looks(cells: Sequence[str]) -> tuple[list[int | None], int]:
    """Return ns by what the cells look like, and after how many the time begins anew (0: never)."""
    matches = [CLOCK.fullmatch(cell.strip()) for cell in cells]
    found = [match for match in matches if match]
    days = _days(dict.fromkeys(match["date"].strip() for match in found))
    short = [match for match in found if not match["second"]]
    in_minutes = any(match["tenths"] for match in short)
    if short and not in_minutes and not all(days.get(m["date"].strip()) for m in short):
        raise BenchError(
            f"'{short[0][0]}' may be hours and minutes or minutes and seconds: say `time_format` "
            "in the mapping"
        )
    parts = [(match["part"] or "", match[0]) for match in found]
    longest = max((len(part) for part, _ in parts), default=0)
    for part, whole in parts:
        if 1 < len(part) < longest and part.endswith("0"):
            raise BenchError(
                f"'{whole}' has fewer digits than others, and they end with 0: are these counts "
                "without zeros before them? Write all with as many digits"
            )
    ns: list[int | None] = []
    for match in matches:
        day = days.get(match["date"].strip()) if match else None
        ns.append(None if day is None or match is None else day * DAY_NS + _ns(match, in_minutes))
    if any(days.values()):
        return ns, 0
    return ns, HOUR_NS if in_minutes else DAY_NS


def _ns(match: re.Match[str], in_minutes: bool) -> int:
    """Return the time of day of a match in ns; with ``in_minutes`` short ones are min:s."""
    first, second = int(match["hour"]), int(match["minute"])
    if match["second"] is None and in_minutes:
        return first * MINUTE_NS + second * SECOND_NS + _part(match["tenths"])
    if match["half"]:
        first = first % 12 + (12 if match["half"] in "Pp" else 0)
    ns = first * HOUR_NS + second * MINUTE_NS + int(match["second"] or 0) * SECOND_NS
    zone = (match["zone"] or "").replace(":", "")
    if zone[:1] in ("+", "-") and zone:
        east = int(zone[1:3]) * HOUR_NS + int(zone[3:5]) * MINUTE_NS
        ns -= -east if zone[0] == "-" else east
    return ns + _part(match["part"] or match["millis"])


def _part(digits: str | None) -> int:
    return int(f"{digits or '0':0<9}")


def _days(dates: dict[str, None]) -> dict[str, int]:
    """Return the day of each date, '' being 0; dates in no known writing are left out.

    BenchError where two writings read all of them and differ in the days between them.
    """
    days = {"": 0} if "" in dates else {}
    written = [date for date in dates if date]
    if not written:
        return days
    sign = next((sign for sign in DATES if sign in written[0]), "-")
    readings = [_read(written, form) for form in DATES[sign]]
    most = max(map(len, readings))
    best = [read for read in readings if read and len(read) == most]
    if len({tuple(np.diff(list(read.values()))) for read in best}) > 1:
        raise BenchError(
            f"which number is the day and which the month of '{written[0]}' cannot be told, and "
            "the date changes: say `time_format` in the mapping"
        )
    return days | (best[0] if best else {})


def _read(dates: Sequence[str], form: str) -> dict[str, int]:
    days = {}
    for date in dates:
        try:
            days[date] = datetime.strptime(date, form).toordinal()
        except ValueError:
            continue
    return days
