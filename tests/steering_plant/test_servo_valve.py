"""Servo valves and load cylinder against closed forms and balances written here."""

import numpy as np
import pytest
from fine_steps import CLAMP, sampled
from scipy.signal import TransferFunction, step

from steering_core.parameters import load_parameters
from steering_plant.model import states
from steering_plant.plant import Plant
from steering_plant.rest import rest_servo_command

PARAMETERS = load_parameters()
SERVO = PARAMETERS.group("servo_valve")
CYLINDER = PARAMETERS.group("load_cylinder")
SPAN, COUNT = 2e-5, 50
FIRST = states.SERVO_VALVE_SIZE


def samples(plant, inputs, ticks):
    parts = [sampled(plant, inputs, SPAN, COUNT) for _ in range(ticks)]
    return np.concatenate([parts[0], *[part[1:] for part in parts[1:]]])


def integral(values):
    return SPAN * (values.sum() - 0.5 * (values[0] + values[-1]))


def test_spools_follow_a_step_as_a_linear_second_order_system():
    """Both valves of a chamber, in opposite directions, 250 Hz (7.3)."""
    plant = Plant(PARAMETERS, "servo_valve")
    rest = rest_servo_command(plant.par[0], plant.state[states.LEFT])
    y = samples(plant, (0.0, rest + 0.1, rest, 0.0, CLAMP, 0.0, 0.0), 8)
    w, d = SERVO["resonance"], SERVO["damping"]
    time = SPAN * np.arange(len(y))
    _, expected = step(TransferFunction([w * w], [1.0, 2.0 * d * w, w * w]), T=time)
    opened = (y[:, states.LEFT_SERVO] - y[0, states.LEFT_SERVO]) / SERVO["stroke"]
    closed = y[:, states.LEFT_SERVO + 2] - y[0, states.LEFT_SERVO + 2]
    np.testing.assert_allclose(opened, 0.1 * expected, atol=1e-6)
    np.testing.assert_allclose(closed / SERVO["stroke"], -opened, atol=1e-12)


def test_the_bias_lets_equal_flows_through_at_half_the_supply():
    plant = Plant(PARAMETERS, "servo_valve")
    assert rest_servo_command(plant.par[0], 0.5 * plant.par[0]["supply_pressure"]) == 0.0
    for tick in range(200):
        plant.step(tick, 0.0, 0.0, 0.0, 0.0, CLAMP, 0.0)
    half = 0.5 * PARAMETERS["closed_centre.supply_pressure"]
    np.testing.assert_allclose(plant.state[[states.LEFT, states.RIGHT]], half, rtol=1e-3)


@pytest.mark.parametrize("command", [-1.0, 1.0])
def test_full_commands_lead_to_tank_and_supply(command):
    plant = Plant(PARAMETERS, "servo_valve")
    for tick in range(300):
        plant.step(tick, 0.0, command, command, 0.0, CLAMP, 0.0)
    end = 0.0 if command < 0.0 else PARAMETERS["closed_centre.supply_pressure"]
    assert plant.state[states.LEFT] == pytest.approx(end, abs=1e4)


def moved_cylinder(ticks=60):
    """The piston is pushed to and fro by its valve on a spring in the rack's end."""
    plant = Plant(PARAMETERS, "servo_valve", load_cylinder=True)
    rest = rest_servo_command(plant.par[0], plant.state[states.LEFT])
    parts = [
        samples(plant, (0.0, rest, rest, 0.0, 0.0, 0.0, opening), ticks)
        for opening in (0.03, -0.05, 0.04)
    ]
    return plant, parts


def test_the_load_cylinders_oil_is_accounted_for():
    """Flow in, by the orifice law written here, less volume swept and oil compressed."""
    _, parts = moved_cylinder()
    oil = PARAMETERS.group("oil")
    full = oil["flow_coefficient"] * np.sqrt(2.0 / oil["density"]) * CYLINDER["full_opening"]

    def through(share, drop):
        smooth = np.sqrt(np.hypot(drop, oil["laminar_transition_pressure"]))
        return full * np.clip(share, 0.0, 1.0) * drop / smooth

    for y in parts:
        piston, share = y[:, FIRST + states.PISTON], y[:, FIRST + states.LOAD_SPOOL]
        share = share / SERVO["stroke"]
        for sign, place in ((1.0, states.LOAD_LEFT), (-1.0, states.LOAD_RIGHT)):
            pressure = y[:, FIRST + place]
            flow = through(CYLINDER["underlap"] + sign * share, 2e7 - pressure)
            flow -= through(CYLINDER["underlap"] - sign * share, pressure)
            swept = sign * CYLINDER["piston_area"] * (piston[-1] - piston[0])
            volume = CYLINDER["chamber_volume"] - sign * CYLINDER["piston_area"] * piston
            compressed = volume / oil["bulk_modulus"]
            squeezed = np.sum(0.5 * (compressed[1:] + compressed[:-1]) * np.diff(pressure))
            assert abs(integral(flow) + swept - squeezed) < 1e-5 * integral(np.abs(flow))


def test_the_load_cylinder_creates_no_energy():
    """The oil's work on the piston is stored, rubbed away or done on the rack through the cell."""
    _, parts = moved_cylinder()
    for y in parts:
        piston, speed, friction = (y[:, FIRST + i] for i in range(3))
        load = y[:, FIRST + states.LOAD_RIGHT] - y[:, FIRST + states.LOAD_LEFT]
        given = integral(load * CYLINDER["piston_area"] * speed)
        stretch = y[:, states.POSITION] - piston
        stretching = y[:, states.VELOCITY] - speed
        cell = CYLINDER["cell_stiffness"] * stretch + CYLINDER["cell_damping"] * stretching
        kinetic = 0.5 * CYLINDER["piston_mass"] * (speed[-1] ** 2 - speed[0] ** 2)
        lost = integral(CYLINDER["damping"] * speed**2 + friction * speed)
        assert lost > 0.0
        moved = integral(np.abs(load) * CYLINDER["piston_area"] * np.abs(speed))
        assert abs(given - kinetic - lost + integral(cell * speed)) < 1e-4 * moved


def test_the_load_cell_measures_what_the_rack_feels():
    """An opened valve pushes the rack to the right turn's side and the load reads positive."""
    plant, _ = moved_cylinder(ticks=1)
    for tick in range(20):
        plant.step(tick, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.05)
    assert plant.out[8] > 100.0
    assert plant.state[states.POSITION] < 0.0


def test_without_a_load_cylinder_its_valve_does_nothing():
    plain, other = (Plant(PARAMETERS, "closed_centre") for _ in range(2))
    for tick in range(50):
        plain.step(tick, 1.0, 14.0, 15.0, 200.0, 4e5, 0.0)
        other.step(tick, 1.0, 14.0, 15.0, 200.0, 4e5, 0.0, 0.7)
    assert np.array_equal(plain.state, other.state)


def test_load_chambers_must_be_larger_than_the_stroke():
    small = PARAMETERS.with_values({"load_cylinder.chamber_volume": 1e-5})
    Plant(small, "servo_valve")
    with pytest.raises(ValueError, match=r"load_cylinder\.chamber_volume"):
        Plant(small, "servo_valve", load_cylinder=True)
