"""An overlay as pressures in the two chambers, and through the controllers."""

import copy

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pressure_control.controller import ValveController
from pressure_control.overlay.split import overlaid
from steering_core.parameters import load_parameters

PARAMETERS = load_parameters()
SIDES = {side: ValveController(PARAMETERS, side) for side in ("left", "right")}
P = SIDES["right"].par[0]
PER_TORQUE = PARAMETERS["mechanics.gear_ratio"] / PARAMETERS["mechanics.piston_area"]
pressure = st.floats(0.0, 1e7)
torque = st.floats(-10.0, 10.0)


@given(right=pressure, left=pressure, overlay=torque)
def test_the_load_pressure_changes_by_the_overlay_and_no_chamber_falls_below_zero(
    right, left, overlay
):
    high, low = overlaid(P, right, left, overlay), overlaid(P, left, right, -overlay)
    assert min(high, low) >= 0.0
    assert (high - low) - (right - left) == pytest.approx(overlay * PER_TORQUE, abs=1e-3)


@given(right=pressure, left=pressure, overlay=torque)
def test_one_is_lowered_by_half_as_far_as_it_goes(right, left, overlay):
    half = 0.5 * abs(overlay) * PER_TORQUE
    found = overlaid(P, right, left, overlay)
    if overlay <= 0.0:
        assert found == pytest.approx(right - min(half, right), abs=1e-6)
    else:
        assert found == pytest.approx(right + 2.0 * half - min(half, left), abs=1e-6)


def test_one_newton_metre_is_1_87_bar():
    right = overlaid(P, 5e5, 5e5, 1.0)
    left = overlaid(P, 5e5, 5e5, -1.0)
    assert right - left == pytest.approx(1.87e5, rel=1e-12)


def references(overlay, torsion, turned=1.0):
    """Return both references [Pa] of one tick at rest but for a torsion-bar torque."""
    found = {}
    for side, controller in SIDES.items():
        core = copy.deepcopy(controller)
        row = (0.0, 0.0, turned * torsion, 5e5, 5e5, 2e7, 0.0, 0.0, 0.0, turned * overlay)
        found[side] = core.step(0, *row)[0]
    return found


@pytest.mark.parametrize("torsion", [-3.0, 0.0, 1.5, 3.5])
@pytest.mark.parametrize("overlay", [-10.0, -2.0, 0.5, 10.0])
def test_the_controllers_add_it_whatever_the_boost_curves_slope(overlay, torsion):
    plain, added = references(0.0, torsion), references(overlay, torsion)
    change = (added["right"] - added["left"]) - (plain["right"] - plain["left"])
    assert change == pytest.approx(overlay * PER_TORQUE, rel=1e-9)
    mirrored = references(overlay, torsion, -1.0)
    assert (mirrored["left"], mirrored["right"]) == (added["right"], added["left"])


def test_no_overlay_is_the_controller_without_one():
    for controller in SIDES.values():
        one, other = copy.deepcopy(controller), copy.deepcopy(controller)
        for tick in range(20):
            row = (0.1, 0.3 * tick, 0.2 * tick, 5e5, 6e5, 2e7, 1e-3, 1e-2, 0.0)
            assert one.step(tick, *row).tobytes() == other.step(tick, *row, 0.0).tobytes()
            assert np.array_equal(one.state, other.state)
