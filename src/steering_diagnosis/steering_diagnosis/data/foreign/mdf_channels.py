"""Where a channel is in an MDF file: by its name, then by group, source and index."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from steering_core.errors import BenchError
from steering_core.naming import unknown
from steering_diagnosis.data.mapping import MappedChannel

MOST_LISTED = 6
"""Places that an error lists before it says how many more there are."""

BUS_FRAMES = ("CAN_DataFrame", "LIN_Frame", "FLX_Frame", "ETH_Frame", "MOST_Message")
"""Channels that the ASAM standard for bus logging gives whole frames."""


@dataclass(frozen=True)
class Place:
    """A channel in an MDF: its group's number and its index within the group, from 0.

    file: the MDF, open. path: of the file that it is, or that it was decoded from.
    """

    file: Any
    path: Path
    group: int
    index: int

    @property
    def block(self) -> Any:
        """asammdf's channel block."""
        return _block(self.file, self.group, self.index)

    def __str__(self) -> str:
        labels = [*_labels(self.file, self.group)[:1], *_sources(self)[:1]]
        return f"group {self.group}, index {self.index}" + "".join(f", '{t}'" for t in labels)


def find(files: Sequence[Any], channel: MappedChannel, path: Path) -> Place:
    """Return the one place that a mapped channel names.

    files: the MDF, and what was decoded from its bus frames; a group's number counts in the first.
    BenchError: there is none (bus frames that were never decoded are told), or several.
    """
    name = channel.source
    named = [place for file in files for place in places(file, name, path)]
    if not named:
        known = [known for file in files for known in file.channels_db if known not in BUS_FRAMES]
        told = undecoded(files[0]) if len(files) == 1 else ""
        raise BenchError(f"'{path}': {unknown('channel', name, known)}{told}")
    found = named
    if channel.group is not None:
        groups = _groups(files, channel.group, path)
        found = [place for place in found if (place.file, place.group) in groups]
    if channel.origin:
        found = [place for place in found if channel.origin in _sources(place)]
    if channel.index is not None:
        found = [place for place in found if place.index == channel.index]
    if len(found) == 1:
        return found[0]
    if not found:
        raise BenchError(f"'{path}': channel '{name}' is not there, but in {_listed(named)}")
    raise BenchError(
        f"'{path}': channel '{name}' occurs {len(found)} times, in {_listed(found)}: say which "
        "with 'group' (number or name), 'source' or 'index'"
    )


def places(file: Any, name: str, path: Path) -> list[Place]:
    """Return the places of a name.

    A channel's own name goes before its further ones (display names, 'name' of 'name\\device',
    'structure.component').
    """
    found = list(file.channels_db.get(name, ()))
    parent, _, part = name.rpartition(".")
    for group, index in file.channels_db.get(parent, ()):
        found += [pair for pair in _inner(file, group, index) if _block(file, *pair).name == part]
    every = [Place(file, path, group, index) for group, index in dict.fromkeys(found)]
    return [place for place in every if place.block.name == name] or every


def components(place: Place) -> list[str]:
    """Return the names of what a structure is made of; empty for anything else."""
    pairs = _inner(place.file, place.group, place.index)
    return [str(_block(place.file, *pair).name) for pair in pairs]


def _inner(file: Any, group: int, index: int) -> list[tuple[int, int]]:
    """Return groups and indices of a structure's components."""
    if file.version < "4":
        return []
    # A structure's components are pairs; what an array depends on is a block.
    listed = file.groups[group].channel_dependencies[index] or ()
    return [pair for pair in listed if isinstance(pair, tuple)]


def _block(file: Any, group: int, index: int) -> Any:
    return file.groups[group].channels[index]


def undecoded(file: Any) -> str:
    """Return what is to be said of bus frames in a file; empty where there are none."""
    found = []
    for frame in BUS_FRAMES:
        groups = sorted({group for group, _ in file.channels_db.get(frame, ())})
        count = sum(file.groups[group].channel_group.cycles_nr for group in groups)
        if count:
            bus = frame.partition("_")[0]
            found.append(f"{count} {bus} frames in group {', '.join(map(str, groups))}")
    if not found:
        return ""
    return (
        f"; the file holds {' and '.join(found)} that were never decoded into channels: name the "
        "CAN database with 'database: FILE.dbc' in the mapping, or decode them in the logger's tool"
    )


def _groups(files: Sequence[Any], wanted: int | str, path: Path) -> set[tuple[Any, int]]:
    """Return files and numbers of the groups that a number or a name means."""
    if isinstance(wanted, int):
        count = len(files[0].groups)
        if wanted >= count:
            raise BenchError(f"'{path}': there is no group {wanted}; they are 0 to {count - 1}")
        return {(files[0], wanted)}
    labels = {(file, k): _labels(file, k) for file in files for k in range(len(file.groups))}
    exact = {group for group, texts in labels.items() if wanted in texts}
    held = {group for group, texts in labels.items() if any(wanted in text for text in texts)}
    if not held:
        known = {text for texts in labels.values() for text in texts}
        raise BenchError(f"'{path}': {unknown('group', wanted, known)}")
    return exact or held


def _labels(file: Any, group: int) -> list[str]:
    """Return what a group is called: its acquisition, the source of it, its comment."""
    block = file.groups[group].channel_group
    source = getattr(block, "acq_source", None)
    texts = [getattr(block, "acq_name", ""), *_named(source), _plain(block.comment or "")]
    return _filled(texts)


def _sources(place: Place) -> list[str]:
    """Return what the source of a channel is called: its path and name, or its group's."""
    group = place.file.groups[place.group].channel_group
    return _filled([*_named(place.block.source), *_named(getattr(group, "acq_source", None))])


def _named(source: Any) -> list[str]:
    return [] if source is None else [source.path, source.name]


def _plain(comment: str) -> str:
    """Return the text of a comment, which may be XML: <CGcomment><TX>text</TX></CGcomment>."""
    marked = re.search(r"<TX>(.*?)</TX>", comment, re.DOTALL)
    return marked.group(1) if marked else comment


def _filled(texts: Iterable[str]) -> list[str]:
    return list(dict.fromkeys(text.strip() for text in texts if text and text.strip()))


def _listed(found: list[Place]) -> str:
    shown = "; ".join(str(place) for place in found[:MOST_LISTED])
    more = len(found) - MOST_LISTED
    return shown + (f"; and {more} more" if more > 0 else "")
