"""The one error that bags raise."""


class BagError(Exception):
    """A bag cannot be written or read; the text names the path and what can be done."""
