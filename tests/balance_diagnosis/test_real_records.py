"""Public records of three machines, one setting: right names, and none without the true cause.

STEER_EMPS_DATA, STEER_TANKS_DATA and STEER_SEALS_DATA say where they are.
"""

from __future__ import annotations

import importlib.util
import os
from pathlib import Path

import pytest

from balance_diagnosis import diagnose

EXAMPLES = Path(__file__).parents[2] / "src" / "balance_diagnosis" / "examples"


def example(name):
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def folder(variable):
    if not os.environ.get(variable):
        pytest.skip(f"{variable} does not say where the public records are")
    return os.environ[variable]


def named(found):
    return {*found.verdict.named, *(name for group in found.verdict.groups for name in group)}


def test_the_axis_rubs_more_in_one_direction():
    fit, held = example("emps_axis").records(folder("STEER_EMPS_DATA"))
    found = diagnose(example("emps_axis").MODEL, [fit], [held])
    assert found.verdict.named == ("viscous friction by direction",)
    beyond = [band for band in found.remaining if band.record == "DATA_EMPS_PULSES"]
    assert max(band.high for band in beyond) > 15.0  # the mode that no cause holds


@pytest.mark.slow
def test_the_upper_tank_overflows_into_the_lower_one():
    fit, held = example("cascaded_tanks").records(folder("STEER_TANKS_DATA"))
    found = diagnose(example("cascaded_tanks").MODEL, [fit], [held])
    assert "overflow into the lower tank" in named(found)
    (gain,) = (g for g in found.gains if g.held_out)
    assert gain.extended < 0.37


@pytest.mark.slow
@pytest.mark.parametrize("seal", ["O-ring", "PK"])
def test_the_seals_friction_grows_with_pressure(seal):
    place = folder("STEER_SEALS_DATA")
    seals = example("seal_friction")
    every = [seals.record(place, seal, bar) for bar in (1, 3, 5, 7)]
    fit = [r.part(0.0, 0.5) for r in every]
    found = diagnose(seals.MODEL, fit)
    assert "friction grows with pressure" in found.verdict.named
    assert 0.5 < found.causes["friction grows with pressure"]["by_pressure"].value < 0.8
    assert not {"Stribeck friction", "load cell is not linear"} & named(found)
    lean = diagnose(seals.MODEL.without("friction grows with pressure"), fit)
    assert lean.verdict.word == "unexplained"
    assert named(lean) == set()
