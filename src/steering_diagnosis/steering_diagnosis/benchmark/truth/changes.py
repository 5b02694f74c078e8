"""What an effect of the truth is, and how it changes a specimen.

``size`` is the deviation that is drawn; what a diagnosis is judged by is ``equivalent``: the
library's parameter that describes the same thing, taken from the truth.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from steering_core.parameters import ParameterSet
from steering_diagnosis.benchmark.truth.specimen import Specimen

Change = Callable[[Specimen, ParameterSet, float], Specimen]
Equivalent = Callable[[float], dict[str, float]]
BOTH, OPEN, CLOSED = ("open_centre", "closed_centre"), ("open_centre",), ("closed_centre",)


@dataclass(frozen=True)
class TrueEffect:
    """A phenomenon as the truth has it.

    typical, largest: sizes [unit of the parameter]; signed: both signs are drawn. equivalent: size
    to the library's parameters that are judged, none where only the name can be. neutral: their
    values without the effect. kinds, loads: manoeuvres and loads on which it can act. formula: in
    words, with what differs from the library. catalogued: False for what it does not have.
    """

    name: str
    formula: str
    change: Change
    typical: float
    largest: float
    equivalent: Equivalent
    neutral: float = 0.0
    signed: bool = False
    systems: tuple[str, ...] = BOTH
    kinds: tuple[str, ...] = ()
    loads: tuple[str, ...] = ()
    catalogued: bool = True


def extra(name: str, scale: float = 1.0, **more: float) -> Change:
    """Return a change that sets one of the extras to ``scale`` times the size."""
    return lambda made, _, size: replace(made, extras={**made.extras, name: scale * size, **more})


def factor_extra(name: str) -> Change:
    """Return a change that makes one of the extras 1 + size."""
    return lambda made, _, size: replace(made, extras={**made.extras, name: 1.0 + size})


def factor(full: str) -> Change:
    """Return a change that makes a data sheet's value (1 + size) times the nominal one."""
    return lambda made, nominal, size: replace(
        made, sheet={**made.sheet, full: nominal[full] * (1.0 + size)}
    )


def more(full: str, sign: float = 1.0) -> Change:
    """Return a change that puts ``sign`` times the size onto the nominal value."""
    return lambda made, nominal, size: replace(
        made, sheet={**made.sheet, full: nominal[full] + sign * size}
    )


def exact(full: str) -> Change:
    """Return a change that takes away what the specimen differs in one value."""
    return lambda made, nominal, _: replace(made, sheet={**made.sheet, full: nominal[full]})


def sensor(row: int, column: int) -> Change:
    """Return a change of a sensor's gain (column 0) or offset (column 1)."""

    def change(made: Specimen, _: ParameterSet, size: float) -> Specimen:
        sensors = made.sensors.copy()
        sensors[row, column] = size + (1.0 if column == 0 else 0.0)
        return replace(made, sensors=sensors)

    return change


def aged(rows: tuple[int, ...], stages: int = 4) -> Change:
    """Return a change that makes measured values old by ``size`` seconds, in so many lags."""

    def change(made: Specimen, _: ParameterSet, size: float) -> Specimen:
        delays = made.delays.copy()
        delays[list(rows)] = size, stages
        return replace(made, delays=delays)

    return change


def several(*changes: Change) -> Change:
    """Return a change that makes several with the same size."""

    def change(made: Specimen, nominal: ParameterSet, size: float) -> Specimen:
        for one in changes:
            made = one(made, nominal, size)
        return made

    return change


def same(parameter: str, neutral: float = 0.0) -> Equivalent:
    """Return the size itself, beyond ``neutral``, as the library's parameter."""
    return lambda size: {parameter: neutral + size}


def name_only(_: float) -> dict[str, float]:
    """Return nothing: no parameter of the library describes the same thing."""
    return {}
