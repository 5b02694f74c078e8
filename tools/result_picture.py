"""Draws docs/result.svg, the README's picture, from the bags of the main job.

    ./steer run --out results/picture
    PYTHONPATH=$(echo src/* | tr ' ' ':') .steer/env/bin/python tools/result_picture.py \\
        results/picture docs/result.svg
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from steering_bringup.bags import read_bag
from steering_bringup.comparison import Comparison, compare

WIDTH, LEFT, PANEL, GAP, POINTS = 960, 70, 150, 46, 1200
FIRST, SECOND, DIFFERENCE = "#222222", "#2a7de1", "#b5480f"
PANELS = (
    ("steering_wheel_torque", "Steering wheel torque [N m]", 1.0),
    ("assistance_pressure", "Assistance pressure [bar]", 1e-5),
)


def main(folder: Path, target: Path) -> None:
    """Compare the two bags in ``folder`` and write the picture."""
    result = compare(read_bag(folder / "open_centre"), read_bag(folder / "closed_centre"))
    top, parts = 34, []
    for key, title, scale in PANELS:
        first, second = (signal * scale for signal in result.signals[key])
        curves = [(first, FIRST, "4 3", 2.0), (second, SECOND, "", 1.2)]
        parts.append(panel(top, title, result.time, curves))
        difference = f"Difference: {title[:1].lower()}{title[1:]}"
        curves = [(second - first, DIFFERENCE, "", 1.0)]
        parts.append(panel(top + PANEL + GAP, difference, result.time, curves))
        top += 2 * (PANEL + GAP)
    target.write_text(page(parts, top, result), encoding="utf-8")


def panel(
    top: float, title: str, time: np.ndarray, curves: list[tuple[np.ndarray, str, str, float]]
) -> str:
    """Return one plot: frame, limits, curves of (values, colour, dashes, width)."""
    largest = nice(max(float(np.abs(values).max()) for values, *_ in curves))
    width = WIDTH - LEFT - 20
    middle = top + 0.5 * PANEL
    frame = f'x="{LEFT}" y="{top}" width="{width}" height="{PANEL}"'
    lines = [
        f'<rect {frame} fill="none" stroke="#c5ccd6"/>',
        f'<path d="M{LEFT} {middle}h{width}" stroke="#c5ccd6"/>',
        f'<text x="{LEFT}" y="{top - 8}" font-weight="bold">{title}</text>',
    ]
    for value in (largest, 0.0, -largest):
        y = middle - value / largest * 0.5 * PANEL + 4
        lines.append(f'<text x="{LEFT - 8}" y="{y}" text-anchor="end">{value:g}</text>')
    for second in np.linspace(time[0], np.ceil(time[-1]), 5):
        x = LEFT + (second - time[0]) / np.ceil(time[-1] - time[0]) * width
        lines.append(
            f'<text x="{x}" y="{top + PANEL + 16}" text-anchor="middle">{second:g} s</text>'
        )
    at = np.unique(np.linspace(0, len(time) - 1, POINTS).astype(int))
    for values, colour, dashes, stroke in curves:
        x = LEFT + (time[at] - time[0]) / np.ceil(time[-1] - time[0]) * width
        y = middle - values[at] / largest * 0.5 * PANEL
        points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
        style = f'stroke="{colour}" stroke-width="{stroke}" stroke-dasharray="{dashes}"'
        lines.append(f'<polyline fill="none" {style} points="{points}"/>')
    return "\n".join(lines)


def nice(value: float) -> float:
    """Return the next of 1, 2, 3, 4, 5, 6, 8 times a power of ten."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(next(n for n in (1, 2, 3, 4, 5, 6, 8, 10) if n * power >= value) * power)


def page(parts: list[str], height: float, result: Comparison) -> str:
    """Return the whole picture with its legend."""
    first, second = result.names
    legend = (
        f'<path d="M620 18h30" stroke="{FIRST}" stroke-width="2" stroke-dasharray="4 3"/>'
        f'<text x="656" y="22">{first}</text>'
        f'<path d="M770 18h30" stroke="{SECOND}" stroke-width="2"/>'
        f'<text x="806" y="22">{second}</text>'
    )
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height - 10:.0f}" '
        'font-family="Helvetica, Arial, sans-serif" font-size="13" fill="#223">'
        f'<rect width="{WIDTH}" height="{height}" fill="#fff"/>'
    )
    return "\n".join([head, legend, *parts, "</svg>", ""])


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
