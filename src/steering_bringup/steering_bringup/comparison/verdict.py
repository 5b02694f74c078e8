"""The comparison in one sentence, and how its key numbers stand against the source's."""

from __future__ import annotations

from dataclasses import dataclass

from steering_bringup.bags import Trace
from steering_bringup.comparison.result import Comparison
from steering_bringup.comparison.signals import Signal

LIMITS = {"assistance_pressure": 1.0e5, "steering_wheel_torque": 0.1}
"""Largest differences of closed-centre from open-centre, on-centre, SI (figs 8.2 and 8.4)."""

TOLD: tuple[str, ...] = ("assistance_pressure", "steering_wheel_torque")
"""What a comparison of two gears is about."""


@dataclass(frozen=True)
class Verdict:
    """`good` is None where there is no limit to judge by."""

    sentence: str
    good: bool | None


def limit(result: Comparison, key: str) -> float | None:
    """The limit of a signal's difference, SI; None if the pair is not the one it was set for."""
    if set(result.systems) != {"open-centre", "closed-centre"} or not result.of_runs:
        return None
    if situation(result) != "on-centre":
        return None
    return LIMITS.get(key)


def verdict(result: Comparison) -> Verdict:
    """One sentence a person can repeat, with the judgement behind it."""
    first, second = result.names
    if result.identical:
        return Verdict(f"{first} and {second} are the same run, bit for bit.", True)
    parts, within = [], []
    for key in told(result):
        text, good = _part(result, key)
        parts.append(text)
        within.append(good)
    judged = [good for good in within if good is not None]
    opening = _opening(result, all(judged) if judged else None)
    sentence = f"{opening}: they differ in {' and in '.join(parts)}" if parts else opening
    if result.of_runs:  # The name of a file keeps its letters.
        sentence = sentence[:1].upper() + sentence[1:]
    return Verdict(sentence + _growth_text(result) + ".", all(judged) if judged else None)


def told(result: Comparison) -> list[str]:
    """The signals that the sentence names: the two that matter, else the first two there are."""
    there = list(result.differences)
    matter = [key for key in TOLD if key in there]
    return matter or there[:2]


def _opening(result: Comparison, good: bool | None) -> str:
    first, second = result.names
    if good is None:
        return f"{second} against {first}"
    if good:
        return f"The {second} system steers like the {first} one"
    return f"The {second} system comes close to the {first} one, but not within its limits"


def _part(result: Comparison, key: str) -> tuple[str, bool | None]:
    signal, bound = result.kinds[key], limit(result, key)
    value = result.differences[key].largest
    text = f"{lowered(signal)} by at most {shown(signal, value)} {signal.shown_unit}".rstrip()
    if bound is None:
        return text, None
    return f"{text} (limit {bound * signal.scale:g} {signal.shown_unit})", value <= bound


def _growth_text(result: Comparison) -> str:
    item = result.growths.get("steering_wheel_torque")
    if item is None:
        return ""
    if item.with_frequency_only:
        return "; the torque difference grows with frequency only"
    return "; the torque difference does not come from frequency alone"


def shown(signal: Signal, value: float) -> str:
    """A value in the unit and with the digits of its signal."""
    scaled = value * signal.scale
    return f"{scaled:.5g}" if signal.digits is None else f"{scaled:.{signal.digits}f}"


def lowered(signal: Signal) -> str:
    """A signal's title within a sentence; a topic's name keeps its letters."""
    return signal.title if signal.digits is None else signal.title.lower()


def situation(result: Comparison) -> str:
    """What both runs say they are: "on-centre" (also if they do not say), "dry park", or ""."""
    kinds = {(_kind(trace, "manoeuvre"), _kind(trace, "load")) for trace in result.traces}
    if all(m in ("", "on_centre") and load in ("", "bicycle") for m, load in kinds):
        return "on-centre"
    return "dry park" if all(load == "dry_park" for _, load in kinds) else ""


def _kind(trace: Trace, part: str) -> str:
    """`kind` of a part of the scenario that a run was made with; empty if it does not say."""
    scenario = trace.run.get("scenario")
    found = scenario.get(part) if isinstance(scenario, dict) else None
    return str(found.get("kind", "")) if isinstance(found, dict) else ""
