"""A free rack: "no load" is a choice with a name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from vehicle_model.loads.base import Load


@dataclass(frozen=True)
class NoLoad(Load):
    """No rack force; the vehicle stands still, as if lifted."""

    kind: ClassVar[str] = "none"
