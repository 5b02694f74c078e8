"""The comparison's figures, in the order and the axes of the source's figures 8.2 to 8.6."""

from __future__ import annotations

import numpy as np

from steering_bringup.comparison.drawing import (
    TIME,
    against_speed,
    both,
    curve,
    error,
    growth_axes,
    growth_caption,
    loop,
)
from steering_bringup.comparison.result import Comparison
from steering_bringup.comparison.verdict import situation
from steering_bringup.pages import Axes, Figure

POWER_WINDOW_S = 0.25
MOST_FURTHER = 12
"""Further channels that are drawn; each costs the page two curves of the whole length."""

DRAWN = frozenset(
    {
        "assistance_pressure",
        "steering_wheel_torque",
        "left_pressure",
        "right_pressure",
        "supply_pressure",
        "steering_wheel_angle",
        "rack_position",
    }
)
"""Signals with a figure of their own."""


def figures(result: Comparison) -> list[Figure]:
    """All figures that the two runs have the signals for."""
    made = [
        assistance_pressure(result),
        steering_wheel_torque(result),
        torque_difference(result),
        chamber_pressures(result),
        motion(result),
        supply(result),
        *further(result),
    ]
    return [figure for figure in made if figure is not None]


def assistance_pressure(result: Comparison) -> Figure | None:
    """Fig 8.2: assistance pressure and its difference."""
    if "assistance_pressure" not in result.signals:
        return None
    upper = both(result, "assistance_pressure", title="Both systems")
    gap = error(result, "assistance_pressure", title="Difference")
    against = against_speed(result, "assistance_pressure")
    return Figure(
        "Assistance pressure" + _as(result, on_centre="8.2", dry_park="8.6"),
        [[upper], [gap, against] if against else [gap]],
        "Pressure that pushes the rack: right minus left chamber.",
        widths=(1.25, 1.0),
    )


def steering_wheel_torque(result: Comparison) -> Figure | None:
    """Fig 8.3: what the driver feels, over time and against the angle."""
    if "steering_wheel_torque" not in result.signals:
        return None
    over_time = both(result, "steering_wheel_torque", title="Over time")
    if _as(result, on_centre="8.3") and max(result.differences["steering_wheel_torque"].peaks) < 5:
        over_time.y_range = (-5.0, 5.0)  # the source's axis
    rows = [[over_time]]
    if "steering_wheel_angle" in result.signals:
        rows[0].append(loop(result, "steering_wheel_angle", "steering_wheel_torque"))
    return Figure(
        "Steering wheel torque" + _as(result, on_centre="8.3"),
        rows,
        "Torque of the driver on the steering wheel. The curves lie on each other where the two "
        "systems feel the same.",
        height=340,
        widths=(1.25, 1.0),
    )


def torque_difference(result: Comparison) -> Figure | None:
    """Fig 8.4: torque difference in time, against speed and against frequency."""
    key = "steering_wheel_torque"
    if key not in result.signals:
        return None
    lower = [against_speed(result, key), growth_axes(result, key)]
    rows = [[error(result, key, title="Over time")], [axes for axes in lower if axes]]
    return Figure(
        "Steering wheel torque difference" + _as(result, on_centre="8.4"),
        [row for row in rows if row],
        growth_caption(result, key),
    )


def chamber_pressures(result: Comparison) -> Figure | None:
    """Fig 8.5: both chambers, and their differences."""
    keys = [k for k in ("left_pressure", "right_pressure") if k in result.signals]
    if not keys:
        return None
    rows = [[both(result, k, result.kinds[k].title) for k in keys]]
    rows.append([error(result, k, result.kinds[k].title + ", difference") for k in keys])
    return Figure("Chamber pressures" + _as(result, on_centre="8.5"), rows, height=270)


def motion(result: Comparison) -> Figure | None:
    """Steering wheel angle and rack position: did both systems drive the same manoeuvre?"""
    keys = [k for k in ("steering_wheel_angle", "rack_position") if k in result.signals]
    if not keys:
        return None
    rows = [[both(result, k, result.kinds[k].title) for k in keys]]
    rows.append([error(result, k, result.kinds[k].title + ", difference") for k in keys])
    return Figure("Motion", rows, "The manoeuvre itself, and how far the two part.", height=250)


def supply(result: Comparison) -> Figure | None:
    """Supply pressure, hydraulic power and energy."""
    axes = []
    if "supply_pressure" in result.signals:
        axes.append(both(result, "supply_pressure", "Supply pressure"))
    known = [(s, e) for s, e in zip((0, 1), result.supply_energy, strict=True) if e is not None]
    if known:
        power = [curve(result, s, *_power(result.time, e)) for s, e in known]
        axes.append(Axes(TIME, "Power [W]", power, "Hydraulic power of the supply", link="time"))
        used = [curve(result, s, result.time, (e - e[0]) * 1e-3) for s, e in known]
        axes.append(Axes(TIME, "Energy [kJ]", used, "Energy used", link="time"))
    if not axes:
        return None
    return Figure(
        "Supply and energy",
        [axes],
        f"Hydraulic power at the supply port, averaged over {POWER_WINDOW_S:g} s.",
    )


def further(result: Comparison) -> list[Figure]:
    """What measured data share beyond a run's own figures: each signal and its difference."""
    if result.of_runs:
        return []
    keys = [key for key in result.differences if key not in DRAWN]
    left = len(keys) - MOST_FURTHER
    made = [
        Figure(result.kinds[k].title, [[both(result, k), error(result, k, "Difference")]])
        for k in keys[:MOST_FURTHER]
    ]
    if left > 0:
        made[-1].caption = f"{left} further signals are in the table alone."
    return made


def _as(result: Comparison, on_centre: str = "", dry_park: str = "") -> str:
    """Which figure of the source this one redraws, if the runs are those of that figure."""
    if set(result.systems) != {"open-centre", "closed-centre"}:
        return ""
    number = {"on-centre": on_centre, "dry park": dry_park}.get(situation(result), "")
    return f" (as figure {number})" if number else ""


def _power(time: np.ndarray, energy: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean power over a sliding window; its time is the window's middle."""
    step = time[1] - time[0] if len(time) > 1 else 1.0
    window = max(1, min(len(time) - 1, round(POWER_WINDOW_S / step)))
    rise = energy[window:] - energy[:-window]
    span = time[window:] - time[:-window]
    return 0.5 * (time[window:] + time[:-window]), rise / span
