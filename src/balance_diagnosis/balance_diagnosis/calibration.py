"""How often a diagnosis of a model with given channels is right: simulated specimens.

A specimen is the model with its parameters drawn within their tolerances, without a cause or with
one of visible size, and with an error like the one that the best set of causes leaves on the
records: its spectrum, at random phases.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from balance_diagnosis.constants import DEFAULT, Constants
from balance_diagnosis.diagnosis import Diagnosis, diagnose, nominal_fit
from balance_diagnosis.errors import BalanceError
from balance_diagnosis.model import Model
from balance_diagnosis.problem import Problem
from balance_diagnosis.record import Record

VISIBLE = 5.0
"""Size of a hidden cause, in typical ones."""

WITHIN = 2.0
"""Standard deviations within which a toleranced parameter is drawn: its tolerance."""


@dataclass(frozen=True)
class Rates:
    """Shares of simulated specimens.

    specimens: without a cause. named_falsely, clean, cannot_tell: of those. causes: by hidden
    cause, of ``hidden`` specimens each: named (alone or in a group), a wrong one named beside or
    instead, and unexplained. failed: specimens that no prediction or no diagnosis was got of.
    """

    specimens: int
    named_falsely: float
    clean: float
    cannot_tell: float
    hidden: int
    causes: Mapping[str, Mapping[str, float]]
    failed: int


def calibrate(
    model: Model,
    records: Sequence[Record],
    specimens: int = 20,
    hidden: int = 4,
    seed: int = 0,
    constants: Constants = DEFAULT,
) -> Rates:
    """Return how often ``diagnose`` is right about machines like this one, on records like these.

    specimens: without a cause. hidden: of each cause, at five times its typical size. It takes as
    many diagnoses. BalanceError where model or records are used wrongly.
    """
    if specimens < 1 or hidden < 0:
        raise BalanceError(f"calibrate: {specimens} specimens and {hidden} of each cause")
    found = diagnose(model, records, constants=constants)
    problem = Problem(model, records, constants)
    problem.learn(nominal_fit(problem))
    draw = np.random.default_rng(seed)
    none = [_judged(found, {}, draw, constants) for _ in range(specimens)]
    causes, lost = {}, sum(answer is None for answer in none)
    for name in model.causes if hidden else ():
        numbers = _visible(problem, name)
        answers = [_judged(found, numbers, draw, constants) for _ in range(hidden)]
        lost += sum(answer is None for answer in answers)
        causes[name] = _told([answer for answer in answers if answer is not None], name)
    words = [answer.verdict.word for answer in none if answer is not None]
    return Rates(
        specimens,
        _share(word in ("named", "ambiguous") for word in words),
        _share(word == "clean" for word in words),
        _share(word == "cannot tell" for word in words),
        hidden,
        causes,
        lost,
    )


def _told(answers: Sequence[Diagnosis], name: str) -> dict[str, float]:
    said = [{*a.verdict.named, *(c for g in a.verdict.groups for c in g)} for a in answers]
    beside = [{*a.verdict.named} - {name} for a in answers]
    return {
        "named": _share(name in names for names in said),
        "wrong": _share(bool(names) for names in beside),
        "unexplained": _share(a.verdict.word == "unexplained" for a in answers),
    }


def _share(which: Iterator[bool] | Sequence[bool]) -> float:
    flags = list(which)
    return sum(flags) / len(flags) if flags else float("nan")


def _visible(problem: Problem, name: str) -> dict[str, float]:
    """Return a cause's numbers at a visible size, within its bounds."""
    probed = problem.probed[name]
    numbers = dict(probed.start)
    for number in probed.cause.numbers:
        if number.name in probed.sizes:
            size = VISIBLE * (numbers[number.name] - number.off)
            numbers[number.name] = float(np.clip(number.off + size, number.low, number.high))
    return numbers


def _judged(
    found: Diagnosis, hidden: Mapping[str, float], draw: np.random.Generator, constants: Constants
) -> Diagnosis | None:
    """Return the diagnosis of one specimen, None where there is none."""
    model, values = found.model, dict(found.extended.values)
    for name, prior in model.parameters.items():
        if not prior.log and prior.scale < 0.5 * (prior.high - prior.low):
            values[name] = prior.value(float(np.clip(draw.standard_normal(), -WITHIN, WITHIN)))
    values |= {**model.off(), **hidden}
    try:
        made = [_like(found, record, values, draw) for record in found.fit]
        return diagnose(model, made, constants=constants)
    except (BalanceError, ArithmeticError, ValueError):
        return None


def _like(
    found: Diagnosis, record: Record, values: Mapping[str, float], draw: np.random.Generator
) -> Record:
    """Return a record of a specimen: its prediction, and an error like the one that was left."""
    starts = found.extended.starts.get(record.name, {})
    made = found.model.predicted({**values, **starts}, record).outputs
    left = found.predicted(record).outputs
    return record.replaced(
        {name: made[name] + another(record[name] - left[name], draw) for name in made}
    )


def another(error: np.ndarray, draw: np.random.Generator) -> np.ndarray:
    """Return an error (n,) of the same spectrum at random phases, NaN where ``error`` is."""
    known = np.isfinite(error)
    padded = np.where(known, error, 0.0) * np.sqrt(len(error) / max(known.sum(), 1))
    spectrum = np.abs(np.fft.rfft(padded))
    turned = spectrum * np.exp(2j * np.pi * draw.uniform(size=len(spectrum)))
    # The mean and Nyquist's line have no phase but a sign.
    turned[0] = spectrum[0] * draw.choice((-1.0, 1.0))
    if len(error) % 2 == 0:
        turned[-1] = spectrum[-1] * draw.choice((-1.0, 1.0))
    return np.where(known, np.fft.irfft(turned, len(error)), np.nan)
