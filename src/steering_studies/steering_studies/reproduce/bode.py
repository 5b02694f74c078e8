"""A Bode plot in the axes of the source's figure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from steering_bringup.pages import Figure
from steering_studies.linear.bode import Family
from steering_studies.linear.sections import bode_figure

Range = tuple[float, float]


def bode(
    family: Family,
    hertz: Range,
    decibel: Range,
    degrees: Range,
    caption: str,
    *,
    phase_to: float | None = None,
    names: Sequence[str] = (),
) -> Figure:
    """Return amplitude and phase over the source's frequencies [Hz], logarithmic.

    decibel, degrees: the ends of the source's axes. Where a curve leaves them the axis is longer,
    and dotted lines mark the source's ends. phase_to [Hz]: the source's phase ends there. names: of
    the curves, the torques by default.
    """
    inside = (family.frequency >= hertz[0]) & (family.frequency <= 1.001 * hertz[1])
    cut = replace(family, frequency=family.frequency[inside], response=family.response[:, inside])
    drawn = bode_figure(cut, caption)
    amplitude, phase = (row[0] for row in drawn.rows)
    if phase_to is not None:
        amplitude.link = phase.link = ""
        low = cut.frequency <= phase_to
        phase.curves = [replace(c, x=c.x[low], y=c.y[low]) for c in phase.curves]
    for axes, ends in ((amplitude, decibel), (phase, degrees)):
        if names:
            axes.curves = [replace(c, name=n) for c, n in zip(axes.curves, names, strict=True)]
        values = np.concatenate([curve.y for curve in axes.curves])
        low_end, high_end = min(ends[0], float(values.min())), max(ends[1], float(values.max()))
        margin = 0.04 * (high_end - low_end)
        axes.y_range = (low_end - margin, high_end + margin)
        axes.limits = ends
    return drawn
