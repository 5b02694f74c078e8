"""What the best model leaves on each record: noise, and structure that may spoil its causes."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import signal

from steering_diagnosis.engine.equations import ROUNDED, bounded, gram_of
from steering_diagnosis.engine.evaluate import Evaluator
from steering_diagnosis.engine.findings import Region
from steering_diagnosis.engine.fit import Fit
from steering_diagnosis.engine.model import Hypothesis, Output
from steering_diagnosis.engine.noise import fit_noise, mean_square, usable
from steering_diagnosis.engine.search import Search
from steering_diagnosis.engine.structure import Remains, Structure, band, louder, region, structures

FITTED = "fitted record"
REFITS = 3
"""Rounds of nuisances and noise on the second record; the noise is taken for white at first."""
LOUD = 2.0
"""Structure this much over the noise is reported however small beside what is explained."""
UNPREDICTED = 0.1
"""Share of what is explained from which an error that nothing predicts speaks against causes."""
AROUND = 1.5
"""Factor by which a structure's band is taken wider."""
ACTING = 0.03
"""Of what is explained in an output: with less of it in a structure's band that is another's."""
CONCERNED = 0.1
"""Share of all that the causes explain, in units of noise, from which an output concerns them."""


@dataclass(frozen=True, repr=False)
class Left:
    """What a model leaves on one record.

    where: which record. before, after: mean squares of the refitted nominal model and of the best
    one, (outputs,). noise: mean square of each output that is noise, (outputs,). explained_part:
    what the best model takes off the refitted nominal one's residual, (n, outputs).
    """

    where: str
    remains: Remains
    structures: Sequence[Structure]
    before: np.ndarray
    after: np.ndarray
    noise: np.ndarray
    explained_part: np.ndarray
    step_s: float

    def regions(self, least: float) -> list[Region]:
        """Return the structure worth reporting: a share of the error above the noise, or loud."""
        found = []
        for s in self.structures:
            above = max(self.before[s.output] - self.noise[s.output], s.energy)
            share = float(np.clip(s.energy / above, 0.0, 1.0))
            if share >= least or s.energy > LOUD * s.noise:
                found.append(self._region(s, share))
        return sorted(found, key=lambda r: -r.share)

    def _region(self, s: Structure, share: float) -> Region:
        output: Output = self.remains.outputs[s.output]
        where = region(s.part, self.remains.states)
        return Region(
            output.balance, output.name, band(s.part, self.step_s), where, share, self.where
        )

    @property
    def explained(self) -> float:
        """Share of the refitted model's error energy above the noise that is explained."""
        above = np.maximum(self.before - self.noise, 0.0) / self.noise
        return float(((self.before - self.after) / self.noise).sum() / max(above.sum(), 1e-12))

    def unconfirmed(self, part: np.ndarray) -> list[Region]:
        """Return where a cause's part of the error, (n, outputs), is loud on this record."""
        energy = mean_square(part, self.remains.valid)
        found = []
        for j in np.flatnonzero(energy > LOUD * self.noise):
            s = Structure(int(j), float(energy[j]), float(self.noise[j]), part[:, j], "cause", "")
            found.append(self._region(s, 1.0))
        return found

    def spoiling(self, least: float, causes: Collection[Hypothesis]) -> list[Region]:
        """Return structure where the causes act that is more than another formula would leave.

        least: share of what is explained there. Causes have to explain their own balance even if
        most of what they do is seen elsewhere. What nothing predicts is excepted, and has to be
        larger: another formula leaves such; on the fitted record it is loud earlier. Causes with
        the only formula there is leave nothing loud. Where they do not act is another phenomenon.
        """
        balances = {cause.balance for cause in causes}
        exact = all(cause.exact for cause in causes)
        explained = np.maximum(self.before - self.after, 0.0)
        weight = explained / self.noise
        found = []
        known = [(s, exact) for s in self.structures]
        if self.where == FITTED:
            known += [(s, False) for s in louder(self.remains)]
        for s, silent in known:
            share = s.energy / max(explained[s.output], 1e-300)
            main = weight[s.output] > CONCERNED * weight.sum()
            own = self.remains.outputs[s.output].balance in balances
            predicted = s.kind != "loud"
            enough = least if predicted else max(least, UNPREDICTED)
            large = share > enough or (silent and s.energy > LOUD * s.noise)
            if large and (main or (own and predicted)) and self._in_band(s):
                found.append(self._region(s, float(min(share, 1.0))))
        return found

    def _in_band(self, s: Structure) -> bool:
        """Return whether some of what is explained has the structure's frequencies.

        A cause whose formula fails there acts there: a mass below a mode, not an offset.
        """
        f, power = signal.periodogram(self.explained_part[:, s.output], detrend="constant")
        low, high = band(s.part, 1.0)
        inside = (f >= low / AROUND) & (f <= high * AROUND)
        return bool(power[inside].sum() > ACTING * power.sum())


def left_by(search: Search, best: Fit, block: np.ndarray) -> list[Left]:
    """Return what the best model leaves on the fitted record and on a second one."""
    p, held = search.problem, search.held
    null = search.null.residual
    found = [_left(search, best, p.runs, best.residual, null, p.valid, block, FITTED)]
    if held.runs is not None:
        residual = held.residual(p, best)
        shift, _ = within_tolerance(search, residual, best.z)
        left = residual + search.held_nuisance @ shift
        before = held.residual(p, search.null)
        found.append(
            _left(search, best, held.runs, left, before, held.valid, held.block, "held-out record")
        )
    return found


def within_tolerance(
    search: Search, residual: np.ndarray, z: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Refit the nuisances, linearised, to the second record: shift of z, (p,), and information.

    What another value within tolerance explains is no structure: one record leaves some open.
    """
    none, book = np.eye(len(z)), search.problem.book
    low, high = book.lowest - z - ROUNDED, book.highest - z + ROUNDED

    def step(gram: np.ndarray, slope: np.ndarray) -> np.ndarray:
        return bounded(gram + none, slope - z, low, high)

    return _shifted(search, residual, step)


def drifted(search: Search, best: Fit) -> np.ndarray:
    """Return what drift from record to record does to the second one, mean squares (outputs,).

    The part of the best model's error there that nuisances explain which differ by a little of
    their tolerance: sensors warm up. No cause takes it away.
    """
    held = search.held
    if held.runs is None:
        return np.zeros(len(search.problem.floor))
    residual = held.residual(search.problem, best)
    stiff = np.eye(len(best.z)) / search.problem.settings.drift**2
    book = search.problem.book
    low, high = book.least - best.z - ROUNDED, book.most - best.z + ROUNDED
    shift, _ = _shifted(search, residual, lambda g, b: bounded(g + stiff, b, low, high))
    after = held.energy(residual + search.held_nuisance @ shift)
    return np.maximum(held.energy(residual) - after, 0.0)


def _shifted(
    search: Search, residual: np.ndarray, step: Callable[[np.ndarray, np.ndarray], np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Return a shift of the nuisances on the second record, (p,), and what it holds about them.

    step: shift by gram matrix (p, p) and slope (p,) of the whitened problem.
    """
    p, held, columns = search.problem, search.held, search.held_nuisance
    assert held.runs is not None
    order, density = p.settings.noise_order, held.runs.grid.density
    rows = usable(held.valid, order)
    noise = fit_noise(residual, rows, p.floor, order, density).white
    shift, gram = np.zeros(columns.shape[-1]), np.zeros((columns.shape[-1],) * 2)
    for _ in range(REFITS):
        white = noise.whiten(np.concatenate([columns, residual[..., None]], axis=-1))
        both = gram_of(white, density * rows)
        gram = both[:-1, :-1]
        shift = step(gram, -both[:-1, -1])
        noise = fit_noise(residual + columns @ shift, rows, p.floor, order, density)
    return shift, gram


def _left(
    search: Search,
    best: Fit,
    runs: Evaluator,
    residual: np.ndarray,
    before: np.ndarray,
    valid: np.ndarray,
    block: np.ndarray,
    where: str,
) -> Left:
    p = search.problem
    states = {n: runs.grid.reduce(np.asarray(x, float)) for n, x in runs.replay.states().items()}
    remains = Remains(
        runs.replay.outputs,
        residual,
        valid,
        block,
        states,
        p.floor,
        p.settings.noise_order,
        runs.grid.density,
        runs.shaken_in(p.book.call(best.z, best.values)),
        runs.own,
    )
    found = structures(remains)
    return Left(
        where,
        remains,
        found,
        mean_square(before, valid),
        mean_square(residual, valid),
        _noise(remains, found),
        np.where(valid, before - residual, 0.0),
        runs.grid.step_s,
    )


def _noise(remains: Remains, left: Sequence[Structure]) -> np.ndarray:
    noise = mean_square(remains.residual, remains.valid)
    for s in left:
        noise[s.output] = s.noise
    return np.maximum(noise, remains.floor**2)
