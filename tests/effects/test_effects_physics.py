"""Each effect against a second route: a closed form, a hand-worked figure, another filter."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from closed_loop import trace
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import trapezoid
from scipy.signal import lfilter

from steering_core.parameters import load_parameters
from steering_plant.boost_curve import opening_areas
from steering_plant.effects import (
    chamber_volume_imbalance,
    cross_piston_leakage,
    entrained_air,
    external_leakage_left,
    external_leakage_right,
    pump_flow_ripple,
    rack_backlash,
    rack_friction_asymmetry,
    rack_stribeck_friction,
    valve_spool_stiction,
)
from steering_plant.effects.models import all_effects
from steering_plant.model.friction import yielding_rate
from steering_plant.model.states import LEFT, PUMP, RIGHT
from steering_plant.plant import Plant
from steering_plant.rest import rest_solenoid_force

BLOCKED = (0.0, 1e10, 0.0)
"""Load that holds the rack: force [N], stiffness [N/m], position [m]."""

FREE = (0.0, 0.0, 0.0)


def plant(valve_system: str, **effects: dict[str, float]) -> Plant:
    """Return a plant of the model with all effects, those not given neutral."""
    return Plant(load_parameters(), valve_system, effects=all_effects(valve_system, effects))


def held(made: Plant) -> float:
    """Return the solenoids' force at rest [N]."""
    closed = made.valve_system == "closed_centre"
    return rest_solenoid_force(made.par[0], made.state[LEFT]) if closed else 0.0


def driven(
    made: Plant,
    ticks: int,
    torque: Callable[[float], float] = lambda t: 0.0,
    load: tuple[float, float, float] = FREE,
    command: Callable[[float], float] = lambda t: 0.0,
) -> np.ndarray:
    """Return what is measured, (ticks, 9), with a driver's torque and a command to both valves."""
    rest = held(made)
    rows = np.empty((ticks, 9))
    for tick in range(ticks):
        t = 1e-3 * tick
        force = rest + command(t)
        rows[tick] = made.step(tick, torque(t), force, force, *load)
    return rows


def swing(t: float) -> float:
    return 6.0 * math.sin(2.0 * math.pi * t)


CHANGED = {
    ("rack_friction_level", "factor", 2.0): ("rack_friction", 120.0),
    ("rack_friction_pressure_slope", "factor", 1.5): ("rack_friction_pressure_slope", 3.3e-5),
    ("rack_viscous_damping", "added", 3e3): ("rack_damping", 3250.0),
    ("rack_mass", "added", 12.0): ("rack_mass", 36.0),
    ("rack_end_stop", "earlier", 0.01): ("rack_stop_position", 0.065),
    ("rack_end_stop", "stiffness", 0.1): ("rack_stop_stiffness", 2e6),
    ("column_friction", "factor", 2.0): ("column_friction", 0.6),
    ("torsion_bar_stiffness", "factor", 0.5): ("torsion_bar_stiffness", 30.367),
    ("valve_overlap", "overlap", 2e-5): ("underlap", -1.5e-5),
}


@pytest.mark.parametrize(("effect", "parameter", "value"), CHANGED)
def test_an_effect_on_a_data_sheet_value_gives_the_value_worked_by_hand(
    effect: str, parameter: str, value: float
) -> None:
    field, expected = CHANGED[effect, parameter, value]
    made = plant("closed_centre", **{effect: {parameter: value}})
    assert made.par[field][0] == pytest.approx(expected, rel=1e-12)


BIAS = {
    ("torque_sensor_gain", "gain", 1.1): (2, 1.1, 0.0),
    ("torque_sensor_offset", "offset", 0.2): (2, 1.0, 0.2),
    ("rack_force_sensor_gain", "gain", 0.9): (8, 0.9, 0.0),
    ("rack_force_sensor_offset", "offset", -50.0): (8, 1.0, -50.0),
    ("pressure_sensor_offset_left", "offset", 1e5): (3, 1.0, 1e5),
    ("pressure_sensor_offset_right", "offset", -1e5): (4, 1.0, -1e5),
}
LATE = {
    ("torque_sensor_delay", "delay", 0.0025): (2,),
    ("angle_sensor_delay", "delay", 0.004): (0, 1),
    ("pressure_sensor_lag", "time_constant", 0.006): (3, 4),
}


@pytest.fixture(scope="module")
def swung() -> np.ndarray:
    return driven(plant("open_centre"), 600, swing, (0.0, 3e5, 0.0))


@pytest.mark.parametrize("case", [*BIAS, *LATE], ids=lambda case: case[0])
def test_a_sensor_effect_changes_its_own_channels_as_its_equation_says(
    case: tuple[str, str, float], swung: np.ndarray
) -> None:
    effect, parameter, value = case
    made = plant("open_centre", **{effect: {parameter: value}})
    first = made.out.copy()
    seen = driven(made, 600, swing, (0.0, 3e5, 0.0))
    expected = swung.copy()
    if case in BIAS:
        channel, gain, offset = BIAS[case]
        expected[:, channel] = gain * swung[:, channel] + offset
    for channel in LATE.get(case, ()):
        ticks = np.arange(601.0)
        with_first = np.concatenate([first[channel : channel + 1], swung[:, channel]])
        if parameter == "delay":
            past = np.interp(ticks - 1e3 * value, ticks, with_first)
        else:  # the bilinear transform of 1/(tau s + 1), another route than the hold of the sensor
            a = 2.0 * value / 1e-3
            start = with_first - with_first[0]
            past = with_first[0] + lfilter([1.0, 1.0], [1.0 + a, 1.0 - a], start)
        expected[:, channel] = past[1:]
    scale = np.maximum(np.ptp(swung, axis=0), 1e-9)
    assert np.max(np.abs(seen - expected) / scale) < 2e-3


def test_entrained_air_is_the_series_of_two_springs() -> None:
    """Numerical derivative of the volume of oil and polytropic air in parallel volumes."""
    beta, fraction, exponent, pressure = 1e9, 0.01, 1.4, 4e5
    atmosphere = entrained_air.ATMOSPHERE

    def volume(gauge: float) -> float:
        return -gauge / beta + fraction * (atmosphere / (gauge + atmosphere)) ** (1 / exponent)

    step = 10.0
    slope = (volume(pressure + step) - volume(pressure - step)) / (2 * step)
    modulus = entrained_air.bulk_modulus(beta, pressure, fraction, exponent)
    assert modulus == pytest.approx(-1.0 / slope, rel=1e-6)


def test_leakage_is_laminar_and_conserves_volume_or_empties_into_the_tank() -> None:
    left = cross_piston_leakage.left_flow(0.0, 3e5, 9e5, 1e-12)
    right = cross_piston_leakage.right_flow(0.0, 3e5, 9e5, 1e-12)
    assert left == -right == pytest.approx(6e-7)
    assert external_leakage_left.left_flow(1e-6, 4e6, 2e-13) == pytest.approx(2e-7)
    assert external_leakage_right.right_flow(1e-6, 4e6, 2e-13) == pytest.approx(2e-7)


@pytest.mark.parametrize("side", ["left", "right"])
def test_an_external_leak_takes_what_the_bridge_lacks(side: str) -> None:
    """In balance, what the leaking chamber loses is the difference of its two orifices' flows."""
    leakage = 3e-12
    made = plant("open_centre", **{f"external_leakage_{side}": {"leakage": leakage}})
    driven(made, 400, load=BLOCKED)
    par, state = made.par[0], made.state
    area, _ = opening_areas(par, made.table, made.out[2])
    pressure = state[LEFT] if side == "left" else state[RIGHT]
    conductance = par["orifice_constant"] * area
    surplus = conductance * (math.sqrt(state[PUMP] - pressure) - math.sqrt(pressure))
    assert surplus == pytest.approx(leakage * pressure, rel=0.02)


def test_stribeck_friction_at_three_speeds() -> None:
    limits = [rack_stribeck_friction.rack_friction_limit(60.0, v, 100.0, 0.01) for v in (0.0, 0.01)]
    assert limits == pytest.approx([160.0, 60.0 + 100.0 / math.e])
    assert rack_stribeck_friction.rack_friction_limit(60.0, 0.1, 100.0, 0.01) == pytest.approx(60.0)


@given(
    st.lists(st.tuples(st.floats(-0.05, 0.05), st.floats(0.0, 3.0)), min_size=1, max_size=12),
    st.floats(-300.0, 300.0),
    st.floats(0.0, 300.0),
    st.floats(0.0005, 0.02),
)
@settings(max_examples=60, deadline=None)
def test_friction_of_direction_and_speed_never_gives_back_more_than_it_took(
    path: list[tuple[float, float]], coulomb: float, breakaway: float, speed: float
) -> None:
    """Any motion from rest, in pieces of constant speed [m/s] and length [displacement constants].

    Tiny cycles are the hard part: a spring that is stiffer one way than the other would feed them.
    """
    nominal, displacement, force, work = 60.0, 1e-4, 0.0, 0.0
    for velocity, length in path:
        if velocity == 0.0:
            continue
        limit = rack_stribeck_friction.rack_friction_limit(nominal, velocity, breakaway, speed)
        middle = rack_friction_asymmetry.rack_friction_middle(0.0, limit, coulomb)
        reached = middle + limit if velocity > 0.0 else limit - middle
        force = min(max(force, middle - limit), middle + limit)
        step = 0.01 * length * displacement
        for _ in range(100):
            rate = yielding_rate(force, nominal, reached, velocity, displacement) / abs(velocity)
            middle_force = force + 0.5 * step * rate
            rate = yielding_rate(middle_force, nominal, reached, velocity, displacement)
            work += middle_force * math.copysign(step, velocity)
            force += step * rate / abs(velocity)
        assert work > -1e-6 * nominal * displacement - 1e-5 * abs(work)


@pytest.mark.parametrize(("coulomb", "viscous"), [(60.0, 0.0), (0.0, 3e3), (-60.0, -3e3)])
def test_friction_differs_between_directions_by_what_is_stated(
    coulomb: float, viscous: float
) -> None:
    """Steady sliding at 20 mm/s either way: the forces' difference is that of their sizes."""

    def resisting(velocity: float) -> float:
        middle = rack_friction_asymmetry.rack_friction_middle(0.0, 80.0, coulomb)
        slid = middle + math.copysign(80.0, velocity)
        return float(slid + rack_friction_asymmetry.rack_force(0.0, velocity, viscous))

    difference = abs(resisting(0.02)) - abs(resisting(-0.02))
    assert difference == pytest.approx(coulomb + 0.02 * viscous)


def test_backlash_is_a_dead_zone_of_the_torsion_bar() -> None:
    stiffness, gap = 60.0, 0.01
    for twist in (-0.02, -0.005, 0.0, 0.003, 0.006, 0.05):
        torque = rack_backlash.torsion_torque(stiffness * twist, twist, gap)
        flank = math.copysign(max(abs(twist) - 0.005, 0.0), twist)
        assert torque == pytest.approx(stiffness * flank, abs=1e-12)


def test_the_rack_stands_where_the_earlier_and_softer_stop_balances_the_load() -> None:
    stop = {"earlier": 0.005, "stiffness": 0.1}
    made = plant("open_centre", rack_end_stop=stop)
    driven(made, 1500, load=(-8e3, 0.0, 0.0))
    # The pump's two sides balance, friction creeps away: 8 kN over 2 MN/m beyond 70 mm.
    assert made.state[2] == pytest.approx(0.070 + 8e3 / 2e6, abs=3e-4)


def test_the_boost_curve_is_shifted_sideways() -> None:
    """Against a blocked rack the load pressure belongs to torque plus offset."""
    made = plant("open_centre", boost_curve_offset={"offset": 0.3})
    out = driven(made, 4000, lambda t: 2.0, BLOCKED)[-1]
    par = load_parameters().group("open_centre")
    expected = par["boost_scale"] * (math.exp(par["boost_rate"] * (out[2] + 0.3)) - 1.0)
    assert out[4] - out[3] == pytest.approx(expected, rel=0.005)


def test_overlap_of_the_bridge_raises_the_pressure_at_rest() -> None:
    """All four edges are as narrow as the closing ones of a torque of 0.5 N m."""
    made = plant("open_centre", valve_overlap={"torque": 0.5})
    driven(made, 1000, load=BLOCKED)
    area, _ = opening_areas(made.par[0], made.table, -0.5)
    p = load_parameters()
    speed = 0.5 * p["open_centre.pump_flow"] / (p["oil.flow_coefficient"] * area)
    assert made.state[PUMP] == pytest.approx(p["oil.density"] * speed**2, rel=1e-3)


@pytest.mark.parametrize(
    ("effect", "factor", "ratio"),
    [("pump_flow_level", 0.9, 0.9**2), ("orifice_flow_coefficient", 0.8, 0.8**-2)],
)
def test_pressures_at_rest_follow_the_square_of_flow_over_coefficient(
    effect: str, factor: float, ratio: float
) -> None:
    nominal, changed = plant("open_centre"), plant("open_centre", **{effect: {"factor": factor}})
    assert changed.state[PUMP] / nominal.state[PUMP] == pytest.approx(ratio, rel=1e-3)


def test_the_ripple_is_a_sine_of_its_share_at_its_frequency() -> None:
    flow = [pump_flow_ripple.pump_flow(1e-4, t, 0.03, 100.0, 0.5) for t in np.arange(1000) * 1e-3]
    amplitude = np.abs(np.fft.rfft(flow))[100] / 500
    assert amplitude == pytest.approx(3e-6)
    assert np.mean(flow) == pytest.approx(1e-4)


@pytest.mark.parametrize("difference", [-6e-5, 2e-5, 6e-5])
def test_one_chamber_gains_what_the_other_loses_and_none_vanishes(difference: float) -> None:
    for volume in (7e-5, 1.75e-5):  # in the middle and at the end of the stroke
        left = chamber_volume_imbalance.left_volume(volume, difference)
        right = chamber_volume_imbalance.right_volume(volume, difference)
        assert min(left, right) > 0.0
        if abs(difference) < volume:
            assert left - right == pytest.approx(difference)


def test_solenoid_lag_is_a_first_order_lag() -> None:
    """A step of the command reaches 63 % of the way after one time constant."""
    made = plant("closed_centre", solenoid_lag={"time_constant": 0.005})
    added = made.effect_states["solenoid_lag", "left_force"]
    rest = held(made)
    assert made.state[added] == pytest.approx(rest, rel=1e-12)
    for tick in range(5):
        made.step(tick, 0.0, rest + 1.0, rest, *BLOCKED)
    assert made.state[added] - rest == pytest.approx(1.0 - np.exp(-1.0), abs=1e-5)
    right = made.effect_states["solenoid_lag", "right_force"]
    assert made.state[right] == pytest.approx(rest, rel=1e-12)


def pressure_loop(**effects: dict[str, float]) -> np.ndarray:
    """Return left pressure on the way up minus on the way down at the same commands [Pa]."""
    made = plant("closed_centre", **effects)
    slow = driven(
        made, 4000, load=BLOCKED, command=lambda t: 8.0 * (1.0 - abs(t % 4.0 - 2.0) / 2.0)
    )
    up, down = slow[:2000, 3], slow[2000:, 3][::-1]
    return (down - up)[800:1600]


def test_hysteresis_of_the_solenoid_is_its_width_over_the_pressure_area() -> None:
    area = 0.25 * math.pi * 1.7e-3**2
    wider = pressure_loop(solenoid_hysteresis={"width": 1.0}) - pressure_loop()
    assert np.median(wider) == pytest.approx(1.0 / area, rel=0.03)


def test_a_sticking_spool_loses_four_times_its_friction_a_stroke() -> None:
    """Loop of force over displacement, far beyond the displacement constant, and back."""
    level, displacement, amplitude = 0.5, 2e-6, 1e-4
    x = amplitude * np.concatenate([np.linspace(0, 1, 1000), np.linspace(1, -1, 2000)] * 1)
    x = np.concatenate([x, np.linspace(-amplitude, amplitude, 2000)])
    force = [0.0]
    for step in np.diff(x):
        force.append(
            force[-1] + valve_spool_stiction.left_rate(force[-1], level, step, displacement)
        )
    loop = slice(1000, None)
    area = trapezoid(np.array(force)[loop], x[loop])
    expected = 4.0 * level * amplitude - 4.0 * level * displacement
    assert area == pytest.approx(expected, rel=0.01)


def pressure_at_reversals(level: float) -> float:
    """Return left pressure [Pa] where the rack turns one way minus where it turns the other."""
    made = plant("closed_centre", valve_spool_stiction={"level": level})
    force = held(made) + 8.0
    way = 3e-3 * np.sin(2.0 * np.pi * np.arange(1751) * 1e-3)
    pressure = [made.step(k, 0.0, force, force, 0.0, 1e8, x)[3] for k, x in enumerate(way)]
    return 0.5 * (pressure[750] + pressure[1750]) - pressure[1250]


def test_sticking_spools_show_as_hysteresis_of_pressure_over_load_flow() -> None:
    """The spool opposes its motion either way: two levels over the pressure area."""
    area = 0.25 * math.pi * 1.7e-3**2
    grown = pressure_at_reversals(0.5) - pressure_at_reversals(0.2)
    assert grown == pytest.approx(2.0 * 0.3 / area, rel=0.06)


def test_the_supply_droops_with_the_filtered_flow() -> None:
    resistance, constant = 3e10, 0.02
    droop = {"resistance": resistance, "time_constant": constant}
    made = plant("closed_centre", supply_pressure_droop=droop)
    flows, pressures = [], []
    rest = held(made)
    for tick in range(300):
        force = rest + 8.0 * math.sin(0.02 * tick) ** 2
        pressures.append(made.step(tick, 0.0, force, rest, *BLOCKED)[5])
        flows.append(made.truth(tick + 1)[6])
    a = 2.0 * constant / 1e-3
    drop = lfilter([1.0, 1.0], [1.0 + a, 1.0 - a], resistance * np.array(flows))
    assert np.ptp(pressures) > 1e4
    assert 2e7 - np.array(pressures) == pytest.approx(drop, abs=0.02 * np.max(drop))


def test_the_load_cylinders_friction_is_the_loop_of_rack_force_over_position() -> None:
    made = plant("open_centre", load_cylinder_friction={"level": 150.0, "displacement": 5e-5})
    out = driven(made, 2000, swing)[1000:]
    x, measured = out[:, 6], out[:, 8]
    stroke = np.ptp(x)
    assert stroke > 2e-3
    area = trapezoid(np.append(measured, measured[0]), np.append(x, x[0]))
    assert area == pytest.approx(2.0 * 150.0 * (stroke - 2 * 5e-5), rel=0.02)


def test_a_relaxing_tyre_follows_a_first_order_lag_in_distance() -> None:
    """Filter the force of the same motion by the closed form and compare."""
    length = 0.4
    late = trace({"tyre_relaxation": {"relaxation_length": length}}, "open_centre")
    from closed_loop import cores

    vehicle = cores({}, "open_centre", 1000).vehicle
    steady = np.array([vehicle.step(k, *row)[0] for k, row in enumerate(late.rack.tolist())])
    decay = np.exp(-load_parameters()["vehicle.speed"] * 1e-3 / length)
    expected, value = np.zeros(1000), 0.0
    for k in range(1, 1000):
        value = steady[k] + (value - steady[k]) * decay
        expected[k] = value
    assert late.load[:, 0] == pytest.approx(expected, abs=1e-9)
    assert not np.any(late.load[:, 1])
