"""The tables: gains, balances, rivals, refitted parameters."""

from __future__ import annotations

from collections.abc import Iterable

from steering_bringup.pages import folded, table
from steering_diagnosis.pages.shown import number, percent, probability, quantity, unit, words
from steering_diagnosis.report import Diagnosis, Report, Signal


def causes_table(report: Report) -> str:
    """Every parameter of every cause with its interval, and how certain the cause is."""
    rows = [
        (
            words(cause.effect),
            cause.balance,
            words(name),
            quantity(estimate.value, estimate.unit),
            f"{number(estimate.low, estimate.unit)} to {quantity(estimate.high, estimate.unit)}",
            probability(cause.p_value),
            f"{cause.delta_bic:.0f}",
        )
        for cause in report.causes
        for name, estimate in cause.parameters.items()
    ]
    head = ("Cause", "Balance", "Parameter", "Estimate", "95 % interval", "p, family-wise", "dBIC")
    return table(head, rows, left_columns=3)


def signals_table(report: Report) -> str:
    """Errors of every signal before and after, fitted and held out."""
    rows = [(words(name), unit(s.unit), *_errors(s)) for name, s in report.signals.items()]
    head = (
        "Signal",
        "Unit",
        "Noise",
        "Nominal",
        "Refitted",
        "Extended",
        "Refitted, held out",
        "Extended, held out",
        "Error above noise gone",
    )
    return table(head, rows, left_columns=2)


def _errors(s: Signal) -> Iterable[str]:
    values = (
        s.noise,
        s.rmse_nominal,
        s.rmse_refitted,
        s.rmse_extended,
        s.rmse_refitted_holdout,
        s.rmse_extended_holdout,
    )
    yield from (number(value, s.unit) for value in values)
    before = s.rmse_refitted_holdout**2 - s.noise_holdout**2
    after = max(s.rmse_extended_holdout**2 - s.noise_holdout**2, 0.0)
    small = before <= 0.1 * s.noise_holdout**2
    yield "within noise" if small else percent(1.0 - after / before)


def balances_table(diagnosis: Diagnosis) -> str:
    """Where the error's energy enters."""
    rows = [
        (error.balance, percent(error.share), f"{error.above_noise:.2g}")
        for error in sorted(diagnosis.balances, key=lambda e: -e.share)
    ]
    return table(("Balance", "Share of the error's energy", "Times its noise"), rows)


def rivals_table(report: Report) -> str:
    """Every rival with its score and why it lost."""
    rows = [(words(r.effect), r.why_not, f"{r.score:.3g}") for r in report.rivals]
    return table(("Rival", "Why not", "Score"), rows, left_columns=2)


def undecidable_table(report: Report) -> str:
    """What this record cannot decide, and why."""
    rows = [(words(name), why) for name, why in report.undecidable.items()]
    return table(("Effect", "Why it cannot be decided"), rows, left_columns=2)


AT_ITS_END = 0.99
"""Share of a tolerance beyond which the fit would have gone on."""


def tolerance_used(report: Report) -> dict[str, float]:
    """Return the share of its tolerance that each nominal parameter was moved by, signed."""
    return {
        name: (entry.refitted - entry.nominal) / entry.tolerance if entry.tolerance else 0.0
        for name, entry in report.nuisance.items()
    }


def at_their_end(report: Report) -> str:
    """Return a sentence on parameters that the refit took to the end of their tolerance, or ''."""
    names = [name for name, share in tolerance_used(report).items() if abs(share) > AT_ITS_END]
    if not names:
        return ""
    return (
        f"at the end of their tolerance: {', '.join(names)}; the record may want more than the "
        "data sheet allows, or tell little of them"
    )


def nuisance_table(report: Report) -> str:
    """Nominal parameters after the refit, by how much of their tolerance they used."""
    used = tolerance_used(report)
    rows = [
        (
            name,
            f"{report.nuisance[name].nominal:.4g}",
            f"{report.nuisance[name].refitted:.4g}",
            f"{share:+.2f}" + (" (at its end)" if abs(share) > AT_ITS_END else ""),
        )
        for name, share in sorted(used.items(), key=lambda item: -abs(item[1]))
    ]
    head = ("Parameter (SI)", "Nominal", "Refitted", "Share of tolerance used")
    return folded(
        f"Nominal parameters, refitted inside their tolerances ({len(rows)})", table(head, rows)
    )
