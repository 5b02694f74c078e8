"""What recorded publishers kept for late subscribers, out of rosbag2's offered profiles."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import yaml

from steering_core.plain_yaml import plain

LATCHED = ("/tf_static", "/robot_description")
"""Names whose publishers keep their last message by convention."""

TRANSIENT_LOCAL = ("1", "transient_local")
KEEP_LAST = ("1", "keep_last")


@dataclass(frozen=True)
class Kept:
    """``durable``: late subscribers get what was kept (transient local).

    ``depth``: how many messages of one publisher; 0: not told, or there were several publishers
    and the bag does not tell whose message is whose.
    """

    durable: bool = False
    depth: int = 0

    def joined(self, other: Kept) -> Kept:
        """Return what holds for a topic of which two places tell."""
        if self.durable != other.durable:
            return self if self.durable else other
        return Kept(self.durable, self.depth if self.depth == other.depth else 0)


def kept_of(profiles: Any) -> Kept:
    """Return it of ``offered_qos_profiles``: a list, or its YAML text; numbers or words in it."""
    if isinstance(profiles, str):
        try:
            profiles = plain(profiles)
        except yaml.YAMLError:
            profiles = None
    entries = [profiles] if isinstance(profiles, Mapping) else profiles
    durable = [
        p
        for p in (entries if isinstance(entries, list) else ())
        if isinstance(p, Mapping) and _is(p, "durability")
    ]
    if len(durable) != 1:
        return Kept(bool(durable))
    depth = durable[0].get("depth")
    if isinstance(depth, int) and depth > 0 and _is(durable[0], "history", KEEP_LAST):
        return Kept(True, depth)
    return Kept(True)


def is_latched_by_name(topic: str) -> bool:
    """Whether a topic's name alone says that its last message is kept."""
    return topic.endswith(LATCHED)


def _is(profile: Mapping[str, Any], key: str, values: tuple[str, ...] = TRANSIENT_LOCAL) -> bool:
    return str(profile.get(key)).strip().lower() in values
