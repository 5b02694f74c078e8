import numpy as np
import pytest
from hypothesis import settings

from driver_model.driver import Driver
from pressure_control.controller import ValveController
from pressure_control.servo_controller import ServoValveController
from steering_bringup.scenario_files import load_scenario
from steering_plant.plant import Plant
from vehicle_model.vehicle import Vehicle

# The first call of a kernel may compile it.
settings.register_profile("kernels", deadline=None)
settings.load_profile("kernels")

CONTROLLERS: dict[str, type] = {
    "closed_centre": ValveController,
    "servo_valve": ServoValveController,
}


class Loop:
    """A closed loop of the shipped cores around any plant that steps like the real one."""

    def __init__(self, name: str, valve_system: str, changes: dict | None = None) -> None:
        self.scenario = load_scenario(name)
        self.parameters = self.scenario.parameter_values().with_values(changes or {})
        self.valve_system = valve_system

    def plant(self) -> Plant:
        """Return the plant under test."""
        return Plant(self.parameters, self.valve_system)

    def run(self, plant, ticks: int | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Return states and inputs of every tick, shapes (n, states) and (n, 6)."""
        p, n = self.parameters, ticks or self.scenario.ticks
        driver = Driver(p, self.scenario.manoeuvre.make(), self.scenario.ticks)
        vehicle = Vehicle(p, self.scenario.load.make(), self.scenario.ticks)
        kind = CONTROLLERS.get(self.valve_system)
        valves = [kind(p, "left"), kind(p, "right")] if kind else []
        states, inputs = np.empty((n, len(plant.state))), np.empty((n, 6))
        for tick in range(n):
            states[tick] = plant.state
            measured = plant.out
            forces = [valve.step(tick, *measured)[1] for valve in valves] or (0.0, 0.0)
            torque, _ = driver.step(tick, *measured[:3])
            inputs[tick] = (torque, *forces, *vehicle.step(tick, *measured[6:]))
            plant.step(tick, *inputs[tick])
        return states, inputs


@pytest.fixture(scope="session")
def closed_loop() -> type[Loop]:
    """Return the class of closed loops around a plant."""
    return Loop


@pytest.fixture(scope="session")
def trajectory(closed_loop):
    """Return a function that gives the plant's states and inputs over a shipped manoeuvre."""
    manoeuvres = {}

    def made(name: str, system: str) -> tuple[np.ndarray, np.ndarray]:
        if (name, system) not in manoeuvres:
            loop = closed_loop(name, system)
            manoeuvres[name, system] = loop.run(loop.plant())
        return manoeuvres[name, system]

    return made
