"""The page of a run with torque overlays: asked, applied, and why the two differ."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from steering_bringup.bags.trace import Trace
from steering_bringup.lane_keeping.lane import lane_offsets, lane_table
from steering_bringup.pages import Axes, Card, Curve, Figure, Page, cards, table
from steering_bringup.schema import NodeSet, Scenario
from steering_core.parameters import ParameterSet
from steering_core.ticks import TICK_PERIOD

APPLIED_TOPIC, ODOMETRY, IMU = "/torque_overlay/applied", "/vehicle/odometry", "/vehicle/imu"
REASONS = {
    "limited_torque": "largest torque",
    "limited_pressure": "largest pressure",
    "limited_acceleration": "lateral acceleration",
    "limited_rate": "rate of the torque",
    "limited_jerk": "lateral jerk",
    "changing_over": "one source fades over to another, or in or out",
    "overridden": "the driver overrides",
    "stale": "a source fell silent",
    "refused": "a message was refused",
}
"""Fields of the applied overlay that say why it differs from what was asked."""
BLUE, ORANGE, GREEN, GREY, RED = "#1f6fb2", "#d9722a", "#2f8f5b", "#8a949f", "#b3363b"
PALE = "#bcd3e8"
COLOURS = (BLUE, ORANGE, GREEN, RED, "#7a5ea8", GREY, "#c2185b", "#6d4c41", "#00838f")
TIME = "Time [s]"
SEEN = 1.0 / 500.0
"""Share of a figure's width that the eye can tell."""
HALF_A_SECOND = 500
ISO_ACCELERATION, ISO_JERK = 3.0, 5.0
"""m/s2 and m/s3 of ISO 11270 for a lane keeping system, the jerk averaged over half a second."""


def write_overlay_page(trace: Trace, scenario: Scenario, node_set: NodeSet, path: Path) -> Path:
    """Write the page of a recorded run; BenchError naming the path if that fails."""
    return overlay_page(trace, scenario, node_set).write(path)


def overlay_page(trace: Trace, scenario: Scenario, node_set: NodeSet) -> Page:
    """Return the page of a run of ``scenario`` whose ``trace`` has an applied overlay."""
    parameters = scenario.parameter_values()
    rows = trace[APPLIED_TOPIC]
    time = rows["tick"] * TICK_PERIOD
    has_lane = any(entry.kind == "lane_keeper" for entry in node_set.nodes.values())
    offset = _offset(trace, parameters) if has_lane and ODOMETRY in trace else None
    page = Page(
        title=f"{scenario.name.replace('_', ' ').capitalize()}: torque overlay",
        subtitle=f"{node_set.name}, {len(rows)} ticks, bag {trace.name}",
        lead=scenario.description[:1].upper() + scenario.description[1:],
        footer=f"Recorded {trace.run.get('started', '')}. This page needs no network.",
    )
    page.add(cards(_cards(rows, offset)))
    page.add(table(("Why applied and asked differ", "from [s]", "for [s]"), _reasons(time, rows)))
    page.heading("Figures", "Dotted lines are limits. Drag to zoom, double-click to go back.")
    if offset is not None:
        page.add(_lane_figure(trace, offset))
    page.add(_torque_figure(time, rows, parameters))
    page.add(_driver_figure(time, rows, trace, parameters))
    page.add(_motion_figure(time, rows, trace, parameters))
    return page


def _cards(rows: np.ndarray, offset: np.ndarray | None) -> list[Card]:
    largest = float(np.max(np.abs(rows["applied"])))
    asked = float(np.max(np.abs(rows["asked"])))
    served = float(np.mean(rows["source"] > 0))
    found = [
        Card("Largest torque applied", f"{largest:.2f}", "N m", f"asked {asked:.2f} N m"),
        Card("A source was served", f"{served:.0%}", "", "of the time"),
        Card(
            "Authority left by the driver",
            f"{float(rows['authority'].min()):.0%}",
            "",
            f"at least; overridden {int(rows['override_count'][-1])} times",
        ),
        Card(
            "Refused",
            str(int(rows["refused_count"][-1])),
            "messages",
            f"{int(rows['stale_count'][-1])} times silent",
            good=not rows["refused_count"][-1],
        ),
    ]
    if offset is not None:
        aside = float(np.max(np.abs(offset)))
        text, unit = (f"{aside:.2f}", "m") if aside >= 1.0 else (f"{aside * 1e3:.0f}", "mm")
        found.insert(0, Card("Farthest from the lane's centre", text, unit))
    return found


def _reasons(time: np.ndarray, rows: np.ndarray) -> list[Sequence[str]]:
    found: list[Sequence[str]] = []
    for field, reason in REASONS.items():
        when = np.flatnonzero(rows[field])
        if len(when):
            found.append((reason, f"{time[when[0]]:.3f}", f"{len(when) * TICK_PERIOD:.3f}"))
    return found or [("they do not differ", "", "")]


def _offset(trace: Trace, parameters: ParameterSet) -> np.ndarray:
    rows = trace[ODOMETRY]
    x, y = rows["pose.pose.position.x"], rows["pose.pose.position.y"]
    return lane_offsets(lane_table(parameters), x, y)


def _lane_figure(trace: Trace, offset: np.ndarray) -> Figure:
    seconds = trace[ODOMETRY]["stamp"] * 1e-9
    axes = Axes(TIME, "Distance to the left [m]", [Curve(seconds, offset, colour=BLUE)])
    return Figure("Distance from the lane's centre", [[axes]])


def _torque_figure(time: np.ndarray, rows: np.ndarray, parameters: ParameterSet) -> Figure:
    most = parameters["overlay.maximum_torque"]
    torque = Axes(
        TIME,
        "Torque [N m]",
        [
            Curve(time, rows["asked"], "asked", ORANGE, width=1.2),
            Curve(time, rows["applied"], "applied", BLUE),
        ],
        limits=(-most, most),
        link="time",
    )
    reasons = [field for field in REASONS if rows[field].any()]
    curves = [
        _bars(time, rows[field], k + 1.0, REASONS[field], COLOURS[k])
        for k, field in enumerate(reasons)
    ]
    lines = [[torque]]
    if curves:
        reach = (0.0, len(curves) + 1.0)
        lines.append([Axes(TIME, "Reason", curves, link="time", y_range=reach)])
    caption = "Above: what the source that is served asks, and what the arbiter lets through. "
    return Figure("Asked and applied", lines, caption + "Below: why the two differ.")


def _bars(time: np.ndarray, on: np.ndarray, y: float, name: str, colour: str) -> Curve:
    """Return a bar at height ``y`` for each time in which ``on`` is true.

    Times closer than what the eye can tell are one, and none is shorter than that.
    """
    seen = (time[-1] - time[0]) * SEEN
    edges = np.diff(np.concatenate([[0], on.astype(np.int8), [0]]))
    starts, ends = time[np.flatnonzero(edges > 0)], time[np.flatnonzero(edges < 0) - 1] + seen
    apart = starts[1:] > ends[:-1]
    starts, ends = starts[np.r_[True, apart]], ends[np.r_[apart, True]]
    gaps = np.full(len(starts), np.nan)
    x = np.column_stack([starts, ends, gaps]).ravel()
    return Curve(x, np.full(len(x), y), name, colour, width=7.0, over_time=False)


def _driver_figure(
    time: np.ndarray, rows: np.ndarray, trace: Trace, parameters: ParameterSet
) -> Figure:
    start, full = parameters["overlay.override_start"], parameters["overlay.override_full"]
    measured = trace["/steering/torque"]
    torque = Axes(
        TIME,
        "Torque [N m]",
        [
            Curve(
                measured["tick"] * TICK_PERIOD,
                measured["torsion_bar_torque"],
                "torsion bar",
                GREY,
                width=1.2,
            ),
            Curve(time, rows["driver_torque"], "hands, estimated", BLUE),
        ],
        limits=(-full, -start, start, full),
        link="time",
    )
    left = Axes(
        TIME, "Authority", [Curve(time, rows["authority"])], link="time", y_range=(-0.05, 1.05)
    )
    caption = (
        f"Hands against the overlay take authority from {start:g} N m on, all of it at {full:g} "
        "N m. What the overlay itself does to the torsion bar does not count."
    )
    return Figure("The driver", [[torque], [left]], caption, height=240)


def _motion_figure(
    time: np.ndarray, rows: np.ndarray, trace: Trace, parameters: ParameterSet
) -> Figure:
    own = rows["lateral_acceleration"]
    most = parameters["overlay.maximum_lateral_acceleration"]
    acceleration = [Curve(time, own, "of the overlay alone, steady", BLUE)]
    each, mean = np.diff(own) / TICK_PERIOD, _averaged_jerk(time, own)
    jerk = [
        Curve(time[1:], each, "of the overlay alone, each tick", PALE, width=1.0),
        Curve(time[-len(mean) :], mean, "of the overlay alone, over half a second", BLUE),
    ]
    if IMU in trace:
        imu = trace[IMU]
        seconds, car = imu["stamp"] * 1e-9, imu["linear_acceleration.y"]
        acceleration.append(Curve(seconds, car, "of the car", GREY))
        mean = _averaged_jerk(seconds, car)
        jerk.append(Curve(seconds[-len(mean) :], mean, "of the car, over half a second", ORANGE))
    rows_of_axes = [
        [Axes(TIME, "Acceleration [m/s²]", acceleration, limits=_both(most, ISO_ACCELERATION))],
        [
            Axes(
                TIME,
                "Jerk [m/s³]",
                jerk,
                limits=_both(parameters["overlay.maximum_lateral_jerk"], ISO_JERK),
            )
        ],
    ]
    for line in rows_of_axes:
        line[0].link = "time"
    caption = (
        f"The arbiter keeps the overlay's own part below the inner lines; ISO 11270 allows the car "
        f"{ISO_ACCELERATION:g} m/s² and {ISO_JERK:g} m/s³ (outer lines)."
    )
    return Figure("Lateral acceleration and jerk", rows_of_axes, caption, height=260)


def _averaged_jerk(seconds: np.ndarray, acceleration: np.ndarray) -> np.ndarray:
    """Return the jerk [m/s3] averaged over the half second before each sample."""
    if len(seconds) < 2:
        return np.zeros(len(seconds))
    ticks = float(np.median(np.diff(seconds))) / TICK_PERIOD
    count = min(max(1, round(HALF_A_SECOND / ticks)), len(seconds) - 1)
    rise = acceleration[count:] - acceleration[:-count]
    return rise / (seconds[count:] - seconds[:-count])


def _both(*limits: float) -> tuple[float, ...]:
    return tuple(sign * limit for limit in limits for sign in (-1.0, 1.0))
