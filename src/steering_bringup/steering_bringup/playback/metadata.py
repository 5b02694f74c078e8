"""What metadata.yaml tells about how a bag was recorded."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

LATCHED = ("/tf_static", "/robot_description")
TRANSIENT_LOCAL = (1, "1", "transient_local")


def compressed(file: Path) -> bool:
    """Whether files or messages are compressed by rosbag2 itself (MCAP's chunks are not meant)."""
    return bool(_information(file).get("compression_format"))


def durable_topics(file: Path) -> frozenset[str]:
    """Return the topics whose publishers kept their last message for late subscribers."""
    names = {name for name, profiles in _profiles(file) if any(map(_is_durable, profiles))}
    return frozenset(names | set(LATCHED))


def _profiles(file: Path) -> Iterator[tuple[str, list[Any]]]:
    for entry in _information(file).get("topics_with_message_count") or ():
        topic = entry.get("topic_metadata") or {}
        profiles = topic.get("offered_qos_profiles") or []
        if isinstance(profiles, str):
            try:
                profiles = yaml.safe_load(profiles) or []
            except yaml.YAMLError:
                profiles = []
        yield str(topic.get("name", "")), profiles if isinstance(profiles, list) else []


def _is_durable(profile: Any) -> bool:
    return isinstance(profile, Mapping) and profile.get("durability") in TRANSIENT_LOCAL


def _information(file: Path) -> dict[str, Any]:
    """Return the file's content; nothing where there is none or it cannot be read."""
    try:
        content = yaml.safe_load(file.read_text(encoding="utf-8"))
        return dict(content["rosbag2_bagfile_information"])
    except (OSError, ValueError, TypeError, KeyError, yaml.YAMLError):
        return {}
