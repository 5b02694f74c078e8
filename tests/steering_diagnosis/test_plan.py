"""The planned experiment separates what it says, and runs."""

import numpy as np
import pytest

from steering_bringup.errors import BenchError
from steering_bringup.schema import Scenario
from steering_diagnosis.planning.candidates import CANDIDATES, scenario
from steering_diagnosis.planning.plan import plan
from steering_diagnosis.planning.separation import apart, separations
from steering_diagnosis.report import Cause, Estimate, Report, Source
from steering_plant.effects import EFFECTS


def report(verdict, causes=()):
    return Report(
        schema=1,
        bag=Source(path="run", sha256=""),
        software="",
        verdict=verdict,
        sentence="",
        causes=list(causes),
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


def test_friction_s_level_and_slope_part_where_the_pressure_changes():
    """With the wheels lifted the pressures hardly move: a slope looks like a level."""
    causes = [
        {"rack_friction_level": EFFECTS["rack_friction_level"].values({})},
        {"rack_friction_pressure_slope": EFFECTS["rack_friction_pressure_slope"].values({})},
    ]
    (parking,), (lifted,) = (
        separations(scenario(name, "open_centre"), causes, {})
        for name in ("parking", "wheel_lifted")
    )
    assert parking > 3.0 * lifted


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
    group = ambiguous("rack_friction_level", "rack_viscous_damping")
    chosen = plan(report("ambiguous", [group]), "open_centre")
    assert chosen.document["name"] == max(chosen.scores, key=chosen.scores.__getitem__)
    assert chosen.score > 0.05
    Scenario.model_validate(chosen.document)
