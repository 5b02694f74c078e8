"""Building blocks of the bench's HTML pages: one file each, opens offline, interactive plots."""

from steering_bringup.pages.figure import Axes, Curve, Figure
from steering_bringup.pages.page import Page
from steering_bringup.pages.parts import Card, cards, folded, paragraph, table

__all__ = [
    "Axes",
    "Card",
    "Curve",
    "Figure",
    "Page",
    "cards",
    "folded",
    "paragraph",
    "table",
]
