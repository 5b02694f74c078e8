"""Reading bags: any of ours, complete or cut off, in one vectorised pass."""

from __future__ import annotations

import json
from collections.abc import Container
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from steering_bringup.bags.append_file import is_being_written
from steering_bringup.bags.definitions import typestore_of
from steering_bringup.bags.errors import BagError
from steering_bringup.bags.foreign import read_foreign
from steering_bringup.bags.mcap_bytes import LOG_TIME, PAYLOAD, gather, map_file
from steering_bringup.bags.messages import add_opaque, add_rows
from steering_bringup.bags.places import METADATA_FILE, RUN_FILE
from steering_bringup.bags.recovery import repair
from steering_bringup.bags.scan import Scan, scan
from steering_bringup.bags.sources.files import bag_files, kind_of
from steering_bringup.bags.trace import Trace
from steering_bringup.bags.writer import BROKEN_OFF, BROKEN_OFF_KEY, OUTCOME_KEY, RUN_KEY
from steering_core.plain_yaml import plain


def read_bag(
    path: str | Path, *, repair_damage: bool = True, topics: Container[str] | None = None
) -> Trace:
    """Read a bag (a folder, or one MCAP or SQLite file) into a Trace.

    topics: what to read; the messages of others are not looked at. None: all.

    A bag that a crash cut off is read as far as it goes, says so in `notes`, and is repaired in
    place for other readers (`repair`: the original bytes are kept), unless `repair_damage` is
    False, the file lies alone, another tool recorded it, or a process is still writing it.
    The channels of a topic are joined in order of time.
    Raises BagError, naming the path, if there is no bag or nothing readable in it.
    """
    path = Path(path)
    files = bag_files(path)
    found = _scan(files.files[0]) if len(files.files) == 1 and not files.notes else None
    if found is None or not _is_plain(found):
        trace = read_foreign(path, topics)
        trace.run, trace.outcome = read_run(path)
        return trace
    (file,) = files.files
    trace = _read(file, found, topics)
    trace.path = path
    trace.run, trace.outcome = read_run(path)
    if trace.outcome.startswith(BROKEN_OFF):
        trace.notes.append(f"the run was {trace.outcome}{_why(trace.run)}")
    if trace.complete and path.is_dir() and not (path / METADATA_FILE).exists():
        trace.complete = False
        trace.notes.insert(0, "not complete (metadata.yaml is missing): every message is there")
    if not trace.complete and path.is_dir() and _is_ours(found):
        if is_being_written(file):
            trace.notes.append("the bag is still being written")
        elif repair_damage:
            trace.notes.append(_try_repair(path))
    return trace


def _why(run: dict[str, Any]) -> str:
    return f": {run[BROKEN_OFF_KEY]}" if run.get(BROKEN_OFF_KEY) else ""


def _try_repair(path: Path) -> str:
    try:
        return str(repair(path))
    except BagError as error:
        return f"not repaired: {error}"


def _scan(file: Path) -> Scan | None:
    """Find the messages of an MCAP file, complete or not; None where it is of another kind."""
    try:
        if kind_of(file) != "mcap":
            return None
        return scan(map_file(file))
    except (OSError, ValueError) as error:
        raise BagError(f"'{file}' cannot be read: {error}") from error


def _is_plain(found: Scan) -> bool:
    """Whether each topic has one channel with a type, and messages that begin as CDR does."""
    channels = found.channels.values()
    if len({c.topic for c in channels}) < len(channels):
        return False
    if not all(c.msgtype.count("/") == 2 and c.encoding == "cdr" for c in channels):
        return False
    return not any(
        gather(block.data, offsets + PAYLOAD, np.dtype("u1")).any()
        for block in found.blocks
        for offsets in block.offsets.values()
    )


def _is_ours(found: Scan) -> bool:
    """Whether the bench wrote a file: other recorders note what publishers offered.

    That would be lost in a repair.
    """
    return not any(c.qos.strip() not in ("", "[]") for c in found.channels.values())


def _read(file: Path, found: Scan, topics: Container[str] | None) -> Trace:
    if found.damage and not found.message_count:
        raise BagError(f"'{file}' holds no whole message: {'; '.join(found.damage)}")
    trace = Trace(complete=found.finished)
    store = typestore_of({c.msgtype: c.definition for c in found.channels.values() if c.msgtype})
    for key, channel in found.channels.items():
        if topics is not None and channel.topic not in topics:
            continue
        trace.types[channel.topic] = channel.msgtype
        stamps, payloads = _in_order(*_payloads(found, key))
        if isinstance(payloads, np.ndarray):
            add_rows(trace, channel.topic, channel.msgtype, store, stamps, payloads)
        elif payloads:
            add_opaque(trace, channel.topic, stamps, payloads)
    if found.damage:
        trace.notes.insert(0, _damage_note(trace, found))
    return trace


def _in_order(
    stamps: np.ndarray, payloads: np.ndarray | list[bytes]
) -> tuple[np.ndarray, np.ndarray | list[bytes]]:
    """Return a channel's messages in order of time; the order of the file where times are equal."""
    if bool(np.all(stamps[1:] >= stamps[:-1])):
        return stamps, payloads
    order = np.argsort(stamps, kind="stable")
    if isinstance(payloads, np.ndarray):
        return stamps[order], np.ascontiguousarray(payloads[order])
    return stamps[order], [payloads[k] for k in order]


def _damage_note(trace: Trace, found: Scan) -> str:
    last = trace.last_tick
    until = "" if last is None else f" up to tick {last}"
    text = "; ".join(found.damage)
    return f"not complete ({text}): {found.message_count} messages{until} were recovered"


def _payloads(found: Scan, channel: int) -> tuple[np.ndarray, np.ndarray | list[bytes]]:
    """Stamps (n,) and payloads of a channel: (n, size) uint8, or a list if sizes differ."""
    parts = [(b.data, b.offsets[channel]) for b in found.blocks if channel in b.offsets]
    if not parts:
        return np.empty(0, np.int64), np.empty((0, 0), np.uint8)
    stamp_type, size_type = np.dtype("<i8"), np.dtype("<u8")
    stamps = np.concatenate([gather(d, o + LOG_TIME, stamp_type) for d, o in parts])
    sizes = np.concatenate([gather(d, o + 1, size_type) for d, o in parts]).astype(int) - 22
    if np.all(sizes == sizes[0]) and sizes[0] > 0:
        item = np.dtype(f"V{sizes[0]}")
        rows = np.concatenate([gather(d, o + PAYLOAD, item) for d, o in parts])
        return stamps, rows.view(np.uint8).reshape(len(rows), -1)
    starts = [(d, int(p)) for d, o in parts for p in o + PAYLOAD]
    return stamps, [d[p : p + n].tobytes() for (d, p), n in zip(starts, sizes, strict=True)]


def read_run(path: Path) -> tuple[dict[str, Any], str]:
    """The run's metadata and outcome: from run.yaml, else from metadata.yaml's custom data."""
    folder = path if path.is_dir() else path.parent
    custom = _custom_data(folder / METADATA_FILE)
    outcome = str(custom.get(OUTCOME_KEY, ""))
    if RUN_KEY in custom:
        return dict(json.loads(custom[RUN_KEY])), outcome
    return dict(_yaml(folder / RUN_FILE) or {}), outcome


def _custom_data(file: Path) -> dict[str, str]:
    content = _yaml(file)
    for name in ("rosbag2_bagfile_information", "custom_data"):
        content = content.get(name) if isinstance(content, dict) else None
    return content if isinstance(content, dict) else {}


def _yaml(file: Path) -> Any:
    try:
        return plain(file.read_text(encoding="utf-8"))
    except (OSError, ValueError, yaml.YAMLError):
        return None
