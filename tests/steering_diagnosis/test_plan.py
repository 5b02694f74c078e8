"""The planned experiment separates what it says, and runs."""

import numpy as np
import pytest

from steering_bringup.errors import BenchError
from steering_bringup.schema import Scenario
from steering_diagnosis.planning.candidates import CANDIDATES, scenario
from steering_diagnosis.planning.plan import plan
from steering_diagnosis.planning.separation import apart, separations
from steering_diagnosis.report import Cause, Estimate, Report, Source


def report(verdict, causes=()):
    return Report(
        bag=Source(path="run", sha256=""), software="", verdict=verdict, sentence="", causes=causes
    )


def ambiguous(*names, **parameters):
    values = {p: Estimate(value=v, low=v, high=v, unit="1") for p, v in parameters.items()}
    return Cause(
        effect=names[0], ambiguous_with=list(names[1:]), balance="", parameters=values,
        p_value=0.0, delta_bic=0.0, gain={},
    )  # fmt: skip


@pytest.mark.parametrize("valve_system", ["open_centre", "closed_centre"])
@pytest.mark.parametrize("name", CANDIDATES)
def test_every_candidate_is_a_scenario(name, valve_system):
    Scenario.model_validate(scenario(name, valve_system))


def test_alike_changes_are_not_apart_and_unlike_ones_are():
    random = np.random.default_rng(3)
    first, other, nuisance = random.normal(size=(3, 4000))
    none = np.zeros((4000, 1))
    assert apart(first, 2.0 * first, none) < 1e-2
    assert apart(first, other, none) == pytest.approx(1.0, rel=0.05)
    with_prior = apart(first + 0.5 * nuisance, first, nuisance[:, None])
    assert with_prior < 0.02


def test_relaxation_and_a_sensor_gain_part_most_where_the_vehicle_is_slow():
    """By rolling, a tyre lags over a distance: at walking pace it is seconds late."""
    causes = [
        {"tyre_relaxation": {"relaxation_length": 0.4}},
        {"torque_sensor_gain": {"gain": 1.05}},
    ]
    (slow,), (fast,) = (
        separations(scenario(name, "open_centre"), causes, {})
        for name in ("walking_pace", "motorway")
    )
    assert slow > 3.0 * fast


def test_nothing_ambiguous_leaves_nothing_to_plan():
    with pytest.raises(BenchError, match="nothing to plan"):
        plan(report("clean"), "open_centre")
    with pytest.raises(BenchError, match="not an effect"):
        plan(report("ambiguous", [ambiguous("parameter:x", "entrained_air")]), "open_centre")


def test_the_best_candidate_is_chosen(monkeypatch):
    monkeypatch.setattr(
        "steering_diagnosis.planning.plan.CANDIDATES",
        {name: CANDIDATES[name] for name in ("parking", "motorway")},
    )
    group = ambiguous("entrained_air", "cross_piston_leakage", air_fraction=0.02)
    chosen = plan(report("ambiguous", [group]), "open_centre")
    assert chosen.document["name"] == max(chosen.scores, key=chosen.scores.__getitem__)
    assert chosen.score > 1.0
    Scenario.model_validate(chosen.document)
