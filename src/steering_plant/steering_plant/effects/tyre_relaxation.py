"""The front tyres build up their side force over a rolled distance."""

from __future__ import annotations

import math

from steering_core.compiled import kernel
from steering_plant.effects.base import Effect, Parameter, State


@kernel
def rack_force(value, distance, lagged_force, relaxation_length):
    """Return the tyres' rack force at this tick [N]; a wheel that stands does not lag."""
    return lagged_force if relaxation_length > 0.0 and distance > 0.0 else value


@kernel
def stiffness(value, distance, relaxation_length):
    """Return the stiffness that the rack feels within the tick [N/m]: a lagging tyre has none."""
    return 0.0 if relaxation_length > 0.0 and distance > 0.0 else value


@kernel
def next_force(force, lagged_force, distance, relaxation_length):
    """Return the lagging rack force [N] after ``distance`` [m] rolled at the steady ``force``."""
    if relaxation_length <= 0.0:
        return force
    return force + (lagged_force - force) * math.exp(-distance / relaxation_length)


EFFECT = Effect(
    name="tyre_relaxation",
    summary="the front tyres build up their side force over a rolled distance",
    sees="rack force and yaw rate late behind the rack; the more, the lower the speed",
    equation="(sigma/u) F' + F = F_steady",
    source="H. B. Pacejka, Tyre and Vehicle Dynamics, chapter 1: first-order relaxation",
    balance="load",
    separating="a sine sweep of angle at 20 and at 100 km/h",
    excitation="steering above 1 Hz, or speeds below 40 km/h",
    parameters={"relaxation_length": Parameter("rolled distance to 63 %", "m", 0, 0, 2, 0.4)},
    acts_in="vehicle",
    slots={"rack_force": rack_force, "stiffness": stiffness},
    states={"lagged_force": State(0.0, next_force)},
    adds_energy=True,
)
