"""--set, --set-file and --delay change a scenario before it is checked."""

from pathlib import Path

import pytest

from steering_bringup.errors import BenchError
from steering_bringup.overrides import set_delay, set_file, set_value
from steering_bringup.plans import for_node_set, node_sets_of
from steering_bringup.scenario_files import check_scenario, open_scenario
from steering_bringup.schema import Scenario


def changed(*texts: str, scenario: str = "on_centre") -> Scenario:
    document = open_scenario(scenario)
    for text in texts:
        set_value(document, text)
    return check_scenario(document, Path())


def test_parameters_are_set_by_full_name():
    scenario = changed("mechanics.rack_mass=30", "vehicle.speed=1e1")
    assert scenario.parameters == {"vehicle.speed": 10.0, "mechanics.rack_mass": 30.0}


def test_the_last_of_two_values_wins():
    assert changed("oil.density=800", "oil.density=900").parameters["oil.density"] == 900.0


def test_a_new_kind_drops_what_belonged_to_the_old_one():
    manoeuvre = changed("manoeuvre.kind=step", "manoeuvre.angle_deg=10").manoeuvre.make()
    assert (manoeuvre.kind, manoeuvre.angle_deg) == ("step", 10.0)
    assert changed("load=dry_park").load.kind == "dry_park"


def test_the_same_kind_keeps_its_values():
    assert changed("manoeuvre.kind=on_centre").manoeuvre.make().duration_s == 20.0


def test_a_scenario_s_node_set_lies_beside_it(tmp_path):
    (tmp_path / "mine.yaml").write_text("manoeuvre: step\nnode_set: set.yaml\n", encoding="utf-8")
    document = open_scenario(str(tmp_path / "mine.yaml"))
    assert check_scenario(document, tmp_path).node_set == (str(tmp_path / "set.yaml"),)


def test_a_delay_counts_in_the_node_sets_that_have_its_connection():
    document = open_scenario("on_centre")
    set_delay(document, "/valve/left/command->plant=1")
    set_delay(document, "/driver/torque->plan=1")
    scenario = check_scenario(document, Path())
    sets = node_sets_of(scenario)
    kept = [set(for_node_set(scenario, each, sets).delays) for each in sets]
    slip = "/driver/torque->plan"
    assert kept == [{slip}, {slip, "/valve/left/command->plant"}]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("rack_mass=3", "did you mean 'mechanics.rack_mass'"),
        ("vehicle.spede=3", "did you mean 'vehicle.speed'"),
        ("durations=3", "did you mean 'duration'"),
        ("manoeuvre.amplitude=3", "did you mean 'amplitude_deg'"),
        ("mechanics.rack_mass=0", "must be greater than 0 kg"),
        ("mechanics.rack_mass=nan", "must be finite"),
        ("mechanics.rack_mass=-.inf", "must be finite"),
        ("mechanics.rack_mass=heavy", "must be a number"),
        ("mechanics=3", "unknown name 'mechanics'"),
        ("oil.density", "write NAME=VALUE"),
        ("=3", "write NAME=VALUE"),
        ("oil.density=", "value is missing"),
        ("record=maybe", "true or false"),
    ],
)
def test_a_fault_names_the_option(text, expected):
    with pytest.raises(BenchError) as caught:
        changed(text)
    assert f"--set {text}" in str(caught.value)
    assert expected in str(caught.value)


def test_a_file_may_hold_parts_of_a_scenario_or_groups_of_parameters(tmp_path):
    path = tmp_path / "extension.yaml"
    path.write_text(
        "schema: 1\nduration: 3\nmechanics: {rack_mass: 30}\nparameters: {oil.density: 9e2}"
    )
    document = open_scenario("weave")
    set_file(document, str(path))
    scenario = check_scenario(document, Path())
    assert scenario.duration == 3.0
    assert scenario.parameters["mechanics.rack_mass"] == 30.0
    assert scenario.parameters["oil.density"] == 900.0
    assert scenario.name == "weave"


def test_a_fault_in_a_file_names_its_line(tmp_path):
    path = tmp_path / "extension.yaml"
    path.write_text("duration: 3\nmechanics: {rack_mass: -1}\n")
    document = open_scenario("weave")
    set_file(document, str(path))
    with pytest.raises(BenchError, match=r"extension.yaml, line 2: .*rack_mass"):
        check_scenario(document, Path())


def test_delays_are_whole_ticks():
    document = open_scenario("weave")
    set_delay(document, "/driver/torque->plant=2")
    assert check_scenario(document, Path()).delays == {"/driver/torque->plant": 2}
    for text in ("/driver/torque=1", "/driver/torque->plant=x", "/driver/torque->plant=-1"):
        with pytest.raises(BenchError, match="write TOPIC->NODE=TICKS"):
            set_delay(document, text)


CURVE = "torsion_bar_torque_Nm,load_pressure_Pa\n-4,-9e6\n-2,-8e5\n0,0\n2,1.2e6\n4,7e6\n"


def test_files_of_an_option_are_looked_for_where_the_command_is_called(tmp_path, monkeypatch):
    """They were once looked for beside the scenario, which for a shipped one is in the package."""
    (tmp_path / "curve.csv").write_text(CURVE)
    (tmp_path / "force.csv").write_text("time_s,rack_force_N\n0,100\n1,200\n")
    monkeypatch.chdir(tmp_path)
    document = open_scenario("on_centre")
    for text in ("boost_curve=curve.csv", "load.kind=table", "load.file=force.csv"):
        set_value(document, text)
    scenario = check_scenario(document, Path("/elsewhere"))
    assert scenario.boost_curve is not None
    assert scenario.boost_curve.load_pressure_Pa == (-9e6, -8e5, 0.0, 1.2e6, 7e6)
    assert scenario.load.make().rack_force_n == (100.0, 200.0)


def test_files_of_a_file_of_changes_lie_beside_it(tmp_path):
    (tmp_path / "curve.csv").write_text(CURVE)
    (tmp_path / "changes.yaml").write_text("boost_curve: curve.csv\n")
    document = open_scenario("on_centre")
    set_file(document, str(tmp_path / "changes.yaml"))
    assert check_scenario(document, Path("/elsewhere")).boost_curve is not None


@pytest.mark.parametrize(
    ("text", "expected"),
    [("0,0\n1,1", "4 points"), (CURVE.split("\n", 1)[1].replace("7e6", "1e6"), "never falls")],
)
def test_a_boost_curve_that_cannot_be_names_the_file(tmp_path, text, expected):
    (tmp_path / "curve.csv").write_text("torsion_bar_torque_Nm,load_pressure_Pa\n" + text)
    with pytest.raises(BenchError, match=rf"curve\.csv: .*{expected}"):
        changed(f"boost_curve={tmp_path / 'curve.csv'}")
