"""The look of the figures, in plotly.js's terms."""

from __future__ import annotations

import html
from typing import Any

import numpy as np

from steering_bringup.pages.arrays import packed

FONT = "Inter, 'Segoe UI', system-ui, -apple-system, 'Helvetica Neue', Arial, sans-serif"
Spans = tuple[tuple[float, float], tuple[float, float]]
"""Share of a figure's width and of its height, from and to."""

COLOUR_BAR = 0.055  # share of the width that a colour bar with its title takes
INK, GRID, MUTED = "#1b2530", "#e6eaef", "#5b6876"


def base_layout(height: int) -> dict[str, Any]:
    """Layout of a figure without its axes."""
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


def axis(title: str) -> dict[str, Any]:
    """Look of one axis."""
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


def limit_line(value: float, suffix: str) -> dict[str, Any]:
    """A dotted line at a value of y."""
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


def axes_title(text: str, spans: Spans) -> dict[str, Any]:
    """Title at the upper left of one plot."""
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


def shaded(shade: np.ndarray, title: str, spans: Spans) -> dict[str, Any]:
    """Markers coloured by a value, with their colour bar."""
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
