"""Removes what set-up made, without touching what another process still uses."""

import shutil
from pathlib import Path

from bootstrap import locks, stamp


def remove(top: Path) -> None:
    """Remove a folder of set-up; its stamp goes first, so that a rest is never taken for whole."""
    stamp.file_of(top).unlink(missing_ok=True)
    if top.is_symlink():
        top.unlink()  # what it leads to belongs to another project
    elif top.exists():
        shutil.rmtree(top)


def remove_outdated(state: Path, keep: set[Path], python: str) -> None:
    """Remove what newer inputs replaced, and what was never finished.

    Of another Python than `python` the environment stays, so that two can be used in turn; a
    workspace goes with its environment.
    """
    for top in state.glob("env-*/"):
        facts = stamp.read(top)
        if top not in keep and (facts is None or facts.get("python") == python):
            remove_if_unused(top)
    for top in state.glob("ws-*/"):
        facts = stamp.read(top) or {}
        environment = state / str(facts.get("environment"))
        if top not in keep and (environment in keep or not environment.is_dir()):
            remove_if_unused(top)


def remove_if_unused(top: Path) -> bool:
    """Remove `top` unless a running command uses it; True where it is gone."""
    with locks.unused(top) as free:
        if free:
            remove(top)
            top.with_name(top.name + ".in-use").unlink(missing_ok=True)
        return free
