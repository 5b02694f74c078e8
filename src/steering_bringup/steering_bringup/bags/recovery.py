"""Repairing a bag that a crash cut off, without touching the bytes that are there."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml

from steering_bringup.bags.append_file import is_being_written
from steering_bringup.bags.errors import BagError
from steering_bringup.bags.mcap_bytes import PAYLOAD, gather, map_file
from steering_bringup.bags.places import METADATA_FILE, RUN_FILE
from steering_bringup.bags.scan import Block, Scan, scan
from steering_bringup.bags.writer import BagWriter
from steering_core.plain_yaml import plain

DAMAGED_SUFFIX = ".damaged"


@dataclass(frozen=True)
class Recovery:
    """What a repair did. `ticks`: ticks from the first to the last message at 1 kHz."""

    path: Path
    original: Path
    messages: int
    last_stamp_ns: int
    damage: tuple[str, ...]

    @property
    def ticks(self) -> int:
        """Ticks of 1 ms up to and with the last message."""
        return self.last_stamp_ns // 1_000_000 + 1

    def __str__(self) -> str:
        return (
            f"repaired: {self.messages} messages, {self.ticks} ticks, are a readable bag again; "
            f"the original bytes are kept in {self.original.name}"
        )


def repair(path: str | Path) -> Recovery:
    """Make a cut-off bag folder readable for every tool.

    The whole messages go into a new NAME.mcap with metadata.yaml; the original file is kept as
    NAME.mcap.damaged. An interruption at any moment leaves the original as it was.
    Raises BagError if the bag is being written, is complete, or holds no whole message.
    """
    folder = Path(path)
    files = sorted(folder.glob("*.mcap")) if folder.is_dir() else []
    if len(files) != 1:
        raise BagError(f"'{folder}' is no bag folder with one .mcap file")
    file = files[0]
    if is_being_written(file):
        raise BagError(f"'{file}' is still being written")
    found = _scan(file)
    if found.finished and (folder / METADATA_FILE).exists():
        raise BagError(f"'{folder}' is complete: there is nothing to repair")
    if not found.message_count:
        raise BagError(f"'{file}' holds no whole message")
    _check_channels(file, found)
    try:
        return _rebuild(folder, file, found)
    except OSError as error:
        raise BagError(f"'{folder}' cannot be repaired: {error.strerror}") from error


def _scan(file: Path) -> Scan:
    """Find what is whole in a file; the bytes stay mapped while the file gets another name."""
    try:
        return scan(map_file(file))
    except (OSError, ValueError) as error:
        raise BagError(f"'{file}' cannot be repaired: {error}") from error


def _check_channels(file: Path, found: Scan) -> None:
    """Refuse what the bench's writer would change: it knows CDR, and one type a topic."""
    types: dict[str, str] = {}
    for channel in found.channels.values():
        known = types.setdefault(channel.topic, channel.msgtype)
        if channel.encoding != "cdr" or not channel.msgtype or channel.msgtype != known:
            raise BagError(
                f"'{file}' is not repaired: its topic {channel.topic} has no type, two types or "
                "messages that are no CDR; it can be read and played as it is"
            )


def _rebuild(folder: Path, file: Path, found: Scan) -> Recovery:
    # The new bag is made in a scratch folder of the same name inside the bag, so that the files
    # can be moved into place, each by one rename, once they are whole.
    scratch = folder / f".repair.{os.getpid()}"
    made = scratch / file.stem
    try:
        last = _write_messages(made, found, _run_of(folder))
        original = _keep(file)
        (made / file.name).replace(file)
        (made / METADATA_FILE).replace(folder / METADATA_FILE)
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
    return Recovery(folder, original, found.message_count, last, tuple(found.damage))


def _keep(file: Path) -> Path:
    """Give the original file a second name that is not taken; return it."""
    kept = file.with_name(file.name + DAMAGED_SUFFIX)
    number = 1
    while kept.exists():
        number += 1
        kept = file.with_name(f"{file.name}{DAMAGED_SUFFIX}.{number}")
    try:
        os.link(file, kept)
    except OSError:
        # Some file systems have no hard links.
        shutil.copy2(file, kept)
    return kept


def _write_messages(target: Path, found: Scan, run: dict[str, object]) -> int:
    topics = {c.topic: c.msgtype for c in found.channels.values()}
    definitions = {c.msgtype: c.definition for c in found.channels.values()}
    last = 0
    with BagWriter(target, topics, run, definitions=definitions) as writer:
        writer.outcome = "recovered: " + ("; ".join(found.damage) or "metadata.yaml was missing")
        for block in found.blocks:
            for topic, stamp, payload in _in_file_order(block, found):
                writer.write(topic, stamp, payload)
                last = max(last, stamp)
    return last


def _in_file_order(block: Block, found: Scan) -> Iterator[tuple[str, int, memoryview]]:
    """Messages of a block in the order in which they were recorded."""
    channels = np.concatenate([np.full(len(o), c) for c, o in block.offsets.items()])
    offsets = np.concatenate(list(block.offsets.values()))
    order = np.argsort(offsets, kind="stable")
    channels, offsets = channels[order], offsets[order]
    sizes = gather(block.data, offsets + 1, np.dtype("<u8")).astype(int) - 22
    stamps = gather(block.data, offsets + 15, np.dtype("<i8")).tolist()
    topics = {key: channel.topic for key, channel in found.channels.items()}
    for channel, offset, size, stamp in zip(
        channels.tolist(), offsets.tolist(), sizes.tolist(), stamps, strict=True
    ):
        if channel in topics:
            yield topics[channel], stamp, block.data[offset + PAYLOAD : offset + PAYLOAD + size]


def _run_of(folder: Path) -> dict[str, object]:
    try:
        return dict(plain((folder / RUN_FILE).read_text(encoding="utf-8")) or {})
    except (OSError, yaml.YAMLError):
        return {}
