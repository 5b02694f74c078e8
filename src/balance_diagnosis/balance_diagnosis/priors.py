"""What is known of a number before the fit: bounds, or a nominal value with its tolerance."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from balance_diagnosis.errors import BalanceError

WIDE = 10.0
"""Ratio of positive bounds from which the scale of a quantity is its logarithm."""

REACH = 4.0
"""Tolerances within which a toleranced parameter is looked for; its prior is much narrower."""

LEAST_SHARE = 0.02
"""Of a positive nominal value: what is positive stays so."""


@dataclass(frozen=True)
class Prior:
    """A normal prior, cut at bounds, of a number or of its logarithm.

    centre, scale: of the number or of its logarithm. low, high, nominal: of the number itself.
    """

    centre: float
    scale: float
    low: float
    high: float
    log: bool = False

    @property
    def nominal(self) -> float:
        """The value at the prior's centre."""
        return self.value(0.0)

    @property
    def limits(self) -> tuple[float, float]:
        """Bounds in standard deviations from the centre."""
        return self.place(self.low), self.place(self.high)

    def value(self, x: float) -> float:
        """Return the number that lies x standard deviations from the centre, within bounds."""
        scaled = self.centre + self.scale * x
        number = math.exp(scaled) if self.log else scaled
        return min(max(number, self.low), self.high)

    def place(self, value: float) -> float:
        """Return where a number lies, in standard deviations from the centre."""
        return ((math.log(value) if self.log else value) - self.centre) / self.scale


def between(low: float, high: float) -> Prior:
    """Return the prior of a parameter of which only bounds are known.

    Half their distance is its standard deviation, so that all between them is nearly as likely;
    positive bounds that differ by a factor of ten or more are taken on a logarithmic scale.
    """
    _finite(low, high)
    if not low < high:
        raise BalanceError(f"between({low:g}, {high:g}): the first bound has to be the lower one")
    log = low > 0.0 and high / low >= WIDE
    a, b = (math.log(low), math.log(high)) if log else (low, high)
    return Prior(0.5 * (a + b), 0.5 * (b - a), float(low), float(high), log)


def toleranced(
    nominal: float,
    share: float | None = None,
    *,
    plus_minus: float | None = None,
    low: float | None = None,
    high: float | None = None,
) -> Prior:
    """Return the prior of a parameter with a nominal value and a tolerance.

    share: tolerance over the nominal value; plus_minus: the tolerance itself, where the nominal
    value is zero. It is taken for two standard deviations. low, high: physical bounds.
    """
    if (share is None) == (plus_minus is None):
        raise BalanceError(f"toleranced({nominal:g}): give a share, or plus_minus, and not both")
    _finite(nominal, *(v for v in (share, plus_minus, low, high) if v is not None))
    tolerance = abs(nominal) * share if share is not None else float(plus_minus or 0.0)
    if not tolerance > 0.0:
        raise BalanceError(f"toleranced({nominal:g}): its tolerance has to be above zero")
    least = LEAST_SHARE * nominal if nominal > 0.0 else -np.inf
    a = max(nominal - REACH * tolerance, least) if low is None else low
    b = nominal + REACH * tolerance if high is None else high
    if not a < nominal < b:
        raise BalanceError(f"toleranced({nominal:g}): the bounds {a:g} to {b:g} exclude it")
    return Prior(float(nominal), 0.5 * tolerance, float(a), float(b))


def _finite(*values: float) -> None:
    for value in values:
        if not isinstance(value, int | float) or not math.isfinite(value):
            raise BalanceError(f"a parameter's bound, value or tolerance is {value}, not a number")
