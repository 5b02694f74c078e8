"""What cannot be is refused with a clear text, at once."""

import math
import time

import numpy as np
import pytest

from steering_core.parameters import ParameterError, load_parameters
from steering_plant.plant import Plant, PlantError

PARAMETERS = load_parameters()
INPUTS = ("driver_torque", "left", "right", "load_force", "load_stiffness", "load_position")


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, 1e300])
@pytest.mark.parametrize("place", range(6), ids=INPUTS)
def test_a_command_that_is_no_number_ends_the_run_at_once(place, bad):
    plant = Plant(PARAMETERS, "closed_centre")
    inputs = np.array([1.0, 20.0, 20.0, 0.0, 1e5, 1e-3])
    for tick in range(5):
        plant.step(tick, *inputs)
    good = plant.state.copy()
    inputs[place] = bad
    begin = time.perf_counter()
    with pytest.raises(PlantError, match=r"left what is physically possible.*\(tick 5\)") as error:
        plant.step(5, *inputs)
    assert time.perf_counter() - begin < 1.0
    assert "rack_position" in str(error.value)
    assert "left_control_pressure" in str(error.value)
    assert np.all(np.isfinite(plant.state))
    assert plant.state[2] == pytest.approx(good[2], abs=1e-3)


def test_too_few_fixed_steps_are_named_as_a_cause():
    plant = Plant(PARAMETERS.with_values({"simulation.inner_steps": 1}), "closed_centre")

    def violent():
        for tick in range(500):
            plant.step(tick, 30.0, 80.0, 0.0, 0.0, 1e6, 0.0)

    with pytest.raises(PlantError, match=r"simulation\.inner_steps set too low"):
        violent()


@pytest.mark.parametrize("steps", [0.5, 2.5, 10_001.0])
def test_inner_steps_are_a_whole_number(steps):
    with pytest.raises(ValueError, match=r"simulation\.inner_steps must be a whole number"):
        Plant(PARAMETERS.with_values({"simulation.inner_steps": steps}), "open_centre")


def test_a_stroke_longer_than_the_chamber_is_refused():
    changed = PARAMETERS.with_values({"open_centre.chamber_volume": 5e-5})
    with pytest.raises(ValueError, match=r"open_centre\.chamber_volume.*would vanish"):
        Plant(changed, "open_centre")


def test_openings_that_cannot_be_are_refused():
    changed = PARAMETERS.with_values({"open_centre.maximum_opening": 2e-6})
    with pytest.raises(ParameterError, match=r"maximum_opening must exceed"):
        Plant(changed, "open_centre")


@pytest.mark.parametrize(
    "change",
    [
        {"closed_centre.supply_pressure": 2e5},
        {"valve_controller.common_pressure_raise": 3e7},
    ],
)
def test_a_supply_below_the_pressure_of_rest_is_named(change):
    """The search for the spool's rest once failed with the solver's own text."""
    with pytest.raises(ParameterError, match=r"closed_centre\.supply_pressure .* must exceed"):
        Plant(PARAMETERS.with_values(change), "closed_centre")


def test_an_unknown_valve_system_names_the_nearest():
    with pytest.raises(ValueError, match="did you mean 'open_centre'"):
        Plant(PARAMETERS, "open_center")
