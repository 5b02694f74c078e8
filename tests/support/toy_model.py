"""A machine of three lines, quick to diagnose, in which anything can be made to go wrong."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from scipy import signal

from steering_diagnosis.engine.model import Hypothesis, HypothesisParameter, Nuisance, Output

SAMPLES, PERIOD_S = 1200, 5e-3
NOISE = 0.02

Effects = Mapping[str, Mapping[str, float]]
Fault = Callable[[Mapping[str, float], Effects, np.ndarray], np.ndarray]
"""Takes a call's nuisances, effects and residuals; returns residuals, or raises."""


def no_fault(nuisances: Mapping[str, float], effects: Effects, found: np.ndarray) -> np.ndarray:
    """Return the residuals as they are."""
    return found


def one_size(name: str, low: float = -5.0, high: float = 5.0, typical: float = 0.5) -> Hypothesis:
    """Return a hypothesis with one size, neutral at 0."""
    parameter = HypothesisParameter("size", "1", 0.0, low, high, typical)
    return Hypothesis(name, name, "first", (parameter,))


LATE = Hypothesis(
    "late", "late", "first", (HypothesisParameter("delay", "s", 0.0, 0.0, 0.2, 0.05, shape=True),)
)
HYPOTHESES = {h.name: h for h in (one_size("square"), one_size("cube"), one_size("product"), LATE)}
NUISANCES = (
    Nuisance("gain", "1", 1.0, 0.04, 0.02),
    Nuisance("offset", "1", 0.0, 0.05),
    Nuisance("lag", "s", 0.0, 0.02, 0.0, 0.5),
)
OUTPUTS = (Output("one", "1", "first"), Output("two", "1", "second"))


def inputs(seed: int) -> np.ndarray:
    """Return two smooth inputs, (n, 2), about 1 in size."""
    white = np.random.default_rng(seed).standard_normal((SAMPLES, 2))
    smooth = signal.lfilter(*signal.butter(2, 0.02), white, axis=0)
    return smooth / np.std(smooth, axis=0)


@dataclass
class Toy:
    """The toy bound to a record. calls: how many it has answered."""

    given: np.ndarray
    measured: np.ndarray
    nuisances: tuple[Nuisance, ...] = NUISANCES
    hypotheses: Mapping[str, Hypothesis] = field(default_factory=lambda: HYPOTHESES)
    fault: Fault = no_fault
    shaking: Fault = no_fault
    outputs: tuple[Output, ...] = OUTPUTS
    period_s: float = PERIOD_S
    calls: int = 0

    def predicted(self, nuisances: Mapping[str, float], effects: Effects) -> np.ndarray:
        """Return both outputs, (n, 2)."""
        p = {n.name: n.nominal for n in self.nuisances} | dict(nuisances)
        size = {name: next(iter(given.values())) for name, given in effects.items()}
        u, v = self.given.T
        one = p.get("gain", 1.0) * u + p.get("offset", 0.0) + size.get("square", 0.0) * u**2
        one = one + size.get("cube", 0.0) * v**3 + size.get("product", 0.0) * u * v
        late = p.get("lag", 0.0) + size.get("late", 0.0)
        time = np.arange(len(u)) * PERIOD_S
        return np.column_stack([np.interp(time - late, time, one), v + 0.2 * one])

    def residuals(self, nuisances: Mapping[str, float], effects: Effects) -> np.ndarray:
        """Return measured minus predicted, (n, 2), unless the fault has it otherwise."""
        self.calls += 1
        found = self.measured - self.predicted(nuisances, effects)
        return self.fault(nuisances, effects, found)

    def shaken(self, nuisances: Mapping[str, float], effects: Effects) -> np.ndarray:
        """Return zeros, (n, 2), unless the fault has it otherwise."""
        return self.shaking(nuisances, effects, np.zeros_like(self.measured))

    def noise(self) -> np.ndarray:
        """Return the sensors' noise, (2,)."""
        return np.full(2, NOISE)

    def states(self) -> Mapping[str, np.ndarray]:
        """Return the inputs."""
        return {"first input": self.given[:, 0], "second input": self.given[:, 1]}


def toy(seed: int, **hidden: float) -> Toy:
    """Return the toy with a record of a specimen in which something is hidden, by name."""
    given = inputs(seed)
    plain = Toy(given, np.zeros((SAMPLES, 2)))
    nuisances = {n: hidden.pop(n) for n in ("gain", "offset", "lag") if n in hidden}
    effects = {n: {HYPOTHESES[n].parameters[0].name: v} for n, v in hidden.items()}
    true = plain.predicted({"gain": 1.01, "offset": 0.01} | nuisances, effects)
    noise = NOISE * np.random.default_rng(seed + 1000).standard_normal(true.shape)
    return Toy(given, true + noise)
