"""The one error that a user can put right: one line that names the thing, the place, what to do."""

from __future__ import annotations

try:
    from steering_core.errors import BenchError
except ModuleNotFoundError:  # installed alone, with pip

    class BenchError(Exception):  # type: ignore[no-redef]
        """What a user can put right, on one line."""


__all__ = ["BenchError"]
