"""What only models of other tools need, and is not installed with the library."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from balance_diagnosis.errors import BalanceError

PACKAGES = {"fmpy": "fmpy", "yaml": "PyYAML"}


def needed(module: str) -> Any:
    """Return an optional module; BalanceError with the line that installs it."""
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        if error.name != module.partition(".")[0]:
            raise
        raise BalanceError(
            f"a model of another tool needs {PACKAGES[error.name]}: "
            f"pip install {PACKAGES[error.name]}"
        ) from None
