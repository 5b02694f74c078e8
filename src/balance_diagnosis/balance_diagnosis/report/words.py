"""What was found, in plain words. Numbers come with their units and intervals."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from balance_diagnosis.diagnosis import Diagnosis
from balance_diagnosis.intervals import Estimate
from balance_diagnosis.model import Model
from balance_diagnosis.priors import Prior
from balance_diagnosis.remaining import Band
from balance_diagnosis.verdicts import (
    AMBIGUOUS,
    CANNOT_TELL,
    CLEAN,
    NAMED,
    PROBABLE,
    UNEXPLAINED,
    Verdict,
)

MEANING = {
    NAMED: "What the model lacks is named, and the records leave no reasonable doubt.",
    AMBIGUOUS: "Something is missing in the model, and the records cannot tell which of a few "
    "causes it is.",
    PROBABLE: "Something is probably missing in the model, but the records do not make it sure.",
    CLEAN: "The model explains the records within its tolerances, and each cause of the catalogue "
    "would have been seen at its typical size.",
    CANNOT_TELL: "No cause is needed to explain the records, but some would not have been seen "
    "either.",
    UNEXPLAINED: "The model lacks something that is not in the catalogue: what no cause explains "
    "is no noise, it follows the motion.",
}
"""Verdict to what it means."""

GLOSSARY = {
    "nominal model": "the model without any cause, its parameters fitted within their tolerances",
    "extended model": "the same with the causes that were found",
    "cause": "something that may be wrong in the model, and that is off in the nominal model",
    "95 % interval": "where the true number lies in 19 of 20 cases, if the extended model is right",
    "probability": "how sure it is that the cause is there, all sets of causes that were tried "
    "taken together",
    "nats": "what evidence is counted in: 3 nats more are 20 times more likely, 5 nats 150 times",
    "typical size": "the size at which a cause changes an output by a twentieth of what it varies",
    "held out": "a record that took no part in the fit nor in the choice of causes; it only tells "
    "what the extended model gains",
    "refitted": "all parameters were fitted anew beside the cause, before it was judged",
    "at its bound": "the best size lies at the end of the bounds that were given: they are too "
    "narrow, or the cause is a stand-in for another one",
    "error": "measured minus predicted",
}
"""Words of the page and what they mean."""


BOUND = 1e-4
"""Share of a number's bounds within which it stands at one of them."""

MOST_DIGITS = 8

BETWEEN = 2.5
"""Standard deviations between the bounds of a prior, below which it says no more than these."""

PRIOR_WIDTH = 2.0 * 1.96
NO_BETTER = 0.9
"""Width of a normal prior's 95 % interval, and the share of it that is no gain of knowledge."""

UNEVEN = 0.2
"""Share of the energy in one tenth of a record from which it is told where that is."""

PLAIN = 1e6
"""Up to here a number is written without an exponent."""


def number(value: float, digits: int = 3) -> str:
    """Return a number as a person writes it, with a true minus sign: 1240, 0.0012, 3.1e−7."""
    if not math.isfinite(value):
        return "none"
    text = f"{value:.{digits}g}"
    if "e+" in text and abs(value) < PLAIN:
        text = f"{float(text):.0f}"
    return text.replace("-", "−")


def quantity(value: float, unit: str) -> str:
    """Return a number with its unit."""
    return number(value) + (f" {unit}" if unit else "")


def percent(share: float) -> str:
    """Return a share in per cent; what is nearly none or nearly all is said so."""
    if not math.isfinite(share):
        return "none"
    if 0.0 < share < 0.001:
        return "below 0.1 %"
    if 0.999 < share < 1.0:
        return "above 99.9 %"
    return f"{100.0 * share:.3g} %"


def probability(value: float) -> str:
    """Return a probability; no finite number of records makes it 0 or 1."""
    if value > 0.999:
        return "above 0.999"
    return "below 0.001" if value < 0.001 else f"{value:.3f}"


def size(estimate: Estimate, model: Model) -> str:
    """Return a number of a cause with its interval: "offset 3.1 N, 95 % within 2.9 to 3.3 N"."""
    value, span = spread(estimate, model.units.get(estimate.name, ""))
    told = f"{estimate.name} {value}, 95 % within {span}"
    return told + (", at its bound" if at_bound(estimate, model) else "")


def spread(estimate: Estimate, unit: str) -> tuple[str, str]:
    """Return a value and its interval with as many digits as the interval's width is worth."""
    width, largest = estimate.high - estimate.low, max(abs(estimate.low), abs(estimate.high))
    digits = 3
    if width > 0.0 and math.isfinite(largest):
        digits = min(max(digits, 2 + math.floor(math.log10(largest / width))), MOST_DIGITS)
    value, low, high = (number(v, digits) for v in (estimate.value, estimate.low, estimate.high))
    end = f" {unit}" if unit else ""
    return value + end, f"{low} to {high}{end}"


def at_bound(estimate: Estimate, model: Model) -> bool:
    """Return whether a number of a cause lies at an end of its bounds where it is not off."""
    numbers = model.causes[estimate.cause].numbers if estimate.cause in model.causes else ()
    for n in numbers:
        if n.name == estimate.name:
            near = BOUND * (n.high - n.low)
            ends = [end for end in (n.low, n.high) if abs(end - n.off) > near]
            return any(abs(estimate.value - end) <= near for end in ends)
    return False


def listed(names: Sequence[str], last: str = "and") -> str:
    """Return names as a person lists them."""
    if len(names) < 2:
        return "".join(names)
    return f"{', '.join(names[:-1])} {last} {names[-1]}"


def sentence(diagnosis: Diagnosis) -> str:
    """Return the answer in one or two sentences."""
    verdict = diagnosis.verdict
    parts = []
    if verdict.named:
        parts.append(f"Named: {_sized(diagnosis, verdict.named)}.")
    parts += [
        f"One of these is there, and the records cannot tell which: {listed(group, 'or')}."
        for group in verdict.groups
    ]
    if verdict.word == PROBABLE:
        likely = max(verdict.probability, key=lambda c: verdict.probability[c])
        told = probability(verdict.probability[likely])
        parts.append(f"Probably {likely} (probability {told}), but not surely.")
    if verdict.word == UNEXPLAINED:
        parts.append(
            f"The best causes leave {percent(verdict.left)} of the nominal model's error, and "
            f"{percent(verdict.predictable)} of that follows the motion."
        )
        if verdict.candidates:
            parts.append(f"Candidates, none of them sure: {listed(verdict.candidates)}.")
    if verdict.word == CLEAN:
        parts.append(f"No cause is needed (probability {probability(verdict.none)}).")
    if verdict.word == CANNOT_TELL:
        parts.append(f"No cause is needed (probability {probability(verdict.none)}).")
        parts += _blind(verdict)
    return " ".join(parts)


def known(prior: Prior) -> str:
    """Return what was known of a number before: "95 ± 19", or its bounds."""
    low, high = prior.limits
    if high - low <= BETWEEN:
        return f"{number(prior.low)} to {number(prior.high)}"
    return f"{number(prior.nominal)} ± {number(2.0 * prior.scale)}"


def undetermined(estimate: Estimate, prior: Prior) -> bool:
    """Return whether the records tell no more of a number than was known before."""
    if prior.log and estimate.low <= 0.0:
        return True
    low, high = prior.limits
    width = prior.place(estimate.high) - prior.place(estimate.low)
    return bool(width > NO_BETTER * min(high - low, PRIOR_WIDTH))


def gained(diagnosis: Diagnosis, units: Mapping[str, str]) -> str:
    """Return how the errors change, over all held-out records, or the fitted ones without these.

    units: of outputs. Empty where no cause was found.
    """
    if not diagnosis.causes:
        return ""
    held = any(g.held_out for g in diagnosis.gains)
    told = [g for g in diagnosis.gains if g.held_out == held]
    parts = []
    for output in dict.fromkeys(g.output for g in told):
        mine = [g for g in told if g.output == output]
        before, after = (
            math.sqrt(sum(v**2 for v in errors) / len(mine))
            for errors in ([g.nominal for g in mine], [g.extended for g in mine])
        )
        worse = sum(g.extended > g.nominal for g in mine)
        how = "falls" if after < before else "grows"
        parts.append(
            f"{output} {how} from {number(before)} to {quantity(after, units.get(output, ''))}"
            + (f" (worse on {worse} of {len(mine)} records)" if worse and len(mine) > 1 else "")
        )
    which = "held-out" if held else "fitted"
    return f"On {which} data the rms error of {'; of '.join(parts)}."


def left(band: Band, unit: str) -> str:
    """Return what is left of an output of a record, and where."""
    kept = (
        f"{percent(band.share)} of the nominal model's error energy"
        if band.share <= 1.0
        else "more than the nominal model's error"
    )
    where = (
        f"{percent(band.part)} of it between {number(band.start)} and {number(band.stop)} s"
        if band.part > UNEVEN
        else "spread over the whole record"
    )
    return (
        f"{quantity(band.rms, unit)} rms, {kept}; its middle half lies between "
        f"{number(band.low)} and {number(band.high)} Hz; {where}"
    )


def _sized(diagnosis: Diagnosis, causes: Sequence[str]) -> str:
    model, found = diagnosis.model, diagnosis.causes
    return "; ".join(
        f"{cause} ({', '.join(size(e, model) for e in found.get(cause, {}).values())})"
        for cause in causes
    )


def _blind(verdict: Verdict) -> list[str]:
    if not verdict.cannot_see:
        return []
    return [f"At their typical size these would not be seen: {listed(list(verdict.cannot_see))}."]
