"""The benchmark's page: rates beside their targets, the confusion matrix, every case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from steering_bringup.pages.page import Page
from steering_bringup.pages.parts import Card, cards, folded, paragraph, table
from steering_diagnosis.benchmark.by_door import HEAD, by_door, cells
from steering_diagnosis.benchmark.scoring import Judgement, Rate


def benchmark_page(
    method: str,
    rates: Sequence[Rate],
    confusion: Mapping[str, Mapping[str, int]],
    judgements: Sequence[Judgement],
) -> Page:
    """Return the page of one method's judgements."""
    judged = [r for r in rates if r.reached is not None]
    met = sum(bool(r.reached) for r in judged)
    page = Page(
        f"Sealed benchmark of diagnosis: {method}",
        lead=f"{met} of {len(judged)} targets met over {len(judgements)} cases.",
        good=met == len(judged),
        subtitle="What was hidden in each record, the diagnosis never saw",
    )
    page.add(cards([_card(r) for r in judged]))
    page.heading("Rates", "Brackets: 95 % interval of the rate (Wilson), from the number of cases.")
    page.add(
        table(("what", "value", "95 % interval", "counted", "target"), [rate_row(r) for r in rates])
    )
    rows = [cells(row) for row in by_door(judgements)]
    if rows:
        page.heading(
            "By door, channels and logger", "A case counts in one row of each kind or more."
        )
        page.add(table(HEAD, rows))
    page.heading("What was hidden, and what was named")
    rows = [
        (row, ", ".join(f"{said} ({n})" for said, n in sorted(counts.items(), key=lambda c: -c[1])))
        for row, counts in confusion.items()
    ]
    page.add(table(("hidden", "named (cases)"), rows, left_columns=2))
    page.heading("Cases")
    head = ("case", "hidden", "named", "verdict", "wrong", "s")
    lines = [
        (
            j.case,
            ", ".join(j.hidden) or "nothing",
            "; ".join(" or ".join(group) for group in j.named) or j.failure or "nothing",
            j.verdict,
            ", ".join(j.wrong),
            f"{j.seconds:.1f}",
        )
        for j in judgements
    ]
    page.add(folded(f"{len(lines)} cases", table(head, lines, left_columns=5)))
    page.add(paragraph("How cases are made and judged: docs/diagnosis_benchmark.md"))
    return page


def rate_row(rate: Rate) -> tuple[str, str, str, str, str]:
    """Return a rate as text: what, value, interval, counted, target."""
    sign = ">=" if rate.at_least else "<="
    target = f"{sign} {100 * rate.target:.3g} %"
    if rate.value is None:
        return rate.what, "-", "", "0", target
    interval = (
        f"{100 * rate.low:.1f} to {100 * rate.high:.1f}"
        if rate.low is not None and rate.high is not None
        else ""
    )
    return rate.what, f"{100 * rate.value:.1f} %", interval, str(rate.n), target


def _card(rate: Rate) -> Card:
    _, value, _, counted, target = rate_row(rate)
    return Card(rate.what, value, remark=f"target {target}, {counted} counted", good=rate.reached)
