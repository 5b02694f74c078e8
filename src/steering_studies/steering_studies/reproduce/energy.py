"""Energy on-centre and straight ahead: the source has no figure of it."""

from __future__ import annotations

from typing import Any

import numpy as np

from steering_bringup.pages import Axes, Curve, Figure
from steering_studies.beyond.energy import PARTS, mean_power
from steering_studies.reproduce.row import Number, Row

ON_CENTRE: dict[str, Any] = {"duration": 10.0, "manoeuvre": {"kind": "on_centre"}}
STRAIGHT: dict[str, Any] = PARTS["straight ahead"][1]

EARLIER = {200.0: 221.0, 150.0: 166.0, 120.0: 133.0}
"""Supply pressure [bar] to the closed centre's mean power [W] in an earlier, independent model."""


def energy() -> Row:
    """Return the mean hydraulic power of both systems."""
    opened = mean_power(ON_CENTRE, "open_centre", {})
    closed = {
        bar: mean_power(ON_CENTRE, "closed_centre", {"closed_centre.supply_pressure": bar * 1e5})
        for bar in EARLIER
    }
    straight = [mean_power(STRAIGHT, system, {}) for system in ("open_centre", "closed_centre")]
    supply = np.array(list(closed))
    curves = [
        Curve(supply, np.array(list(closed.values())), "closed centre", "#1f5fa8",
              mode="lines+markers", over_time=False),
        Curve(supply, np.full(len(supply), opened), "open centre", "#b3261e", over_time=False),
    ]  # fmt: skip
    return Row(
        "energy",
        "Mean hydraulic power; the numbers beside ours are an earlier model's",
        [
            Number("on-centre cycle, open centre", "W", 239.0, opened),
            *(
                Number(f"on-centre cycle, closed centre at {bar:.0f} bar", "W", EARLIER[bar], found)
                for bar, found in closed.items()
            ),
            Number("straight ahead, open centre", "W", 114.0, straight[0]),
            Number("straight ahead, closed centre at 200 bar", "W", 4.9, straight[1]),
        ],
        [
            Figure(
                "On-centre cycle",
                [[Axes("supply pressure [bar]", "mean hydraulic power [W]", curves)]],
            )
        ],
        words="The source leaves energy to its outlook. In the cycle the closed centre saves as "
        "much as its supply pressure is lowered; straight ahead it takes its leakage alone.",
    )


ROWS = (energy,)
