"""The time of an MDF group's samples. Sample numbers are never taken for seconds."""

from __future__ import annotations

from typing import Any

import numpy as np
from asammdf.blocks import v4_constants as v4

from steering_core.errors import BenchError
from steering_diagnosis.data.foreign.mdf_channels import Place, places
from steering_diagnosis.data.foreign.mdf_values import numbers
from steering_diagnosis.data.mapping import Mapping
from steering_diagnosis.data.units import FACTORS, spelled

SYNC = {
    v4.SYNC_TYPE_ANGLE: "an angle",
    v4.SYNC_TYPE_DISTANCE: "a distance",
    v4.SYNC_TYPE_INDEX: "an index",
}
"""What a master is that is no time."""

MOST_NAMED = 12
"""Channels of a group that an error names."""


def clock(place: Place, mapping: Mapping) -> tuple[np.ndarray | None, str, tuple[str, ...]]:
    """Return times (n,), their unit ("" where the file does not say), and what is to be noted.

    The channel that the mapping names with ``time``, where the group has it; else the group's
    master. None: there is none, and the mapping's ``rate`` counts. BenchError: nor that.
    """
    file, group = place.file, place.group
    master = _master(place)
    named = _named(place, mapping.time) if mapping.time else None
    if named is not None and named != master:
        times = numbers(named)[0]
        if not np.isfinite(times).any():
            raise BenchError(f"'{place.path}': 'time: {mapping.time}' has no number in it")
        return times, unit_of(named), ()
    why = _why_not(master, group)
    if not why:
        assert master is not None
        virtual = _virtual(file, master.block)
        times = file.get_master(master.group) if virtual else numbers(master)[0]
        told = mapping.time and named is None
        note = f"group {group} has no channel '{mapping.time}': its own time was taken"
        return np.asarray(times, np.float64), unit_of(master), (note,) if told else ()
    if mapping.rate is not None:
        return None, "", (f"{why}: taken at {mapping.rate:g} Hz from 0 s on, as 'rate' says",)
    names = ", ".join(block.name for block in file.groups[group].channels[:MOST_NAMED])
    lacks = f" and no channel '{mapping.time}'" if mapping.time else ""
    raise BenchError(
        f"'{place.path}': {why}{lacks}; give 'rate' in Hz, or name a channel of that group with "
        f"'time' (it has {names})"
    )


def _why_not(master: Place | None, group: int) -> str:
    """Return why a group's master is no time; empty where it is one."""
    if master is None:
        return f"group {group} has no time: its samples are only counted"
    block, unit = master.block, unit_of(master)
    named = f"the master '{block.name}' of group {group}"
    sync = v4.SYNC_TYPE_TIME if master.file.version < "4" else block.sync_type
    if sync in SYNC:
        return f"{named} is {SYNC[sync]}, no time"
    if unit and spelled(unit) not in FACTORS["s"]:
        return f"{named} is in '{unit}', no unit of time"
    if sync != v4.SYNC_TYPE_TIME and not unit:
        return f"{named} does not say that it is a time"
    if _virtual(master.file, block) and _counted(master.file, block):
        return f"{named} only counts its samples"
    return ""


def _named(place: Place, name: str) -> Place | None:
    """Return the channel of a name in the group of ``place``; None where it has none."""
    inside = [p for p in places(place.file, name, place.path) if p.group == place.group]
    if len(inside) > 1:
        raise BenchError(
            f"'{place.path}': 'time: {name}' occurs {len(inside)} times in group {place.group}"
        )
    return inside[0] if inside else None


def unit_of(place: Place) -> str:
    """Return a channel's own unit, else that of its conversion."""
    block = place.block
    own = block.unit or (block.conversion.unit if block.conversion is not None else "")
    text = own.decode("latin-1") if isinstance(own, bytes) else str(own)
    return text.strip(" \0\t\r\n")


def _master(place: Place) -> Place | None:
    """Return the master of a channel's group, which may be in another group (column storage)."""
    file, group = place.file, place.group
    if file.version >= "4":
        block = file.groups[group].channel_group
        if block.flags & v4.FLAG_CG_REMOTE_MASTER:
            group = block.cg_master_index
    index = file.masters_db.get(group)
    return None if index is None else Place(file, place.path, group, index)


def _virtual(file: Any, block: Any) -> bool:
    """Return whether a master's times are computed from the sample's number."""
    if file.version < "4":
        return bool(block.bit_count == 0)
    return bool(block.channel_type == v4.CHANNEL_TYPE_VIRTUAL_MASTER)


def _counted(file: Any, block: Any) -> bool:
    """Return whether a virtual master is nothing but the sample's number."""
    if file.version < "4":
        return not block.sampling_rate
    rule = block.conversion
    if rule is None or rule.conversion_type == v4.CONVERSION_TYPE_NON:
        return True
    return bool(rule.conversion_type == v4.CONVERSION_TYPE_LIN and (rule.a, rule.b) == (1.0, 0.0))
