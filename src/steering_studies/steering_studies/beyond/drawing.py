"""Figures that several studies draw alike."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from steering_bringup.pages import Axes, Curve, Figure

COLOURS = ("#1b2530", "#b3261e", "#1f5fa8", "#1b7f4b", "#8a5a00", "#6a3fa0")


def over_time(
    title: str, panels: Mapping[str, Mapping[str, tuple[np.ndarray, np.ndarray]]], height: int = 240
) -> Figure:
    """Return panels above each other: title of y to name to (time, values), in shown units."""
    rows = [
        [
            Axes(
                "time [s]",
                y_title,
                [
                    Curve(time, values, name, COLOURS[k % len(COLOURS)], width=1.4)
                    for k, (name, (time, values)) in enumerate(curves.items())
                ],
                link="time",
            )
        ]
        for y_title, curves in panels.items()
    ]
    return Figure(title, rows, height=height)
