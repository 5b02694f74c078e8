"""What the controllers refuse."""


class ControllerError(ValueError):
    """A choice of controller parameters that cannot work."""
