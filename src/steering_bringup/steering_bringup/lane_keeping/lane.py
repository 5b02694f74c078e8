"""The lane: a curve to the left, one to the right, with clothoids between, then straight on."""

from __future__ import annotations

import math

import numpy as np

from steering_core.compiled import kernel
from steering_core.parameters import ParameterSet

SPACING = 1.0
"""Distance [m] between two points of the lane's centre line."""


@kernel
def lane_at(lane, s):
    """Return x, y [m], heading [rad] and curvature [1/m] of the centre line after ``s`` [m].

    lane: table of ``lane_table``. Beyond either end the lane goes straight on.
    """
    last = lane.shape[0] - 1
    i = min(max(math.floor(s / SPACING), 0), last)
    ahead = s - i * SPACING
    x, y, heading, curvature = lane[i, 0], lane[i, 1], lane[i, 2], lane[i, 3]
    if i == last or ahead < 0.0:
        return x + ahead * math.cos(heading), y + ahead * math.sin(heading), heading, 0.0
    share = ahead / SPACING
    return (
        x + share * (lane[i + 1, 0] - x),
        y + share * (lane[i + 1, 1] - y),
        heading + share * (lane[i + 1, 2] - heading),
        curvature + share * (lane[i + 1, 3] - curvature),
    )


def lane_table(parameters: ParameterSet) -> np.ndarray:
    """Return [x m, y m, heading rad, curvature 1/m] of the centre line, shape (n, 4)."""
    p = parameters.group("lane_keeping")
    tight = 1.0 / p["lane_radius"]
    pieces = (
        (p["lane_straight"], 0.0),
        (p["lane_transition"], tight),
        (p["lane_arc"], tight),
        (2.0 * p["lane_transition"], -tight),
        (p["lane_arc"], -tight),
        (p["lane_transition"], 0.0),
    )
    ends = np.cumsum([0.0, *(length for length, _ in pieces)])
    s = np.arange(0.0, ends[-1] + SPACING, SPACING)
    curvature = np.interp(s, ends, [0.0, *(end for _, end in pieces)])
    turned = 0.5 * (curvature[1:] + curvature[:-1]) * SPACING
    heading = np.concatenate([[0.0], np.cumsum(turned)])
    middle = 0.5 * (heading[1:] + heading[:-1])
    x, y = (np.concatenate([[0.0], np.cumsum(step(middle) * SPACING)]) for step in (np.cos, np.sin))
    return np.column_stack([x, y, heading, curvature])


def lane_offsets(lane: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return how far left of the centre line [m] a car at ``x``, ``y`` [m] is, shape (n,).

    The points follow each other along the lane, some metres apart at most.
    """
    along, offsets = 0.0, np.empty(len(x))
    for k in range(len(x)):
        for _ in range(3):  # the foot of the perpendicular: the lane bends little on the way
            lane_x, lane_y, heading, _ = lane_at(lane, along)
            ahead, aside = x[k] - lane_x, y[k] - lane_y
            along += ahead * math.cos(heading) + aside * math.sin(heading)
        lane_x, lane_y, heading, _ = lane_at(lane, along)
        ahead, aside = x[k] - lane_x, y[k] - lane_y
        offsets[k] = aside * math.cos(heading) - ahead * math.sin(heading)
    return offsets
