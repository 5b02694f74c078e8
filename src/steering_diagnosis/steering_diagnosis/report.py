"""The report's data: ``report.json`` (docs/diagnosis.md) as a checked schema, and its evidence."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

Verdict = Literal["clean", "named", "ambiguous", "unexplained", "insufficient_excitation"]


class Part(BaseModel):
    """Base of all parts: unknown keys are refused, numbers are finite or None."""

    model_config = ConfigDict(
        extra="forbid", populate_by_name=True, allow_inf_nan=False, serialize_by_alias=True
    )


class Estimate(Part):
    """A parameter with its 95 % interval, SI."""

    value: float
    low: float
    high: float
    unit: str


class Cause(Part):
    """A named cause. ``gain``: signal to share of held-out error energy above the noise removed."""

    effect: str
    ambiguous_with: list[str] = Field(default_factory=list, max_length=2)
    separating_experiment: str | None = None
    balance: str
    parameters: dict[str, Estimate]
    p_value: float
    delta_bic: float
    gain: dict[str, float]


class Unexplained(Part):
    """Structure that no hypothesis explains; ``share`` of the error energy above the noise."""

    balance: str
    band_hz: tuple[float, float]
    region: str
    share: float


class Rival(Part):
    """A hypothesis that lost, and why."""

    effect: str
    score: float
    why_not: str


class Refitted(Part):
    """A nominal parameter after the refit inside its tolerance (absolute)."""

    nominal: float
    refitted: float
    tolerance: float


class Signal(Part):
    """Errors of one signal on the fitted record and on the held-out data, root mean square, SI.

    noise_holdout: with what sensors drift between the two, which no cause takes away.
    """

    unit: str
    noise: float
    rmse_nominal: float
    rmse_refitted: float
    rmse_extended: float
    noise_holdout: float
    rmse_nominal_holdout: float
    rmse_refitted_holdout: float
    rmse_extended_holdout: float


class Source(Part):
    """Where data came from."""

    path: str
    sha256: str


class Learned(Part):
    """What a record tells of the toleranced parameters: their posterior under the tolerances.

    deviation: one standard deviation of a specimen, half the tolerance (absolute). mean (p,) and
    covariance (p, p): in these deviations from nominal. changed_by: parameter to the named effects
    that are in it.
    """

    names: list[str]
    nominal: list[float]
    deviation: list[float]
    mean: list[float]
    covariance: list[list[float]]
    changed_by: dict[str, list[str]] = Field(default_factory=dict)


class Report(Part):
    """``report.json``, schema 1."""

    schema_version: Literal[1] = Field(1, alias="schema")
    bag: Source
    holdout: Source | None = None
    software: str
    valve_system: str = ""
    verdict: Verdict
    sentence: str
    causes: list[Cause] = Field(default_factory=list)
    unexplained: list[Unexplained] = Field(default_factory=list)
    undecidable: dict[str, str] = Field(default_factory=dict)
    rivals: list[Rival] = Field(default_factory=list)
    nuisance: dict[str, Refitted] = Field(default_factory=dict)
    learned: Learned | None = None
    signals: dict[str, Signal] = Field(default_factory=dict)
    suspicions: list[str] = Field(default_factory=list)
    notes: list[str] = Field(default_factory=list)


@dataclass(frozen=True, repr=False)
class Overlay:
    """One channel's curves on the record's grid, (n,), SI: what the picture shows."""

    unit: str
    measured: np.ndarray
    nominal: np.ndarray
    refitted: np.ndarray
    extended: np.ndarray


@dataclass(frozen=True)
class BalanceError:
    """How much of the error's energy enters at one balance.

    share: of all balances' energy above the noise. above_noise: root mean square over noise.
    residual: (n,) in the balance's ``unit`` (N m, N, m3/s, Pa, ...), nominal model.
    extended: the same with the named causes. by: axis (time, speed, pressure, position, frequency)
    to (bin centres, root mean square of the nominal residual in each bin).
    """

    balance: str
    unit: str
    share: float
    above_noise: float
    residual: np.ndarray
    extended: np.ndarray
    by: Mapping[str, tuple[np.ndarray, np.ndarray]] = field(default_factory=dict)


@dataclass(frozen=True, repr=False)
class Diagnosis:
    """The report and the evidence behind it, for the page.

    held_out: (n,) bool on the grid. free_form: fields of ``engine.structure.FreeForm``, or nothing.
    """

    report: Report
    time: np.ndarray
    overlays: Mapping[str, Overlay] = field(default_factory=dict)
    balances: tuple[BalanceError, ...] = ()
    held_out: np.ndarray | None = None
    extension: Mapping[str, Any] = field(default_factory=dict)
    free_form: Mapping[str, Any] = field(default_factory=dict)
