"""A linear, time-invariant model with named states, inputs and outputs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class LinearModel:
    """x' = a x + b u, y = c x + d u, small deviations from an operating point, SI units.

    a (n, n), b (n, m), c (k, n), d (k, m); names of states, inputs and outputs in order.
    """

    a: np.ndarray
    b: np.ndarray
    c: np.ndarray
    d: np.ndarray
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]

    def response(self, omega: np.ndarray) -> np.ndarray:
        """Return the frequency response, complex, shape (len(omega), k, m), omega in rad/s."""
        s = 1j * np.asarray(omega, float)[:, None, None]
        inner = np.linalg.solve(s * np.eye(len(self.a)) - self.a, self.b.astype(complex))
        return self.c @ inner + self.d

    def channel(self, output: str, source: str, omega: np.ndarray) -> np.ndarray:
        """Return the response of one output to one input, complex, shape (len(omega),)."""
        row, column = self.outputs.index(output), self.inputs.index(source)
        return self.response(omega)[:, row, column]

    def poles(self) -> np.ndarray:
        """Return the eigenvalues [rad/s]."""
        return np.linalg.eigvals(self.a)

    def selected(
        self, states: Sequence[str], inputs: Sequence[str], outputs: Sequence[str]
    ) -> LinearModel:
        """Return the model of some states, the others held at their operating point."""
        rows = [self.states.index(name) for name in states]
        columns = [self.inputs.index(name) for name in inputs]
        seen = [self.outputs.index(name) for name in outputs]
        return LinearModel(
            self.a[np.ix_(rows, rows)],
            self.b[np.ix_(rows, columns)],
            self.c[np.ix_(seen, rows)],
            self.d[np.ix_(seen, columns)],
            tuple(states),
            tuple(inputs),
            tuple(outputs),
        )
