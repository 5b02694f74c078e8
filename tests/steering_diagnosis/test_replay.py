"""The replay against the bench itself: what it reproduces, and where it sees each effect."""

import pickle
from dataclasses import replace

import numpy as np
import pytest
from bench_records import NOISE, bench_record

from steering_core.errors import BenchError
from steering_core.parameters import ParameterError
from steering_diagnosis.steering.drive import LONE_HZ
from steering_diagnosis.steering.replay import UNSETTLED, SteeringReplay
from steering_diagnosis.steering.simulation import Simulation
from steering_diagnosis.steering.smoothing import HIGHEST_HZ, low_pass

SYSTEMS = ("open_centre", "closed_centre")
INTEGRATION_ERROR = {
    "torsion_bar_torque": 5e-4,
    "rack_position": 1e-7,
    "rack_speed": 5e-5,
    "left_pressure": 1e3,
    "right_pressure": 1e3,
    "supply_pressure": 1e3,
    "driver_torque": 0.02,
    "rack_force": 0.05,
    "load_force": 0.05,
}
"""Tenths of what good sensors' noise would be."""


@pytest.fixture(scope="module", params=SYSTEMS)
def system(request):
    return request.param


@pytest.fixture(scope="module")
def noisy(system):
    return SteeringReplay(bench_record(system, noise=NOISE))


def by_output(replay, residuals):
    return {o.name: residuals[replay.judged, i] for i, o in enumerate(replay.outputs)}


def test_it_reproduces_the_bench_within_the_integration_error(system):
    replay = SteeringReplay(bench_record(system))
    errors = by_output(replay, replay.residuals({}, {}))
    assert errors.keys() == INTEGRATION_ERROR.keys()
    for name, error in errors.items():
        assert np.abs(error).max() < INTEGRATION_ERROR[name], name


def test_with_noise_the_residuals_are_the_sensors_noise(noisy):
    errors = by_output(noisy, noisy.residuals({}, {}))
    for name, sensor in (
        ("left_pressure", "left_pressure_sensor"),
        ("rack_position", "rack_position_sensor"),
        ("rack_force", "rack_force_sensor"),
    ):
        assert np.std(errors[name]) == pytest.approx(NOISE[f"{sensor}.noise"], rel=0.15)
    assert np.std(errors["torsion_bar_torque"]) < 3.0 * NOISE["torque_sensor.noise"]


@pytest.mark.parametrize(
    ("effect", "given"),
    [
        ("torque_sensor_gain", {"gain": 1.05}),
        ("angle_sensor_delay", {"delay": 4e-3}),
        ("rack_friction_level", {"factor": 1.8}),
        ("cross_piston_leakage", {"leakage": 2e-12}),
        ("pressure_sensor_lag", {"time_constant": 5e-3}),
        ("rack_force_sensor_gain", {"gain": 1.05}),
    ],
)
def test_an_effect_of_the_bench_is_gone_when_the_replay_has_it_too(system, effect, given):
    replay = SteeringReplay(bench_record(system, effects={effect: given}))
    without = by_output(replay, replay.residuals({}, {}))
    with_it = by_output(replay, replay.residuals({}, {effect: given}))
    worst = max(without, key=lambda n: np.std(without[n]) / INTEGRATION_ERROR[n])
    assert np.std(without[worst]) > 10.0 * INTEGRATION_ERROR[worst]
    assert np.std(with_it[worst]) < 0.05 * np.std(without[worst])


def test_a_hidden_parameter_is_gone_when_refitted(system):
    hidden = {"mechanics.piston_area": 7.1e-4, "mechanics.torsion_bar_stiffness": 61.5}
    replay = SteeringReplay(bench_record(system, hidden=hidden))
    before = by_output(replay, replay.residuals({}, {}))["torsion_bar_torque"]
    after = by_output(replay, replay.residuals(hidden, {}))["torsion_bar_torque"]
    assert np.std(after) < 0.05 * np.std(before)


def test_sensor_effects_need_no_new_simulation(noisy):
    noisy.residuals({}, {})
    count = noisy.simulation.count
    noisy.residuals({"torque_sensor.offset": 0.1}, {"pressure_sensor_lag": {"time_constant": 0.01}})
    assert noisy.simulation.count == count
    noisy.residuals({"mechanics.rack_mass": 25.0}, {})
    assert noisy.simulation.count == count + 1


def test_the_inputs_noise_shakes_the_model_in_question():
    """A heavier rack, less damped, rings on what leaves the nominal one quiet."""
    replay = SteeringReplay(bench_record("open_centre", noise=NOISE))
    nominal, heavy = (replay.shaken({}, e) for e in ({}, {"rack_mass": {"added": 60.0}}))
    speed = [o.name for o in replay.outputs].index("rack_speed")
    assert np.nanstd(heavy[:, speed]) > 1.5 * np.nanstd(nominal[:, speed])


def test_it_is_deterministic_and_travels_to_other_processes(noisy):
    there = pickle.loads(pickle.dumps(noisy))
    effects = {"rack_viscous_damping": {"added": 200.0}}
    given = noisy.residuals({}, effects)
    assert np.array_equal(given, there.residuals({}, effects), equal_nan=True)


def test_an_answer_does_not_depend_on_what_was_asked_before(noisy):
    offset = {"right_pressure_sensor.offset": 2e5}
    fresh = SteeringReplay(noisy.record)
    fresh.residuals(offset, {})
    asked_second = fresh.residuals({}, {})
    assert np.array_equal(noisy.residuals({}, {}), asked_second, equal_nan=True)
    alone = SteeringReplay(noisy.record).residuals({}, {})
    assert np.array_equal(alone, asked_second, equal_nan=True)


def test_nothing_is_judged_before_the_rack_has_moved(system):
    """Friction at rest depends on how the rack came there, which no record tells."""
    record = bench_record(system, duration=4.0)
    still = np.full(600, record["steering_wheel_angle"][0])
    angle = np.concatenate([still, record["steering_wheel_angle"][: len(record) - len(still)]])
    held = replace(record, channels={**record.channels, "steering_wheel_angle": angle})
    first = np.flatnonzero(SteeringReplay(held).judged)[0]
    assert len(still) < first <= 1000
    assert np.flatnonzero(SteeringReplay(record).judged)[0] >= UNSETTLED


def test_a_lone_load_cell_keeps_what_shakes_the_rack():
    """Beside the load's command the cell is low-passed deeper: the command has the fast part."""
    random = np.random.default_rng(5)
    record = bench_record("open_centre", noise=NOISE)
    shaking = low_pass(300.0 * random.standard_normal(len(record)), 160.0)
    command = ("load_force", "load_stiffness", "load_position")
    channels = {n: v for n, v in record.channels.items() if n not in command}
    shaken = record["rack_force"] + shaking + random.standard_normal(len(record))
    lone = SteeringReplay(replace(record, channels={**channels, "rack_force": shaken}))
    curve = lone.drive.curves["rack_force"]
    assert curve.cutoff_hz == LONE_HZ > HIGHEST_HZ
    left = (curve.values[-len(record) :] - record["rack_force"] - shaking)[500:-500]
    assert np.std(left) < 0.2 * np.std(shaking)


def test_a_lone_load_cell_may_be_late_and_no_sensor_is_early():
    record = bench_record("open_centre", noise=NOISE)
    command = ("load_force", "load_stiffness", "load_position")
    channels = {n: v for n, v in record.channels.items() if n not in command}
    late = np.concatenate([record["rack_force"][:1].repeat(2), record["rack_force"][:-2]])
    lone = SteeringReplay(replace(record, channels={**channels, "rack_force": late}))
    delay = "rack_force_sensor.delay"
    known = {n.name: n for n in lone.nuisances}
    assert (known[delay].low, known[delay].high) == (0.0, 0.063)
    assert delay not in {n.name for n in SteeringReplay(record).nuisances}
    errors = [
        np.std(by_output(lone, lone.residuals({delay: s}, {}))["right_pressure"])
        for s in (0.0, 2e-3)
    ]
    assert errors[1] < 0.9 * errors[0]
    with pytest.raises(ParameterError, match="at least 0 s"):
        lone.residuals({delay: -1e-4}, {})


def test_the_data_sheet_takes_both_ends_of_every_nuisance(system):
    record = bench_record(system, duration=2.0)
    for n in SteeringReplay(record).nuisances:
        assert n.low <= n.nominal <= n.high, n.name
        ends = [n.low, min(n.high, n.nominal + 40.0 * n.tolerance)]
        for end in ends:
            assert record.nominal.with_values({n.name: end})[n.name] == end


def test_another_record_takes_the_outputs_of_the_first():
    first = SteeringReplay(bench_record("open_centre", duration=3.0))
    record = bench_record("open_centre", duration=2.0)
    channels = {n: v for n, v in record.channels.items() if n != "supply_pressure"}
    other = SteeringReplay(replace(record, channels=channels, vehicle_load="table"), like=first)
    assert other.outputs == first.outputs
    missing = np.isnan(other.residuals({}, {})[other.judged]).all(axis=0)
    names = [o.name for o in first.outputs]
    assert [n for n, m in zip(names, missing, strict=True) if m] == [
        "supply_pressure",
        "load_force",
    ]
    assert np.array_equal(
        other.residuals({}, {}), pickle.loads(pickle.dumps(other)).residuals({}, {}), equal_nan=True
    )


def test_without_the_rack_force_the_load_command_drives(system):
    record = bench_record(system)
    channels = {n: v for n, v in record.channels.items() if n != "rack_force"}
    replay = SteeringReplay(replace(record, channels=channels))
    errors = by_output(replay, replay.residuals({}, {}))
    assert np.abs(errors["torsion_bar_torque"]).max() < 0.01
    undecidable = {u.hypothesis for u in replay.undecidable}
    assert {"load_cylinder_friction", "rack_force_sensor_gain"} <= undecidable


def test_without_any_load_the_rack_is_prescribed(system):
    record = bench_record(system)
    load = ("rack_force", "load_force", "load_stiffness", "load_position")
    channels = {n: v for n, v in record.channels.items() if n not in load}
    replay = SteeringReplay(replace(record, channels=channels))
    errors = by_output(replay, replay.residuals({}, {}))
    assert np.abs(errors["torsion_bar_torque"]).max() < 0.02
    assert "rack_friction_level" in {u.hypothesis for u in replay.undecidable}
    assert "rack_friction_level" not in replay.hypotheses


def test_without_the_wheel_angle_it_says_what_is_missing():
    record = bench_record("open_centre", duration=2.0)
    channels = {n: v for n, v in record.channels.items() if n != "steering_wheel_angle"}
    with pytest.raises(BenchError, match="steering_wheel_angle"):
        SteeringReplay(replace(record, channels=channels))


def test_under_given_pressures_the_mechanics_needs_no_hydraulics():
    record = bench_record("closed_centre", noise=NOISE)
    commands = ("left_solenoid_force", "right_solenoid_force")
    without = {n: values for n, values in record.channels.items() if n not in commands}
    replay = SteeringReplay(replace(record, channels=without))
    trace = replay.run({}, {}).trace
    driven = replay.drive.driven(record.nominal)
    assert not trace.flows.any()
    replay.drive.valves = True  # the kernel then goes through the hydraulics as well
    with_hydraulics = Simulation(replay.drive).driven_by(driven, record.nominal, {})
    assert with_hydraulics.flows.any()
    # other inner steps: the two are apart by the errors of both
    for name in ("rack_position", "rack_speed", "left_pressure"):
        apart = (trace[name] - with_hydraulics[name])[replay.judged]
        assert np.std(apart) < INTEGRATION_ERROR[name], name
    apart = (trace.torque - with_hydraulics.torque)[replay.judged]
    assert np.std(apart) < INTEGRATION_ERROR["torsion_bar_torque"]
