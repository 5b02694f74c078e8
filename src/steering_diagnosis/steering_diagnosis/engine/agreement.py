"""Do two records of one specimen ask for the same nominal parameters?

What no cause and no tolerance explains is taken up by tolerances all the same, by others on each
record: an estimate of +2 standard deviations on one and of -2 on the other is no specimen.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from steering_diagnosis.engine.equations import gram_of
from steering_diagnosis.engine.findings import Region
from steering_diagnosis.engine.remaining import within_tolerance
from steering_diagnosis.engine.search import Search
from steering_diagnosis.engine.structure import band

INFLATION = 4.0
"""Of both covariances: what noise models do not know of noise that is not stationary."""
BLUR = 0.2
"""Standard deviations of a nuisance to which no model is known."""
NAMED = 3
"""Nuisances that are told, those most apart."""


@dataclass(frozen=True, repr=False)
class Estimate:
    """Nuisances from one record. z: standard deviations, (p,). information: of the data, (p, p)."""

    z: np.ndarray
    information: np.ndarray


def disagreement(one: Estimate, other: Estimate) -> tuple[float, np.ndarray]:
    """Return the mean square of the estimates' difference over what is expected, and each one's.

    Expected is what both noises scatter, and how far each record's prior pulls its estimate: the
    specimen is drawn from N(0, 1), an estimate is A z + noise with A = (G + 1)^-1 G. About 1 for
    the same specimen; each nuisance's share: difference over its own standard deviation, (p,).
    """
    (a, noise_a), (b, noise_b) = _shrunk(one), _shrunk(other)
    p = len(one.z)
    spread = (a - b) @ (a - b).T + noise_a + noise_b + BLUR**2 * np.eye(p)
    apart = one.z - other.z
    square = float(apart @ np.linalg.solve(spread, apart))
    return square / p, apart / np.sqrt(np.diag(spread))


def records_apart(search: Search, noise: np.ndarray) -> Region | None:
    """Return where the nominal model is another one on the second record, None where it is not.

    noise: mean square of each output that is noise, (outputs,).
    """
    p, held, null = search.problem, search.held, search.null
    if held.runs is None:
        return None
    before = held.residual(p, null)
    shift, information = within_tolerance(search, before, null.z)
    own = p.noise(null.residual)
    first = Estimate(null.z, gram_of(own.whiten(p.nuisance), p.weights() ** 2))
    square, each = disagreement(first, Estimate(null.z + shift, information))
    if square < p.settings.least_disagreement:
        return None
    part = -search.held_nuisance @ shift
    energy = held.energy(before)
    gone = energy - held.energy(before - part)
    j = int(np.argmax(gone / noise))
    output = p.runs.replay.outputs[j]
    names = [p.book.nuisances[i].name for i in np.argsort(-np.abs(each))[:NAMED]]
    text = f"the two records ask for different values of {', '.join(names)}"
    above = max(energy[j] - noise[j], gone[j])
    share = float(np.clip(gone[j] / above, 0.0, 1.0))
    where = band(part[:, j], held.runs.grid.step_s)
    return Region(output.balance, output.name, where, text, share, "both records")


def _shrunk(estimate: Estimate) -> tuple[np.ndarray, np.ndarray]:
    """Return what an estimate has of the specimen, A, and the covariance of its noise."""
    information = estimate.information / INFLATION
    posterior = np.linalg.inv(information + np.eye(len(information)))
    return posterior @ information, posterior @ information @ posterior
