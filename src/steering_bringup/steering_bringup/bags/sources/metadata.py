"""What metadata.yaml tells about a bag; where it is broken, that, and whatever is still in it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from steering_bringup.bags.sources.qos import Kept, kept_of
from steering_core.plain_yaml import plain

INFORMATION = "rosbag2_bagfile_information"


@dataclass(frozen=True)
class Metadata:
    """``files``: names of the bag's files as they are written there; ``counts``: their messages.

    ``kept``: topic -> what its publishers kept. ``messages``: of the whole bag, None: not told.
    ``problem``: why the file cannot be used.
    """

    files: tuple[str, ...] = ()
    counts: Mapping[str, int] = field(default_factory=dict)
    kept: Mapping[str, Kept] = field(default_factory=dict)
    messages: int | None = None
    problem: str = ""


def read_metadata(file: Path) -> Metadata:
    """Return what a bag's metadata.yaml of any version tells; nothing where there is no file."""
    try:
        content = plain(file.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return Metadata()
    except OSError as error:
        return Metadata(problem=str(error.strerror))
    except UnicodeDecodeError:
        return Metadata(problem="it is no text")
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        mark = getattr(error, "problem_mark", None)
        return Metadata(problem=f"line {mark.line + 1} is no YAML" if mark else "it is no YAML")
    information = content.get(INFORMATION) if isinstance(content, Mapping) else None
    if not isinstance(information, Mapping):
        return Metadata(problem=f"it has no {INFORMATION}" if content else "it is empty")
    entries = list(_mappings(information.get("files")))
    listed = information.get("relative_file_paths")
    names = listed if isinstance(listed, list) and listed else [e.get("path") for e in entries]
    count = information.get("message_count")
    return Metadata(
        tuple(name for name in names if isinstance(name, str) and name),
        {
            own_name(str(entry.get("path"))): number
            for entry in entries
            if isinstance(number := entry.get("message_count"), int)
        },
        dict(_kept(information)),
        count if isinstance(count, int) else None,
    )


def _kept(information: Mapping[str, Any]) -> Iterable[tuple[str, Kept]]:
    for entry in _mappings(information.get("topics_with_message_count")):
        topic = entry.get("topic_metadata")
        if isinstance(topic, Mapping) and topic.get("offered_qos_profiles"):
            yield str(topic.get("name")), kept_of(topic["offered_qos_profiles"])


def _mappings(items: Any) -> Iterable[Mapping[str, Any]]:
    return (i for i in items if isinstance(i, Mapping)) if isinstance(items, list) else ()


def own_name(path: str) -> str:
    """Return a file's own name; other systems write other separators."""
    return path.replace("\\", "/").rpartition("/")[2]
