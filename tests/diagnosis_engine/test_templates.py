"""What a hypothesis without a size does is looked at as it is, at several steps."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from steering_diagnosis.engine.catalogue import catalogue
from steering_diagnosis.engine.diagnose import begin
from steering_diagnosis.engine.evaluate import Evaluator
from steering_diagnosis.engine.model import Hypothesis, HypothesisParameter, Nuisance, Output
from steering_diagnosis.engine.sampling import sampling
from steering_diagnosis.engine.settings import Settings
from steering_diagnosis.engine.templates import FAR, templates

STOP = Hypothesis(
    "stop",
    "a stop where the motion ends early",
    "rack",
    (HypothesisParameter("earlier", "m", 0.0, 0.0, 0.07, 0.01, shape=True),),
)


class Stopped:
    """A motion to 30 mm of 80 mm: a stop shows only where it is earlier by 50 mm and more."""

    outputs = (Output("position", "m", "rack"),)
    nuisances = (Nuisance("gain", "1", 1.0, 0.01),)
    hypotheses: ClassVar = {"stop": STOP}
    period_s = 1e-3

    def residuals(self, nuisances, effects):
        at = 0.08 - effects.get("stop", {}).get("earlier", 0.0)
        return -nuisances.get("gain", 1.0) * np.minimum(self.states()["position"], at)[:, None]

    def shaken(self, nuisances, effects):
        return np.zeros((2000, 1))

    def noise(self):
        return np.zeros(1)

    def states(self):
        return {"position": 0.032 * np.sin(np.linspace(0.0, 20.0, 2000))}


def test_a_stop_far_from_the_nominal_one_is_seen():
    replay = Stopped()
    settings = Settings()
    runs = Evaluator(replay, sampling(2000, 1e-3, settings))
    book = catalogue(replay)
    base = runs.base
    found, _ = templates(runs, book, base, np.zeros((*base.shape, 1)), settings.shape_grid)
    trials = [t for t in found if t.hypothesis == "stop"]
    steps = sorted(t.unit[0] for t in trials)
    assert np.allclose(steps, [0.004, 0.01, 0.025, *(0.01 * f for f in FAR)])
    moved = [t.unit[0] for t in trials if np.abs(t.columns).max() > 1e-4]
    assert moved == [0.01 * f for f in FAR[1:]]
    far = [t for t in trials if t.unit[0] in moved]
    assert [(t.least, t.most) for t in far] == 2 * [(1.0, 1.0)]


class Yielding(Stopped):
    """A motion to 30 mm stopped at 24 mm by what gives way: no template is right at a contact."""

    def residuals(self, nuisances, effects):
        free = self.states()["position"]
        met = 0.08 - 0.056
        soft = np.where(free > met, met + 0.4 * (free - met), free)
        noise = 2e-6 * np.random.default_rng(1).standard_normal(len(free))
        return super().residuals(nuisances, effects) + (soft + noise)[:, None]


def test_a_stop_that_gives_way_is_tried_although_its_template_gains_nothing():
    search, _ = begin(Yielding())
    scores = {s.hypothesis: s for s in search.scores(search.null)}
    assert scores["stop"].removes > 0.3
    assert any(fit.names == {"stop"} for fit in search.extended(search.null, 0))
