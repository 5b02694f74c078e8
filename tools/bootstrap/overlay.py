"""A person's own ROS workspace on top of the bench's: what of their shell is kept for it."""

import os
from collections.abc import Iterable, Mapping
from pathlib import Path

from bootstrap.layout import Layout

PATHS = ("PYTHONPATH", "AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH", "LD_LIBRARY_PATH")


def search_paths(layout: Layout, base: Mapping[str, str]) -> dict[str, str]:
    """Return the search paths of workspaces that were built on the bench's environment.

    In a shell of ``./steer env``, which has the bench among its prefixes, that is everything but
    the bench itself. Elsewhere a workspace tells what it was built on, and only its own folders
    count: whatever else is there may be another ROS.
    """
    if layout.system_ros:
        return {}
    given = {name: _entries(base.get(name, "")) for name in PATHS}
    prefixes = given["AMENT_PREFIX_PATH"]
    mine = (layout.state, layout.source)
    if not any(_below(prefix, mine) for prefix in prefixes):
        workspaces = [_workspace(Path(p)) for p in prefixes if _is_built_on(Path(p), layout.state)]
        given = {name: [e for e in found if _below(e, workspaces)] for name, found in given.items()}
    return {
        name: os.pathsep.join(e for e in entries if not _below(e, mine))
        for name, entries in given.items()
    }


def _entries(text: str) -> list[str]:
    return [entry for entry in text.split(os.pathsep) if entry]


def _below(entry: str, folders: Iterable[Path]) -> bool:
    return any(Path(entry).is_relative_to(folder) for folder in folders)


def _workspace(prefix: Path) -> Path:
    """Return the workspace of an install prefix: of all its packages, or of one of them."""
    merged = (prefix / "local_setup.sh").is_file()
    return prefix.parent if merged else prefix.parent.parent


def _is_built_on(prefix: Path, state: Path) -> bool:
    """Return whether the files that colcon and ament leave name a folder below ``state``."""
    index = prefix / "share" / "ament_index" / "resource_index" / "parent_prefix_path"
    files = [*index.glob("*"), prefix / "setup.sh", prefix.parent / "setup.sh"]
    return any(f"{state}{os.sep}" in _text(file) for file in files)


def _text(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""
