"""The reproduction as one page: a table of all numbers, then every figure in the source's axes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from steering_bringup.pages import Card, Page, cards, paragraph, table
from steering_studies.reproduce.row import Number, Row

WORDS = {"reproduced": "reproduced", "differs": "differ", "shape only": "have no printed number"}


def reproduction_page(rows: Sequence[Row]) -> Page:
    """Return the page."""
    counts = Counter(str(row.verdict) for row in rows)
    told = ", ".join(f"{counts[key]} {word}" for key, word in WORDS.items() if counts[key])
    page = Page(
        title="The source, reproduced",
        subtitle="A. Dell'Amico, Pressure Control in Hydraulic Power Steering Systems, 2013",
        lead=f"Of {len(rows)} figures, {told}.",
        good=not counts["differs"] or None,
        footer="Numbers of the source are those of its text and axes; its curves are not printed "
        "as numbers. This page needs no network.",
    )
    page.add(
        cards(
            Card(key, str(counts[key]), "", f"of {len(rows)} figures", good)
            for key, good in (("reproduced", True), ("differs", False), ("shape only", None))
        )
    )
    page.add(table(HEAD, [line for row in rows for line in _lines(row)], left_columns=2))
    for row in rows:
        page.heading(f"{row.name.capitalize()}: {row.title}", row.sentence())
        for figure in row.figures:
            page.add(figure)
        if not row.figures:
            page.add(paragraph("Numbers only."))
    return page


HEAD = ("Figure", "Number", "Unit", "Source", "Ours", "Tolerance", "Verdict")


def _lines(row: Row) -> list[tuple[str, ...]]:
    return [(row.figure, *_cells(number)) for number in row.numbers]


def _cells(number: Number) -> tuple[str, ...]:
    source = "not printed" if number.source is None else f"{number.source:g}"
    if number.source is not None and number.sense != "is":
        source = f"{number.sense} {source}"
    tolerance = "" if number.source is None else _text(number.tolerance, 2)
    verdict = {True: "met", False: "not met", None: ""}[number.good]
    return (number.what, number.unit, source, _text(number.ours, 3), tolerance, verdict)


def _text(value: float, digits: int) -> str:
    """Return a number without an exponent where it is large."""
    return f"{value:.0f}" if abs(value) >= 10.0**digits else f"{value:.{digits}g}"
