"""The reproduction as one page: a table of all numbers, then every figure in the source's axes."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence

from steering_bringup.pages import Card, Page, cards, paragraph, table
from steering_studies.reproduce.row import Number, Row

WORDS = {"reproduced": "reproduced", "differs": "differ", "shape only": "have no printed number"}


def reproduction_page(rows: Sequence[Row]) -> Page:
    """Return the page, in the order of the source; what is no figure of the source comes last."""
    rows = sorted(rows, key=_place)
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
        page.heading(f"Figure {row.figure}: {row.title}", row.sentence())
        for figure in row.figures:
            page.add(figure)
        if not row.figures:
            page.add(paragraph("Numbers only."))
    return page


def _place(row: Row) -> tuple[int, ...]:
    """Return the numbers of the row's first figure: "8.2, 8.3" is (8, 2)."""
    found = re.match(r"(\d+)\.(\d+)", row.figure)
    return tuple(int(part) for part in found.groups()) if found else (1000,)


HEAD = ("Figure", "Number", "Unit", "Source", "Ours", "Tolerance", "Verdict")


def _lines(row: Row) -> list[tuple[str, ...]]:
    return [(row.figure, *_cells(number)) for number in row.numbers]


def _cells(number: Number) -> tuple[str, ...]:
    source = "not printed" if number.source is None else f"{number.source:g}"
    if number.source is not None and number.sense != "is":
        source = f"{number.sense} {source}"
    tolerance = "" if number.source is None else f"{number.tolerance:.2g}"
    verdict = {True: "met", False: "not met", None: ""}[number.good]
    return (number.what, number.unit, source, f"{number.ours:.3g}", tolerance, verdict)
