"""Gram matrices by one thread: the same sum whatever the library's threads do."""

from __future__ import annotations

from steering_core.compiled import kernel


@kernel
def gram(values, weights, out):  # type: ignore[no-untyped-def]
    """Add the lower triangle of the weighted gram of ``values`` (rows, k) to ``out`` (k, k)."""
    rows, columns = values.shape
    for t in range(rows):
        w = weights[t]
        if w > 0.0:
            for a in range(columns):
                scaled = w * values[t, a]
                for b in range(a + 1):
                    out[a, b] += scaled * values[t, b]
