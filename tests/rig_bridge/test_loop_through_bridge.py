"""The bench's own cores drive the emulated rig through the bridge, beside the simulated plant."""

import numpy as np
import pytest
from healthy_rig import emulated_rig
from rig_links import both_ends
from rig_loop import Loop

from driver_model.driver import Driver
from driver_model.manoeuvres import make_manoeuvre
from pressure_control.controller import ValveController
from rig_bridge.safety.machine import State
from steering_core.parameters import load_parameters
from steering_plant.plant import Plant
from vehicle_model.loads import LOADS
from vehicle_model.vehicle import Vehicle

TICKS = 3000
NAMES = emulated_rig().commanded
# One more sample of delay than in simulation, and noise: a lower gain than the data sheet's.
PARAMETERS = load_parameters("nominal").with_values({"valve_controller.resonance": 300.0})


class Bench:
    """Driver, both valve controllers and vehicle; ``commands`` of a tick's measurements."""

    def __init__(self, still: int) -> None:
        """The driver holds the wheel still for so many ticks, while the rig is checked."""
        manoeuvre = make_manoeuvre("on_centre", duration_s=3.0)
        self.driver = Driver(PARAMETERS, manoeuvre, TICKS)
        self.driver.reference = np.concatenate([np.zeros(still), self.driver.reference])
        self.driver.hands_on = np.concatenate([np.ones(still), self.driver.hands_on])
        self.vehicle = Vehicle(PARAMETERS, LOADS["bicycle"](), TICKS + still)
        self.valves = [ValveController(PARAMETERS, side) for side in ("left", "right")]

    def commands(self, tick, measured):
        torque = self.driver.step(tick, *measured[:3])[0]
        load = self.vehicle.step(tick, *measured[6:])
        left, right = (valve.step(tick, *measured).copy() for valve in self.valves)
        return dict(zip(NAMES, (torque, *left, *right, *load), strict=True))


def simulated(bench):
    plant = Plant(PARAMETERS, "closed_centre")
    trace = [plant.out.copy()]
    for tick in range(TICKS):
        asked = bench.commands(tick, plant.out)
        inputs = [asked[name] for name in NAMES if not name.endswith("reference_pressure")]
        trace.append(plant.step(tick, *inputs).copy())
    return np.array(trace)


def through_bridge(loop, bench, still):
    trace, measured = [], loop.rig.plant.out
    for tick in range(still + TICKS):
        reply = loop.tick(bench.commands(tick, measured))
        measured = np.array(list(reply.measured.values()))
        trace.append(loop.rig.plant.out.copy())
    assert reply.state is State.RUNNING, loop.bridge.report()
    return np.array(trace)[still:]


@pytest.mark.slow
def test_on_centre_driving_through_the_bridge_is_that_of_the_simulation():
    still = 150
    expected = simulated(Bench(0))
    with both_ends("udp") as (bench_end, rig_end):
        loop = Loop(bench_end, rig_end)
        actual = through_bridge(loop, Bench(still), still)
        assert loop.bridge.guard.commands.limited == 0
    angle = np.degrees(expected[:TICKS, 0] - actual[:, 0])
    torque = expected[:TICKS, 2] - actual[:, 2]
    load = (expected[:TICKS, 4] - expected[:TICKS, 3]) - (actual[:, 4] - actual[:, 3])
    assert abs(expected[:, 2]).max() > 1.5, "the manoeuvre is driven"
    assert abs(angle).max() < 1.0
    assert abs(torque).max() < 0.3
    assert abs(load).max() < 3e5
