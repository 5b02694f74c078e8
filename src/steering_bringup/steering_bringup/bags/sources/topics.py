"""The topics of a bag's files, told apart by what the files say of them, not by a bare name."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from typing import Protocol

from steering_bringup.bags.chunks import Channel
from steering_bringup.bags.definitions import typestore_of
from steering_bringup.bags.meaning import Field, fields_of_definition, first_difference
from steering_bringup.bags.sources.qos import Kept, is_latched_by_name, kept_of


@dataclass(frozen=True)
class TopicInfo:
    """A topic of a bag. ``definition``: the message's text, ``digest``: its type's hash, if told.

    ``durable``: its publisher kept messages for late subscribers (transient local), ``depth`` of
    them, 0: not told.
    """

    name: str
    msgtype: str
    count: int
    encoding: str = "cdr"
    definition: str = ""
    digest: str = ""
    durable: bool = False
    depth: int = 0


class _File(Protocol):
    channels: dict[int, Channel]
    counts: dict[int, int]


class Topics:
    """Joins the channels of several files. ``kept``: what metadata.yaml tells, by topic."""

    def __init__(self, kept: Mapping[str, Kept]) -> None:
        self._kept = kept
        self._found: list[TopicInfo] = []

    def take(self, file: _File) -> dict[int, int]:
        """Take a file's channels; return the place of each channel's topic."""
        places: dict[int, int] = {}
        kept: dict[int, list[Kept]] = {}
        for key, channel in file.channels.items():
            place = self._place(channel)
            places[key] = place
            kept.setdefault(place, []).append(kept_of(channel.qos))
            info = self._found[place]
            self._found[place] = replace(info, count=info.count + file.counts.get(key, 0))
        for place, tells in kept.items():
            # Several channels of a file are several publishers: nobody knows whose is whose.
            here = tells[0] if len(tells) == 1 else Kept(any(k.durable for k in tells))
            info = self._found[place]
            known = Kept(info.durable, info.depth)
            both = known.joined(here) if known.durable else here
            self._found[place] = replace(info, durable=both.durable, depth=both.depth)
        return places

    def labelled(self) -> tuple[dict[str, TopicInfo], list[str]]:
        """Return the topics by label, and the label of each place.

        The name is the label of the one with most messages, those that are CDR first; others of
        this name have their type behind it.
        """
        infos = [self._with_metadata(info) for info in self._found]
        labels = [""] * len(infos)
        for place in sorted(range(len(infos)), key=lambda k: _rank(infos[k])):
            labels[place] = _label(infos[place], labels)
        return dict(zip(labels, infos, strict=True)), labels

    def _place(self, channel: Channel) -> int:
        """Return the place of the topic that a channel is of; a new one at the end."""
        made = TopicInfo(
            channel.topic,
            _full_name(channel.msgtype),
            0,
            channel.encoding.strip().lower(),
            channel.definition,
            channel.digest,
        )
        for place, info in enumerate(self._found):
            if _same(info, made):
                return place
        self._found.append(made)
        return len(self._found) - 1

    def _with_metadata(self, info: TopicInfo) -> TopicInfo:
        told = self._kept.get(info.name, Kept())
        known = Kept(info.durable, info.depth)
        both = told if told.durable else known
        durable = both.durable or is_latched_by_name(info.name)
        return replace(info, durable=durable, depth=both.depth)


def _same(one: TopicInfo, other: TopicInfo) -> bool:
    if (one.name, one.msgtype, one.encoding) != (other.name, other.msgtype, other.encoding):
        return False
    if one.definition == other.definition or not one.definition or not other.definition:
        return True
    try:
        return not first_difference(_fields(one), _fields(other))
    except KeyError:
        return False


def _fields(info: TopicInfo) -> tuple[Field, ...]:
    store = typestore_of({info.msgtype: info.definition})
    return fields_of_definition(info.msgtype, store.fielddefs)


def _label(info: TopicInfo, taken: Collection[str]) -> str:
    kind = f"{info.msgtype or 'no type'}, {info.encoding or 'no encoding'}"
    label, number = info.name, 1
    while label in taken:
        label = f"{info.name} ({kind})" if number == 1 else f"{info.name} ({kind}, {number})"
        number += 1
    return label


def _rank(info: TopicInfo) -> tuple[bool, int]:
    return info.encoding != "cdr" or not info.msgtype, -info.count


def _full_name(msgtype: str) -> str:
    """Return a type's name with its middle part, which some tools leave out."""
    package, *rest = msgtype.replace("::", "/").split("/")
    return f"{package}/msg/{rest[0]}" if len(rest) == 1 else "/".join((package, *rest))
