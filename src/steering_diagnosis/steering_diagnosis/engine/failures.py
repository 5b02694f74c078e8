"""What may go wrong in one model without costing the others.

A replay that leaves what is possible, a value out of its range, an overflow, equations without a
solution: such a model is given up, and the report says so. Programming errors (TypeError,
AttributeError, a ValueError of the engine's own) are none of them.
"""

from __future__ import annotations

import numpy as np
from numba.core.errors import NumbaError

from steering_core.errors import BenchError


class CandidateError(Exception):
    """A model that cannot be evaluated; the text says why, on one line."""


class GivenUpError(CandidateError):
    """The same, with the causes of the model that it costs."""

    def __init__(self, names: frozenset[str], why: str) -> None:
        super().__init__(why)
        self.names = names


NUMERICAL = (CandidateError, ArithmeticError, np.linalg.LinAlgError)
"""What the engine's own algebra may raise about a model."""

OF_A_REPLAY = (*NUMERICAL, BenchError, ValueError, NumbaError)
"""What a model's own code may raise; checked ranges are ValueErrors."""


def reason(error: BaseException) -> str:
    """Return why something failed, on one line."""
    text = " ".join(str(error).split())
    plain = isinstance(error, (CandidateError, BenchError)) and text
    return text if plain else f"{type(error).__name__}: {text}".rstrip(": ")
