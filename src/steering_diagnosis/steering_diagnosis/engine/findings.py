"""What the engine found: the inference's whole answer, before it becomes a report."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from steering_diagnosis.engine.evidence import Evidence
from steering_diagnosis.engine.intervals import Interval
from steering_diagnosis.engine.model import Hypothesis, Nuisance, Output
from steering_diagnosis.engine.structure import FreeForm
from steering_diagnosis.report import Verdict


@dataclass(frozen=True)
class NamedCause:
    """A cause that is named. gain: output to share of held-out error energy removed."""

    hypothesis: Hypothesis
    parameters: Mapping[str, Interval]
    evidence: Evidence
    ambiguous_with: tuple[str, ...]
    separating: str | None
    gain: Mapping[str, float]


@dataclass(frozen=True)
class Loser:
    """A hypothesis that is not named. score: gain of its likelihood ratio, alone or as a rival."""

    hypothesis: str
    score: float
    why_not: str


@dataclass(frozen=True)
class Region:
    """Structure without a name. share: of the output's error energy above the noise."""

    balance: str
    output: str
    band_hz: tuple[float, float]
    region: str
    share: float
    where: str
    """The fitted record or the held-out one."""


@dataclass(frozen=True)
class Rms:
    """Root mean squares of one output [unit]: noise, and errors of the three models."""

    noise: float
    nominal: float
    refitted: float
    extended: float


@dataclass(frozen=True, repr=False)
class Findings:
    """The engine's answer.

    nuisances, effects: absolute parameters of the extended model, as ``Replay.residuals`` takes
    them; refitted: of the nominal model refitted inside tolerance. residuals: on the decimated
    grid of the fitted record, (n, outputs) each. undecidable: hypothesis to reason.
    step, spread: from the fit to the posterior's mean, and its covariance: of the nuisances
    [standard deviations of a specimen] in the order of ``catalogue``, and behind them of the
    parameters [units] of the active hypotheses ``active``.
    """

    verdict: Verdict
    causes: tuple[NamedCause, ...]
    unexplained: tuple[Region, ...]
    losers: tuple[Loser, ...]
    free_form: FreeForm | None
    outputs: tuple[Output, ...]
    catalogue: tuple[Nuisance, ...]
    refitted: Mapping[str, float]
    nuisances: Mapping[str, float]
    effects: Mapping[str, Mapping[str, float]]
    fitted: Mapping[str, Rms]
    held_out: Mapping[str, Rms]
    undecidable: Mapping[str, str]
    explained: float
    calls: int
    step_s: float
    step: np.ndarray
    spread: np.ndarray
    active: tuple[tuple[str, str], ...]
    held_out_samples: np.ndarray
    residual_nominal: np.ndarray
    residual_refitted: np.ndarray
    residual_extended: np.ndarray
    notes: tuple[str, ...] = field(default=())
