"""The one error that the command line reports without a traceback."""

from __future__ import annotations


class BenchError(Exception):
    """What a user can put right: the text names the thing and what to do, on one line."""
