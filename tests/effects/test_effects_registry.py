"""What holds for every registered effect."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest
from closed_loop import Effects, trace
from hypothesis import given, settings
from hypothesis import strategies as st

from steering_core.parameters import load_parameters
from steering_plant.boost_curve import FORMULA
from steering_plant.effects import EFFECTS
from steering_plant.effects.base import BALANCES, VALVE_SYSTEMS, Parameter, arguments
from steering_plant.effects.models import all_effects, plant_model, vehicle_model
from steering_plant.effects.table import page
from steering_plant.model import step
from steering_plant.model.states import LEFT, VELOCITY
from steering_plant.plant import Plant
from steering_plant.rest import rest_servo_command, rest_solenoid_force
from vehicle_model.model import slots
from vehicle_model.model import step as vehicle_step

IN_PLANT = [name for name, effect in EFFECTS.items() if effect.acts_in == "plant"]

UNDRIVEN = {"rack_end_stop"}
"""What a weave on-centre cannot show."""


def rest_command(plant: Plant) -> float:
    """Return the command to either valve that holds the pressure at rest."""
    par, pressure = plant.par[0], float(plant.state[LEFT])
    if plant.valve_system == "servo_valve":
        return rest_servo_command(par, pressure)
    return rest_solenoid_force(par, pressure) if plant.valve_system == "closed_centre" else 0.0


def weave(valve_system: str, effects: Effects, load_cylinder: bool = False) -> np.ndarray:
    """Return measurements and truth, (400, 17), of a plant turned to and fro with its valves."""
    plant = Plant(load_parameters(), valve_system, FORMULA, effects, load_cylinder)
    rest = rest_command(plant)
    size = 0.02 if valve_system == "servo_valve" else 4.0
    rows = []
    for tick in range(400):
        swing = math.sin(0.015 * tick)
        left, right = rest - size * min(swing, 0.0), rest + size * max(swing, 0.0)
        measured = plant.step(tick, 2.0 * swing, left, right, 0.0, 3e5, 0.0)
        rows.append(np.concatenate([measured, plant.truth(tick + 1)]))
    return np.array(rows)


@pytest.fixture(scope="module")
def nominal() -> dict[str, np.ndarray]:
    return {valve_system: weave(valve_system, {}) for valve_system in VALVE_SYSTEMS}


@pytest.mark.parametrize("valve_system", VALVE_SYSTEMS)
def test_neutral_effects_reproduce_the_nominal_model_to_the_bit(
    valve_system: str, nominal: dict[str, np.ndarray]
) -> None:
    neutral = weave(valve_system, all_effects(valve_system))
    assert neutral.tobytes() == nominal[valve_system].tobytes()


def test_effects_act_beside_a_load_cylinder_too() -> None:
    """Neutral ones change no bit; more friction of its piston shows."""
    nominal = weave("open_centre", {}, load_cylinder=True)
    neutral = weave("open_centre", all_effects("open_centre"), load_cylinder=True)
    friction: Effects = {"load_cylinder_friction": {"level": 100.0}}
    rubbing = weave("open_centre", all_effects("open_centre", friction), load_cylinder=True)
    assert neutral.tobytes() == nominal.tobytes()
    assert np.max(np.abs(rubbing - nominal)[:, 8]) > 10.0


def test_neutral_tyres_reproduce_the_nominal_vehicle_to_the_bit() -> None:
    neutral = {"tyre_relaxation": EFFECTS["tyre_relaxation"].neutral()}
    loads = [trace(effects, "open_centre", 300).load for effects in ({}, neutral)]
    assert loads[0].tobytes() == loads[1].tobytes()


@pytest.mark.parametrize("name", [name for name in IN_PLANT if name not in UNDRIVEN])
def test_a_typical_effect_shows(name: str, nominal: dict[str, np.ndarray]) -> None:
    effect = EFFECTS[name]
    for valve_system in effect.valve_systems:
        changed = weave(valve_system, all_effects(valve_system, {name: effect.values({})}))
        assert np.max(np.abs(changed - nominal[valve_system])) > 1e-6, valve_system


@pytest.mark.parametrize("name", EFFECTS)
def test_an_effect_says_what_it_is(name: str) -> None:
    effect = EFFECTS[name]
    assert effect.name == name
    assert re.fullmatch(r"[a-z]+(_[a-z]+)*", name)
    for text in (effect.summary, effect.sees, effect.equation, effect.source, effect.excitation):
        assert len(text) > 3
    assert set(effect.balances) <= set(BALANCES)
    assert set(effect.competes) <= set(load_parameters())
    assert effect.valve_systems
    assert set(effect.valve_systems) <= set(VALVE_SYSTEMS)
    for parameter in effect.parameters.values():
        assert parameter.unit
        assert parameter.low <= parameter.neutral <= parameter.high
        assert parameter.low <= parameter.typical <= parameter.high
        assert set(parameter.valve_systems) <= set(effect.valve_systems)
    for valve_system in effect.valve_systems:
        acting = effect.acting(valve_system).values()
        assert any(p.typical != p.neutral for p in acting), valve_system


@pytest.mark.parametrize("name", [n for n, e in EFFECTS.items() if e.sets])
def test_what_an_effect_changes_is_on_the_data_sheet_and_neutral_changes_nothing(name: str) -> None:
    sheet = load_parameters()
    for parameter, change in EFFECTS[name].sets.items():
        neutral = EFFECTS[name].parameters[parameter].neutral
        assert neutral == change.neutral
        for full in change.names:
            assert change.applied(sheet[full], neutral) == sheet[full]


@pytest.mark.parametrize("valve_system", VALVE_SYSTEMS)
def test_every_choice_of_effects_is_of_one_model_and_none_is_the_nominal_one(
    valve_system: str,
) -> None:
    model = plant_model(all_effects(valve_system), valve_system)[0]
    for name, effect in EFFECTS.items():
        chosen = {name: effect.values({})}
        wanted = model if effect.slots else step
        assert plant_model(chosen, valve_system)[0] is wanted, name
    assert plant_model({}, valve_system)[0] is step


def test_the_vehicle_takes_all_its_effects_beside_one_of_the_plant() -> None:
    both = {name: EFFECTS[name].values({}) for name in ("rack_backlash", "tyre_relaxation")}
    beside = [vehicle_model({name: both[name]}, slots, vehicle_step) for name in both]
    assert beside[0][0] is beside[1][0]
    assert beside[0][1].tolist() == [0.0]  # neutral where only the plant's is on
    assert vehicle_model({}, slots, vehicle_step)[0] is vehicle_step


def test_the_model_of_all_effects_says_where_each_parameter_and_state_is() -> None:
    for valve_system in VALVE_SYSTEMS:
        typical = {name: EFFECTS[name].values({}) for name in all_effects(valve_system)}
        module, added = plant_model(typical, valve_system)
        assert module is plant_model(all_effects(valve_system), valve_system)[0]
        for (effect, parameter), position in added.positions.items():
            assert added.values[position] == typical[effect][parameter]
        in_slots = [n for n in typical if EFFECTS[n].slots]
        assert len(added.positions) == sum(len(EFFECTS[n].parameters) for n in in_slots)
        assert sorted(added.states.values()) == list(range(-len(added.rests), 0))


TAKEN_POWER = {
    "left_flow": lambda s, added: -s["left"] * added,
    "right_flow": lambda s, added: -s["right"] * added,
    "rack_force": lambda s, added: s["velocity"] * added,
    "column_torque": lambda s, added: s["speed"] * added,
    "load_force": lambda s, added: s["velocity"] * added,
}
"""Power [W] that an effect takes out of the model through what it adds in a slot."""

CONSERVATIVE = {"bulk_modulus", "torsion_torque"}
"""Slots with a function of one coordinate alone, which gives back in a cycle what it took."""

THROTTLES = {"valve_torque", "valve_overlap", "flow_coefficient", "spool_opening"}
"""Slots that open and close orifices: any opening loses pressure in the direction of the flow."""

STORED = {"left_volume", "right_volume"}
"""Slots that make a spring longer or shorter by a constant."""

FRICTION = {
    "rack_friction_limit",
    "rack_friction_middle",
    "column_friction_limit",
    "load_cylinder_friction_limit",
}
"""Slots of friction elements: passive where the band of the force holds zero, tested below."""

BEHIND_A_STATE = {"left_spool_force", "right_spool_force", "load_force", "supply_pressure"}
"""Slots of effects whose force or pressure is a state of its own: see test_effects_physics."""

SIGNALS = {
    "left": st.floats(-1e5, 2e7),
    "right": st.floats(-1e5, 2e7),
    "velocity": st.floats(-1, 1),
    "speed": st.floats(-20, 20),
    "position": st.floats(-0.1, 0.1),
    "angle": st.floats(-10, 10),
}


def drawn(name: str, parameter: Parameter) -> st.SearchStrategy[float]:
    return st.floats(parameter.low, parameter.high)


PARAMETERS = {
    (name, parameter): drawn(parameter, p)
    for name, effect in EFFECTS.items()
    for parameter, p in effect.parameters.items()
}


@given(st.fixed_dictionaries(SIGNALS), st.fixed_dictionaries(PARAMETERS))
@settings(max_examples=200, deadline=None)
def test_an_effect_that_is_no_source_never_adds_power(
    signals: dict[str, float], values: dict[tuple[str, str], float]
) -> None:
    known = CONSERVATIVE | THROTTLES | STORED | FRICTION | BEHIND_A_STATE | TAKEN_POWER.keys()
    for effect in EFFECTS.values():
        if effect.adds_energy or effect.acts_in != "plant":
            continue
        given_values = {n: values[effect.name, n] for n in effect.parameters}
        power = 0.0
        for slot, made in effect.slots.items():
            assert slot in known, f"{effect.name}: judge {slot}"
            if slot in TAKEN_POWER and not effect.states:
                own = signals | given_values
                added = made(*(0.0 if a == "value" else own[a] for a in arguments(made)))
                power += TAKEN_POWER[slot](signals, added)
        assert power >= 0.0, effect.name


@pytest.mark.parametrize("valve_system", VALVE_SYSTEMS)
def test_with_every_effect_on_the_plant_comes_to_rest(valve_system: str) -> None:
    """Nobody at the wheel, no load: what starts out of balance settles and stays."""
    typical = {
        name: EFFECTS[name].values({})
        for name in all_effects(valve_system)
        if not EFFECTS[name].adds_energy
    }
    plant = Plant(load_parameters(), valve_system, effects=all_effects(valve_system, typical))
    rest = rest_command(plant)
    for tick in range(1500):
        plant.step(tick, 0.0, rest, rest, 0.0, 0.0, 0.0)
    assert abs(plant.state[VELOCITY]) < 1e-3


def test_the_page_of_effects_is_that_of_the_registry() -> None:
    """``python -m steering_plant.effects.table > docs/effects.md`` makes it again."""
    made = Path(__file__).parents[2] / "docs" / "effects.md"
    assert made.read_text(encoding="utf-8") == page()


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


def test_two_plants_of_the_model_of_all_effects_differ_by_their_values_alone() -> None:
    offset: Effects = {"boost_curve_offset": {"offset": 0.2}}
    plants = [
        Plant(load_parameters(), "open_centre", effects=all_effects("open_centre", effects))
        for effects in ({}, offset)
    ]
    assert plants[0].model is plants[1].model
    first, second = (plant.step(0, *[0.0] * 6).copy() for plant in plants)
    assert not np.array_equal(first, second)
