"""The one error that bags raise."""

from steering_bringup.errors import BenchError


class BagError(BenchError):
    """A bag cannot be written or read; the text names the path and what can be done."""
