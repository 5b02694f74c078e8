"""A figure of one or more axes beside and above each other, as data for plotly.js."""

from __future__ import annotations

import html
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from steering_bringup.pages.arrays import every, packed, thin

FONT = "Inter, 'Segoe UI', system-ui, -apple-system, 'Helvetica Neue', Arial, sans-serif"
Spans = tuple[tuple[float, float], tuple[float, float]]
"""Share of a figure's width and of its height, from and to."""

COLOUR_BAR = 0.055  # share of the width that a colour bar with its title takes
INK, GRID, MUTED = "#1b2530", "#e6eaef", "#5b6876"


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

    link: axes of a figure with the same link zoom together in x.
    """

    x_title: str
    y_title: str
    curves: list[Curve]
    title: str = ""
    limits: tuple[float, ...] = ()
    y_range: tuple[float, float] | None = None
    link: str = ""
    log_x: bool = False


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
        layout = _base_layout(self.height * len(self.rows) + 60)
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
        horizontal = _axis(axes.x_title) | {"domain": list(spans[0]), "anchor": f"y{suffix}"}
        vertical = _axis(axes.y_title) | {"domain": list(spans[1]), "anchor": f"x{suffix}"}
        if axes.log_x:
            horizontal["type"] = "log"
        if axes.link and axes.link in places:
            horizontal["matches"] = places[axes.link]
        elif axes.link:
            places[axes.link] = f"x{suffix}"
        if axes.y_range:
            vertical["range"] = list(axes.y_range)
        layout[f"xaxis{suffix}"], layout[f"yaxis{suffix}"] = horizontal, vertical
        layout["shapes"] += [_limit_line(value, suffix) for value in axes.limits]
        if axes.title:
            layout["annotations"].append(_axes_title(axes.title, spans))

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
            trace["marker"] = _shaded(curve.shade[part], curve.shade_title, spans)
        return trace


def _base_layout(height: int) -> dict[str, Any]:
    return {
        "height": height,
        "margin": {"l": 78, "r": 40, "t": 56, "b": 48},
        "font": {"family": FONT, "size": 12.5, "color": INK},
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "#ffffff",
        "hovermode": "closest",
        "hoverlabel": {"font": {"family": FONT, "size": 12}},
        "legend": {
            "orientation": "h",
            "traceorder": "reversed",
            "x": 1,
            "xanchor": "right",
            "y": 0.995,
            "yanchor": "top",
            "yref": "container",
            "bgcolor": "rgba(0,0,0,0)",
            "font": {"size": 13},
        },
        "modebar": {
            "orientation": "v",
            "bgcolor": "rgba(255,255,255,0.85)",
            "color": "#aab4bf",
            "activecolor": INK,
        },
        "shapes": [],
        "annotations": [],
    }


def _axis(title: str) -> dict[str, Any]:
    return {
        "title": {"text": title, "standoff": 8, "font": {"size": 12.5, "color": MUTED}},
        "gridcolor": GRID,
        "zerolinecolor": "#c4ccd5",
        "zerolinewidth": 1,
        "linecolor": "#c4ccd5",
        "showline": True,
        "mirror": True,
        "ticks": "outside",
        "tickcolor": "#c4ccd5",
        "ticklen": 4,
    }


def _limit_line(value: float, suffix: str) -> dict[str, Any]:
    return {
        "type": "line",
        "xref": f"x{suffix} domain",
        "yref": f"y{suffix}",
        "x0": 0,
        "x1": 1,
        "y0": value,
        "y1": value,
        "line": {"color": "#b3261e", "width": 1, "dash": "dot"},
    }


def _axes_title(text: str, spans: Spans) -> dict[str, Any]:
    return {
        "text": f"<b>{html.escape(text)}</b>",
        "xref": "paper",
        "yref": "paper",
        "x": spans[0][0],
        "y": spans[1][1],
        "xanchor": "left",
        "yanchor": "bottom",
        "yshift": 3,
        "showarrow": False,
        "font": {"size": 12.5, "color": INK},
    }


def _shaded(shade: np.ndarray, title: str, spans: Spans) -> dict[str, Any]:
    bottom, top = spans[1]
    return {
        "size": 3.5,
        "color": packed(shade),
        "colorscale": "Viridis",
        "reversescale": True,
        "showscale": True,
        "colorbar": {
            "title": {"text": title, "side": "right", "font": {"size": 11.5, "color": MUTED}},
            "thickness": 9,
            "outlinewidth": 0,
            "x": spans[0][1] + 0.008,
            "xanchor": "left",
            "y": (bottom + top) / 2,
            "len": top - bottom,
        },
    }
