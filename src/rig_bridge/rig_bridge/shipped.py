"""The rigs that come with the bench. Light: a list must be quick."""

from __future__ import annotations

import re
from pathlib import Path

from steering_core.errors import BenchError
from steering_core.naming import unknown

FOLDER = Path(__file__).resolve().parent / "rigs"


def shipped_rigs() -> dict[str, Path]:
    """Return name to file; a file without channels is an emulator's own."""
    files = sorted(FOLDER.glob("*.yaml"))
    return {path.stem: path for path in files if _entry("channels", path) is not None}


def description(path: Path) -> str:
    """Return what a rig's file says of itself in a line."""
    return _entry("description", path) or ""


def find_rig(name: str) -> Path:
    """Return the file of a shipped rig's name or of a path; BenchError suggests the nearest."""
    path = Path(name)
    if path.suffix in (".yaml", ".yml") or path.is_file():
        if not path.is_file():
            raise BenchError(f"there is no rig's file '{name}'")
        return path
    known = shipped_rigs()
    if name not in known:
        raise BenchError(f"{unknown('rig', name, known)} (or give a .yaml file)")
    return known[name]


def _entry(key: str, path: Path) -> str | None:
    found = re.search(rf"^{key}:(.*)$", path.read_text(encoding="utf-8"), re.MULTILINE)
    return None if found is None else found.group(1).strip(" \"'")
