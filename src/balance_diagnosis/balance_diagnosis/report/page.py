"""The page: one HTML file without a script that loads nothing, of any model."""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence
from typing import Any

from balance_diagnosis.diagnosis import Diagnosis
from balance_diagnosis.held_out import Curve
from balance_diagnosis.report import words
from balance_diagnosis.report.data import output_units
from balance_diagnosis.report.style import STYLE
from balance_diagnosis.report.svg import AFTER, BEFORE, INK, Line, plot
from balance_diagnosis.verdicts import CLEAN, NAMED

POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"
"""The browser itself refuses whatever the page might want to load from elsewhere."""

MOST_CURVES = 24
"""Outputs that are drawn, those with the largest errors first."""

BYTES, BYTES_A_POINT, LINES = 1.1e6, 12.5, 5
"""Of all curves together, of a point, and lines of an output: measured, two models, two errors."""


def render(diagnosis: Diagnosis, told: dict[str, Any]) -> str:
    """Return the whole file. told: the same as data."""
    sound = told["verdict"] in (NAMED, CLEAN) and " grows " not in told["gain"]
    kind = "good" if sound else "open"
    title = f"{told['model']}: {told['verdict']}"
    return "".join(
        [
            "<!doctype html><html lang='en'><head><meta charset='utf-8'>",
            f"<meta http-equiv='Content-Security-Policy' content=\"{POLICY}\">",
            "<meta name='viewport' content='width=device-width, initial-scale=1'>",
            f"<title>{html.escape(title)}</title><style>{STYLE}</style></head><body>",
            f"<header class='{kind}'><h1>{html.escape(title)}</h1>",
            f"<p class='lead'>{html.escape(told['sentence'])}</p>",
            f"<p>{html.escape(told['gain'])}</p>" if told["gain"] else "",
            f"<p>{html.escape(told['meaning'])}</p></header><main>",
            *_named(diagnosis),
            *_gains(diagnosis),
            *_curves(diagnosis),
            *_left(diagnosis),
            *_catalogue(diagnosis),
            *_parameters(diagnosis),
            *_rates(told["rates"]),
            *_made(diagnosis, told),
            "</main></body></html>",
        ]
    )


def _heading(text: str, explanation: str = "") -> str:
    more = f"<p class='more'>{html.escape(explanation)}</p>" if explanation else ""
    return f"<h2>{html.escape(text)}</h2>{more}"


def _table(head: Sequence[str], rows: Iterable[Sequence[str]], texts: int = 1) -> str:
    """Return a table; its first columns are texts, the others numbers."""

    def line(cells: Sequence[str], tag: str) -> str:
        return "".join(
            f"<{tag}{'' if k < texts else ' class=n'}>{html.escape(str(cell))}</{tag}>"
            for k, cell in enumerate(cells)
        )

    body = "".join(f"<tr>{line(row, 'td')}</tr>" for row in rows)
    return f"<div class='wide'><table><tr>{line(head, 'th')}</tr>{body}</table></div>"


def _unit(diagnosis: Diagnosis, output: str) -> str:
    return output_units(diagnosis).get(output, "")


def _named(diagnosis: Diagnosis) -> list[str]:
    verdict, units = diagnosis.verdict, diagnosis.model.units
    said = dict.fromkeys(verdict.named, "named")
    said |= {c: f"one of group {k + 1}" for k, g in enumerate(verdict.groups) for c in g}
    said |= dict.fromkeys(verdict.candidates, "candidate")
    rows = []
    for cause, numbers in diagnosis.causes.items():
        for e in numbers.values():
            value, span = words.spread(e, units.get(e.name, ""))
            rows.append(
                (
                    cause,
                    said.get(cause, "probable"),
                    words.probability(verdict.probability[cause]),
                    e.name,
                    value,
                    span + (", at its bound" if words.at_bound(e, diagnosis.model) else ""),
                )
            )
    if not rows:
        return []
    head = ("cause", "verdict", "probability", "number", "value", "95 % interval")
    return [_heading("What was found"), _table(head, rows, 2)]


def _gains(diagnosis: Diagnosis) -> list[str]:
    rows = []
    for g in diagnosis.gains:
        unit = _unit(diagnosis, g.output)
        change = 1.0 - (g.extended / g.nominal) ** 2 if g.nominal > 0.0 else 0.0
        rows.append(
            (
                g.record,
                "held out" if g.held_out else "fitted",
                g.output,
                words.quantity(g.nominal, unit),
                words.quantity(g.extended, unit),
                words.percent(change) if change >= 0.0 else "worse",
            )
        )
    held = any(g.held_out for g in diagnosis.gains)
    told = (
        "Rms errors, measured minus predicted. Records that were held out took no part in the fit "
        "nor in the choice of causes."
        if held
        else "Rms errors, measured minus predicted. No record was held out: that the extended "
        "model does better on the record that it was fitted to proves little."
    )
    head = ("record", "", "output", "nominal model", "extended model", "energy removed")
    return [_heading("What the extended model gains", told), _table(head, rows, 3)]


def _curves(diagnosis: Diagnosis) -> list[str]:
    def badness(curve: Curve) -> float:
        gain = next(
            g for g in diagnosis.gains if (g.record, g.output) == (curve.record, curve.output)
        )
        spread = float((curve.measured[curve.measured == curve.measured]).std()) or 1.0
        return gain.nominal / spread

    shown = list(diagnosis.curves)
    note = ""
    if len(shown) > MOST_CURVES:
        chosen = sorted(range(len(shown)), key=lambda i: -badness(shown[i]))[:MOST_CURVES]
        note = f"Of {len(shown)} outputs the {MOST_CURVES} with the largest errors are drawn."
        shown = [shown[i] for i in sorted(chosen)]
    columns = int(BYTES / (max(len(shown), 1) * LINES * 2 * BYTES_A_POINT))
    columns = min(columns, 450)
    parts = [_heading("Before and after", note)]
    for curve in shown:
        unit = _unit(diagnosis, curve.output)
        named = f"{curve.output}, {'held-out' if curve.held_out else 'fitted'} '{curve.record}'"
        axis = f"{curve.output} [{unit}]" if unit else curve.output
        judged = curve.measured == curve.measured
        nominal, extended = (
            Line(curve.times, curve.measured - y, name, colour)
            for y, name, colour in (
                (curve.nominal, "nominal model", BEFORE),
                (curve.extended, "extended model", AFTER),
            )
        )
        lines = [
            Line(curve.times, curve.measured, "measured", INK),
            Line(curve.times, _where(judged, curve.nominal), "nominal model", BEFORE),
            Line(curve.times, _where(judged, curve.extended), "extended model", AFTER),
        ]
        parts += [
            "<figure>",
            plot(lines, named, "time [s]", axis, columns),
            plot([nominal, extended], f"error of {named}", "time [s]", axis, columns),
            "</figure>",
        ]
    return parts


def _where(judged: Any, values: Any) -> Any:
    made = values.astype(float, copy=True)
    made[~judged] = float("nan")
    return made


def _left(diagnosis: Diagnosis) -> list[str]:
    verdict = diagnosis.verdict
    rows = [
        (
            f"{band.output}, {'held-out' if band.held_out else 'fitted'} '{band.record}'",
            words.left(band, _unit(diagnosis, band.output)),
        )
        for band in diagnosis.remaining
    ]
    told = (
        f"Beyond noise, the extended model leaves {words.percent(verdict.left)} of the nominal "
        f"model's error on the fitted records; {words.percent(verdict.predictable)} of what is "
        "left follows the motion, the rest looks like noise."
    )
    return [_heading("What is left, and where", told), _table(("output", "left"), rows, 2)]


def _catalogue(diagnosis: Diagnosis) -> list[str]:
    verdict, units = diagnosis.verdict, diagnosis.model.units
    said = {*verdict.named, *(c for group in verdict.groups for c in group)}
    rows = []
    for cause in sorted(diagnosis.model.causes, key=lambda c: -verdict.probability[c]):
        if cause in said:
            continue
        typical = ", ".join(
            f"{name} {words.quantity(value, units.get(name, ''))}"
            for name, value in diagnosis.typical.get(cause, {}).items()
        )
        blind = verdict.cannot_see.get(cause)
        seen = "yes" if blind is None else f"no: {words.number(max(blind, 0.0), 2)} nats expected"
        rows.append(
            (
                cause,
                verdict.refused.get(cause, "not needed"),
                words.probability(verdict.probability[cause]),
                typical,
                seen,
            )
        )
    if not rows:
        return []
    head = ("cause", "why it is not named", "probability", "typical size", "would it be seen?")
    told = (
        "Every other cause of the catalogue with the reason. The last column says whether these "
        "records would show it at its typical size, beside what was found."
    )
    return [_heading("What was not named, and why", told), _table(head, rows, 2)]


def _parameters(diagnosis: Diagnosis) -> list[str]:
    units = diagnosis.model.units
    before = {(n.record, n.name): n for n in diagnosis.nominal}
    rows = []
    for n in diagnosis.numbers:
        if n.cause:
            continue
        unit = units.get(n.name, "")
        value, span = words.spread(n, unit)
        name = f"{n.name}, start of '{n.record}'" if n.record else n.name
        plain = before.get((n.record, n.name))
        prior = diagnosis.model.parameters.get(n.name) or diagnosis.model.starts.get(n.name)
        if prior and words.undetermined(n, prior):
            span += ", not determined"
        rows.append(
            (
                name,
                words.known(prior) if prior else "nothing",
                words.spread(plain, unit)[0] if plain else "",
                value,
                span,
            )
        )
    if not rows:
        return []
    head = ("parameter", "known before", "nominal model", "extended model", "95 % interval")
    return [_heading("Parameters"), _table(head, rows)]


def _rates(rates: Any) -> list[str]:
    title = "How often this diagnosis is right"
    if rates is None:
        told = (
            "Not measured for this model and these channels: calibrate(model, ...) simulates "
            "machines without and with each cause, and tells the rates."
        )
        return [_heading(title, told)]
    return [_heading(title), _table(("rate", "value"), _flat(rates), 2)]


def _flat(data: Any, name: str = "") -> list[tuple[str, str]]:
    """Return nested data as rows of name and value."""
    if isinstance(data, dict):
        inner = {f"{name}, {key}" if name else str(key): value for key, value in data.items()}
        return [row for key, value in inner.items() for row in _flat(value, key)]
    return [(name, words.number(data) if isinstance(data, float) else str(data))]


def _made(diagnosis: Diagnosis, told: dict[str, Any]) -> list[str]:
    records = [
        (
            r["name"],
            "held out" if r["held_out"] else "fitted",
            (
                f"{r['samples']} samples in {words.number(r['seconds'])} s, "
                f"every {words.number(r['period'])} s"
            ),
            ", ".join(f"{c} [{u}]" if u else c for c, u in r["channels"].items()),
            r["sha256"][:12],
        )
        for r in told["records"]
    ]
    made_by = f"balance_diagnosis {told['library']}, {told['model_calls']} model calls"
    constants = ", ".join(f"{k} {words.number(v)}" for k, v in told["constants"].items())
    parts = [
        _heading("How it was made"),
        f"<p><code>{html.escape(told['call'])}</code><br>{html.escape(made_by)}</p>",
        _table(("record", "", "length", "channels", "sha256"), records, 5),
        f"<p class='more'>Constants: {html.escape(constants)}.</p>",
    ]
    if told["failed_calls"]:
        rows = [(why, str(times)) for why, times in told["failed_calls"].items()]
        parts += ["<p>The model failed in some calls, which were left out:</p>"]
        parts.append(_table(("failure", "times"), rows))
    meaning = "".join(
        f"<dt>{html.escape(k)}</dt><dd>{html.escape(v)}</dd>" for k, v in words.GLOSSARY.items()
    )
    return [*parts, _heading("Words"), f"<dl>{meaning}</dl>"]
