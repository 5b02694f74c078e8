"""The closed-centre system against the open-centre one: figures 8.1 to 8.6."""

from __future__ import annotations

from functools import cache

import numpy as np

from steering_bringup.pages import Axes, Curve, Figure
from steering_core.parameters import load_parameters
from steering_core.ticks import TICK_PERIOD
from steering_studies.linear import source_figures
from steering_studies.linear.steps import torque_step
from steering_studies.linear.systems import Comparison, assistance_pressure
from steering_studies.reproduce.row import Number, Row

BAR = 1e-5
OPENED, CLOSED, BETWEEN = "#b3261e", "#1f5fa8", "#1b2530"
STEP_AT = 0.1
"""Where the source's time axis has the step [s]."""


@cache
def on_centre() -> Comparison:
    """Return both systems on-centre; figures 8.2 to 8.5 share the run."""
    return source_figures.on_centre(load_parameters())


def step() -> Row:
    """Return fig 8.1."""
    made = torque_step(load_parameters())
    held = np.arange(-20, 0) * TICK_PERIOD
    time = np.concatenate([held, made.time]) + STEP_AT

    def curve(pressure: np.ndarray, name: str, colour: str, dash: str) -> Curve:
        whole = np.concatenate([np.full(len(held), pressure[0]), pressure])
        return Curve(time, whole * BAR, name, colour, dash=dash)

    axes = Axes(
        "time [s]",
        "pressure [bar]",
        [
            curve(made.opened, "open centre", OPENED, "dash"),
            curve(made.closed, "closed centre", CLOSED, "solid"),
        ],
        y_range=(4.0, 16.0),
    )
    rise = [made.rise(pressure) * 1e3 for pressure in (made.opened, made.closed)]
    return Row(
        "8.1",
        "Step of 2 N m with the controller",
        [
            Number("pressure before the step", "bar", 4.5, made.closed[0] * BAR, "pressure"),
            Number("pressure after the step", "bar", 15.0, made.closed[-1] * BAR, "pressure"),
            Number("90 % of the step, closed centre (source: as fast as the open one)", "ms",
                   rise[0], rise[1], "time", "at most"),
        ],
        [Figure("Pressure of the right chamber", [[axes]])],
        words="Pressures of the source are read off its axis; the time is our open centre's.",
    )  # fmt: skip


def assistance() -> Row:
    """Return fig 8.2."""
    made = on_centre()
    return Row(
        "8.2",
        "Assistance pressure on centre",
        [
            Number("largest difference", "bar", 1.0, made.load_pressure * BAR, "pressure",
                   "at most"),
            Number("largest assistance pressure (axis)", "bar", 40.0,
                   made.largest_load_pressure * BAR, "pressure", "at most"),
        ],
        [
            _pair(
                "Assistance pressure, and the difference of both systems",
                made,
                (assistance_pressure(made.opened) * BAR, assistance_pressure(made.closed) * BAR),
                ("pressure [bar]", "difference [bar]"),
                ((-40.0, 40.0), (-1.0, 1.0)),
            )
        ],
    )  # fmt: skip


def driver_torque() -> Row:
    """Return fig 8.3."""
    made = on_centre()
    shown = _curves(made, (made.opened.driver[:, 0], made.closed.driver[:, 0]))
    axes = Axes("time [s]", "steering wheel torque [N m]", shown, y_range=(-5.0, 5.0))
    return Row(
        "8.3",
        "Steering wheel torque on centre",
        [Number("largest torque (axis)", "N m", 5.0, made.largest_torque, "torque", "at most")],
        [Figure("Steering wheel torque", [[axes]], height=360)],
        words="The curves lie on each other.",
    )


def torque_difference() -> Row:
    """Return fig 8.4, over time and over the steering wheel's speed."""
    made = on_centre()
    difference = made.closed.driver[:, 0] - made.opened.driver[:, 0]
    speed = np.degrees(made.closed.torque[:, 1])
    time = _time(made)
    slow = float(np.abs(difference[time < 3.0]).max())
    return Row(
        "8.4",
        "Difference of steering wheel torque",
        [
            Number("largest difference", "N m", 0.1, made.driver_torque, "torque", "at most"),
            Number("largest difference in the first 3 s", "N m", None, slow, "torque"),
            Number("largest steering wheel speed (axis)", "deg/s", 400.0,
                   float(np.abs(speed).max()), "other", "at most"),
        ],
        [
            Figure(
                "Torque difference, closed centre less open centre",
                [
                    [Axes("time [s]", "difference [N m]", [Curve(time, difference, colour=BETWEEN)],
                          y_range=(-0.13, 0.13), limits=(-0.1, 0.1))],
                    [Axes("steering wheel speed [deg/s]", "difference [N m]",
                          [Curve(speed, difference, colour=BETWEEN, width=0.8, over_time=False)],
                          y_range=(-0.13, 0.13), limits=(-0.1, 0.1))],
                ],
            )
        ],
        words="It grows with frequency only, as the source says.",
    )  # fmt: skip


def chamber_pressures() -> Row:
    """Return fig 8.5."""
    made = on_centre()
    figures = [
        _pair(
            f"Pressure of the {name} chamber",
            made,
            (made.opened.pressure[:, k] * BAR, made.closed.pressure[:, k] * BAR),
            ("pressure [bar]", "difference [bar]"),
            ((0.0, 40.0), (-1.0, 1.0)),
        )
        for k, name in enumerate(("left", "right"))
    ]
    worst = [float(np.abs(made.closed.pressure[:, k] - made.opened.pressure[:, k]).max()) * BAR
             for k in (0, 1)]  # fmt: skip
    return Row(
        "8.5",
        "Chamber pressures on centre",
        [
            Number("largest difference, left chamber", "bar", 1.0, worst[0], "pressure", "at most"),
            Number("largest difference, right chamber", "bar", 1.0, worst[1], "pressure",
                   "at most"),
            Number("largest pressure (axis)", "bar", 40.0,
                   float(made.closed.pressure[:, :2].max()) * BAR, "pressure", "at most"),
        ],
        figures,
    )  # fmt: skip


def dry_park() -> Row:
    """Return fig 8.6, with the scheduled gain and with the source's constant, lower one."""
    scheduled = source_figures.dry_park(load_parameters())
    lower = source_figures.dry_park_lower_gain(load_parameters())
    time = _time(scheduled)
    curves = _curves(
        scheduled, (assistance_pressure(scheduled.opened) * BAR,
                    assistance_pressure(lower.closed) * BAR)
    )  # fmt: skip
    curves[1] = Curve(time, curves[1].y, "closed centre, lower gain", CLOSED)
    differences = [
        Curve(time, (assistance_pressure(run.closed) - assistance_pressure(run.opened)) * BAR, name,
              colour)
        for run, name, colour in (
            (lower, "closed centre, lower gain", CLOSED),
            (scheduled, "closed centre, scheduled gain", BETWEEN),
        )
    ]  # fmt: skip
    return Row(
        "8.6",
        "Dry park",
        [
            Number("largest load pressure", "bar", 80.0, lower.largest_load_pressure * BAR,
                   "pressure"),
            Number("largest difference, constant gain of 175 rad/s", "bar", None,
                   lower.load_pressure * BAR, "pressure"),
            Number("largest difference, gain falling with pressure", "bar", None,
                   scheduled.load_pressure * BAR, "pressure"),
        ],
        [
            Figure(
                "Load pressure against the dry-park spring, and the difference to the open centre",
                [
                    [Axes("time [s]", "pressure [bar]", curves, y_range=(-90.0, 90.0), link="t",
                          limits=(-80.0, 80.0))],
                    [Axes("time [s]", "difference [bar]", differences, link="t")],
                ],
            )
        ],
        words="As the source says, they part where the pressure passes zero and at its peaks. A "
        "gain that falls with the pressure keeps them closer than a low constant one.",
    )  # fmt: skip


def _time(made: Comparison) -> np.ndarray:
    return np.arange(len(made.closed.driver)) * TICK_PERIOD


def _curves(made: Comparison, values: tuple[np.ndarray, np.ndarray]) -> list[Curve]:
    time = _time(made)
    return [
        Curve(time, values[0], "open centre", OPENED, dash="dash", width=2.4),
        Curve(time, values[1], "closed centre", CLOSED),
    ]


def _pair(
    title: str,
    made: Comparison,
    values: tuple[np.ndarray, np.ndarray],
    titles: tuple[str, str],
    ranges: tuple[tuple[float, float], tuple[float, float]],
) -> Figure:
    """Return both systems above, their difference below."""
    between = [Curve(_time(made), values[1] - values[0], colour=BETWEEN)]
    upper = Axes("time [s]", titles[0], _curves(made, values), y_range=ranges[0], link="t")
    lower = Axes("time [s]", titles[1], between, y_range=ranges[1], link="t")
    return Figure(title, [[upper], [lower]], height=240)


ROWS = (
    step,
    assistance,
    driver_torque,
    torque_difference,
    chamber_pressures,
    dry_park,
)
