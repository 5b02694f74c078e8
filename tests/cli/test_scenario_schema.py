"""The schema refuses what cannot run, in one line that names file, line, key and remedy."""

from pathlib import Path

import pytest

from steering_bringup.errors import BenchError
from steering_bringup.scenario_files import load_node_set, load_scenario, restore
from steering_bringup.schema import NodeSet, Scenario
from steering_bringup.shipped import descriptions, shipped

GOOD = """\
schema: 1
name: mine
duration: 2.0
manoeuvre:
  kind: weave
  amplitude_deg: 10
parameters:
  mechanics:
    rack_mass: 30
"""


def write(folder: Path, text: str) -> str:
    path = folder / "mine.yaml"
    path.write_text(text, encoding="utf-8")
    return str(path)


@pytest.mark.parametrize("name", shipped("scenario"))
def test_every_shipped_scenario_is_valid_and_described(name):
    scenario = load_scenario(name)
    assert scenario.name == name
    assert len(scenario.description) > 20
    for node_set in scenario.node_set:
        assert load_node_set(node_set).name == node_set


def test_the_default_scenario_is_the_source_s_manoeuvre():
    scenario = load_scenario("on_centre")
    assert scenario.node_set == ("open_centre", "closed_centre")
    assert scenario.ticks == 20_000
    assert scenario.parameter_values()["vehicle.speed"] == pytest.approx(70 / 3.6, abs=1e-3)
    manoeuvre = scenario.manoeuvre.make()
    assert (manoeuvre.amplitude_deg, manoeuvre.final_frequency_hz) == (30.0, 2.0)


def test_a_file_may_nest_parameters_and_leave_out_defaults(tmp_path):
    scenario = load_scenario(write(tmp_path, GOOD))
    assert scenario.parameters == {"mechanics.rack_mass": 30.0}
    assert scenario.node_set == ("closed_centre",)
    assert scenario.load.kind == "bicycle"


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("duration", "durations", ["line 3", "'durations'", "did you mean 'duration'"]),
        ("2.0", "-2", ["line 3", "duration", "greater than 0", "-2"]),
        ("2.0", "2.00049", ["line 3", "whole number of milliseconds"]),
        ("2.0", ".nan", ["line 3", "finite"]),
        ("kind: weave", "kind: weeve", ["line 5", "'weeve'", "did you mean 'weave'"]),
        ("amplitude_deg", "amplitude", ["line 6", "did you mean 'amplitude_deg'"]),
        ("deg: 10", "deg: 5000", ["line 6", "amplitude_deg must be from -1080 to 1080"]),
        ("deg: 10", "deg: ten", ["line 6", "must be a number", "'ten'"]),
        ("deg: 10", "deg: true", ["line 6", "must be a number", "true"]),
        ("rack_mass", "rack_mas", ["line 9", "did you mean 'mechanics.rack_mass'"]),
        ("mass: 30", "mass: -30", ["line 9", "mechanics.rack_mass must be greater than 0 kg"]),
        ("mass: 30", "mass: .nan", ["line 9", "finite"]),
        ("schema: 1", "schema: 2", ["line 1", "schema", "must be 1"]),
        ("name: mine", "duration: 1", ["line 3", "'duration' is given twice"]),
        ("  kind: weave\n", "", ["line 4", "'kind' is missing"]),
        ("manoeuvre:", "manoeuvre: [", ["line"]),
    ],
)
def test_a_fault_is_named_with_its_line(tmp_path, old, new, expected):
    assert old in GOOD
    path = write(tmp_path, GOOD.replace(old, new))
    with pytest.raises(BenchError) as caught:
        load_scenario(path)
    text = str(caught.value)
    assert "\n" not in text
    for part in ["mine.yaml", *expected]:
        assert part in text


def test_a_missing_file_and_an_unknown_name_are_told_apart(tmp_path):
    with pytest.raises(BenchError, match="there is no scenario file"):
        load_scenario(str(tmp_path / "no.yaml"))
    with pytest.raises(BenchError, match="did you mean 'dry_park'"):
        load_scenario("drypark")


def test_a_manoeuvre_file_becomes_numbers_that_survive_a_round_trip(tmp_path):
    (tmp_path / "angle.csv").write_text("time_s,steering_wheel_angle_deg\n0,0\n0.1,1e-3\n1,5\n")
    text = GOOD.replace("kind: weave\n  amplitude_deg: 10", "kind: table\n  file: angle.csv")
    scenario = load_scenario(write(tmp_path, text))
    data = scenario.model_dump(mode="json", by_alias=True)
    assert data["manoeuvre"]["steering_wheel_angle_deg"] == [0.0, 1e-3, 5.0]
    (tmp_path / "angle.csv").unlink()
    again = restore(Scenario, data, "bag")
    assert again.manoeuvre.make() == scenario.manoeuvre.make()


@pytest.mark.parametrize("name", shipped("node set"))
def test_a_node_set_survives_a_round_trip(name):
    node_set = load_node_set(name)
    assert restore(NodeSet, node_set.model_dump(mode="json", by_alias=True), "bag") == node_set
    assert name in descriptions("node set")


def test_the_json_schema_offers_parameters_with_units():
    schema = Scenario.model_json_schema()
    parameters = schema["properties"]["parameters"]["properties"]
    assert "kg" in parameters["mechanics.rack_mass"]["description"]
    assert parameters["mechanics"]["properties"]["rack_mass"]["exclusiveMinimum"] == 0
    assert schema["additionalProperties"] is False


def test_the_json_schema_offers_effects_with_bounds():
    effects = Scenario.model_json_schema()["properties"]["effects"]
    assert effects["additionalProperties"] is False
    leakage = effects["properties"]["cross_piston_leakage"]["properties"]["leakage"]
    assert (leakage["minimum"], leakage["maximum"]) == (0.0, 1e-11)
    assert "m3/(s Pa)" in leakage["description"]


def test_the_json_schema_takes_what_a_scenario_may_leave_out_or_shorten():
    """One node set, a kind alone, no name: an editor must not mark what runs."""
    schema = Scenario.model_json_schema()
    assert schema["required"] == ["manoeuvre"]
    properties = schema["properties"]
    assert {"type": "string"} in properties["node_set"]["anyOf"]
    for key, kind in (("manoeuvre", "step"), ("load", "dry_park")):
        (names,) = [option["enum"] for option in properties[key]["anyOf"] if "enum" in option]
        assert kind in names
