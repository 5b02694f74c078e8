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
from steering_bringup.bags.trace import Trace
from steering_bringup.bags.writer import OUTCOME_KEY, RUN_KEY


def read_bag(
    path: str | Path, *, repair_damage: bool = True, topics: Container[str] | None = None
) -> Trace:
    """Read a bag (folder or .mcap file) into a Trace.

    topics: what to read; the messages of others are not looked at. None: all.

    A bag that a crash cut off is read as far as it goes, says so in `notes`, and is repaired in
    place for other readers (`repair`: the original bytes are kept), unless `repair_damage` is
    False, the file lies alone, or a process is still writing it.
    Raises BagError, naming the path, if there is no bag or nothing readable in it.
    """
    path = Path(path)
    file = mcap_file(path)
    if file is None:
        return read_foreign(path, topics)
    trace = read_mcap(file, topics)
    trace.path = path
    trace.run, trace.outcome = read_run(path)
    if trace.complete and path.is_dir() and not (path / METADATA_FILE).exists():
        trace.complete = False
        trace.notes.insert(0, "not complete (metadata.yaml is missing): every message is there")
    if not trace.complete and repair_damage and path.is_dir():
        if is_being_written(file):
            trace.notes.append("the bag is still being written")
        else:
            trace.notes.append(_try_repair(path))
    return trace


def _try_repair(path: Path) -> str:
    try:
        return str(repair(path))
    except BagError as error:
        return f"not repaired: {error}"


def mcap_file(path: Path) -> Path | None:
    """The MCAP file of a bag; None if the path holds a bag of another kind."""
    if not path.exists():
        raise BagError(f"there is no bag '{path}'")
    if path.is_file():
        return path if path.suffix == ".mcap" else None
    files = sorted(path.glob("*.mcap"))
    if len(files) == 1:
        return files[0]
    if not files and not any(path.glob("*.db3")) and not (path / METADATA_FILE).exists():
        raise BagError(f"'{path}' is no bag: it holds no .mcap file")
    return None


def read_mcap(file: Path, topics: Container[str] | None = None) -> Trace:
    """Read one MCAP file, complete or not."""
    try:
        found = scan(map_file(file))
    except (OSError, ValueError) as error:
        raise BagError(f"'{file}' cannot be read: {error}") from error
    if found.damage and not found.message_count:
        raise BagError(f"'{file}' holds no whole message: {'; '.join(found.damage)}")
    trace = Trace(complete=found.finished)
    store = typestore_of({c.msgtype: c.definition for c in found.channels.values() if c.msgtype})
    for key, channel in found.channels.items():
        if topics is not None and channel.topic not in topics:
            continue
        trace.types[channel.topic] = channel.msgtype
        stamps, payloads = _payloads(found, key)
        if isinstance(payloads, np.ndarray):
            add_rows(trace, channel.topic, channel.msgtype, store, stamps, payloads)
        elif payloads:
            add_opaque(trace, channel.topic, stamps, payloads)
    if found.damage:
        trace.notes.insert(0, _damage_note(trace, found))
    return trace


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
    information = (_yaml(file) or {}).get("rosbag2_bagfile_information") or {}
    return information.get("custom_data") or {}


def _yaml(file: Path) -> Any:
    try:
        return yaml.load(file.read_text(encoding="utf-8"), Loader=_LOADER)
    except (OSError, yaml.YAMLError):
        return None


_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
