"""The comparison as one HTML page."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from steering_bringup.comparison.figures import figures
from steering_bringup.comparison.metadata import flatten
from steering_bringup.comparison.result import Comparison
from steering_bringup.comparison.verdict import limit, shown, told, verdict
from steering_bringup.pages import Card, Page, cards, folded, paragraph, table

_UNIT_AFTER_NUMBER = re.compile(r"(\d) (bar|N m)")


def write_page(result: Comparison, path: str | Path) -> Path:
    """Write the page; BenchError naming the path if that fails."""
    return comparison_page(result).write(path)


def comparison_page(result: Comparison) -> Page:
    """The page: verdict and key numbers, the figures, the metadata."""
    judged = verdict(result)
    first, second = result.names
    page = Page(
        title=f"{_start(first) if result.of_runs else first} and {second} compared",
        subtitle=_subtitle(result),
        lead=_UNIT_AFTER_NUMBER.sub("\\1\N{NO-BREAK SPACE}\\2", judged.sentence),
        good=judged.good,
        footer=_footer(result),
    )
    page.add(cards(_cards(result)))
    for note in result.notes:
        page.add(paragraph(note, "note"))
    page.add(table(_head(result), _rows(result)))
    page.add(table(("Energy", "Unit", first, second, "Difference"), _energy_rows(result)))
    page.heading(
        "Figures",
        f"Differences are {second} minus {first}, tick by tick; {_treatment(result)}. "
        "Drag to zoom, double-click to go back, click a name to hide its curve.",
    )
    for figure in figures(result):
        page.add(figure)
    page.heading("How the runs were made")
    page.add(_changed(result))
    for name, trace in zip(result.names, result.traces, strict=True):
        rows = [(key, _text(value)) for key, value in flatten(trace.run).items()]
        title = f"Everything recorded about {name} ({trace.name})"
        page.add(folded(title, table(("what", "value"), rows, left_columns=2)))
    return page


def _start(text: str) -> str:
    return text[:1].upper() + text[1:]


def _treatment(result: Comparison) -> str:
    if result.of_runs:
        return "nothing is filtered or resampled"
    return "what was not sampled at 1 kHz was brought onto it, as the notes say"


def _subtitle(result: Comparison) -> str:
    scenario = result.traces[0].run.get("scenario")
    name = str(scenario.get("name", "")) if isinstance(scenario, dict) else ""
    parts = [name.replace("_", "-")] if name else []
    bags = " and ".join(trace.name for trace in result.traces)
    what = "bags" if result.of_runs else "data"
    return " · ".join(
        [*parts, f"{result.duration:.1f} s at 1 kHz, {len(result.time)} ticks", f"{what} {bags}"]
    )


def _footer(result: Comparison) -> str:
    software = result.traces[0].run.get("software")
    revision = software.get("revision", "") if isinstance(software, dict) else ""
    started = result.traces[0].run.get("started", "")
    made = f"Recorded {started}" if started else "Recorded at an unknown time"
    return f"{made}{f', software {revision}' if revision else ''}. This page needs no network."


def _cards(result: Comparison) -> list[Card]:
    found = [_difference_card(result, key) for key in told(result)]
    powers = [e.mean_power for e in result.energies]
    for name, power in zip(result.names, powers, strict=True):
        if power is not None:
            found.append(
                Card(
                    f"Hydraulic power, {name}",
                    f"{power:.0f}",
                    "W",
                    _relative(name, power, result),
                )
            )
    return found


def _relative(name: str, power: float, result: Comparison) -> str:
    """Mean power against the first run's, where that is known."""
    reference = result.energies[0].mean_power
    if name == result.names[0] or not reference:
        return f"mean over {result.duration:.1f} s"
    share = power / reference - 1.0
    return f"{abs(share):.0%} {'more' if share > 0 else 'less'} than {result.names[0]}"


def _difference_card(result: Comparison, key: str) -> Card:
    signal, item, bound = result.kinds[key], result.differences[key], limit(result, key)
    remark, good = f"largest, at {item.at:.2f} s", None
    if bound is not None:
        good = item.largest <= bound
        words = "within" if good else "above"
        remark = f"{words} the limit of {bound * signal.scale:g} {signal.shown_unit}"
    return Card(
        f"{signal.title} difference", shown(signal, item.largest), signal.shown_unit, remark, good
    )


def _head(result: Comparison) -> tuple[str, ...]:
    first, second = result.names
    return (
        "Signal",
        "Unit",
        f"Peak, {first}",
        f"Peak, {second}",
        "Largest difference",
        "at [s]",
        "Rms difference",
        *(("Limit",) if _limited(result) else ()),
    )


def _limited(result: Comparison) -> bool:
    return any(limit(result, key) is not None for key in result.differences)


def _rows(result: Comparison) -> list[tuple[str, ...]]:
    limits = {key: limit(result, key) for key in result.differences}
    limited = _limited(result)
    rows = []
    for key, item in result.differences.items():
        signal, bound = result.kinds[key], limits[key]
        a, b, largest = (shown(signal, value) for value in (*item.peaks, item.largest))
        rows.append(
            (
                signal.title,
                signal.shown_unit,
                a,
                b,
                largest,
                f"{item.at:.3f}",
                shown(signal, item.rms),
                *(("" if bound is None else f"{bound * signal.scale:g}",) if limited else ()),
            )
        )
    return rows


def _energy_rows(result: Comparison) -> list[tuple[str, ...]]:
    def row(title: str, unit: str, pair: list[float | None], digits: int) -> tuple[str, ...]:
        texts = ["not known" if v is None else f"{v:.{digits}f}" for v in pair]
        a, b = pair
        error = "" if a is None or b is None else f"{b - a:+.{digits}f}"
        return (title, unit, *texts, error)

    energies = result.energies
    supplies = [None if e.supply is None else e.supply * 1e-3 for e in energies]
    return [
        row("Mean hydraulic power", "W", [e.mean_power for e in energies], 1),
        row("Hydraulic energy", "kJ", supplies, 3),
        row("Driver's work", "J", [e.driver_work for e in energies], 2),
    ]


def _changed(result: Comparison) -> str:
    if not result.changed and not result.of_runs:
        return paragraph("Nothing that differs is recorded about how they were made.")
    if not result.changed:
        return paragraph("Both runs were made with the same parameters, node set and software.")
    rows = [(name, _text(a), _text(b)) for name, a, b in result.changed]
    head = ("differs", *result.names)
    return folded(f"What differs between the runs ({len(rows)})", table(head, rows, 3))


def _text(value: Any) -> str:
    return "-" if value is None else str(value)
