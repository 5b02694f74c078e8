"""What is left beside the causes: bands of frequency in which an error stands out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import welch

from balance_diagnosis.evidence import Fit
from balance_diagnosis.held_out import error_of
from balance_diagnosis.problem import Problem
from balance_diagnosis.record import Record


@dataclass(frozen=True)
class Band:
    """A band [Hz] of what is left in an output, with its share of the energy that is left."""

    record: str
    output: str
    low: float
    high: float
    share: float
    rms: float


def bands(problem: Problem, fit: Fit, records: Sequence[Record]) -> list[Band]:
    """Return the bands of each record that hold a material share, the largest first."""
    return []
