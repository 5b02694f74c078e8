"""A figure of one or more axes beside and above each other, as data for plotly.js."""

from __future__ import annotations

import html
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from steering_bringup.pages.arrays import every, packed, thin
from steering_bringup.pages.style import (
    COLOUR_BAR,
    INK,
    Spans,
    axes_title,
    axis,
    base_layout,
    limit_line,
    shaded,
)


@dataclass(frozen=True)
class Curve:
    """One curve. x, y: (n,) in the axes' units. `over_time`: x rises, so extremes are kept.

    dash: "solid", "dash", "dot". mode: "lines", "markers" or "lines+markers". shade: (n,) values
    that colour the markers, with their title. A name is in the legend once a figure.
    """

    x: np.ndarray
    y: np.ndarray
    name: str = ""
    colour: str = INK
    dash: str = "solid"
    width: float = 1.6
    mode: str = "lines"
    over_time: bool = True
    shade: np.ndarray | None = None
    shade_title: str = ""


@dataclass
class Axes:
    """One plot. Titles carry the unit. limits: dotted lines at these values of y.

    link: axes of a figure with the same link zoom together in x. x_names: what stands at 0, 1, 2
    and so on in place of the numbers.
    """

    x_title: str
    y_title: str
    curves: list[Curve]
    title: str = ""
    limits: tuple[float, ...] = ()
    y_range: tuple[float, float] | None = None
    link: str = ""
    log_x: bool = False
    log_y: bool = False
    x_names: tuple[str, ...] = ()


@dataclass
class Figure:
    """Rows of axes with a title and a caption; height in pixels a row."""

    title: str
    rows: list[list[Axes]]
    caption: str = ""
    height: int = 300
    widths: tuple[float, ...] = ()
    _names: set[str] = field(default_factory=set, repr=False)

    def data(self) -> dict[str, Any]:
        """`data` and `layout` for Plotly.newPlot."""
        self._names = set()
        traces: list[dict[str, Any]] = []
        layout = base_layout(self.height * len(self.rows) + 60)
        places: dict[str, str] = {}
        number = 0
        for row, line in enumerate(self.rows):
            for column, axes in enumerate(line):
                number += 1
                suffix = "" if number == 1 else str(number)
                spans = self._spans(row, column)
                self._add_axes(layout, axes, suffix, spans, places)
                traces += [self._trace(curve, suffix, spans) for curve in axes.curves]
        return {"data": traces, "layout": layout}

    def render(self, identifier: str) -> str:
        """HTML of the figure's card; the plot itself is drawn when it comes into view."""
        caption = f"<p class='caption'>{html.escape(self.caption)}</p>" if self.caption else ""
        height = self.height * len(self.rows) + 60
        return (
            f"<section class='figure'><h3>{html.escape(self.title)}</h3>{caption}"
            f"<div class='plot' id='{identifier}' style='height:{height}px'></div></section>"
        )

    def _spans(self, row: int, column: int) -> Spans:
        """Share of the figure's width and height that an axes takes."""
        count = len(self.rows[row])
        shares = np.array(self.widths if len(self.widths) == count else (1.0,) * count)
        gap = 0.09
        widths = shares / shares.sum() * (1.0 - gap * (count - 1))
        left = float(widths[:column].sum() + gap * column)
        lines = len(self.rows)
        space = 0.0 if lines == 1 else 0.20 / (lines - 1) if lines > 2 else 0.17
        height = (1.0 - space * (lines - 1)) / lines
        top = 1.0 - row * (height + space)
        right = left + float(widths[column])
        if any(curve.shade is not None for curve in self.rows[row][column].curves):
            right -= COLOUR_BAR
        return (left, right), (max(0.0, top - height), top)

    def _add_axes(
        self,
        layout: dict[str, Any],
        axes: Axes,
        suffix: str,
        spans: Spans,
        places: dict[str, str],
    ) -> None:
        horizontal = axis(axes.x_title) | {"domain": list(spans[0]), "anchor": f"y{suffix}"}
        vertical = axis(axes.y_title) | {"domain": list(spans[1]), "anchor": f"x{suffix}"}
        if axes.log_x:
            horizontal["type"] = "log"
        if axes.log_y:
            vertical["type"] = "log"
        if axes.x_names:
            horizontal["tickvals"] = list(range(len(axes.x_names)))
            horizontal["ticktext"] = list(axes.x_names)
        if axes.link and axes.link in places:
            horizontal["matches"] = places[axes.link]
        elif axes.link:
            places[axes.link] = f"x{suffix}"
        if axes.y_range:
            vertical["range"] = list(axes.y_range)
        layout[f"xaxis{suffix}"], layout[f"yaxis{suffix}"] = horizontal, vertical
        layout["shapes"] += [limit_line(value, suffix) for value in axes.limits]
        if axes.title:
            layout["annotations"].append(axes_title(axes.title, spans))

    def _trace(
        self,
        curve: Curve,
        suffix: str,
        spans: Spans,
    ) -> dict[str, Any]:
        if curve.over_time and curve.shade is None:
            x, y = thin(np.asarray(curve.x, float), np.asarray(curve.y, float))
            part = slice(None)
        else:
            part = every(len(curve.x))
            x, y = curve.x[part], curve.y[part]
        trace: dict[str, Any] = {
            "type": "scatter",
            "x": packed(x),
            "y": packed(y),
            "xaxis": f"x{suffix}",
            "yaxis": f"y{suffix}",
            "mode": curve.mode,
            "name": curve.name,
            "legendgroup": curve.name,
            "showlegend": bool(curve.name) and curve.name not in self._names,
            "line": {"color": curve.colour, "dash": curve.dash, "width": curve.width},
            "marker": {"color": curve.colour, "size": 6},
        }
        self._names.add(curve.name)
        if curve.shade is not None:
            trace["marker"] = shaded(curve.shade[part], curve.shade_title, spans)
        return trace
