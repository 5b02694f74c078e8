"""What the library names, what it leaves unnamed, and how often: on models of a line or two."""

from __future__ import annotations

import numpy as np
import pytest

from balance_diagnosis import Model, Record, calibrate, diagnose, toleranced
from balance_diagnosis.calibration import another
from balance_diagnosis.constants import DEFAULT
from balance_diagnosis.diagnosis import nominal_fit
from balance_diagnosis.machines import MACHINES
from balance_diagnosis.problem import Problem

NOISE, BEND, SAMPLES = 0.05, 0.08, 1500


def line(p, record):
    """Return a gain with what may be wrong about it."""
    u = record["u"]
    return {"y": p.gain * u + p.bend * u**2 + p.cubic * u**3 + p.offset}


def fragile(p, record):
    """Return the same; with a little of one cause there is no number, with more no answer."""
    if p.broken > 0.2:
        raise FloatingPointError("diverged")
    return {"y": line(p, record)["y"] + (np.nan if p.broken > 0.0 else 0.0)}


CAUSES = {
    "bend": {"bend": (0.0, -1.0, 1.0)},
    "cubic": {"cubic": (0.0, -1.0, 1.0)},
    "offset": {"offset": (0.0, -2.0, 2.0)},
}
MODEL = Model(line, {"gain": toleranced(1.0, 0.1)}, CAUSES)


def record(seed: int = 1, gain: float = 1.03, bend: float = 0.0) -> Record:
    draw = np.random.default_rng(seed)
    times = 0.01 * np.arange(SAMPLES)
    u = np.sin(2.1 * times) + 0.7 * np.sin(5.3 * times + draw.uniform(0.0, 6.0))
    y = gain * u + bend * u**2 + NOISE * draw.standard_normal(SAMPLES)
    return Record(times, {"u": u, "y": y}, name=f"seed {seed}")


def named(found):
    return {*found.verdict.named, *(name for group in found.verdict.groups for name in group)}


def test_a_hidden_cause_is_named_with_the_size_that_least_squares_gives():
    made = record(bend=BEND)
    found = diagnose(MODEL, [made])
    assert found.verdict.named == ("bend",)
    bend = found.causes["bend"]["bend"]
    u = made["u"]
    expected = np.linalg.lstsq(np.column_stack([u, u**2]), made["y"], rcond=None)[0]
    gain = next(number for number in found.numbers if number.name == "gain")
    assert bend.value == pytest.approx(expected[1], rel=0.02)
    assert gain.value == pytest.approx(expected[0], rel=0.01)
    assert bend.low < BEND < bend.high
    assert set(found.verdict.refused) == {"cubic", "offset"}


@pytest.mark.parametrize("seed", range(6))
def test_a_specimen_within_its_tolerance_has_no_cause(seed):
    assert named(diagnose(MODEL, [record(seed, gain=1.0 + 0.02 * (seed - 3))])) == set()


def test_what_the_catalogue_lacks_is_unexplained():
    found = diagnose(MODEL.without("bend"), [record(bend=3.0 * BEND)])
    assert named(found) == set()
    assert found.verdict.word == "unexplained"


def test_records_held_out_select_nothing():
    fitted, other = record(1, bend=BEND), record(2)
    alone, beside = diagnose(MODEL, [fitted]), diagnose(MODEL, [fitted], holdout=[other])
    assert beside.verdict == alone.verdict
    assert [gain.held_out for gain in beside.gains] == [False, True]


def test_a_cause_that_the_model_cannot_follow_costs_itself_alone():
    causes = {**CAUSES, "broken": {"broken": (0.0, 0.0, 1.0)}}
    found = diagnose(Model(fragile, {"gain": toleranced(1.0, 0.1)}, causes), [record(bend=BEND)])
    assert found.verdict.named == ("bend",)
    assert "broken" in found.verdict.refused
    assert sum(found.failures.values()) > 0


def test_a_cause_that_the_nominal_fit_has_put_out_of_reach_is_tried_elsewhere():
    """The upper tank's level is not measured: the fit had put it below every brim."""
    tanks = MACHINES["two tanks"]
    problem = Problem(
        tanks.model, [tanks.record(11, "overflowing", **tanks.hidden["overflow"])], DEFAULT
    )
    problem.learn(nominal_fit(problem))
    assert "brim" in problem.probed["overflow"].sizes


def test_another_error_has_the_same_spectrum_and_the_same_gaps():
    draw = np.random.default_rng(3)
    error = np.convolve(draw.standard_normal(1000), np.ones(9), "same")
    made = another(error, draw)
    assert np.abs(np.fft.rfft(made)) == pytest.approx(np.abs(np.fft.rfft(error)))
    assert np.abs(made - error).max() > 1.0
    error[100:300] = np.nan
    assert np.isnan(another(error, draw)).tolist() == np.isnan(error).tolist()


def test_rates_of_simulated_specimens():
    rates = calibrate(MODEL, [record()], specimens=6, hidden=2)
    assert rates.named_falsely == 0.0
    assert rates.failed == 0
    assert {name: told["named"] for name, told in rates.causes.items()} == dict.fromkeys(
        CAUSES, 1.0
    )
