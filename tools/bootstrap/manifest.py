"""Notices deleted files quickly: a folder whose time stamp is unchanged has lost nothing."""

import os
from pathlib import Path
from typing import TypedDict

CACHES = "__pycache__"


class Manifest(TypedDict):
    """Folders relative to the top: [time stamp in ns, names]; sizes of shared libraries."""

    folders: dict[str, tuple[int, list[str]]]
    sizes: dict[str, int]


def take(top: Path) -> Manifest:
    """Record every name below `top`, apart from compiled Python, which Python makes again."""
    result = Manifest(folders={}, sizes={})
    for folder, subfolders, files in os.walk(top):
        subfolders[:] = [name for name in subfolders if name != CACHES]
        relative = os.path.relpath(folder, top)
        names = sorted(subfolders + files)
        result["folders"][relative] = (os.stat(folder).st_mtime_ns, names)
        for name in files:
            if ".so" in name:
                path = os.path.normpath(os.path.join(relative, name))
                result["sizes"][path] = os.stat(os.path.join(top, path)).st_size
    return result


def missing(top: Path, manifest: Manifest) -> tuple[list[str], bool]:
    """Names that are gone or cut short, and whether harmless changes made the stamps outdated."""
    gone: list[str] = []
    outdated = False
    for relative, (stamp, names) in manifest["folders"].items():
        folder = os.path.join(top, relative)
        try:
            now = os.stat(folder).st_mtime_ns
        except OSError:
            gone.append(relative)
            continue
        if now != stamp:
            outdated = True
            present = set(os.listdir(folder))
            gone += [os.path.join(relative, name) for name in names if name not in present]
    return gone + _shortened(top, manifest["sizes"]), outdated


def _shortened(top: Path, sizes: dict[str, int]) -> list[str]:
    """Shared libraries whose size is not the recorded one (broken links included)."""
    changed = []
    for relative, size in sizes.items():
        try:
            same = os.stat(os.path.join(top, relative)).st_size == size
        except OSError:
            same = False
        if not same:
            changed.append(relative)
    return changed
