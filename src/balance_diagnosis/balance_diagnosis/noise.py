"""The noise of each output: what neither the model, nor any cause, nor any smooth function takes.

Estimated once for all models that are compared. The residual is regressed on the columns of the
parameters and of all causes (free), on smooth functions of the states and on slow functions of
time (ridge; the scales that make it most likely, "type II"). What is left gives the variance and
the time over which it is correlated. A drift is not in it: it is error that no cause explains.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from balance_diagnosis.evidence import Noise, derivatives
from balance_diagnosis.features import slow_functions, smooth_functions
from balance_diagnosis.problem import Problem
from balance_diagnosis.rows import Series

SCALES = np.r_[0.0, 10.0 ** np.arange(-2.0, 3.0, 0.5)]
"""Of the functions' share over the noise's, as they are tried."""

FINEST = 1e-6
"""Of an output's deviation: no sensor resolves less, and a model without noise can be solved."""

LEAST_SHARE = 1e-4
"""Of the error's deviation that the noise has at least: two solvers differ by as much."""


class Scenery:
    """Smooth functions of the states at the rows, about one model. One array for each series."""

    def __init__(self, problem: Problem, names: Sequence[str], x: np.ndarray) -> None:
        count = round(problem.constants.features)
        self.smooth: list[np.ndarray] = []
        self.slow: list[np.ndarray] = []
        for number, record in enumerate(problem.records):
            made = problem.predicted(number, problem.values(names, x, number))
            inputs = {k: v for k, v in record.channels.items() if k not in made.outputs}
            functions = smooth_functions({**inputs, **made.states, **made.outputs}, count)
            drift = slow_functions(len(record))
            for s in (s for s in problem.rows if s.record == number):
                self.smooth.append(_reduced(s, functions))
                self.slow.append(_reduced(s, drift))


def _reduced(s: Series, functions: np.ndarray) -> np.ndarray:
    return (
        np.stack([s.means(f) for f in functions.T], axis=1)
        if functions.size
        else np.zeros((len(s), 0))
    )


def estimate(
    problem: Problem,
    scenery: Scenery,
    names: Sequence[str],
    x: np.ndarray,
    secants: Sequence[np.ndarray],
) -> Noise:
    """Return the noise about a model.

    An output has one level over all records, in energy a sample: what the model leaves has one size
    as well, and a quiet record is no better judge of its form than a loud one.

    secants: what causes outside of it change, (rows,) each.
    """
    residual = problem.residual(names, x)
    assert residual is not None
    own = derivatives(problem, names, x, residual)
    columns = np.concatenate([own, np.stack(secants, axis=1)], axis=1) if secants else own
    outputs = len(problem.outputs)
    samples, level = np.zeros(outputs), np.zeros(outputs)
    for i, (s, span) in enumerate(zip(problem.rows, problem.spans, strict=True)):
        rest, variance = _separate(
            residual[span], columns[span], scenery.smooth[i], scenery.slow[i]
        )
        length = correlation_length(*s.spread_out(rest))
        told = problem.records[s.record].noise.get(s.output, 0.0) / np.sqrt(s.step)
        finest = FINEST * problem.scale[s.record, s.output]
        least = max(told, LEAST_SHARE * float(residual[span].std()), finest)
        j, n = problem.outputs.index(s.output), len(s) / length
        samples[j] += n
        level[j] += n * s.step * max(variance * length, least**2)
    step = np.concatenate([np.full(len(s), s.step) for s in problem.rows])
    sd = np.sqrt((level / samples)[problem.output_of] / step)
    facts = np.full(outputs, problem.constants.facts / outputs)
    return Noise(sd, samples, facts)


def _separate(
    residual: np.ndarray, columns: np.ndarray, smooth: np.ndarray, slow: np.ndarray
) -> tuple[np.ndarray, float]:
    """Return what no column and no function explains, (rows,), and its variance."""
    basis = _basis(columns, len(residual))
    freedom = len(residual) - basis.shape[1]

    def beside(values: np.ndarray) -> np.ndarray:
        return values - basis @ (basis.T @ values)

    rest = beside(residual)
    functions = beside(np.concatenate([smooth, slow], axis=1))
    gram, product, energy = functions.T @ functions, functions.T @ rest, float(rest @ rest)

    def likelihood(a: float, b: float) -> tuple[float, np.ndarray, float]:
        """Return the log likelihood of two scales, the functions' weights, and what is left."""
        scale = np.r_[np.full(smooth.shape[1], a), np.full(slow.shape[1], b)] + 1e-9
        lower = np.linalg.cholesky(np.eye(len(scale)) + scale[:, None] * gram * scale)
        y = np.linalg.solve(lower, scale * product)
        unexplained = max(energy - float(y @ y), 1e-300)
        value = -0.5 * freedom * np.log(unexplained) - np.log(np.diag(lower)).sum()
        return float(value), scale * np.linalg.solve(lower.T, y), unexplained

    a = b = 0.0
    for _ in range(2):
        a = max(SCALES, key=lambda tried: likelihood(tried, b)[0])
        b = max(SCALES, key=lambda tried: likelihood(a, tried)[0])
    _, weights, unexplained = likelihood(a, b)
    return rest - functions @ weights, unexplained / max(freedom, 1)


def _basis(columns: np.ndarray, rows: int) -> np.ndarray:
    """Return an orthonormal basis of the columns, of at most a third of the rows."""
    norms = np.linalg.norm(columns, axis=0)
    kept = columns[:, norms > 1e-12 * norms.max(initial=1e-300)]
    if not kept.shape[1]:
        return np.zeros((rows, 0))
    u, values, _ = np.linalg.svd(kept / np.linalg.norm(kept, axis=0), full_matrices=False)
    return u[:, values > 1e-6 * values[0]][:, : max(rows // 3, 1)]


def correlation_length(grid: np.ndarray, known: np.ndarray) -> float:
    """Return the samples that count as one: 1 + 2 sum of correlations.

    grid, known: values and ones on a regular grid, zero where there is none. The sum goes on while
    pairs of neighbours are positive (Geyer 1992).
    """
    size = 2 * len(grid)
    cov = np.fft.irfft(np.abs(np.fft.rfft(grid, size)) ** 2)[: len(grid)]
    count = np.fft.irfft(np.abs(np.fft.rfft(known, size)) ** 2)[: len(grid)]
    mean = cov / np.maximum(count, 1.0)
    if not mean[0] > 0.0:
        return 1.0
    rho, length = mean / mean[0], 1.0
    for lag in range(1, len(rho) // 4, 2):
        pair = rho[lag] + rho[lag + 1]
        if pair <= 0.0:
            break
        length += 2.0 * pair
    return float(length)


def spikes(problem: Problem, secants: dict[str, np.ndarray]) -> np.ndarray:
    """Return what each cause does at its least size, from its typical secant, (rows, k)."""
    share = problem.constants.spike
    if not secants or not share > 0.0:
        return np.zeros((problem.count, 0))
    return share * np.stack(list(secants.values()), axis=1)
