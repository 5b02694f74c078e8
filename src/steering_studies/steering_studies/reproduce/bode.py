"""A Bode plot in the axes of the source's figure."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from steering_bringup.pages import Figure
from steering_studies.linear.bode import Family
from steering_studies.linear.sections import bode_figure

Range = tuple[float, float]


def bode(
    family: Family, hertz: Range, decibel: Range, degrees: Range, caption: str, unit: str = "N m"
) -> Figure:
    """Return amplitude and phase over the source's frequencies [Hz], logarithmic.

    decibel, degrees: the ends of the source's axes. Where a curve leaves them the axis is longer,
    and dotted lines mark the source's ends.
    """
    inside = (family.frequency >= hertz[0]) & (family.frequency <= 1.001 * hertz[1])
    cut = replace(family, frequency=family.frequency[inside], response=family.response[:, inside])
    drawn = bode_figure(cut, caption, unit)
    for axes, ends in zip((row[0] for row in drawn.rows), (decibel, degrees), strict=True):
        values = np.concatenate([curve.y for curve in axes.curves])
        low, high = min(ends[0], float(values.min())), max(ends[1], float(values.max()))
        margin = 0.04 * (high - low)
        axes.y_range = (low - margin, high + margin)
        axes.limits = ends
    return drawn
