import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from steering_core.parameters import load_parameters
from vehicle_model.loads import LOADS, LoadError, load_table, make_load
from vehicle_model.vehicle import Vehicle

NOMINAL = load_parameters()
HEADER = "time_s,rack_force_N\n"


def vehicle(kind: str, ticks: int = 100, **values) -> Vehicle:
    return Vehicle(NOMINAL, make_load(kind, **values), ticks)


def test_the_registry_holds_the_kinds_under_their_names():
    assert set(LOADS) == {"bicycle", "dry_park", "none", "table", "clamp", "position_servo"}
    for kind, made in LOADS.items():
        assert made.kind == kind
        assert (made.__doc__ or "").strip()


def test_dry_park_is_a_spring_handed_over_whole():
    v = vehicle("dry_park")
    force, stiffness, position = v.step(0, 0.004, 0.1, 0.0)
    assert force == pytest.approx(1.75e6 * 0.004)
    assert stiffness == 1.75e6
    assert position == 0.004
    v.step(1, -0.004, 0.0, 0.0)
    assert v.out[0] == -force
    assert v.odometry().v_x == 0.0


def test_a_clamp_pushes_back_wherever_the_rack_goes():
    v = vehicle("clamp", stiffness_n_m=1e9)
    assert v.step(0, 1e-6, 0.0, 0.0).tolist() == [1e3, 1e9, 1e-6]


def test_a_position_servo_asks_for_no_force_where_the_rack_follows_its_sine():
    v = vehicle("position_servo", ticks=8000, amplitude_m=0.004, angular_frequency_rad_s=0.5)
    wanted = 0.004 * np.sin(0.5 * 1e-3 * np.arange(8000))
    forces = np.array([v.step(tick, wanted[tick], 0.0, 0.0)[0] for tick in range(8000)])
    assert np.max(np.abs(forces[2000:])) < 1e-6
    assert v.step(8000, 0.0, 0.0, 0.0)[0] == pytest.approx(-2e6 * 0.004 * np.sin(4.0), rel=1e-3)


def test_no_load_is_exactly_nothing():
    v = vehicle("none")
    for tick in range(20):
        assert v.step(tick, 0.01 * tick, 0.1, 5.0)[:2].tolist() == [0.0, 0.0]
    assert v.odometry()[:2] == (0.0, 0.0)


def test_table_gives_its_force_whatever_the_rack_does_and_holds_the_end():
    v = vehicle("table", ticks=40, time_s=(0.01, 0.03), rack_force_n=(100.0, -300.0))
    forces = [v.step(tick, 0.001 * tick, 0.0, 0.0)[0] for tick in range(60)]
    assert forces[:11] == pytest.approx([100.0] * 11)
    assert forces[20] == pytest.approx(-100.0)
    assert forces[30:] == pytest.approx([-300.0] * 30)
    assert v.out[1] == 0.0


def test_table_drives_the_car_like_the_bicycle():
    one, other = vehicle("table"), vehicle("bicycle")
    for tick in range(100):
        for v in (one, other):
            v.step(tick, 0.00005 * tick, 0.0, 0.0)
    assert one.odometry() == other.odometry()
    assert one.imu() == other.imu()


def test_table_file_is_read(tmp_path):
    path = tmp_path / "force.csv"
    path.write_text(HEADER + "0,0\n1,2300\n", encoding="utf-8")
    load = make_load("table", file=path)
    assert load == load_table(path)
    assert load.external(np.array([0.5, 3.0])) == pytest.approx([1150.0, 2300.0])


FAULTS = [
    (HEADER + "0,0\n1,nan\n", r"force\.csv, line 3: rack_force_N must be finite"),
    (HEADER + "1,0\n0,0\n", r"force\.csv, line 3: time_s must increase"),
    ("time_s,rack_force_n\n0,0\n", "line 1: unknown column 'rack_force_n'; did you mean"),
]


@pytest.mark.parametrize(("text", "message"), FAULTS)
def test_faults_in_a_file_are_named(tmp_path, text, message):
    path = tmp_path / "force.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(LoadError, match=message):
        load_table(path)


WRONG = [
    ("clamp", {"stiffness_n_m": -1.0}, "clamp: stiffness_n_m"),
    ("position_servo", {"amplitude_m": float("nan")}, "position_servo: every value"),
    ("bycicle", {}, "unknown load 'bycicle'; did you mean 'bicycle'"),
    ("dry_park", {"stiffness": 1.0}, "dry_park: unknown field 'stiffness'"),
    ("table", {"time_s": (0.0, 1.0), "rack_force_n": (0.0,)}, "2 times for 1 forces"),
    ("table", {"time_s": (0.0,), "rack_force_n": (float("nan"),)}, "must be finite"),
    ("table", {"time_s": (0.0, 0.0), "rack_force_n": (1.0, 1.0)}, "entry 1 does not"),
    ("table", {"file": "a.csv", "time_s": (0.0,)}, "either a file or times and forces"),
    ("table", {"file": "/nowhere/a.csv"}, "there is no such file"),
]


@pytest.mark.parametrize(("kind", "values", "message"), WRONG)
def test_wrong_values_are_named(kind, values, message):
    with pytest.raises(LoadError, match=message):
        make_load(kind, **values)


@pytest.mark.parametrize("kind", LOADS)
def test_travels_through_pydantic(kind):
    adapter = TypeAdapter(LOADS[kind])
    assert adapter.validate_python(adapter.dump_python(make_load(kind))) == make_load(kind)
    with pytest.raises(ValidationError, match="surprise"):
        adapter.validate_python({"surprise": 1.0})
