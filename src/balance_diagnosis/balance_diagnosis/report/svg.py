"""Curves as SVG: a plot of lines over time, reduced to what a screen shows."""

from __future__ import annotations

import html
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

WIDTH, HEIGHT = 900, 210
LEFT, RIGHT, TOP, BOTTOM = 78, 12, 26, 36  # margins of the plot itself
INK, MUTED, GRID = "#1b2530", "#5b6876", "#e6eaef"
BEFORE, AFTER = "#d55e00", "#0072b2"


@dataclass(frozen=True)
class Line:
    """One curve, (n,) each; NaN interrupts it."""

    x: np.ndarray
    y: np.ndarray
    name: str
    colour: str = INK


def plot(lines: Sequence[Line], title: str, x_title: str, y_title: str, columns: int) -> str:
    """Return one plot as an SVG element. columns: of the screen that a curve is reduced to."""
    reduced = [(line, *reduce(line.x, line.y, columns)) for line in lines]
    x_low, x_high = _range([x for _, x, _ in reduced], 0.0)
    y_low, y_high = _range([y for _, _, y in reduced], 0.05)
    box = _Box(x_low, x_high, y_low, y_high)
    parts = [
        f"<svg viewBox='0 0 {WIDTH} {HEIGHT}' role='img' xmlns='http://www.w3.org/2000/svg'>",
        f"<title>{html.escape(title)}</title>",
        _grid(box, x_title, y_title),
        *(_path(box, line, x, y) for line, x, y in reduced),
        f"<text x='{LEFT}' y='16' class='t'>{html.escape(title)}</text>",
        _legend(lines),
        "</svg>",
    ]
    return "".join(parts)


def reduce(x: np.ndarray, y: np.ndarray, columns: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the least and the largest value of each column of samples, in their order.

    A column without a number becomes one NaN. Short curves stay as they are.
    """
    if len(x) <= 2 * columns:
        return x, y
    size = -(-len(x) // columns)
    pad = -len(x) % size
    values = np.pad(y, (0, pad), constant_values=np.nan).reshape(-1, size)
    known = np.isfinite(values)
    least = np.where(known, values, np.inf).argmin(axis=1)
    most = np.where(known, values, -np.inf).argmax(axis=1)
    offset = size * np.arange(len(values))
    both = np.stack([np.minimum(least, most), np.maximum(least, most)], axis=1) + offset[:, None]
    keep = np.minimum(both, len(x) - 1).ravel()
    return x[keep], np.where(np.repeat(known.any(axis=1), 2), y[keep], np.nan)


def ticks(low: float, high: float, most: int) -> list[float]:
    """Return round numbers between two others."""
    span = (high - low) / most
    power = 10.0 ** math.floor(math.log10(span))
    step = next(m * power for m in (1.0, 2.0, 5.0, 10.0) if m * power >= span)
    first = math.ceil(low / step - 1e-9)
    return [k * step for k in range(first, math.floor(high / step + 1e-9) + 1)]


@dataclass(frozen=True)
class _Box:
    x_low: float
    x_high: float
    y_low: float
    y_high: float

    def x(self, value: np.ndarray | float) -> np.ndarray:
        share = (np.asarray(value) - self.x_low) / (self.x_high - self.x_low)
        return LEFT + share * (WIDTH - LEFT - RIGHT)

    def y(self, value: np.ndarray | float) -> np.ndarray:
        share = (np.asarray(value) - self.y_low) / (self.y_high - self.y_low)
        return HEIGHT - BOTTOM - share * (HEIGHT - TOP - BOTTOM)


def _range(values: Sequence[np.ndarray], margin: float) -> tuple[float, float]:
    """Return the ends of an axis; a constant one is opened."""
    known = np.concatenate([v[np.isfinite(v)] for v in values])
    if not len(known):
        return 0.0, 1.0
    low, high = float(known.min()), float(known.max())
    if not high - low > 1e-9 * max(abs(low), abs(high)):
        opened = abs(low) or 1.0
        return low - opened, high + opened
    return low - margin * (high - low), high + margin * (high - low)


def _grid(box: _Box, x_title: str, y_title: str) -> str:
    floor, middle = HEIGHT - BOTTOM, (TOP + HEIGHT - BOTTOM) / 2
    parts = []
    for value in ticks(box.x_low, box.x_high, 9):
        x = f"{float(box.x(value)):.1f}"
        parts.append(f"<path class='g' d='M{x} {TOP}V{floor}'/>")
        parts.append(f"<text x='{x}' y='{floor + 14}' class='n m'>{value:.6g}</text>")
    for value in ticks(box.y_low, box.y_high, 5):
        y = float(box.y(value))
        parts.append(f"<path class='g' d='M{LEFT} {y:.1f}H{WIDTH - RIGHT}'/>")
        parts.append(f"<text x='{LEFT - 6}' y='{y + 4:.1f}' class='n e'>{value:.4g}</text>")
    parts.append(
        f"<text x='{WIDTH / 2}' y='{HEIGHT - 4}' class='n m'>{html.escape(x_title)}</text>"
        f"<text transform='translate(14 {middle}) rotate(-90)' class='n m'>"
        f"{html.escape(y_title)}</text>"
    )
    return "".join(parts)


def _path(box: _Box, line: Line, x: np.ndarray, y: np.ndarray) -> str:
    """Return one curve; each stretch between gaps is a line of its own."""
    known = np.isfinite(x) & np.isfinite(y)
    across, up = box.x(x), box.y(y)
    parts, pen = [], "M"
    for i, here in enumerate(known):
        if here:
            parts.append(f"{pen}{across[i]:.1f} {up[i]:.1f}")
        pen = "L" if here else "M"
    return f"<path class='c' stroke='{line.colour}' d='{''.join(parts)}'/>" if parts else ""


def _legend(lines: Sequence[Line]) -> str:
    spans = "".join(
        f"<tspan fill='{line.colour}'>\u2003— {html.escape(line.name)}</tspan>" for line in lines
    )
    return f"<text x='{WIDTH - RIGHT}' y='16' class='n e'>{spans}</text>"
