"""Whitening of many columns at once."""

from __future__ import annotations

from steering_core.compiled import kernel


@kernel
def whiten(values, coefficients, sd, white):  # type: ignore[no-untyped-def]
    """Fill ``white`` with whitened ``values``, (n, outputs, k); its first ``order`` rows stay."""
    n, outputs, columns = values.shape
    order = coefficients.shape[1]
    for t in range(order, n):
        for j in range(outputs):
            for c in range(columns):
                white[t, j, c] = values[t, j, c]
            for k in range(order):
                a = coefficients[j, k]
                for c in range(columns):
                    white[t, j, c] -= a * values[t - 1 - k, j, c]
            for c in range(columns):
                white[t, j, c] /= sd[j]
