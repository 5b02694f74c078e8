"""The comparison's figures, in the order and the axes of the source's figures 8.2 to 8.6."""

from __future__ import annotations

import numpy as np

from steering_bringup.comparison.result import Comparison
from steering_bringup.comparison.signals import BY_KEY
from steering_bringup.comparison.verdict import limit, situation
from steering_bringup.pages import Axes, Curve, Figure

OPEN, CLOSED, DIFFERENCE = "#1b2530", "#2f7fd6", "#c2530c"
OPEN_WIDTH, CLOSED_WIDTH = 1.5, 2.8
TIME = "Time [s]"
SPEED = "Steering wheel speed [deg/s]"
POWER_WINDOW_S = 0.25


def figures(result: Comparison) -> list[Figure]:
    """All figures that the two runs have the signals for."""
    made = [
        assistance_pressure(result),
        steering_wheel_torque(result),
        torque_difference(result),
        chamber_pressures(result),
        motion(result),
        supply(result),
    ]
    return [figure for figure in made if figure is not None]


def assistance_pressure(result: Comparison) -> Figure | None:
    """Fig 8.2: assistance pressure and its difference."""
    if "assistance_pressure" not in result.signals:
        return None
    both = _both(result, "assistance_pressure", title="Both systems")
    error = _error(result, "assistance_pressure", title="Difference")
    against = _against_speed(result, "assistance_pressure")
    return Figure(
        "Assistance pressure" + _as(result, on_centre="8.2", dry_park="8.6"),
        [[both], [error, against] if against else [error]],
        "Pressure that pushes the rack: right minus left chamber.",
        widths=(1.25, 1.0),
    )


def steering_wheel_torque(result: Comparison) -> Figure | None:
    """Fig 8.3: what the driver feels, over time and against the angle."""
    if "steering_wheel_torque" not in result.signals:
        return None
    over_time = _both(result, "steering_wheel_torque", title="Over time")
    if _as(result, on_centre="8.3") and max(result.differences["steering_wheel_torque"].peaks) < 5:
        over_time.y_range = (-5.0, 5.0)  # the source's axis
    rows = [[over_time]]
    if "steering_wheel_angle" in result.signals:
        rows[0].append(_loop(result, "steering_wheel_angle", "steering_wheel_torque"))
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
    lower = [_against_speed(result, key), _growth_axes(result, key)]
    rows = [[_error(result, key, title="Over time")], [axes for axes in lower if axes]]
    return Figure(
        "Steering wheel torque difference" + _as(result, on_centre="8.4"),
        [row for row in rows if row],
        _growth_caption(result, key),
    )


def chamber_pressures(result: Comparison) -> Figure | None:
    """Fig 8.5: both chambers, and their differences."""
    keys = [k for k in ("left_pressure", "right_pressure") if k in result.signals]
    if not keys:
        return None
    rows = [[_both(result, k, BY_KEY[k].title) for k in keys]]
    rows.append([_error(result, k, BY_KEY[k].title + ", difference") for k in keys])
    return Figure("Chamber pressures" + _as(result, on_centre="8.5"), rows, height=270)


def motion(result: Comparison) -> Figure | None:
    """Steering wheel angle and rack position: did both systems drive the same manoeuvre?"""
    keys = [k for k in ("steering_wheel_angle", "rack_position") if k in result.signals]
    if not keys:
        return None
    rows = [[_both(result, k, BY_KEY[k].title) for k in keys]]
    rows.append([_error(result, k, BY_KEY[k].title + ", difference") for k in keys])
    return Figure("Motion", rows, "The manoeuvre itself, and how far the two part.", height=250)


def supply(result: Comparison) -> Figure | None:
    """Supply pressure, hydraulic power and energy."""
    axes = []
    if "supply_pressure" in result.signals:
        axes.append(_both(result, "supply_pressure", "Supply pressure"))
    known = [(s, e) for s, e in zip((0, 1), result.supply_energy, strict=True) if e is not None]
    if known:
        power = [_curve(result, s, *_power(result.time, e)) for s, e in known]
        axes.append(Axes(TIME, "Power [W]", power, "Hydraulic power of the supply", link="time"))
        used = [_curve(result, s, result.time, (e - e[0]) * 1e-3) for s, e in known]
        axes.append(Axes(TIME, "Energy [kJ]", used, "Energy used", link="time"))
    if not axes:
        return None
    return Figure(
        "Supply and energy",
        [axes],
        f"Hydraulic power at the supply port, averaged over {POWER_WINDOW_S:g} s.",
    )


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


def _curve(
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
    return 1 if result.systems == ("closed-centre", "open-centre") else 0


def _sides(result: Comparison) -> tuple[int, int]:
    """The solid curve first, so that the dashed one lies on top."""
    dashed = _dashed(result)
    return 1 - dashed, dashed


def _both(result: Comparison, key: str, title: str = "") -> Axes:
    signal = BY_KEY[key]
    curves = [
        _curve(result, side, result.time, result.signals[key][side] * signal.scale)
        for side in _sides(result)
    ]
    label = f"{_quantity(key)} [{signal.shown_unit}]"
    return Axes(TIME, label, curves, title, link="time")


def _quantity(key: str) -> str:
    if "pressure" in key:
        return "Pressure"
    return {"steering_wheel_angle": "Angle", "rack_position": "Position"}.get(key, "Torque")


def _difference_label(result: Comparison, key: str) -> str:
    return f"Difference [{BY_KEY[key].shown_unit}]"


def _error(result: Comparison, key: str, title: str = "") -> Axes:
    signal = BY_KEY[key]
    curve = Curve(result.time, result.error(key) * signal.scale, colour=DIFFERENCE, width=1.2)
    return Axes(
        TIME,
        _difference_label(result, key),
        [curve],
        title,
        limits=_limits(result, key),
        link="time",
    )


def _limits(result: Comparison, key: str) -> tuple[float, ...]:
    """Limit lines, unless the difference is so small that they would flatten it."""
    bound = limit(result, key)
    if bound is None or result.differences[key].largest < 0.2 * bound:
        return ()
    return (-bound * BY_KEY[key].scale, bound * BY_KEY[key].scale)


def _loop(result: Comparison, x_key: str, y_key: str) -> Axes:
    x, y = BY_KEY[x_key], BY_KEY[y_key]
    curves = [
        _curve(
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


def _against_speed(result: Comparison, key: str) -> Axes | None:
    """Difference against steering wheel speed, coloured by the frequency of steering."""
    if "steering_wheel_speed" not in result.signals:
        return None
    speed = result.signals["steering_wheel_speed"][0] * BY_KEY["steering_wheel_speed"].scale
    error = result.error(key) * BY_KEY[key].scale
    growth = result.growths.get(key)
    shade, title = result.time, "time [s]"
    if growth is not None:
        shade = np.interp(result.time, growth.time, growth.frequency)
        title = "frequency [Hz]"
    curve = Curve(speed, error, mode="markers", over_time=False, shade=shade, shade_title=title)
    return Axes(
        SPEED,
        _difference_label(result, key),
        [curve],
        "Against steering wheel speed",
        limits=_limits(result, key),
    )


def _growth_axes(result: Comparison, key: str) -> Axes | None:
    growth = result.growths.get(key)
    if growth is None:
        return None
    peak = growth.peak * BY_KEY[key].scale
    slope, rest = np.polyfit(growth.frequency, peak, 1)
    ends = np.array([0.0, growth.frequency.max()])
    return Axes(
        "Frequency of the half-cycle [Hz]",
        f"Largest difference [{BY_KEY[key].shown_unit}]",
        [
            Curve(ends, rest + slope * ends, colour="#9aa5b1", dash="dot", width=1.4),
            Curve(growth.frequency, peak, colour=DIFFERENCE, mode="lines+markers", over_time=False),
        ],
        "Against the frequency of steering",
        y_range=(min(0.0, float(rest)), float(peak.max()) * 1.1) if peak.max() > 0 else None,
    )


def _growth_caption(result: Comparison, key: str) -> str:
    growth = result.growths.get(key)
    if growth is None:
        return "Its growth with frequency cannot be judged: too few half-cycles of steering."
    share = max(0.0, growth.static_share)
    return (
        "Lower right: the largest difference of each half-cycle of steering. A straight line "
        f"through these points leaves {share:.0%} of it at zero frequency."
    )
