"""Single plots of two runs, of which the comparison's figures are made."""

from __future__ import annotations

import numpy as np

from steering_bringup.comparison.result import Comparison
from steering_bringup.comparison.signals import Signal
from steering_bringup.comparison.verdict import limit
from steering_bringup.pages import Axes, Curve

OPEN, CLOSED, DIFFERENCE = "#1b2530", "#2f7fd6", "#c2530c"
OPEN_WIDTH, CLOSED_WIDTH = 1.5, 2.8
TIME = "Time [s]"
SPEED = "Steering wheel speed [deg/s]"


def curve(
    result: Comparison, side: int, x: np.ndarray, y: np.ndarray, over_time: bool = True
) -> Curve:
    """A run's curve: open-centre dashed and thin, closed-centre solid and broad beneath it."""
    dashed = _dashed(result) == side
    return Curve(
        x,
        y,
        result.names[side],
        colour=OPEN if dashed else CLOSED,
        dash="dash" if dashed else "solid",
        width=OPEN_WIDTH if dashed else CLOSED_WIDTH,
        over_time=over_time,
    )


def _dashed(result: Comparison) -> int:
    """Which run is drawn dashed: the open-centre one, else the first."""
    return 1 if result.systems[0] != result.systems[1] == "open-centre" else 0


def _sides(result: Comparison) -> tuple[int, int]:
    """The solid curve first, so that the dashed one lies on top."""
    dashed = _dashed(result)
    return 1 - dashed, dashed


def both(result: Comparison, key: str, title: str = "") -> Axes:
    """Both runs' signal over time."""
    signal = result.kinds[key]
    curves = [
        curve(result, side, result.time, result.signals[key][side] * signal.scale)
        for side in _sides(result)
    ]
    return Axes(TIME, _with_unit(_quantity(signal), signal), curves, title, link="time")


_QUANTITIES = {"Pa": "Pressure", "N m": "Torque", "rad": "Angle", "rad/s": "Speed"}
_QUANTITIES |= {"m": "Position", "m/s": "Speed", "N": "Force"}


def _quantity(signal: Signal) -> str:
    return _QUANTITIES.get(signal.unit, "Value")


def _with_unit(text: str, signal: Signal) -> str:
    return f"{text} [{signal.shown_unit}]" if signal.shown_unit else text


def _difference_label(result: Comparison, key: str) -> str:
    return _with_unit("Difference", result.kinds[key])


def error(result: Comparison, key: str, title: str = "") -> Axes:
    """Second minus first run over time, with its limits."""
    signal = result.kinds[key]
    curve = Curve(result.time, result.error(key) * signal.scale, colour=DIFFERENCE, width=1.2)
    return Axes(
        TIME,
        _difference_label(result, key),
        [curve],
        title,
        limits=limits(result, key),
        link="time",
    )


def limits(result: Comparison, key: str) -> tuple[float, ...]:
    """Limit lines, unless the difference is so small that they would flatten it."""
    bound = limit(result, key)
    if bound is None or result.differences[key].largest < 0.2 * bound:
        return ()
    return (-bound * result.kinds[key].scale, bound * result.kinds[key].scale)


def loop(result: Comparison, x_key: str, y_key: str) -> Axes:
    """One signal against another, both runs."""
    x, y = result.kinds[x_key], result.kinds[y_key]
    curves = [
        curve(
            result,
            side,
            result.signals[x_key][side] * x.scale,
            result.signals[y_key][side] * y.scale,
            over_time=False,
        )
        for side in _sides(result)
    ]
    return Axes(
        f"{x.title} [{x.shown_unit}]", f"Torque [{y.shown_unit}]", curves, "Against the angle"
    )


def against_speed(result: Comparison, key: str) -> Axes | None:
    """Difference against steering wheel speed, coloured by the frequency of steering."""
    if "steering_wheel_speed" not in result.signals:
        return None
    speed = result.signals["steering_wheel_speed"][0] * result.kinds["steering_wheel_speed"].scale
    gap = result.error(key) * result.kinds[key].scale
    growth = result.growths.get(key)
    shade, title = result.time, "time [s]"
    if growth is not None:
        shade = np.interp(result.time, growth.time, growth.frequency)
        title = "frequency [Hz]"
    curve = Curve(speed, gap, mode="markers", over_time=False, shade=shade, shade_title=title)
    return Axes(
        SPEED,
        _difference_label(result, key),
        [curve],
        "Against steering wheel speed",
        limits=limits(result, key),
    )


def growth_axes(result: Comparison, key: str) -> Axes | None:
    """Peak of each half-cycle against its frequency; None where there are too few."""
    growth = result.growths.get(key)
    if growth is None:
        return None
    peak = growth.peak * result.kinds[key].scale
    slope, rest = np.polyfit(growth.frequency, peak, 1)
    ends = np.array([0.0, growth.frequency.max()])
    return Axes(
        "Frequency of the half-cycle [Hz]",
        f"Largest difference [{result.kinds[key].shown_unit}]",
        [
            Curve(ends, rest + slope * ends, colour="#9aa5b1", dash="dot", width=1.4),
            Curve(growth.frequency, peak, colour=DIFFERENCE, mode="lines+markers", over_time=False),
        ],
        "Against the frequency of steering",
        y_range=(min(0.0, float(rest)), float(peak.max()) * 1.1) if peak.max() > 0 else None,
    )


def growth_caption(result: Comparison, key: str) -> str:
    """What the plot of `growth_axes` shows, in words."""
    growth = result.growths.get(key)
    if growth is None:
        return "Its growth with frequency cannot be judged: too few half-cycles of steering."
    share = max(0.0, growth.static_share)
    return (
        "Lower right: the largest difference of each half-cycle of steering. A straight line "
        f"through these points leaves {share:.0%} of it at zero frequency."
    )
