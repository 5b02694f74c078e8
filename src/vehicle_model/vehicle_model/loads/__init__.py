"""Loads on the rack. One file each.

``LOADS`` is the one place where a load is registered; node parameters, scenarios, the
documentation and the tests read it.
"""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from steering_core.naming import unknown
from vehicle_model.loads.base import Load, LoadError
from vehicle_model.loads.bicycle import Bicycle
from vehicle_model.loads.clamp import Clamp
from vehicle_model.loads.dry_park import DryPark
from vehicle_model.loads.none import NoLoad
from vehicle_model.loads.position_servo import PositionServo
from vehicle_model.loads.table import Table, load_table

LOADS: dict[str, type[Load]] = {
    made.kind: made for made in (Bicycle, DryPark, NoLoad, Table, Clamp, PositionServo)
}

__all__ = ["LOADS", "Load", "LoadError", "load_table", "make_load"]


def make_load(kind: str = "bicycle", **values: Any) -> Load:
    """Return the load ``kind`` with ``values`` in place of its defaults.

    ``make_load("table", file=path)`` reads a CSV file. Raises LoadError for an unknown kind or
    field (naming the nearest known one) and for a value that cannot be.
    """
    if kind not in LOADS:
        raise LoadError(unknown("load", kind, LOADS))
    if kind == Table.kind and "file" in values:
        if len(values) > 1:
            raise LoadError("table: give either a file or times and forces")
        return load_table(values["file"])
    known = [field.name for field in fields(LOADS[kind])]
    for name in values:
        if name not in known:
            raise LoadError(f"{kind}: {unknown('field', name, known)}")
    return LOADS[kind](**values)
