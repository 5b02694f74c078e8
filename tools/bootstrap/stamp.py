"""The stamp beside a finished environment or workspace; what has none is never used."""

import json
import os
from pathlib import Path
from typing import Any

from bootstrap import manifest

Facts = dict[str, Any]


def file_of(top: Path) -> Path:
    """Stamp of the folder `top`."""
    return top.with_name(top.name + ".json")


def write(top: Path, **facts: Any) -> None:
    """Record what `top` holds, last of all."""
    _replace(file_of(top), {"manifest": manifest.take(top), **facts})


def read(top: Path) -> Facts | None:
    """Facts of a finished `top`; None where it is absent, half made or unreadable."""
    try:
        facts = json.loads(file_of(top).read_bytes())
        return facts if {"folders", "sizes"} <= facts["manifest"].keys() else None
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return None


def damage(top: Path, facts: Facts) -> list[str]:
    """Files below `top` that are gone or cut short since the stamp was written."""
    gone, outdated = manifest.missing(top, facts["manifest"])
    if outdated and not gone:
        _refresh(top, facts)
    return gone


def _refresh(top: Path, facts: Facts) -> None:
    """Keep the next check fast after harmless additions; a read-only project goes without."""
    folders = facts["manifest"]["folders"]
    try:
        for relative, (_, names) in folders.items():
            folders[relative] = (os.stat(top / relative).st_mtime_ns, names)
        _replace(file_of(top), facts)
    except OSError:
        return


def _replace(file: Path, content: Facts) -> None:
    """Write `content` so that a reader sees the old file or the whole new one."""
    partial = file.with_name(f"{file.name}.{os.getpid()}")
    partial.write_text(json.dumps(content, separators=(",", ":")))
    os.replace(partial, file)
