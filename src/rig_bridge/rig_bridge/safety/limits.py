"""Limits on commands: free functions of what is asked and what was sent last."""

from __future__ import annotations


def limited(asked: float, last: float, interval: tuple[float, float], step: float) -> float:
    """Return ``asked`` within ``interval``, at most ``step`` away from ``last``.

    ``last`` lies within ``interval``; so does the result, to the bit.
    """
    nearest = min(max(asked, last - step), last + step)
    return min(max(nearest, interval[0]), interval[1])


def blended(safe: float, asked: float, share: float) -> float:
    """Return the command between ``safe`` (share 0) and ``asked`` (share 1)."""
    return asked if share >= 1.0 else safe + share * (asked - safe)


def smooth(progress: float) -> float:
    """Return a share that leaves 0 and reaches 1 without a kink (3 p^2 - 2 p^3)."""
    p = min(max(progress, 0.0), 1.0)
    return p * p * (3.0 - 2.0 * p)
