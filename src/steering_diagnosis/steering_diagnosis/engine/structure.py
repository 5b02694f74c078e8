"""What remains: is it noise, or structure that no hypothesis explains?

Three tests on whitened residuals, so that coloured noise and slow drift are no structure: smooth
functions of the states that predict blocks which took no part in their fit, errors that several
outputs share, and energy that comes and goes with the excitation. All ask for significance and
for a visible size. A fourth needs no idea of what the error depends on: it is far louder than the
noise of sensors and inputs.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy import signal, stats

from steering_diagnosis.engine.basis import (
    by_direction,
    knots,
    orders,
    product,
    repeated,
    single,
    splines,
    usable_state,
)
from steering_diagnosis.engine.evidence import certainty
from steering_diagnosis.engine.model import Output
from steering_diagnosis.engine.noise import INPUTS_NOISE, Noise, fit_noise, usable

FOLDS = 4
RIDGE = 1e-2
SIGMAS = 4.0
TOGETHER = 3
VISIBLE = 0.3
"""Predictable energy over the noise's from which structure is visible."""
COARSE, VISIBLE_COARSE = 0.05, 1.2
"""Where the resolution is below this share of the noise, tolerances show nothing of how well an
output can be modelled: structure has to exceed the noise."""
SCATTER = 2.5
"""Structure is visible from so many resolutions: a twentieth of what the tolerances scatter."""
NEXT_TO_NONE, NOISELESS = 0.1, 2.0
"""Known noise over the resolution below which it is none; then two solvers' difference, which comes
and goes with the motion, is all there is, and structure is visible from so much more."""
SHARED_SCATTER = 15.0
"""An error that outputs share counts from so many resolutions: a third of the scatter."""
LOUD = 2.3
"""Error over known noise, rms, from which it is structure. Clean records reach 2.2: noise is not
quite white, and sensors drift."""
LOUDER, LEFT_SCATTER = 3.5, 0.5
"""The same, and resolutions that count as noise, of what is left beside causes. Clean records reach
2.9: a twentieth of the scatter hides what a wrong cause leaves where tolerances scatter much."""
SHIFTS = (-2, -1, 0, 1, 2)
BURSTS = 3.0
"""Mean energy over the quiet quarter's from which energy is not stationary."""


@dataclass(frozen=True, repr=False)
class Structure:
    """Structure in one output. part: its time series, (n,). energy, noise: mean squares."""

    output: int
    energy: float
    noise: float
    part: np.ndarray
    kind: str
    state: str


@dataclass(frozen=True)
class FreeForm:
    """A smooth term that predicts held-out blocks: ``output`` += table(state)."""

    output: str
    balance: str
    state: str
    at: tuple[float, ...]
    value: tuple[float, ...]
    gain: float


@dataclass(frozen=True, repr=False)
class Remains:
    """A residual with what is needed to judge it. residual, valid: (n, outputs); block: (n,).

    shaken: what another draw of the inputs' noise does, (n, outputs). own: mean squares of the
    outputs' own white noise, (outputs,).
    """

    outputs: Sequence[Output]
    residual: np.ndarray
    valid: np.ndarray
    block: np.ndarray
    states: Mapping[str, np.ndarray]
    floor: np.ndarray
    order: int
    density: float
    shaken: np.ndarray
    own: np.ndarray


def structures(remains: Remains) -> list[Structure]:
    """Return the structure in each output, where there is any."""
    states = {n: usable_state(x) for n, x in remains.states.items()}
    functions = {n: (x, single(x)) for n, x in states.items() if x is not None}
    # What repeats along a state, as a worn screw or tooth does, is finer than a smooth curve.
    more = {f"{n}, fine": (x, repeated(x)) for n, (x, _) in functions.items()}
    turning = {n: x for n, (x, _) in functions.items() if n.endswith("[rad]")}
    more |= {f"{n}, orders": (x, orders(x)) for n, x in turning.items()}
    # A speed's direction is an acceleration, which friction and hysteresis know nothing of.
    kept = {n: x for n, (x, _) in functions.items() if "/s" not in n}
    more |= {f"{n}, by direction": (x, by_direction(x)) for n, x in kept.items()}
    functions |= more
    found = []
    for j in range(len(remains.outputs)):
        if usable(remains.valid, remains.order)[:, j].sum() > 20 * remains.order:
            structure = (
                _predictable(remains, functions, j)
                or _common(remains, j)
                or _bursts(remains, j)
                or _loud(remains, j)
            )
            if structure is not None:
                found.append(structure)
    return found


def band(part: np.ndarray, step_s: float) -> tuple[float, float]:
    """Return the band that holds the middle half of a signal's energy [Hz]; a constant has none."""
    f, power = signal.periodogram(part, 1.0 / step_s, detrend="constant")
    if power.sum() <= 0.0:
        return 0.0, 0.0
    share = np.cumsum(power) / np.cumsum(power)[-1]
    return float(f[np.searchsorted(share, 0.25)]), float(f[np.searchsorted(share, 0.75)])


def region(part: np.ndarray, states: Mapping[str, np.ndarray]) -> str:
    """Return in words where a signal's energy is concentrated."""
    best, text = 1.5, "everywhere"
    for name, x in states.items():
        edges = np.unique(np.nanquantile(x, np.linspace(0.0, 1.0, 7)))
        if len(edges) < 4:
            continue
        bins = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(edges) - 2)
        count = np.maximum(np.bincount(bins, minlength=len(edges) - 1), 1)
        level = np.bincount(bins, part**2, minlength=len(edges) - 1) / count
        k = int(np.argmax(level))
        ratio = level[k] / max(np.mean(part**2), 1e-300)
        if ratio > best:
            best, text = ratio, f"{name} from {edges[k]:.3g} to {edges[k + 1]:.3g}"
    return text


def free_form(remains: Remains, structure: Structure) -> FreeForm | None:
    """Return the best smooth function of one state, if it predicts held-out blocks."""
    j, best, gain = structure.output, "", 0.1
    for name, x in remains.states.items():
        x = np.nan_to_num(x)
        if np.ptp(x) > 0.0:
            part, sigmas = _cross_validated(remains, splines(x, knots(x)), j)
            after = _mean_square(remains, remains.residual[:, j] - part, j)
            share = 1.0 - after / _mean_square(remains, remains.residual[:, j], j)
            if sigmas > 2.0 and share > gain:
                best, gain = name, share
    if not best:
        return None
    x = np.nan_to_num(remains.states[best])
    columns, rows = splines(x, knots(x)), remains.valid[:, j]
    weight = np.linalg.lstsq(columns[rows], remains.residual[rows, j], rcond=None)[0]
    order = np.argsort(x, kind="stable")[np.linspace(0, len(x) - 1, 41).astype(int)]
    at, kept = np.unique(x[order], return_index=True)
    value = (columns[order] @ weight)[kept]
    output = remains.outputs[j]
    return FreeForm(output.name, output.balance, best, tuple(at), tuple(value), float(gain))


def _predictable(
    remains: Remains, functions: Mapping[str, tuple[np.ndarray, np.ndarray]], j: int
) -> Structure | None:
    """Find what smooth functions of the states predict: of one, then of the best together.

    It has to be large against what the inputs' noise does: the replay's own states carry that, and
    predict it.
    """
    before = _mean_square(remains, remains.residual[:, j], j)
    if before < (SCATTER * remains.floor[j]) ** 2 or not functions:
        return None
    alone = {}
    for name, (_, columns) in functions.items():
        part, sigmas = _cross_validated(remains, columns, j)
        alone[name] = (sigmas, before - _mean_square(remains, remains.residual[:, j] - part, j))
    best = sorted((n for n in alone if alone[n][0] > 2.0), key=lambda n: -alone[n][1])[:TOGETHER]
    if not best:
        return None
    parts = [functions[n][1] for n in best]
    parts += [product(functions[a][0], functions[b][0]) for a, b in combinations(best, 2)]
    part, sigmas = _cross_validated(remains, np.concatenate(parts, axis=1), j)
    after = _mean_square(remains, remains.residual[:, j] - part, j)
    handed_on = INPUTS_NOISE * _mean_square(remains, remains.shaken[:, j], j)
    if sigmas < SIGMAS or before - after < max(_least(remains, after, j), handed_on):
        return None
    return Structure(j, before - after, after, part, "predictable", "")


def _common(remains: Remains, j: int) -> Structure | None:
    """Find an error that several outputs share: sensors' noise is each one's own.

    It has to be large against the tolerances' scatter and against what the inputs' noise does,
    because that is shared as well.
    """
    before = _mean_square(remains, remains.residual[:, j], j)
    others = [i for i in range(remains.residual.shape[1]) if i != j]
    if before < (SHARED_SCATTER * remains.floor[j]) ** 2 or not others:
        return None
    shifted = [np.roll(remains.residual[:, others], k, axis=0) for k in SHIFTS]
    part, sigmas = _cross_validated(remains, np.concatenate(shifted, axis=1), j)
    after = _mean_square(remains, remains.residual[:, j] - part, j)
    shared = INPUTS_NOISE * _mean_square(remains, remains.shaken[:, j], j)
    if sigmas < SIGMAS or after > 0.5 * before or before - after < shared:
        return None
    return Structure(j, before - after, after, part, "common", "")


def _bursts(remains: Remains, j: int) -> Structure | None:
    """Find energy that comes and goes with the excitation, as a mode that pulses excite.

    More of it than the inputs' noise makes come and go, which a moving gear hands on.
    """
    rows = usable(remains.valid, remains.order)[:, j]
    noise = _noise(remains, remains.residual[:, j], j)
    both = noise.whiten(np.stack([remains.residual[:, [j]], remains.shaken[:, [j]]], axis=-1))[:, 0]
    count = np.bincount(remains.block, rows)
    kept = count > 10
    energy, handed_on = (
        np.bincount(remains.block, np.where(rows, white**2, 0.0))[kept] / count[kept]
        for white in both.T
    )
    handed_on = INPUTS_NOISE * handed_on
    excitation = _excitation(remains)[kept]
    quiet = max(float(np.quantile(energy - handed_on, 0.25)), 0.0)
    expected = quiet + float(handed_on.mean())
    rank = stats.spearmanr(energy - handed_on, excitation) if excitation.std() > 0.0 else None
    follows = rank is not None and rank.statistic > 0.0 and rank.pvalue < 1e-3
    if not follows or energy.mean() < BURSTS * expected:
        return None
    total = _mean_square(remains, remains.residual[:, j], j)
    share = 1.0 - expected / float(energy.mean())
    left = max((1.0 - share) * total, remains.floor[j] ** 2)
    if share * total < _least(remains, left, j):
        return None
    return Structure(j, share * total, left, remains.residual[:, j], "bursts", "")


def louder(remains: Remains) -> list[Structure]:
    """Return the errors that are too loud to be left beside causes that are named."""
    found = [_loud(remains, j, LOUDER, LEFT_SCATTER) for j in range(len(remains.outputs))]
    return [s for s in found if s is not None]


def _loud(
    remains: Remains, j: int, least: float = LOUD, scatter: float = SCATTER
) -> Structure | None:
    """Find an error far above all noise that is known, whatever it may depend on."""
    own, handed_on = remains.own[j], _mean_square(remains, remains.shaken[:, j], j)
    if own + handed_on == 0.0:
        return None
    noise = own + INPUTS_NOISE * handed_on + (scatter * remains.floor[j]) ** 2
    total = _mean_square(remains, remains.residual[:, j], j)
    if total < least**2 * noise:
        return None
    return Structure(j, total - noise, noise, remains.residual[:, j], "loud", "")


def _least(remains: Remains, noise: float, j: int) -> float:
    """Return the energy from which structure is visible: over noise and tolerances' scatter."""
    coarse = remains.floor[j] ** 2 < COARSE**2 * noise
    scatter = SCATTER * remains.floor[j] * (NOISELESS if _noiseless(remains, j) else 1.0)
    return (VISIBLE_COARSE if coarse else VISIBLE) * noise + scatter**2


def _noiseless(remains: Remains, j: int) -> bool:
    known = remains.own[j] + _mean_square(remains, remains.shaken[:, j], j)
    return bool(noiseless(known, remains.floor[j]))


def noiseless(known: np.ndarray, floor: np.ndarray) -> np.ndarray:
    """Return which outputs are known to have next to no noise, (outputs,).

    known: mean squares of all noise, zero where nothing is known. floor: resolutions.
    """
    return np.asarray((known > 0.0) & (known < (NEXT_TO_NONE * floor) ** 2))


def _excitation(remains: Remains) -> np.ndarray:
    """Return how fast the states move in each block, (blocks,)."""
    total = np.zeros(remains.block.max() + 1)
    for x in remains.states.values():
        rate = np.abs(np.diff(np.nan_to_num(x), append=np.nan_to_num(x[-1])))
        if rate.std() > 0.0:
            total += np.bincount(remains.block, rate / rate.std())
    return total


def _noise(remains: Remains, residual: np.ndarray, j: int) -> Noise:
    rows = usable(remains.valid, remains.order)[:, [j]]
    floor = remains.floor[[j]]
    return fit_noise(residual[:, None], rows, floor, remains.order, remains.density)


def _cross_validated(remains: Remains, columns: np.ndarray, j: int) -> tuple[np.ndarray, float]:
    """Return the prediction of each block from the others, and its gain in standard errors."""
    rows = usable(remains.valid, remains.order)[:, j]
    fold = remains.block % FOLDS
    part = np.zeros(len(rows))
    gain: np.ndarray = np.zeros(1)
    for _ in range(2):
        noise = _noise(remains, remains.residual[:, j] - part, j)
        white = noise.whiten(remains.residual[:, [j]])[:, 0]
        c = noise.whiten(columns[:, None, :])[:, 0]
        grams = [c[m].T @ c[m] for m in (rows & (fold == f) for f in range(FOLDS))]
        slopes = [c[m].T @ white[m] for m in (rows & (fold == f) for f in range(FOLDS))]
        total, ridge = sum(grams), RIDGE * np.trace(sum(grams)) / columns.shape[1]
        predicted = np.zeros(len(rows))
        part = np.zeros(len(rows))
        for f in range(FOLDS):
            kept = total - grams[f] + ridge * np.eye(columns.shape[1])
            x = np.linalg.solve(kept, sum(slopes) - slopes[f])
            predicted[fold == f] = c[fold == f] @ x
            part[fold == f] = columns[fold == f] @ x
        each = np.where(rows, white**2 - (white - predicted) ** 2, 0.0)
        gain = np.bincount(remains.block, each)
    return part, certainty(gain)


def _mean_square(remains: Remains, values: np.ndarray, j: int) -> float:
    rows = remains.valid[:, j]
    return float(np.mean(values[rows] ** 2)) if rows.any() else 0.0
