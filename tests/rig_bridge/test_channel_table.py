"""The channel table: the shipped one is complete; wrong ones are refused by file, line and key."""

import pytest
import yaml
from healthy_rig import EMULATED

from rig_bridge.rig_file import load_rig
from rig_bridge.signals import COMMANDED, MEASURED
from steering_core.errors import BenchError
from steering_plant.sensors import CHANNELS


def written(tmp_path, change):
    data = yaml.safe_load(EMULATED.read_text())
    change(data)
    path = tmp_path / "rig.yaml"
    path.write_text(yaml.safe_dump(data))
    return path


def refused(tmp_path, change):
    with pytest.raises(BenchError) as error:
        load_rig(written(tmp_path, change))
    text = str(error.value)
    assert "\n" not in text
    assert "rig.yaml" in text
    return text


def channel(name, **values):
    return lambda data: data["channels"][name].update(values)


def test_the_shipped_table_has_every_signal_once():
    rig = load_rig(EMULATED)
    assert rig.measured == tuple(MEASURED)
    assert rig.commanded == tuple(COMMANDED)[:8]
    for names in (rig.measured, rig.commanded):
        slots = [entry.udp.slot for entry in rig.rows(names) if entry.udp is not None]
        assert sorted(slots) == list(range(len(names)))


def test_measurements_are_those_of_the_simulated_plant_in_its_order():
    assert tuple(MEASURED) == CHANNELS


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (channel("rack_force", unit="kN"), "unit must be N, got kN"),
        (channel("driver_torque", direction="measured"), "direction must be commanded"),
        (channel("rack_force", scal=1.0), "did you mean 'scale'"),
        (channel("rack_force", scale=0.0), "must be greater than 0"),
        (channel("rack_force", scale=-1.0), "must be greater than 0"),
        (channel("rack_force", scale=float("nan")), "scale"),
        (channel("rack_force", sign=0), "sign"),
        (channel("rack_force", range=[5.0, -5.0]), "[lowest, highest]"),
        (channel("rack_force", range=[-5.0, 5.0]), "plausible must lie within range"),
        (channel("rack_force", rate=0.0), "rate"),
        (channel("rack_force", safe=0.0), "commanded channels only"),
        (channel("rack_force", udp={"slot": 8, "raw": "int16"}), "beyond what int16 holds"),
        (channel("rack_force", udp={"slot": 8, "raw": "int8"}), "raw"),
        (channel("load_force", safe=1e6), "must lie within range"),
        (channel("load_force", frozen_ticks=3), "measured channels only"),
        (lambda data: data["channels"].pop("rack_speed"), "'rack_speed' is missing"),
        (lambda data: data["channels"].pop("left_solenoid_force"), "same kinds"),
        (
            lambda data: data["channels"].update(rack_sped=data["channels"]["rack_speed"]),
            "did you mean 'rack_speed'",
        ),
        (
            lambda data: data["relations"]["torsion_bar"]["factors"].update(rack_positon=1.0),
            "did you mean 'rack_position'",
        ),
        (lambda data: data["rates"]["rack"].update(rate="load_force"), "unknown measured signal"),
        (lambda data: data.update(watching={"stale_ticks": 0}), "stale_ticks"),
    ],
)
def test_wrong_tables_are_refused(tmp_path, change, said):
    assert said in refused(tmp_path, change)


def test_no_file_and_no_mapping(tmp_path):
    with pytest.raises(BenchError, match="there is no file"):
        load_rig(tmp_path / "none.yaml")
    (tmp_path / "list.yaml").write_text("- 1\n")
    with pytest.raises(BenchError, match="mapping"):
        load_rig(tmp_path / "list.yaml")


def test_a_rig_with_a_hand_on_the_wheel_takes_no_driver_torque(tmp_path):
    rig = load_rig(written(tmp_path, lambda data: data["channels"].pop("driver_torque")))
    assert "driver_torque" not in rig.commanded
