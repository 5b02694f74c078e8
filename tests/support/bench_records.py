"""Records made by the bench itself in memory, with sensors that are not ideal."""

# mypy: allow-untyped-defs

import numpy as np

from steering_bringup.cores import build_cores
from steering_bringup.direct.runner import run
from steering_bringup.scenario_files import load_node_set, load_scenario
from steering_bringup.schema import Scenario
from steering_diagnosis.data.channels import MEASURED
from steering_diagnosis.data.record import Record
from steering_plant.effects.models import all_effects

NOISE = {
    "torque_sensor.noise": 5e-3,
    "angle_sensor.noise": 1e-4,
    "left_pressure_sensor.noise": 5e3,
    "right_pressure_sensor.noise": 5e3,
    "supply_pressure_sensor.noise": 5e3,
    "rack_position_sensor.noise": 5e-6,
    "rack_force_sensor.noise": 5.0,
}
VALVES = ("left", "right")


def bench_record(system, scenario="on_centre", duration=6.0, effects=None, hidden=None, noise=None):
    """Return the record of a direct run.

    effects, hidden (parameters): of the truth, which the record's nominal parameters do not know.
    The other effects are there too, and neutral: one model to compile for all tests.
    """
    given = load_scenario(scenario)
    parameters = {**given.parameters, **(hidden or {}), **(noise or {})}
    data = given.model_dump(by_alias=True)
    acting = {**all_effects(system, effects), **effects} if effects else {}
    data |= {"duration": duration, "parameters": parameters, "effects": acting}
    made = Scenario.model_validate(data)
    trace = run(build_cores(made, load_node_set(system)), made.ticks)
    measured = np.column_stack([trace.torque, trace.pressure, trace.rack])
    channels = dict(zip(MEASURED, measured.T.copy(), strict=True))
    channels["driver_torque"] = trace.driver[:, 0].copy()
    if system == "closed_centre":
        for side, valve in zip(VALVES, (trace.left_valve, trace.right_valve), strict=True):
            channels[f"{side}_reference_pressure"] = valve[:, 0].copy()
            channels[f"{side}_solenoid_force"] = valve[:, 1].copy()
    for column, name in enumerate(("load_force", "load_stiffness", "load_position")):
        channels[name] = trace.load[:, column].copy()
    return Record(system, channels, given.parameter_values(), vehicle_load=made.load.kind)
