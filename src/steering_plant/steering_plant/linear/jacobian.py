"""Numerical linearisation of the nonlinear right-hand side: the second route to every model."""

from __future__ import annotations

import numpy as np

from steering_plant.linear.linear_model import LinearModel
from steering_plant.model.dynamics import rates
from steering_plant.model.states import INPUT_NAMES
from steering_plant.plant import TOLERANCES, Plant

STEP = 0.1
"""Step of the differences as a share of the state's integration tolerance."""

INPUT_STEPS = (1e-4, 1e-4, 1e-4, 1e-1, 1.0, 1e-9, 1e-7)
"""Steps of the inputs, in the order of INPUT_NAMES, SI."""


def numerical_model(plant: Plant, state: np.ndarray, inputs: np.ndarray) -> LinearModel:
    """Linearise the plant without effects at a state and held inputs by central differences.

    All states are outputs. Where a friction element is loaded its rate has a kink at standstill;
    switch friction off to compare with models that have none.
    """
    y, u = np.array(state, float), np.array(inputs, float)

    def slopes(values: np.ndarray, position: int, step: float) -> np.ndarray:
        kept, sides = values[position], []
        for sign in (1.0, -1.0):
            values[position] = kept + sign * step
            rate = np.zeros(len(y))
            rates(plant.par[0], plant.table, plant.effects, 0.0, y, u, rate, plant.flows)
            sides.append(rate)
        values[position] = kept
        return (sides[0] - sides[1]) / (2.0 * step)

    a = [slopes(y, k, STEP * min(TOLERANCES[name], 1e3)) for k, name in enumerate(plant.names)]
    b = [slopes(u, k, step) for k, step in enumerate(INPUT_STEPS)]
    size = len(y)
    return LinearModel(
        np.array(a).T,
        np.array(b).T,
        np.eye(size),
        np.zeros((size, len(b))),
        plant.names,
        INPUT_NAMES,
        plant.names,
    )
