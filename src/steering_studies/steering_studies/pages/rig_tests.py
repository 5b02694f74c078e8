"""Rig tests and what they tell of the gear, figures 3.4 to 3.11 of the source."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from steering_bringup.pages import Axes, Curve, Figure, Page, paragraph, table
from steering_core.parameters import ParameterSet
from steering_studies.channels import Channels
from steering_studies.identification.column import released_at
from steering_studies.identification.identify import Identified
from steering_studies.identification.opening_areas import BoostCurve

COLOURS = ("#1f5fa8", "#1b7f4b", "#b3261e", "#8a5a00", "#6a3fa0", "#1b2530")
BAR, DEGREE, MILLIMETRE = 1e-5, 180.0 / np.pi, 1e3


def rig_test_page(
    runs: Mapping[str, Channels], identified: Identified, nominal: ParameterSet
) -> Page:
    """Return the page of an identification: estimates beside the nominal ones, every figure."""
    count = len(identified.estimates)
    page = Page(
        title="Rig tests and identification",
        lead=f"{count} parameters identified from {len(runs)} runs.",
        good=not identified.missing,
        footer="This page needs no network.",
    )
    for name in identified.missing:
        page.add(paragraph(f"No test '{name}' was recorded: its parameters stay nominal.", "note"))
    page.add(table(HEAD, _rows(identified, nominal), left_columns=2))
    page.heading("Figures", "In the source's axes; its own curves are not printed as numbers.")
    for figure in figures(runs, identified):
        page.add(figure)
    return page


HEAD = ("Parameter", "Unit", "Nominal", "Identified", "95 % interval", "Difference")


def _percent(ratio: float) -> str:
    """Return how far a ratio is from 1, signed; without a sign where it rounds to nothing."""
    shown = f"{100.0 * (ratio - 1.0):+.1f}"
    return "0.0" if shown in ("+0.0", "-0.0") else shown


def _rows(identified: Identified, nominal: ParameterSet) -> list[tuple[str, ...]]:
    return [
        (
            name,
            estimate.unit,
            f"{nominal[name]:.4g}",
            f"{estimate.value:.4g}",
            f"{estimate.low:.4g} to {estimate.high:.4g}",
            f"{_percent(estimate.value / nominal[name])} %",
        )
        for name, estimate in identified.estimates.items()
    ]


def figures(runs: Mapping[str, Channels], identified: Identified) -> list[Figure]:
    """Return the figures of the tests that are there."""
    made: list[Figure] = []
    if identified.boost_curve is not None:
        made += boost_figures(identified.boost_curve)
    loops = {name: c for name, c in runs.items() if name.startswith("rack_friction")}
    if loops:
        made.append(friction_figure(loops))
    if "column_friction" in runs:
        made.append(column_friction_figure(runs["column_friction"]))
    if "stiffness" in runs:
        made.append(stiffness_figure(runs["stiffness"]))
    if "inertia" in runs:
        made.append(inertia_figure(runs["inertia"]))
    if "system" in runs:
        made.append(system_figure(runs["system"]))
    return made


def boost_figures(curve: BoostCurve) -> list[Figure]:
    """Return figs 3.4 and 3.5: boost curve and opening areas."""
    pressure = Curve(curve.torque, np.abs(curve.load_pressure) * BAR, "measured", COLOURS[0],
                     mode="lines+markers")  # fmt: skip
    areas = [
        Curve(curve.torque, curve.area_1 * 1e6, "A1", COLOURS[0], mode="lines+markers"),
        Curve(curve.torque, curve.area_2 * 1e6, "A2", COLOURS[2], mode="lines+markers"),
    ]
    return [
        Figure(
            "Boost curve and opening areas (figs 3.4, 3.5)",
            [
                [
                    Axes("torsion bar torque [N m]", "assistance pressure [bar]", [pressure]),
                    Axes("torsion bar torque [N m]", "area opening [mm2]", areas),
                ]
            ],
        )
    ]


def friction_figure(loops: Mapping[str, Channels]) -> Figure:
    """Return fig 3.6: rack force against rack position at each pressure."""
    ordered = sorted(loops.items(), key=lambda item: _pressure(item[1]))
    curves = [
        Curve(
            channels["rack_position"][3000::20] * MILLIMETRE,
            -channels["rack_force"][3000::20],
            f"{_pressure(channels):.0f} bar",
            COLOURS[k % len(COLOURS)],
            over_time=False,
            width=1.2,
        )
        for k, (_, channels) in enumerate(ordered)
    ]
    axes = Axes("rack position [mm]", "rack force [N]", curves, y_range=(-800.0, 800.0))
    return Figure("Rack friction (fig 3.6)", [[axes]], height=380)


def _pressure(channels: Channels) -> float:
    return float(np.mean(channels["left_pressure"]) * BAR)


def column_friction_figure(channels: Channels) -> Figure:
    """Return fig 3.7: torsion bar torque against the angle of the free wheel."""
    curve = Curve(
        channels["steering_wheel_angle"][3000::10] * DEGREE,
        -channels["torsion_bar_torque"][3000::10],
        colour=COLOURS[0],
        over_time=False,
    )
    axes = Axes("steering wheel angle [deg]", "torsion bar torque [N m]", [curve])
    return Figure("Column friction (fig 3.7)", [[axes]])


def stiffness_figure(channels: Channels) -> Figure:
    """Return fig 3.8: torque against angle with the rack clamped."""
    curve = Curve(
        channels["steering_wheel_angle"][::10] * DEGREE,
        channels["torsion_bar_torque"][::10],
        colour=COLOURS[0],
        over_time=False,
    )
    axes = Axes("steering wheel angle [deg]", "steering wheel torque [N m]", [curve])
    return Figure("Column and torsion bar stiffness (fig 3.8)", [[axes]])


def inertia_figure(channels: Channels) -> Figure:
    """Return fig 3.9: free oscillation after the release."""
    begin = released_at(channels)
    torque = channels["torsion_bar_torque"][begin:]
    curve = Curve(np.arange(len(torque)) * 1e-3, torque, colour=COLOURS[0])
    return Figure(
        "Free oscillation of the steering wheel (fig 3.9)",
        [[Axes("time [s]", "steering wheel torque [N m]", [curve])]],
    )


def system_figure(channels: Channels) -> Figure:
    """Return figs 3.10 and 3.11: angle and torque of the system test."""
    time = np.arange(len(channels["steering_wheel_angle"])) * 1e-3
    angle = Curve(time, channels["steering_wheel_angle"] * DEGREE, colour=COLOURS[0])
    torque = Curve(time, channels["torsion_bar_torque"], colour=COLOURS[0])
    return Figure(
        "System test (figs 3.10, 3.11)",
        [
            [Axes("time [s]", "steering wheel angle [deg]", [angle], link="time")],
            [Axes("time [s]", "torsion bar torque [N m]", [torque], link="time")],
        ],
        height=220,
    )
