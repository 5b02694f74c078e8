"""Removes what set-up made, without touching what another process still uses."""

import shutil
from pathlib import Path

from bootstrap import locks, stamp


def remove(top: Path) -> None:
    """Remove a folder of set-up; its stamp goes first, so that a rest is never taken for whole."""
    stamp.file_of(top).unlink(missing_ok=True)
    if top.exists():
        shutil.rmtree(top)


def remove_others(state: Path, keep: set[Path]) -> None:
    """Remove environments and workspaces that are neither kept nor in use."""
    for pattern in ("env-*", "ws-*"):
        for top in state.glob(pattern):
            if top.is_dir() and top not in keep:
                remove_if_unused(top)


def remove_if_unused(top: Path) -> bool:
    """Remove `top` unless a running command uses it; True where it is gone."""
    with locks.unused(top) as free:
        if free:
            remove(top)
            top.with_name(top.name + ".in-use").unlink(missing_ok=True)
        return free
