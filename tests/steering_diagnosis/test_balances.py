"""Balance residuals: noise on a clean record, and each effect at the balance that it declares."""

import pytest
from bench_records import NOISE, bench_record

from steering_diagnosis.steering.balance_errors import Balances
from steering_diagnosis.steering.replay import SteeringReplay
from steering_plant.effects import EFFECTS

SYSTEMS = ("open_centre", "closed_centre")


def errors(system, effect=None, given=None, extended=True):
    effects = {effect: given} if effect else {}
    record = bench_record(system, duration=8.0, effects=effects, noise=NOISE)
    balances = Balances(SteeringReplay(record))
    return {e.balance: e for e in balances.errors({}, effects)}, balances


@pytest.mark.parametrize("system", SYSTEMS)
def test_on_a_clean_record_every_balance_is_at_its_noise(system):
    for balance, error in errors(system)[0].items():
        assert error.above_noise < 1.5, balance


@pytest.mark.parametrize(
    ("system", "effect", "given"),
    [
        ("open_centre", "rack_viscous_damping", {"added": 900.0}),
        ("open_centre", "column_friction", {"factor": 2.0}),
        ("open_centre", "rack_backlash", {"gap": 0.01}),
        ("open_centre", "pump_flow_level", {"factor": 0.9}),
        ("closed_centre", "external_leakage_left", {"leakage": 3e-12}),
        ("closed_centre", "external_leakage_right", {"leakage": 3e-12}),
        ("closed_centre", "supply_pressure_droop", {"resistance": 5e10, "time_constant": 0.02}),
        ("closed_centre", "load_cylinder_friction", {"level": 100.0, "displacement": 1e-4}),
    ],
)
def test_an_effect_shows_at_its_balance_and_is_gone_with_it(system, effect, given):
    found, balances = errors(system, effect, given)
    own = found[EFFECTS[effect].balance]
    assert own.above_noise > 2.0
    direct = {n: e for n, e in found.items() if n != "valve flow"}
    assert max(direct.values(), key=lambda e: e.share).balance == own.balance
    judged = balances.replay.judged
    assert (own.extended[judged] ** 2).mean() < 0.35 * (own.residual[judged] ** 2).mean()


def test_a_sensor_s_error_shows_at_the_balances_that_it_takes_part_in():
    found, _ = errors("closed_centre", "torque_sensor_gain", {"gain": 1.06})
    touched = {n for n, e in found.items() if e.above_noise > 2.0}
    assert {"torsion bar", "rack force"} <= touched
    assert not touched & {"supply", "load", "rack position sensor"}


def test_the_error_is_shown_by_time_speed_pressure_position_and_frequency():
    found, _ = errors("open_centre")
    assert {tuple(e.by) for e in found.values()} == {
        ("time", "speed", "pressure", "position", "frequency")
    }
    for error in found.values():
        assert all(len(centres) == len(rms) > 5 for centres, rms in error.by.values())
    assert sum(e.share for e in found.values()) == pytest.approx(1.0)
