"""The extension of the model: what it holds, and that runs take it."""

import pytest
import yaml
from bench_records import bench_record

from steering_bringup.cores import build_cores
from steering_bringup.direct.runner import run
from steering_bringup.node_parameters import node_parameters
from steering_bringup.overrides import set_file
from steering_bringup.scenario_files import check_scenario, find, load_node_set, open_scenario
from steering_diagnosis.engine.model import Nuisance
from steering_diagnosis.steering.extension import extension
from steering_diagnosis.steering.replay import SteeringReplay

CAUSE = {"cross_piston_leakage": {"leakage": 2e-12}, "torque_sensor_gain": {"gain": 1.04}}
KNOWN = (
    Nuisance("mechanics.rack_mass", "kg", 24.0, 0.72),
    Nuisance("oil.density", "kg/m3", 870.0, 17.4),
    Nuisance("torque_sensor.offset", "N m", 0.0, 0.02),
)
REFITTED = {"mechanics.rack_mass": 24.5, "oil.density": 870.1, "torque_sensor.offset": 0.01}


def scenario_with(tmp_path, content):
    file = tmp_path / "extension.yaml"
    file.write_text(yaml.safe_dump(content), encoding="utf-8")
    document = open_scenario("on_centre")
    set_file(document, str(file))
    return check_scenario(document, find("scenario", "on_centre").parent)


def test_it_holds_causes_and_what_moved_in_the_plant():
    made = extension(CAUSE, REFITTED, KNOWN)
    assert made == {"effects": CAUSE, "parameters": {"mechanics.rack_mass": 24.5}}


@pytest.mark.parametrize("system", ["open_centre", "closed_centre"])
def test_a_run_takes_it(system, tmp_path):
    """In the direct runner, and as ROS parameters of the graph's nodes."""
    scenario = scenario_with(tmp_path, extension(CAUSE, REFITTED, KNOWN))
    assert scenario.effects == CAUSE
    assert scenario.parameters["mechanics.rack_mass"] == 24.5
    node_set = load_node_set(system)
    cores = build_cores(scenario, node_set)
    assert cores.plant.par["rack_mass"][0] == 24.5
    assert len(run(cores, 50).torque) == 50
    plant = node_parameters(scenario, node_set)["plant"]
    assert plant["effects.cross_piston_leakage.leakage"] == 2e-12
    assert plant["mechanics.rack_mass"] == 24.5


def test_every_hypothesis_of_a_record_can_be_written_and_loaded(tmp_path):
    replay = SteeringReplay(bench_record("closed_centre", duration=1.0))
    effects = {
        h.name: {p.name: p.typical for p in h.parameters} for h in replay.hypotheses.values()
    }
    scenario = scenario_with(tmp_path, extension(effects, {}, replay.nuisances))
    assert scenario.effects.keys() == effects.keys()
