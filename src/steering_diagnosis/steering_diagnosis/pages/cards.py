"""The key numbers of the first screen: cause, size, certainty, gain."""

from __future__ import annotations

from steering_bringup.pages import Card
from steering_diagnosis.pages.shown import number, percent, quantity, unit, words
from steering_diagnosis.report import Cause, Report


def cards_of(report: Report) -> list[Card]:
    """Return one card a cause with its first parameter, then the gain and what is unexplained."""
    found = [_cause(cause) for cause in report.causes]
    if report.causes:
        found.append(_gain(report))
    for part in report.unexplained[:1]:
        band = f"{part.band_hz[0]:.3g} to {part.band_hz[1]:.3g} Hz, {part.region}"
        found.append(Card(f"Unexplained: {part.balance}", percent(part.share), remark=band))
    return found


def _cause(cause: Cause) -> Card:
    name, estimate = next(iter(cause.parameters.items()))
    span = f"95 % within {number(estimate.low, estimate.unit)} to "
    span += quantity(estimate.high, estimate.unit)
    title = words(cause.effect)
    if cause.ambiguous_with:
        title += " or " + " or ".join(words(other) for other in cause.ambiguous_with)
    shown = unit(estimate.unit)
    return Card(
        f"{title}: {words(name)}",
        number(estimate.value, estimate.unit),
        "" if shown == "1" else shown,
        span,
    )


def best_gain(report: Report) -> tuple[str, float] | None:
    """Return the signal with the largest share of error energy removed, and that share."""
    shares: dict[str, float] = {}
    for name, signal in report.signals.items():
        before = signal.rmse_refitted_holdout**2 - signal.noise_holdout**2
        after = signal.rmse_extended_holdout**2 - signal.noise_holdout**2
        if before > 0.1 * signal.noise_holdout**2:
            shares[name] = 1.0 - max(after, 0.0) / before
    if not shares:
        return None
    name = max(shares, key=lambda key: shares[key])
    return name, shares[name]


def _gain(report: Report) -> Card:
    best = best_gain(report)
    where = "hold-out record" if report.holdout else "held-out blocks"
    if best is None:
        return Card("Gain on held-out data", "none", remark="no signal stands above its noise")
    name, share = best
    remark = f"of {words(name)}'s error above the noise is gone, {where}"
    return Card("Gain on held-out data", percent(share), remark=remark, good=share >= 0.8)
