"""What an effect shows beside another one is what a diagnosis can see of it."""

from __future__ import annotations

import numpy as np
import pytest

from steering_core.parameters import load_parameters
from steering_diagnosis.benchmark.cases import draw_case, seen_as
from steering_diagnosis.benchmark.truth.course import draw_course
from steering_diagnosis.benchmark.truth.effects import TRUE_EFFECTS
from steering_diagnosis.benchmark.truth.run import run_closed_loop
from steering_diagnosis.benchmark.truth.specimen import draw_specimen
from steering_diagnosis.benchmark.visibility import VISIBLE, Probe, Sensitivity

SYSTEM = "open_centre"
HEAVY, SOFT = 8.27, -0.515


@pytest.fixture(scope="module")
def probe():
    random = np.random.default_rng(4)
    nominal = load_parameters()
    course = draw_course(random, 6.0, "park", "dry_park")
    specimen = draw_specimen(nominal, random)
    given = run_closed_loop(specimen, nominal, course, closed=False)
    return Probe(specimen, nominal, SYSTEM, course, given)


def known(*names):
    return {name: TRUE_EFFECTS[SYSTEM][name] for name in names}


def test_alone_it_is_the_effect_itself(probe):
    (effect,) = known("rack_mass").values()
    alone = probe.beside({"rack_mass": HEAVY})
    assert np.allclose(alone["rack_mass"], probe.effect(effect, HEAVY), atol=1e-9)


def test_together_the_two_make_the_whole_change(probe):
    sizes = {"rack_mass": HEAVY, "torsion_bar_stiffness": SOFT}
    both = known(*sizes)
    seen = probe.beside(sizes)
    bar = probe.effect(both["torsion_bar_stiffness"], SOFT)
    mass = probe.effect(both["rack_mass"], HEAVY)
    assert np.allclose(seen["rack_mass"] + bar, seen["torsion_bar_stiffness"] + mass, atol=1e-6)
    assert not np.allclose(seen["rack_mass"], mass, rtol=0.1)


def test_both_effects_of_a_pair_are_visible_beside_each_other():
    """A heavy rack rang on this seed's first record at one stick, and beside the soft bar not."""
    sealed = draw_case("pair", 630027).sealed
    assert min(sealed.ratios.values()) > VISIBLE


def test_what_is_too_small_to_be_seen_needs_no_run_of_its_own():
    """A lag of 20 us is too short for the step of these runs."""
    seen = Sensitivity({"lag": np.ones(8)}, {"lag": 0.01}, np.zeros((8, 1)))
    found = seen_as("invisible", None, seen, {"lag": 2e-5})  # type: ignore[arg-type]
    assert np.allclose(found["lag"], 2e-3)
