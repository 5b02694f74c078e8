"""The one error that the command line reports without a traceback."""

from steering_core.errors import BenchError

__all__ = ["BenchError"]
