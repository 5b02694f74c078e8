"""What the engine needs of a model: predicted channels, nuisance parameters, and hypotheses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np


@dataclass(frozen=True)
class Output:
    """A predicted channel: residual = measured - predicted. balance: where its error enters."""

    name: str
    unit: str
    balance: str


@dataclass(frozen=True)
class Nuisance:
    """A nominal parameter that may differ within its tolerance.

    tolerance: two standard deviations of one specimen, absolute [unit]. low, high: its physical
    range, which holds the nominal value; the engine never asks the replay for a value beyond.
    """

    name: str
    unit: str
    nominal: float
    tolerance: float
    low: float = -np.inf
    high: float = np.inf


@dataclass(frozen=True)
class HypothesisParameter:
    """A parameter of a hypothesis, bounds and neutral value as in the effects' registry.

    typical: a visible size. shape: it has no meaning at the other parameters' neutral values (a
    gap, a delay, a Stribeck speed) and must be scanned. turn: values that differ by it are the
    same, 0: none are; the replay is asked for that within half of it about zero.
    """

    name: str
    unit: str
    neutral: float
    low: float
    high: float
    typical: float
    shape: bool = False
    turn: float = 0.0

    def turned(self, value: float) -> float:
        """Return by how much a value has to be less to be within half a turn about zero."""
        return self.turn * round(value / self.turn) if self.turn else 0.0


@dataclass(frozen=True)
class Hypothesis:
    """One physical cause.

    balance: where it acts. competes: nuisances that express the same thing within tolerance; it is
    named only beyond that. replaces: those of them that are the very same, and stay nominal where
    it is active: its own parameter is what they would be. excitation: what a record needs to show
    it. summary: for the report. separating: text of an experiment that tells it from what looks
    alike, where the effect knows. exact: its formula is the only one there is (an offset, a gain, a
    mass), so that a large one leaves nothing for others to fit.
    """

    name: str
    summary: str
    balance: str
    parameters: tuple[HypothesisParameter, ...]
    competes: tuple[str, ...] = ()
    replaces: tuple[str, ...] = ()
    excitation: str = ""
    separating: str = ""
    exact: bool = False

    @property
    def shapes_only(self) -> bool:
        """Whether it has no size that could be small, as a stop, a gap or a delay."""
        return all(p.shape for p in self.parameters)


Effects = Mapping[str, Mapping[str, float]]
"""Hypotheses that are on, with their parameters; absent ones are neutral."""


class Replay(Protocol):
    """A model bound to one record. Everything is on the record's grid, n samples.

    ``residuals`` must be deterministic and cheap: the engine calls it some hundred times.
    """

    @property
    def outputs(self) -> tuple[Output, ...]:
        """Predicted channels, the columns of the residuals."""

    @property
    def nuisances(self) -> tuple[Nuisance, ...]:
        """Nominal parameters with a tolerance."""

    @property
    def hypotheses(self) -> Mapping[str, Hypothesis]:
        """Causes by name."""

    @property
    def period_s(self) -> float:
        """Period of the record's grid [s]."""

    def residuals(self, nuisances: Mapping[str, float], effects: Effects) -> np.ndarray:
        """Return measured minus predicted, (n, outputs), SI; NaN where nothing was measured.

        nuisances: absolute values of those that differ from nominal. A model that cannot be
        replayed raises BenchError, ValueError, ArithmeticError, or gives NaN where the nominal one
        gives a number: see ``failures``.
        """

    def shaken(self, nuisances: Mapping[str, float], effects: Effects) -> np.ndarray:
        """Return what another draw of the inputs' noise changes in the residuals, (n, outputs).

        Arguments as for ``residuals``. Zeros where inputs have none. No model can explain that.
        """

    def noise(self) -> np.ndarray:
        """Return the standard deviation of each output's own noise in a sample, white, (outputs,).

        Zero where it has none, or where nothing is known of it.
        """

    def states(self) -> Mapping[str, np.ndarray]:
        """Return the signals that a free-form term may depend on, name [unit] to (n,)."""


@dataclass(frozen=True)
class Undecidable:
    """A hypothesis that this record cannot decide, and why."""

    hypothesis: str
    why: str
