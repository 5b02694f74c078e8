"""The verdict on one case: what the node did, what the arbiter did, and what to change."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from pressure_control.overlay.arbiter import overlay_record
from pressure_control.overlay.lateral import lateral_gain
from pressure_control.overlay.limits import overlay_bounds
from steering_bringup.check_node.faults import START, STOP, Fault, Heard
from steering_bringup.check_node.record import Record, Subject
from steering_core.parameters import ParameterSet

ASKED, APPLIED, AUTHORITY, SOURCE, STALE, REFUSED, REFUSALS = 0, 1, 5, 6, 14, 15, 16
GONE = 1e-9
"""N m below which an overlay has faded out."""
SETTLED = 600
"""Ticks from the beginning in which a node comes up; it is served after them."""
STAND_DOWN = 450
"""Ticks within which a node whose inputs stop must stop asking."""
SMALL_WISH = 0.1
ROUNDING = 1e-9


@dataclass(frozen=True)
class Verdict:
    """One line of the table. ``change``: what to do about a failure."""

    fault: str
    injected: str
    node: str
    arbiter: str
    passed: bool
    change: str = ""

    def as_json(self) -> dict[str, Any]:
        """Return the verdict for machines."""
        return asdict(self)


def judge(subject: Subject, fault: Fault, record: Record, parameters: ParameterSet) -> Verdict:
    """Return the verdict on what was recorded under ``fault``."""
    asks = _wishes(record.heard)
    faults = [
        *_process_faults(subject, fault, record),
        *_node_faults(fault, record, parameters),
        *_arbiter_faults(fault, record, parameters),
    ]
    told = _told_node(fault, record, asks)
    return Verdict(
        fault.key, fault.told, told, _told_arbiter(record.rows), not faults, "; ".join(faults[:2])
    )


def _wishes(heard: Sequence[Heard]) -> np.ndarray:
    return np.array([h.torque for h in heard if h.priority >= 0.0])


def _process_faults(subject: Subject, fault: Fault, record: Record) -> list[str]:
    """What is wrong with the process: it must live on, but for a member that refuses a NaN."""
    if fault.killed:
        return []  # the arbiter's part is what counts
    refuses = fault.key == "inputs-nan" and subject.style == "member"
    if record.ended and not (refuses and "not finite" in record.ended):
        return [f"the node must go on: {record.ended}"]
    return []


def _node_faults(fault: Fault, record: Record, parameters: ParameterSet) -> list[str]:
    largest, found = parameters["overlay.out_of_range"], []
    wrong = [h for h in record.heard if not abs(h.torque) <= largest]
    if wrong:
        t = wrong[0].torque
        what = "no number" if not math.isfinite(t) else f"{t:g} N m, above {largest:g}"
        found.append(
            f"asked {len(wrong)} times for {what}: check what you read (math.isfinite), bound what "
            "you ask"
        )
    if any(not math.isfinite(h.priority) for h in record.heard):
        found.append("its priority is no number")
    names = sorted({h.source for h in record.heard})
    if len(names) > 1:
        found.append(f"names itself {', '.join(map(repr, names[:3]))}: always send one source name")
    if "" in names:
        found.append("names no source: set the message's field source to the node's name")
    stops = fault.inputs is not None and fault.key == "inputs-stop" and record.reads
    if stops and (last := [h for h in record.heard if START + STAND_DOWN <= h.tick < STOP]):
        asking = [h for h in last if h.priority >= 0.0 and abs(h.torque) > SMALL_WISH]
        if asking:
            found.append(
                f"goes on asking for {asking[-1].torque:.2g} N m without inputs: stand by "
                "(priority -1) when the newest one is older than a few periods"
            )
    return found


def _arbiter_faults(fault: Fault, record: Record, parameters: ParameterSet) -> list[str]:
    rows = record.rows
    if not len(rows):
        return []
    found = [] if _keeps_limits(rows, parameters) else ["THE ARBITER BROKE A LIMIT: report it"]
    if record.ended:
        return found
    end = STOP if not fault.killed else len(rows)
    if fault.refused and rows[min(STOP, len(rows)) - 1, REFUSALS] == 0:
        found.append("the arbiter refused nothing")
    if fault.ends and abs(rows[end - 1, APPLIED]) > GONE:
        found.append(f"{rows[end - 1, APPLIED]:.2g} N m were still applied at the end of the fault")
    if fault.killed:
        return found
    if not any(h.priority >= 0.0 for h in record.heard):
        return [*found, "it stood by all the time (priority below 0): give it something to do"]
    before = slice(SETTLED, START)
    return found + _service_faults(fault, record, rows, before)


def _service_faults(fault: Fault, record: Record, rows: np.ndarray, before: slice) -> list[str]:
    """The node must be served before the fault, and again by the end of the run."""
    ticks = [h.tick for h in record.heard if h.tick < START]
    stale = float(np.mean(rows[before, STALE]))
    if stale > 0.05:
        gap = float(np.median(np.diff(ticks))) if len(ticks) > 2 else math.nan
        text = f"silent {stale:.0%} of the time: its messages come every {gap:.0f} ms, the arbiter "
        return [text + "waits three of its usual periods; ask steadily, 100 times a second"]
    if not rows[-100:, SOURCE].any():
        return ["it was not served again after the fault: it must recover by itself"]
    return []


def _keeps_limits(rows: np.ndarray, parameters: ParameterSet) -> bool:
    par, bounds = overlay_record(parameters)[0], np.zeros(5)
    overlay_bounds(par, lateral_gain(par, parameters["vehicle.speed"]), bounds)
    applied = rows[:, APPLIED]
    if not np.isfinite(applied).all():
        return False
    level = np.max(np.abs(applied)) <= min(bounds[:3]) + ROUNDING
    steps = np.abs(np.diff(applied, prepend=0.0))
    return bool(level and np.max(steps) <= min(bounds[3:]) + ROUNDING)


def _told_node(fault: Fault, record: Record, asks: np.ndarray) -> str:
    if not record.heard:
        return record.ended or "said nothing"
    finite = asks[np.isfinite(asks)]
    span = f"{finite.min():+.3g} to {finite.max():+.3g} N m" if len(finite) else "stood by"
    text = f"{len(record.heard)} messages, {span}"
    if fault.inputs is not None and not record.reads:
        text += ", reads nothing of the bench"
    elif fault.inputs is not None:
        inside = [h for h in record.heard if START <= h.tick < STOP]
        text += f", {len(inside)} of them in the fault"
    return f"{text}; {record.ended}" if record.ended else text


def _told_arbiter(rows: np.ndarray) -> str:
    if not len(rows):
        return "heard nothing"
    told = [f"applied up to {np.max(np.abs(rows[:, APPLIED])):.3g} N m"]
    inside = rows[START:STOP]
    if rows[-1, REFUSALS]:
        told.append(f"refused {rows[-1, REFUSALS]:.0f}")
    if inside[:, STALE].any():
        told.append("took it as silent")
    if len(inside) and rows[:, AUTHORITY].min() < 1.0:
        told.append(f"left {rows[:, AUTHORITY].min():.0%} to it")
    gone = np.flatnonzero(np.abs(rows[START:, APPLIED]) <= GONE)
    if len(gone) and abs(rows[START - 1, APPLIED]) > GONE:
        told.append(f"nothing applied after {gone[0]} ms")
    return ", ".join(told)
