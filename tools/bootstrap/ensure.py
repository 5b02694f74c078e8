"""Finds out quickly whether environment and workspace are whole; if not, sets them up."""

from pathlib import Path
from typing import NamedTuple

from bootstrap import fingerprint, locks, stamp
from bootstrap.errors import SetupError
from bootstrap.layout import Layout


class Ready(NamedTuple):
    """Folders of a whole environment and workspace, in use for the life of this process."""

    environment: Path
    workspace: Path


def ensure(layout: Layout, thorough: bool = False) -> Ready:
    """Return what is ready, after setting up or repairing what is not.

    `thorough` compares every installed file with its recorded hash.
    """
    ready = names(layout)
    if thorough or not (_mark(ready) and whole(ready)):
        # Only here, as the common call shall not wait for the modules of set-up.
        from bootstrap.set_up import set_up

        set_up(layout, ready, thorough)
        if not _mark(ready):
            raise SetupError(f"{ready.environment} is being removed; run this again")
    return ready


def names(layout: Layout) -> Ready:
    """Where environment and workspace of the present inputs belong."""
    for file in layout.locks():
        if not file.is_file():
            raise SetupError(f"{file} is missing: restore it, for example by git checkout")
    key = fingerprint.environment_key(layout)
    built = fingerprint.workspace_key(layout, key)
    return Ready(layout.state / f"env-{key}", layout.state / f"ws-{built}")


def whole(ready: Ready) -> bool:
    """True where both are finished and have lost no file."""
    for top in ready:
        facts = stamp.read(top)
        if facts is None or stamp.damage(top, facts):
            return False
    return True


def _mark(ready: Ready) -> bool:
    if not ready.environment.parent.is_dir():
        return False
    return all(locks.mark_in_use(top) is not None for top in ready)
