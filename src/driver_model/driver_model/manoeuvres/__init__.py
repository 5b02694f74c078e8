"""Manoeuvres: what the driver wants the steering wheel to do. One file each.

``MANOEUVRES`` is the one place where a manoeuvre is registered; node parameters, scenarios, the
documentation and the tests read it.
"""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from driver_model.manoeuvres.base import Manoeuvre, ManoeuvreError
from driver_model.manoeuvres.chirp import Chirp
from driver_model.manoeuvres.free_release import FreeRelease
from driver_model.manoeuvres.hold import Hold
from driver_model.manoeuvres.lane_change import LaneChange
from driver_model.manoeuvres.on_centre import OnCentre
from driver_model.manoeuvres.ramp import Ramp
from driver_model.manoeuvres.step import Step
from driver_model.manoeuvres.table import Table, load_table
from driver_model.manoeuvres.weave import Weave
from steering_core.naming import unknown

MANOEUVRES: dict[str, type[Manoeuvre]] = {
    made.kind: made
    for made in (OnCentre, Chirp, Step, Ramp, Weave, FreeRelease, Hold, LaneChange, Table)
}

__all__ = ["MANOEUVRES", "Manoeuvre", "ManoeuvreError", "load_table", "make_manoeuvre"]


def make_manoeuvre(kind: str = "on_centre", **values: Any) -> Manoeuvre:
    """Return the manoeuvre ``kind`` with ``values`` in place of its defaults.

    ``make_manoeuvre("table", file=path)`` reads a CSV file. Raises ManoeuvreError for an unknown
    kind or field (naming the nearest known one) and for a value that cannot be.
    """
    if kind not in MANOEUVRES:
        raise ManoeuvreError(unknown("manoeuvre", kind, MANOEUVRES))
    if kind == Table.kind and "file" in values:
        if len(values) > 1:
            raise ManoeuvreError("table: give either a file or times and angles")
        return load_table(values["file"])
    known = [field.name for field in fields(MANOEUVRES[kind])]
    for name in values:
        if name not in known:
            raise ManoeuvreError(f"{kind}: {unknown('field', name, known)}")
    return MANOEUVRES[kind](**values)
