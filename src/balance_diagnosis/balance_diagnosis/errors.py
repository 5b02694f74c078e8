"""The one error that a user can put right: one line that names the thing, the place, what to do."""

from __future__ import annotations


class BalanceError(Exception):
    """What a user can put right, on one line."""
