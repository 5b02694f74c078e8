"""Looking inside a tick: the plant's own integrator over spans shorter than a tick."""

# mypy: allow-untyped-defs

import numpy as np

from steering_plant.model.integrator import OK, advance

CLAMP = 1e10
"""Load stiffness [N/m] of a clamped rack."""


def sampled(plant, inputs, span, count):
    """Return the states at 0, span, ..., count span under held inputs, shape (count + 1, n)."""
    states = np.empty((count + 1, len(plant.state)))
    states[0] = plant.state
    held, step = np.array(inputs, dtype=float), np.array([span])
    for row in range(count):
        status = advance(
            plant.par[0],
            plant.table,
            plant.effects,
            plant.scale,
            0.0,
            span,
            plant.state,
            step,
            held,
            plant.work,
            plant.flows,
        )
        assert status == OK
        states[row + 1] = plant.state
    return states
