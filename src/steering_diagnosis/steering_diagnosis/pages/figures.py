"""The pictures: the one that proves the verdict, every signal, every balance."""

from __future__ import annotations

import numpy as np

from steering_bringup.pages import Axes, Curve, Figure
from steering_diagnosis.pages.shown import scale, unit, words
from steering_diagnosis.report import BalanceError, Diagnosis, Overlay

MEASURED, NOMINAL, EXTENDED, HELD = "#1b2530", "#b3261e", "#1b7f4b", "#1f5fa8"

AXIS_TITLES = {
    "time": "time [s]",
    "speed": "rack speed [mm/s]",
    "pressure": "load pressure [bar]",
    "position": "rack position [mm]",
    "frequency": "frequency [Hz]",
}
AXIS_SCALES = {"speed": 1e3, "pressure": 1e-5, "position": 1e3}


def proof(diagnosis: Diagnosis, signal: str) -> Figure:
    """Return the signal that the verdict shows best: curves above, errors below."""
    overlay = diagnosis.overlays[signal]
    extended = bool(diagnosis.report.causes)
    return Figure(
        f"{_start(words(signal))}: measurement and model",
        [
            [_curves(diagnosis, overlay, words(signal), extended)],
            [_errors(diagnosis, overlay, extended)],
        ],
        caption="Red: nominal model, refitted inside its tolerances. "
        + ("Green: with the named cause. " if extended else "")
        + "The model is driven by the measured inputs.",
        height=270,
    )


def signal_figure(diagnosis: Diagnosis, signal: str) -> Figure:
    """Return one signal's curves and errors, smaller, for the list of all."""
    figure = proof(diagnosis, signal)
    figure.caption, figure.height = "", 210
    return figure


def balance_figure(error: BalanceError, time: np.ndarray, extended: bool) -> Figure:
    """Return a balance's residual over time, and its size against each axis."""
    factor, shown = scale(error.unit), unit(error.unit)
    over_time = [Curve(time, error.residual * factor, "nominal", NOMINAL)]
    if extended:
        over_time.append(Curve(time, error.extended * factor, "extended", EXTENDED))
    rows = [[Axes("time [s]", f"residual [{shown}]", over_time)]]
    binned = [
        Axes(
            AXIS_TITLES.get(axis, axis),
            f"rms [{shown}]",
            [
                Curve(
                    centres * AXIS_SCALES.get(axis, 1.0),
                    sizes * factor,
                    colour=NOMINAL,
                    mode="lines+markers",
                    over_time=False,
                )
            ],
            log_x=axis == "frequency",
        )
        for axis, (centres, sizes) in error.by.items()
        if axis != "time"
    ]
    if binned:
        rows.append(binned)
    return Figure(f"{_start(error.balance)}: what the balance lacks", rows, height=220)


def _curves(diagnosis: Diagnosis, overlay: Overlay, name: str, extended: bool) -> Axes:
    factor, shown = scale(overlay.unit), unit(overlay.unit)
    curves = [
        Curve(diagnosis.time, overlay.measured * factor, "measured", MEASURED, width=2.2),
        Curve(diagnosis.time, overlay.refitted * factor, "nominal, refitted", NOMINAL, width=1.2),
    ]
    if extended:
        curves.append(
            Curve(diagnosis.time, overlay.extended * factor, "extended", EXTENDED, width=1.2)
        )
    return Axes("time [s]", f"{name} [{shown}]", curves, link="time")


def _errors(diagnosis: Diagnosis, overlay: Overlay, extended: bool) -> Axes:
    factor, shown = scale(overlay.unit), unit(overlay.unit)
    error = (overlay.measured - overlay.refitted) * factor
    curves = [Curve(diagnosis.time, error, "nominal, refitted", NOMINAL, width=1.0)]
    if extended:
        rest = (overlay.measured - overlay.extended) * factor
        curves.append(Curve(diagnosis.time, rest, "extended", EXTENDED, width=1.0))
    held = diagnosis.held_out
    if held is not None and np.any(held) and not np.all(held):
        low = float(np.nanmin(error)) if np.any(np.isfinite(error)) else 0.0
        marks = np.where(held, low, np.nan)
        curves.append(Curve(diagnosis.time, marks, "held out", HELD, width=4.0, over_time=False))
    return Axes("time [s]", f"measured - model [{shown}]", curves, link="time")


def _start(text: str) -> str:
    return text[:1].upper() + text[1:]
