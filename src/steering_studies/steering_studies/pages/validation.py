"""Validation of a model against a system test: figures 4.8 to 4.12 of the source."""

from __future__ import annotations

from steering_bringup.pages import Axes, Curve, Figure, Page, table
from steering_studies.validation import Validation

SHOWN = {"Pa": ("bar", 1e-5), "rad": ("deg", 57.29577951308232), "m": ("mm", 1e3)}
TITLES = {
    "steering_wheel_angle": "Steering wheel angle (fig 4.8)",
    "torsion_bar_torque": "Torsion bar torque (fig 4.9)",
    "rack_position": "Rack position (fig 4.10)",
    "supply_pressure": "Pump pressure (fig 4.11)",
    "load_pressure": "Pressure difference (fig 4.12)",
}
HEAD = ("Channel", "Unit", "Rms error", "Largest error", "Fit", "Delay [ms]")


def validation_page(made: Validation, name: str) -> Page:
    """Return the page: figures of merit, then every channel overlaid."""
    worst = min(made.merits.items(), key=lambda item: item[1].fit)
    page = Page(
        title=f"Validation against the record {name}",
        lead=f"The worst channel, {worst[0].replace('_', ' ')}, has a fit of "
        f"{100.0 * worst[1].fit:.1f} %; 100 % is no error at all.",
        footer="Fit: 1 - rms of the error over the measurement's own deviation. "
        "This page needs no network.",
    )
    page.add(table(HEAD, [_row(key, made) for key in made.merits], left_columns=2))
    for key in made.merits:
        page.add(channel_figure(made, key))
    return page


def _row(key: str, made: Validation) -> tuple[str, ...]:
    found = made.merits[key]
    unit, scale = SHOWN.get(found.unit, (found.unit, 1.0))
    return (
        key.replace("_", " "),
        unit,
        f"{found.rms * scale:.3g}",
        f"{found.peak * scale:.3g}",
        f"{100.0 * found.fit:.1f} %",
        f"{found.delay * 1e3:.0f}",
    )


def channel_figure(made: Validation, key: str) -> Figure:
    """Return measurement and simulation of one channel, overlaid."""
    unit, scale = SHOWN.get(made.merits[key].unit, (made.merits[key].unit, 1.0))
    curves = [
        Curve(made.time, made.measured[key] * scale, "measured", "#1b2530", width=2.2),
        Curve(made.time, made.simulated[key] * scale, "simulated", "#b3261e", width=1.2),
    ]
    axes = Axes("time [s]", f"{key.replace('_', ' ')} [{unit}]", curves)
    return Figure(TITLES.get(key, key), [[axes]], height=260)
