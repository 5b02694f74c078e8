"""Sizes of a cause that add nothing are none: an asymmetry may be viscous, dry, or both."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from steering_diagnosis.engine.catalogue import scales
from steering_diagnosis.engine.failures import NUMERICAL
from steering_diagnosis.engine.fit import Fit, Problem, refit


def parsimonious(problem: Problem, best: Fit) -> tuple[Problem, Fit]:
    """Return the model whose every size is worth its place by the information criterion.

    The problem returned keeps the sizes that are none at neutral. A cause keeps one size at least,
    and every size without which it cannot be replayed.
    """
    for name in sorted(best.names):
        free = _amplitudes(problem, best, name)
        for i in free[: len(free) - 1]:
            held = replace(problem, frozen=problem.frozen | {(name, i)})
            value = best.values[name].copy()
            value[i] = problem.book.hypotheses[name].parameters[i].neutral
            try:
                trial = refit(held, best.z, {**best.values, name: value})
            except NUMERICAL:
                continue
            if trial.misfit - best.misfit < np.log(max(best.noise.count.max(), 2.0)):
                problem, best = held, trial
    return problem, best


def _amplitudes(problem: Problem, best: Fit, name: str) -> list[int]:
    """Return the positions of a cause's sizes, shapes left out, smallest first."""
    h = problem.book.hypotheses[name]
    unit = np.abs(best.values[name] - [p.neutral for p in h.parameters]) / scales(h)
    return sorted((i for i, p in enumerate(h.parameters) if not p.shape), key=lambda i: unit[i])
