"""Comparison of two recorded runs: numbers, a few lines for the terminal, one HTML page."""

from steering_bringup.comparison.page import comparison_page, write_page
from steering_bringup.comparison.result import Comparison, compare
from steering_bringup.comparison.summary import summary
from steering_bringup.comparison.verdict import Verdict, verdict

__all__ = [
    "Comparison",
    "Verdict",
    "compare",
    "comparison_page",
    "summary",
    "verdict",
    "write_page",
]
