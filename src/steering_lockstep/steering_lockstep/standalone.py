"""One node alone in a process, without a supervisor."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


def spin_alone(kind: str, make: Callable[..., Any]) -> None:
    """Run the node of ``kind``."""
    raise NotImplementedError
