"""The rows that are judged: each output of each record, averaged down to the band of its error."""

from __future__ import annotations

import numpy as np


def cut(error: np.ndarray, share: float) -> float:
    """Return the frequency below which a share of an error's energy lies [1/sample].

    error: (n,), NaN where nothing is judged.
    """
    known = np.isfinite(error)
    filled = np.where(known, error, 0.0)
    filled = filled - filled.sum() / max(known.sum(), 1) * known
    energy = np.cumsum(np.abs(np.fft.rfft(filled)) ** 2)
    if not energy[-1] > 0.0:
        return 0.5
    return 0.5 * (np.searchsorted(energy / energy[-1], share) + 1) / len(energy)


class Series:
    """One output of one record, averaged over ``step`` samples a row.

    valid: judged samples, (n,). at: numbers of the rows that are kept, of ``blocks``: those of
    which at least half is judged.
    """

    def __init__(self, record: int, output: str, step: int, valid: np.ndarray) -> None:
        self.record, self.output, self.step, self.valid = record, output, step, valid
        self.blocks = -(-len(valid) // step)
        count = self._sums(valid.astype(float))
        self.at = np.flatnonzero(count >= 0.5 * step)
        self.count = count[self.at]

    def __len__(self) -> int:
        return len(self.at)

    def _sums(self, values: np.ndarray) -> np.ndarray:
        padded = np.zeros(self.blocks * self.step)
        padded[: len(values)] = values
        return padded.reshape(self.blocks, self.step).sum(axis=1)

    def means(self, values: np.ndarray) -> np.ndarray:
        """Return the rows of something that is known at every sample, (n,) to (rows,)."""
        return self._sums(np.where(self.valid, values, 0.0))[self.at] / self.count

    def spread_out(self, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return rows and ones where they are on the regular grid, (blocks,) each, else zero."""
        grid, known = np.zeros(self.blocks), np.zeros(self.blocks)
        grid[self.at], known[self.at] = rows, 1.0
        return grid, known


def series(
    record: int, output: str, error: np.ndarray, share: float, most: int, least: int
) -> Series:
    """Return the rows of an output for its nominal error, (n,), NaN where nothing is judged."""
    valid = np.isfinite(error)
    step = max(1, int(min(0.5 / cut(error, share), valid.sum() / least)))
    return Series(record, output, max(step, -(-int(valid.sum()) // most)), valid)
