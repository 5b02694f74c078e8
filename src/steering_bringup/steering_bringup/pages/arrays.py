"""Arrays for a page: as few points as the eye needs, in a form the plot library reads directly."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np

MOST_POINTS = 4000


def thin(x: np.ndarray, y: np.ndarray, most: int = MOST_POINTS) -> tuple[np.ndarray, np.ndarray]:
    """At most about `most` points of a curve (n,) over a rising x, keeping every extreme.

    Each stretch of samples gives its smallest and its largest value, in their order.
    """
    count = len(x)
    if count <= most:
        return x, y
    size = -(-2 * count // most)
    whole = count // size * size
    blocks = y[:whole].reshape(-1, size)
    base = np.arange(0, whole, size)
    rest = np.arange(whole, count)
    keep = np.unique(
        np.concatenate(
            [[0, count - 1], base + blocks.argmin(axis=1), base + blocks.argmax(axis=1), rest]
        )
    )
    return x[keep], y[keep]


def every(count: int, most: int = MOST_POINTS) -> slice:
    """Every k-th of `count` samples, so that at most `most` are left."""
    return slice(None, None, max(1, -(-count // most)))


def packed(values: np.ndarray) -> dict[str, Any]:
    """An array as base64 float32: a seventh of its size as text, and enough for a screen."""
    data = np.ascontiguousarray(values, "<f4").tobytes()
    return {"dtype": "f4", "bdata": base64.b64encode(data).decode("ascii")}
