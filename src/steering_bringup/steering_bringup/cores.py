"""From a scenario to the objects that compute: plant, valve controllers, driver and vehicle."""

from __future__ import annotations

from typing import Any

import numpy as np

from driver_model.driver import Driver
from pressure_control.load_force import LoadForceController
from pressure_control.overlay.arbiter import OverlayArbiter
from steering_bringup.direct.effects import loop_for
from steering_bringup.direct.runner import Cores
from steering_bringup.errors import BenchError
from steering_bringup.lane_keeping.keeper import LaneKeeper
from steering_bringup.node_parameters import curve_points
from steering_bringup.schema import NodeSet, Scenario
from steering_bringup.valve_controllers import control_modules, valve_controllers
from steering_core.parameters import ParameterError
from steering_lockstep.topics import LOAD_COMMAND, overlay_source
from steering_plant.effects.models import vehicle_model
from steering_plant.measured_boost_curve import boost_table
from steering_plant.plant import Plant
from vehicle_model.model import slots, step
from vehicle_model.motion_messages import odometry_fields
from vehicle_model.vehicle import Vehicle


def build_cores(scenario: Scenario, node_set: NodeSet) -> Cores:
    """Return fresh cores at rest; BenchError for values that cannot be built."""
    try:
        return _build(scenario, node_set)
    except (ValueError, ParameterError) as error:
        raise BenchError(f"scenario '{scenario.name}' cannot run: {error}") from None


def _build(scenario: Scenario, node_set: NodeSet) -> Cores:
    parameters, ticks = scenario.parameter_values(), scenario.ticks
    valve_system = node_set.valve_system
    table = boost_curve(scenario)
    plant = Plant(parameters, valve_system, table, scenario.effects, node_set.load_cylinder)
    left, right = valve_controllers(node_set, parameters, table)
    rolling = vehicle_model(scenario.effects, slots, step)
    return Cores(
        plant=plant,
        driver=Driver(parameters, scenario.manoeuvre.make(), ticks),
        vehicle=Vehicle(parameters, scenario.load.make(), ticks, *rolling),
        left=left,
        right=right,
        arbiter=overlay_arbiter(scenario, node_set),
        lane_keeper=lane_keeper(scenario, node_set),
        loop=loop_for(plant.model, rolling[0], *control_modules(left)),
        load_cylinder=LoadForceController(parameters) if node_set.load_cylinder else None,
    )


def overlay_arbiter(scenario: Scenario, node_set: NodeSet) -> OverlayArbiter | None:
    """Return the arbiter of a node set that has one, with the periods of its sources."""
    arbiters = [(n, e) for n, e in node_set.nodes.items() if e.kind == "overlay_arbiter"]
    if not arbiters:
        return None
    name, entry = arbiters[0]
    inputs = {t: scenario.delays.get(f"{t}->{name}", d) for t, d in entry.inputs.items()}
    sources = [topic for topic in inputs if overlay_source(topic)]
    period = {topic: e.period for e in node_set.nodes.values() for topic in e.outputs}
    delays = [inputs[t] for t in sources]
    return OverlayArbiter(scenario.parameter_values(), [period[t] for t in sources], delays)


def lane_keeper(scenario: Scenario, node_set: NodeSet) -> LaneKeeper | None:
    """Return the lane keeper of a node set that has one."""
    found = [entry for entry in node_set.nodes.values() if entry.kind == "lane_keeper"]
    return LaneKeeper(scenario.parameter_values(), found[0].period) if found else None


def step_once(cores: Cores) -> None:
    """Do tick 0 with every core on its own, as the nodes do. The cores are moved on."""
    measured = cores.plant.out.tolist()
    torque, rack = measured[:3], measured[6:]
    forces = [0.0, 0.0]
    for index, controller in enumerate((cores.left, cores.right)):
        if controller is not None:
            forces[index] = float(controller.step(0, *measured)[1])
    applied = float(cores.driver.step(0, *torque)[0])
    load = cores.vehicle.step(0, *rack).tolist()
    if cores.lane_keeper is not None:
        cores.lane_keeper.step(0, 0.0, 0.0, 0.0, 1.0, cores.vehicle.odometry().v_x, 0.0, 0.0)
    opened = 0.0
    if cores.load_cylinder is not None:
        opened = float(cores.load_cylinder.step(0, *rack, *load)[1])
    if cores.arbiter is not None:
        cores.arbiter.step(0, *torque, 0.0, *[0.0] * (2 * len(cores.arbiter.periods)))
    cores.plant.truth(0)
    cores.plant.step(0, *[applied, *forces, *load, opened])


def boost_curve(scenario: Scenario) -> np.ndarray:
    """Return the measured boost curve's table, or the one that stands for the formula."""
    return boost_table(curve_points(scenario))


def rest_values(cores: Cores) -> dict[str, tuple[float, ...]]:
    """Return what each topic is taken to have held before the first tick: the state of rest."""
    measured = cores.plant.out
    rest: dict[str, Any] = {
        "/steering/torque": measured[:3],
        "/steering/pressure": measured[3:6],
        "/steering/rack": measured[6:],
        "/driver/torque": np.zeros(2),
        "/vehicle/rack_force": np.zeros(3),
        "/vehicle/odometry": np.array(odometry_fields(cores.vehicle.odometry())),
    }
    for topic, controller in (
        ("/valve/left/command", cores.left),
        ("/valve/right/command", cores.right),
    ):
        if controller is not None:
            rest[topic] = controller.out
    if cores.load_cylinder is not None:
        rest[LOAD_COMMAND] = cores.load_cylinder.out
    return {topic: tuple(values.tolist()) for topic, values in rest.items()}
