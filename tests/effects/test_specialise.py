"""Copies of kernels with other text in them."""

from __future__ import annotations

import pytest

import vehicle_model.model.step as nominal_step
from pressure_control import servo_controller, state_places
from steering_bringup.direct import loop
from steering_core import specialise
from steering_plant.effects import EFFECTS
from steering_plant.effects.base import Effect, Parameter
from steering_plant.effects.compose import compose
from steering_plant.model import slots


def test_the_same_text_gives_the_same_package() -> None:
    text = '"""Nothing."""\n'
    first = specialise.specialised_package("vehicle_model.model", {"slots.py": text})
    again = specialise.specialised_package("vehicle_model.model", {"slots.py": text})
    assert first is again
    assert first.__name__ != "vehicle_model.model"


def test_a_file_that_is_not_there_cannot_be_replaced() -> None:
    with pytest.raises(ValueError, match=r"slot\.py"):
        specialise.specialised_package("vehicle_model.model", {"slot.py": ""})


def test_an_import_that_is_not_there_cannot_be_replaced() -> None:
    with pytest.raises(ValueError, match="does not import from steering_plant"):
        specialise.specialised_module(nominal_step, {"steering_plant": "other"})


def test_another_module_whose_name_begins_alike_is_left_alone() -> None:
    """The states of the controllers once came from a servo controller's, which has none."""
    other = "pressure_control.servo_controller"
    made = specialise.specialised_module(loop, {"pressure_control.controller": other})
    assert made.controller_step is servo_controller.controller_step
    assert made.SPOOL_SEEN == state_places.SPOOL_SEEN


def _effect(**changes: object) -> Effect:
    made = EFFECTS["cross_piston_leakage"]
    return Effect(**(vars(made) | changes))


def test_an_effect_in_an_unknown_slot_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    made = EFFECTS["cross_piston_leakage"].slots["left_flow"]
    monkeypatch.setitem(EFFECTS, "wrong", _effect(name="wrong", slots={"left_flows": made}))
    with pytest.raises(ValueError, match="wrong: unknown slot 'left_flows'; did you mean 'left_f"):
        compose({"wrong": {"leakage": 0.0}}, slots, {})


def test_an_argument_that_nobody_gives_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    parameters = {"leak": Parameter("", "m3/(s Pa)", 0, 0, 1, 0)}
    monkeypatch.setitem(EFFECTS, "wrong", _effect(name="wrong", parameters=parameters))
    with pytest.raises(ValueError, match="wrong: unknown argument 'leakage'"):
        compose({"wrong": {"leak": 0.0}}, slots, {})
