"""The scenarios and node sets that come with the bench: their files and descriptions."""

from __future__ import annotations

from importlib import resources
from pathlib import Path

from steering_core.plain_yaml import plain

FOLDERS = {"scenario": "scenarios", "node set": "nodesets"}


def shipped(what: str) -> dict[str, Path]:
    """Return name to file of the shipped scenarios ("scenario") or node sets ("node set")."""
    folder = Path(str(resources.files("steering_bringup") / FOLDERS[what]))
    return {path.stem: path for path in sorted(folder.glob("*.yaml"))}


def descriptions(what: str) -> dict[str, str]:
    """Return name to description, read without the schema: a list must be quick."""
    return {
        name: str(plain(path.read_text(encoding="utf-8")).get("description", ""))
        for name, path in shipped(what).items()
    }
