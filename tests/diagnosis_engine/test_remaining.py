"""Structure beside a cause: its own, which gives it away, or another phenomenon's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sled import SledReplay, record

from steering_diagnosis.engine.diagnose import begin
from steering_diagnosis.engine.evidence import handed_on
from steering_diagnosis.engine.model import Hypothesis, Output
from steering_diagnosis.engine.remaining import Left, left_by
from steering_diagnosis.engine.structure import Remains, Structure

STEP_S = 5e-3
TIME = np.arange(4000) * STEP_S
NOISE = 0.01
ONES = np.ones(2)
EXPLAINED = np.sin(2.0 * np.pi * 0.8 * TIME)


def _left(hz: float, size: float, output: int = 0, kind: str = "predictable") -> Left:
    """Return a record whose causes explain the first of two outputs, and what is left beside."""
    part = size * np.sin(2.0 * np.pi * hz * TIME)
    residual = np.zeros((len(TIME), 2))
    residual[:, output] = part
    explained = np.column_stack([EXPLAINED, 0.01 * EXPLAINED])
    before, after = np.mean((residual + explained) ** 2, axis=0), np.mean(residual**2, axis=0)
    remains = Remains(
        (Output("torque", "N m", "torsion bar"), Output("position", "m", "rack")),
        residual,
        np.ones_like(residual, bool),
        np.arange(len(TIME)) // 200,
        {"angle [rad]": EXPLAINED},
        np.full(2, 1e-3),
        8,
        1.0,
        np.zeros((len(TIME), 2)),
        np.zeros(2),
    )
    found = [Structure(output, float(np.mean(part**2)), NOISE, part, kind, "")]
    noise = np.full(2, NOISE)
    return Left("fitted record", remains, found, before, after, noise, explained, STEP_S)


@pytest.mark.parametrize(
    ("hz", "size", "output", "balance", "exact", "spoilt"),
    [
        (0.9, 0.3, 0, "torsion bar", False, ["torque"]),
        (0.9, 0.15, 0, "torsion bar", False, []),
        (0.9, 0.15, 0, "torsion bar", True, []),
        (0.9, 0.22, 0, "torsion bar", True, ["torque"]),
        (25.0, 0.3, 0, "torsion bar", False, []),
        (0.9, 0.3, 1, "torsion bar", False, []),
        (0.9, 0.3, 1, "rack", False, ["position"]),
    ],
    ids=[
        "its own",
        "another formula's",
        "no louder than the noise",
        "loud, of an exact cause",
        "a mode",
        "another output",
        "its own balance's output",
    ],
)
def test_what_spoils_a_cause(
    hz: float, size: float, output: int, balance: str, exact: bool, spoilt: list[str]
) -> None:
    cause = Hypothesis("cause", "", balance, (), exact=exact)
    found = _left(hz, size, output).spoiling(0.06, [cause])
    assert [r.output for r in found] == spoilt


def test_what_nothing_predicts_spoils_only_where_a_cause_explains_most() -> None:
    cause = Hypothesis("cause", "", "rack", ())
    assert _left(0.9, 0.4, 0, "loud").spoiling(0.06, [cause])
    assert not _left(0.9, 0.3, 0, "loud").spoiling(0.06, [cause])
    assert not _left(0.9, 0.4, 1, "loud").spoiling(0.06, [cause])


@pytest.mark.parametrize(
    ("own", "size", "where", "spoilt"),
    [
        (0.05, 0.4, "fitted record", True),
        (0.05, 0.4, "held-out record", False),
        (0.10, 0.4, "fitted record", False),
        (0.05, 0.3, "fitted record", False),
    ],
    ids=["loud", "of the other record", "no louder than known noise", "another formula's"],
)
def test_what_is_left_beside_causes_is_no_louder_than_noise(own, size, where, spoilt):
    left = _left(0.9, size)
    left = replace(
        left, where=where, structures=[], remains=replace(left.remains, own=own**2 * ONES)
    )
    assert bool(left.spoiling(0.06, [Hypothesis("cause", "", "rack", ())])) is spoilt


def test_loud_structure_is_reported_beside_causes() -> None:
    (region,) = _left(25.0, 0.3).regions(0.2)
    assert region.output == "torque"
    assert region.band_hz == pytest.approx((25.0, 25.0), abs=0.2)


def test_what_a_second_record_does_not_show_is_told_of_the_first() -> None:
    left = _left(0.9, 0.0)
    told = left.unconfirmed(np.column_stack([EXPLAINED, 0.01 * EXPLAINED]))
    assert [r.output for r in told] == ["torque"]


class Ringing(SledReplay):
    """A sled on which the inputs' noise shakes one model only."""

    def shaken(self, nuisances, effects):
        return np.full_like(self.measured, 0.5 if "drag" in effects else 0.0)


def test_a_model_is_judged_beside_the_noise_that_it_hands_on():
    made = record(5, drag=800.0)
    search, block = begin(Ringing(made.drive, made.load, made.measured))
    (nominal,) = left_by(search, search.null, block)
    (dragged,) = left_by(search, search.best(), block)
    assert not nominal.remains.shaken.any()
    assert dragged.remains.shaken == pytest.approx(0.5, rel=0.01)


class Quieter(SledReplay):
    """A sled on which a cause takes away what the inputs' noise shakes."""

    def shaken(self, nuisances, effects):
        noise = 1e-4 * np.random.default_rng(2).standard_normal(self.measured.shape)
        return np.zeros_like(noise) if "drag" in effects else noise


@pytest.mark.parametrize(("kind", "counts"), [(Quieter, True), (Ringing, False)])
def test_to_hand_on_less_noise_is_no_evidence(kind, counts):
    made = record(5, drag=800.0)
    search, _ = begin(kind(made.drive, made.load, made.measured))
    full = search.fit(frozenset({"drag"}), search.null.z, {"drag": np.array([700.0])})
    gain = search.null.misfit - full.misfit
    noise = handed_on(search.problem, search.null) if counts else 0.0
    assert (noise > 0.0) == counts
    assert search.weigh(search.null, full).ratio == pytest.approx(gain - noise)
