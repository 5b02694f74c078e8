"""What holds for every registered effect."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from closed_loop import Effects, cores, trace
from hypothesis import given, settings
from hypothesis import strategies as st

from steering_core.parameters import load_parameters
from steering_plant.effects import EFFECTS
from steering_plant.effects.base import arguments
from steering_plant.plant import Plant

NEUTRAL = {name: effect.neutral() for name, effect in EFFECTS.items()}

SYSTEMS = ("open_centre", "closed_centre")


@pytest.mark.parametrize("valve_system", SYSTEMS)
def test_neutral_effects_reproduce_the_nominal_model_to_the_bit(valve_system: str) -> None:
    nominal, neutral = trace({}, valve_system), trace(NEUTRAL, valve_system)
    for topic, values in nominal.topics().items():
        assert values.tobytes() == neutral.topics()[topic].tobytes(), topic


@pytest.mark.parametrize("name", EFFECTS)
def test_a_typical_effect_shows(name: str) -> None:
    nominal, changed = trace({}, "closed_centre"), trace({name: {}}, "closed_centre")
    difference = max(
        float(np.max(np.abs(values - changed.topics()[topic])))
        for topic, values in nominal.topics().items()
    )
    assert difference > 1e-6


@pytest.mark.parametrize("name", EFFECTS)
def test_an_effect_says_what_it_is(name: str) -> None:
    effect = EFFECTS[name]
    assert effect.name == name
    assert re.fullmatch(r"[a-z]+(_[a-z]+)*", name)
    for text in (effect.summary, effect.sees, effect.equation, effect.source, effect.balance):
        assert len(text) > 3
    assert effect.parameters
    for parameter in effect.parameters.values():
        assert parameter.unit
        assert parameter.low <= parameter.neutral <= parameter.high
        assert parameter.low <= parameter.typical <= parameter.high
    assert any(p.typical != p.neutral for p in effect.parameters.values())


@pytest.mark.parametrize("name", [n for n, e in EFFECTS.items() if e.sets])
def test_what_an_effect_sets_is_on_the_data_sheet_and_neutral_is_its_value(name: str) -> None:
    sheet = load_parameters()
    for parameter, full_name in EFFECTS[name].sets.items():
        assert sheet[full_name] == EFFECTS[name].parameters[parameter].neutral


TAKEN_POWER = {
    "left_flow": lambda s, added: -s["left"] * added,
    "right_flow": lambda s, added: -s["right"] * added,
    "rack_force": lambda s, added: s["velocity"] * added,
    "column_torque": lambda s, added: s["speed"] * added,
    "spool_force": lambda s, added: s["speed"] * added,
}
"""Power [W] that an effect takes out of the model through what it adds in a slot."""

CONSERVATIVE = {"bulk_modulus"}
"""Slots with a function of one pressure alone, which gives back in a cycle what it took."""


@given(
    st.fixed_dictionaries(
        {
            "left": st.floats(-1e5, 2e7),
            "right": st.floats(-1e5, 2e7),
            "velocity": st.floats(-1, 1),
            "speed": st.floats(-20, 20),
            "position": st.floats(-0.1, 0.1),
            "angle": st.floats(-10, 10),
            "spool": st.floats(-1e-3, 1e-3),
        }
    )
)
@settings(max_examples=200, deadline=None)
def test_an_effect_that_is_no_source_never_adds_power(signals: dict[str, float]) -> None:
    for effect in EFFECTS.values():
        if effect.adds_energy:
            continue
        known = signals | {n: p.typical for n, p in effect.parameters.items()}
        power = 0.0
        for slot, made in effect.slots.items():
            assert slot in TAKEN_POWER or slot in CONSERVATIVE, f"{effect.name}: judge {slot}"
            if slot in TAKEN_POWER:
                added = made(*(0.0 if a == "value" else known[a] for a in arguments(made)))
                power += TAKEN_POWER[slot](signals, added)
        assert power >= 0.0, effect.name


@pytest.mark.parametrize("valve_system", SYSTEMS)
def test_effects_start_at_rest(valve_system: str) -> None:
    """With every effect on, nothing moves until the driver does."""
    typical: Effects = {name: {} for name, effect in EFFECTS.items() if not effect.sets}
    made = cores(typical, valve_system, 10)
    plant = made.plant
    start = plant.state.copy()
    left, right = (0.0 if c is None else float(c.out[1]) for c in (made.left, made.right))
    plant.step(0, 0.0, left, right, 0.0, 0.0, 0.0)
    moved = np.abs(plant.state[:8] - start[:8])
    assert np.all(moved[:4] < 1e-9)
    assert np.all(moved[6:8] < 1e3)


def test_an_unknown_effect_is_named_with_the_nearest() -> None:
    with pytest.raises(ValueError, match="entrained_air"):
        Plant(load_parameters(), "open_centre", effects={"entraned_air": {}})


def test_an_unknown_parameter_is_named_with_the_nearest() -> None:
    with pytest.raises(ValueError, match="air_fraction"):
        Plant(load_parameters(), "open_centre", effects={"entrained_air": {"air_fracton": 0.1}})


@pytest.mark.parametrize("value", [math.nan, math.inf, -1.0, 0.5])
def test_a_value_out_of_bounds_is_refused(value: float) -> None:
    with pytest.raises(ValueError, match=r"entrained_air\.air_fraction must be between"):
        EFFECTS["entrained_air"].values({"air_fraction": value})
