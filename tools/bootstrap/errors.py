"""The one error that set-up raises on purpose."""


class SetupError(Exception):
    """Set-up cannot go on; the text is one line for the person at the terminal."""
