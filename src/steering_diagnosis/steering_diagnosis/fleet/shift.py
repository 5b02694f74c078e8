"""What toleranced parameters of several specimens have in common. Pure.

A specimen's parameters z [standard deviations of the tolerance] scatter about a common mean mu:
z ~ N(mu, I). Its record says z ~ N(m, C) under the tolerances as prior: by itself it has
the information J = C^-1 - I. Without z its mean is known with (J^-1 + I)^-1 = I - C, and
(I - C) mu is expected where m was found (Gelman et al.: Bayesian Data Analysis, 5.4).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats

from steering_diagnosis.report import Learned

FREE = 10.0
"""Standard deviation of a common shift before the records [deviations of a specimen]: any."""

FALSE_ALARM = 0.01
"""Of a whole fleet without any shift: that some parameter is called shifted."""

TOLD = 0.1
"""Share of what records could tell of a parameter at most, from which it is judged."""


@dataclass(frozen=True)
class Shift:
    """A parameter's mean over the fleet. mean, sd: standard deviations of a specimen from nominal.

    scatter: of the specimens about the mean, over that of the tolerance; NaN where little is told.
    judged: whether the records tell enough. common: whether the mean is not the data sheet's.
    """

    name: str
    nominal: float
    deviation: float
    mean: float
    sd: float
    scatter: float
    judged: bool
    common: bool

    @property
    def value(self) -> float:
        """The fleet's mean in the parameter's unit."""
        return self.nominal + self.mean * self.deviation


def shifts(members: Sequence[Learned], alone: Sequence[frozenset[str]] = ()) -> list[Shift]:
    """Return the mean of every parameter, the most certain shifts first.

    alone: of each member, parameters in which it has a cause of its own: it says nothing of these.
    """
    names = list(dict.fromkeys(name for member in members for name in member.names))
    at = {name: i for i, name in enumerate(names)}
    weight, found = np.eye(len(names)) / FREE**2, np.zeros(len(names))
    each = []
    for member, own in zip(members, alone or [frozenset()] * len(members), strict=True):
        place = np.array([at[name] for name in member.names])
        told = np.array([name not in own for name in member.names], float)
        w = (np.eye(len(place)) - np.array(member.covariance)) * np.outer(told, told)
        m = np.array(member.mean) * told
        weight[np.ix_(place, place)] += w
        found[place] += m
        each.append((place, w, m))
    cov = np.linalg.inv(weight)
    mean = cov @ found
    critical = stats.norm.isf(0.5 * FALSE_ALARM / max(len(names), 1))
    squares, expected = np.zeros(len(names)), np.zeros(len(names))
    for place, w, m in each:
        squares[place] += (m - w @ mean[place]) ** 2
        expected[place] += np.diag(w)
    table = {
        n: (v, d) for x in members for n, v, d in zip(x.names, x.nominal, x.deviation, strict=True)
    }
    result = []
    for i, name in enumerate(names):
        sd = float(np.sqrt(cov[i, i]))
        judged = bool(expected[i] > TOLD * len(members))
        scatter = float(np.sqrt(squares[i] / expected[i])) if judged else float("nan")
        common = judged and bool(abs(mean[i]) > critical * sd)
        result.append(Shift(name, *table[name], float(mean[i]), sd, scatter, judged, common))
    return sorted(result, key=lambda s: -abs(s.mean) / s.sd)
