"""The closed loop tick by tick, with a hand in it: for what happens in mid-run.

The same cores in the same order as the direct runner, called one by one from Python, so that a
study can change what the controllers see, what the solenoids do, or the supply at any tick.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from steering_bringup.cores import build_cores
from steering_bringup.scenario_files import load_node_set
from steering_bringup.schema import Scenario
from steering_plant.model.states import SUPPLY_FLOW
from steering_plant.plant import Plant

Sensed = Callable[[int, list[float]], list[float]]
"""(tick, nine measured values) to what the valve controllers are told."""

Acted = Callable[[int, float, float], tuple[float, float]]
"""(tick, left and right solenoid force [N]) to what acts."""

After = Callable[[int, float, float], None]
"""(tick, left and right reference pressure [Pa]): called once the controllers have computed."""

Before = Callable[[int, Plant], None]
"""Called before the plant's step of a tick."""


@dataclass(frozen=True, repr=False)
class Record:
    """One run, a row a tick, SI. measured (n, 9): order of the plant's sensors. driver (n,) [N m].

    references (n, 2) [Pa], forces (n, 2) [N]: left, right. supply_flow (n,) [m3/s].
    """

    measured: np.ndarray
    driver: np.ndarray
    references: np.ndarray
    forces: np.ndarray
    supply_flow: np.ndarray

    @property
    def time(self) -> np.ndarray:
        """Seconds, (n,)."""
        return np.arange(len(self.driver)) * 1e-3

    @property
    def load_pressure(self) -> np.ndarray:
        """Right minus left chamber pressure [Pa], (n,)."""
        return self.measured[:, 4] - self.measured[:, 3]


def closed_loop(
    document: dict[str, Any],
    parameters: dict[str, float],
    *,
    sensed: Sensed | None = None,
    acted: Acted | None = None,
    before: Before | None = None,
    after: After | None = None,
) -> Record:
    """Run a scenario given as data, with ``parameters`` on top of its own, and the hooks."""
    given = {**document.get("parameters", {}), **parameters}
    scenario = Scenario.model_validate(
        {"schema": 1, "name": "study", **document, "parameters": given, "truth": False}
    )
    cores = build_cores(scenario, load_node_set(scenario.node_set[0]))
    plant, controllers = cores.plant, (cores.left, cores.right)
    n = scenario.ticks
    made = Record(np.empty((n, 9)), np.empty(n), np.zeros((n, 2)), np.zeros((n, 2)), np.zeros(n))
    for tick in range(n):
        values = plant.out.tolist()
        made.measured[tick] = values
        told = values if sensed is None else sensed(tick, list(values))
        for side, controller in enumerate(controllers):
            if controller is not None:
                made.references[tick, side], made.forces[tick, side] = controller.step(tick, *told)
        if after is not None:
            after(tick, *(float(value) for value in made.references[tick]))
        made.driver[tick] = float(cores.driver.step(tick, *values[:3])[0])
        load = cores.vehicle.step(tick, *values[6:]).tolist()
        left, right = (float(force) for force in made.forces[tick])
        if acted is not None:
            left, right = acted(tick, left, right)
        if before is not None:
            before(tick, plant)
        plant.step(tick, made.driver[tick], left, right, *load)
        made.supply_flow[tick] = plant.flows[SUPPLY_FLOW]
    return made
