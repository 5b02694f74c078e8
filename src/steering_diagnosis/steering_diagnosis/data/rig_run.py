"""What a bag of a rig differs in from one of the simulated bench, by its metadata alone.

The rig's file and the bridge's report are in the metadata: by how many ticks commands act later,
what the guard let through, which ticks hold old values, and when the rig was safe. The emulator's
own file, where the rig is an emulated one, is never read.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from rig_bridge.safety.limits import limited
from rig_bridge.safety.machine import State
from rig_bridge.signals import PERIOD_S
from steering_diagnosis.data.channels import COMMANDED, MEASURED

RUNNING = State.RUNNING.value

LOAD = ("load_force", "load_stiffness", "load_position")
"""What the vehicle asks for. It is not delayed here: the replay finds its age at the load cell."""

ACTING = tuple(name for name in COMMANDED if name not in LOAD)
"""Commands that a replay takes as what acts from a tick on."""


def as_on_the_rig(
    channels: dict[str, np.ndarray], run: Mapping[str, Any], first_tick: int, notes: list[str]
) -> np.ndarray | None:
    """Change ``channels`` (n,) to what acted and was measured; note it.

    Measurements of lost frames become NaN. Returns where the rig did not run, (n,) bool, None
    where it always did; unchanged without a rig in the metadata.
    """
    rig = (run.get("rig") or {}).get("content")
    if not rig or not channels:
        return None
    report = run.get("rig_run") or {}
    idle = _idle(report.get("changes") or [], first_tick, len(next(iter(channels.values()))))
    _forget_lost(channels, report)
    for name in ACTING:
        row = _row(rig, name)
        if name not in channels or row is None:
            continue
        sent = channels[name]
        if report.get("limited_commands"):
            sent = _sent(sent, row, idle)
        channels[name] = _later(np.where(idle, row.get("safe", 0.0), sent), rig.get("delay", 0))
    _tell(rig, report, idle, notes)
    return idle if idle.any() else None


def _row(rig: Mapping[str, Any], name: str) -> Mapping[str, Any] | None:
    """Return the rig's channel of a command; a valve's force and opening share a field."""
    table: Mapping[str, Mapping[str, Any]] = rig.get("channels") or {}
    return table.get(name) or table.get(name.replace("solenoid_force", "valve_opening"))


def _idle(changes: list[Mapping[str, Any]], first_tick: int, count: int) -> np.ndarray:
    """Return at which ticks the nodes' commands did not act, (n,) bool."""
    idle = np.zeros(count, dtype=bool)
    for change in changes:
        if change["tick"] is not None:
            idle[max(change["tick"] - first_tick, 0) :] = change["to"] != RUNNING
    return idle


def _forget_lost(channels: dict[str, np.ndarray], report: Mapping[str, Any]) -> None:
    """Set to NaN what a tick holds only because its own frame was lost.

    Live sensors never repeat all values exactly; the report lists but the first losses.
    """
    measured = [name for name in MEASURED if name in channels]
    if not report.get("lost_frames") or not measured:
        return
    repeated = np.all([np.diff(channels[name]) == 0.0 for name in measured], axis=0)
    lost = np.concatenate([[False], repeated])
    for name in measured:
        channels[name] = np.where(lost, np.nan, channels[name])


def _sent(asked: np.ndarray, row: Mapping[str, Any], idle: np.ndarray) -> np.ndarray:
    """Return what the guard let through of what was asked, (n,)."""
    sent, last, step = asked.copy(), asked[0], row["rate"] * PERIOD_S
    low, high = row["range"]
    for tick in np.flatnonzero(np.isfinite(asked)):
        let_through = limited(asked[tick], last, (low, high), step)
        sent[tick] = last = row.get("safe", 0.0) if idle[tick] else let_through
    return sent


def _later(values: np.ndarray, ticks: int) -> np.ndarray:
    """Return ``values`` (n,) ``ticks`` later, the first one held before."""
    at = np.maximum(np.arange(len(values)) - ticks, 0)
    return values[at]


def _tell(
    rig: Mapping[str, Any], report: Mapping[str, Any], idle: np.ndarray, notes: list[str]
) -> None:
    if delay := rig.get("delay", 0):
        notes.append(f"rig '{rig.get('name')}': commands act {delay} ms later than recorded")
    if count := report.get("limited_commands"):
        notes.append(f"{count} commands were limited by range or rate: the sent ones are used")
    if held := report.get("held"):
        notes.append(f"{held} ticks were answered with older commands than those recorded")
    if idle.any():
        notes.append(f"the rig was not running for {idle.sum()} ticks: these are not judged")
