"""The plant's effects as the schema and the lists see them."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.util import find_spec
from typing import Any


def effects() -> Mapping[str, Any]:
    """Return the registered effects by name."""
    if find_spec("steering_plant.effects") is None:
        return {}
    from steering_plant.effects import EFFECTS

    return EFFECTS
