"""Valve design: Pareto fronts, static characteristics and steps, figures 6.4, 6.5, 6.7."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pressure_control.valve_design.front import Front, distance_to
from pressure_control.valve_design.problem import VARIABLES, Evaluation
from steering_bringup.pages import Axes, Card, Curve, Figure, Page, cards, paragraph, table
from steering_studies.valve_design import Behaviour, Characteristic, Step

COLOURS = ("#1f5fa8", "#1b7f4b", "#b3261e", "#8a5a00", "#6a3fa0", "#1b2530")


def valve_design_page(
    fronts: Sequence[Front],
    chosen: np.ndarray,
    found: Evaluation,
    sheet: Evaluation,
    behaviour: Behaviour,
) -> Page:
    """Return the page: the chosen design on the fronts, the data sheet's, and its behaviour."""
    factor = max(distance_to(front, sheet.step_time, sheet.force) for front in fronts)
    page = Page(
        title="Valve design by optimisation",
        lead=f"The chosen valve rises to 90 % of 100 bar in {found.step_time * 1e3:.1f} ms with "
        f"{found.force:.0f} N. The data sheet's, {sheet.step_time * 1e3:.1f} ms and "
        f"{sheet.force:.0f} N, could be better in both by a factor of {factor:.2f}.",
        good=found.feasible,
        footer="This page needs no network.",
    )
    page.add(
        cards(
            [
                Card("Step time", f"{found.step_time * 1e3:.2f}", "ms", "source: below 5 ms"),
                Card("Solenoid force", f"{found.force:.1f}", "N", "largest of four extreme points"),
                Card("Overshoot", f"{found.overshoot * 1e-5:.1f}", "bar", "source: below 5 bar"),
            ]
        )
    )
    page.add(front_figure(fronts, found, sheet))
    page.add(_fronts_table(fronts))
    page.add(_design_table(chosen))
    page.heading("The chosen design")
    margins = behaviour.stability
    page.add(
        paragraph(
            f"Highest loop gain {margins.gain:.0f}, at {margins.pressure * 1e-5:.0f} bar and "
            f"{margins.flow * 6e4:.2f} l/min: phase margin {margins.phase_margin:.0f} deg (5.30)."
        )
    )
    page.add(characteristic_figure(behaviour.characteristics))
    page.add(step_figure(behaviour.steps))
    return page


def front_figure(fronts: Sequence[Front], found: Evaluation, sheet: Evaluation) -> Figure:
    """Return fig 6.4: solenoid force against step time."""
    curves = [
        Curve(
            front.step_times * 1e3,
            front.forces,
            front.method,
            COLOURS[k],
            mode="lines+markers",
            over_time=False,
        )
        for k, front in enumerate(fronts)
    ]
    for name, one, colour in (("chosen", found, COLOURS[2]), ("data sheet", sheet, COLOURS[5])):
        at = (np.array([one.step_time * 1e3]), np.array([one.force]))
        curves.append(Curve(*at, name, colour, mode="markers", over_time=False))
    axes = Axes("step time to 90 % [ms]", "solenoid force [N]", curves, y_range=(10.0, 70.0))
    highest = max(float(front.forces.max()) for front in fronts)
    caption = "The source's axis, 10 to 70 N."
    if highest > 70.0:
        caption += f" The quick end of the front goes on to {highest:.0f} N."
    return Figure("Pareto front (fig 6.4)", [[axes]], caption, height=380)


def characteristic_figure(characteristics: Sequence[Characteristic]) -> Figure:
    """Return fig 6.5: pressure against load flow in both directions."""
    curves = [
        Curve(
            c.flow * 6e4,
            c.pressure * 1e-5,
            f"{c.reference * 1e-5:.0f} bar",
            COLOURS[k % len(COLOURS)],
            over_time=False,
        )
        for k, c in enumerate(characteristics)
    ]
    axes = Axes("load flow [l/min]", "pressure [bar]", curves)
    return Figure("Static characteristic, reducing and relieving (fig 6.5)", [[axes]], height=360)


def step_figure(steps: Sequence[Step]) -> Figure:
    """Return fig 6.7: step responses."""
    curves = [
        Curve(
            s.time * 1e3,
            s.pressure * 1e-5,
            f"{s.start * 1e-5:.0f} to {s.reference * 1e-5:.0f} bar",
            COLOURS[k % len(COLOURS)],
        )
        for k, s in enumerate(steps)
    ]
    return Figure("Steps (fig 6.7)", [[Axes("time [ms]", "pressure [bar]", curves)]])


def _fronts_table(fronts: Sequence[Front]) -> str:
    rows = [
        (
            front.method,
            str(len(front.forces)),
            str(front.evaluations),
            f"{front.step_times.min() * 1e3:.1f} to {front.step_times.max() * 1e3:.1f}",
            f"{front.forces.min():.1f} to {front.forces.max():.1f}",
        )
        for front in fronts
        if len(front.forces)
    ]
    return table(("Method", "Designs", "Evaluations", "Step time [ms]", "Force [N]"), rows)


def _design_table(chosen: np.ndarray) -> str:
    rows = [
        (name.replace("_", " "), unit, f"{value:.4g}", f"{low:g} to {high:g}")
        for (name, (unit, low, high)), value in zip(VARIABLES.items(), chosen, strict=True)
    ]
    return table(("Variable", "Unit", "Chosen", "Bounds"), rows, left_columns=2)
