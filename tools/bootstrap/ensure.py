"""Makes sure that environment and workspace are whole: quickly if they are, else by set-up."""

import os
import signal
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

from bootstrap import environment, fingerprint, locks, stamp, tools_present, workspace
from bootstrap.errors import SetupError
from bootstrap.layout import Layout
from bootstrap.logged import LoggedRunner
from bootstrap.progress import say
from bootstrap.removal import remove_others

KEPT_LOGS = 10


@dataclass(frozen=True)
class Ready:
    """A whole environment and workspace, marked as in use for the life of this process."""

    environment: Path
    workspace: Path


def ensure(layout: Layout, thorough: bool = False) -> Ready:
    """Return what is ready, after setting up or repairing what is not.

    `thorough` compares every installed file with its recorded hash.
    """
    ready = _names(layout)
    if not thorough and _mark(ready) and _whole(ready):
        return ready
    layout.state.mkdir(exist_ok=True)
    (layout.state / "COLCON_IGNORE").touch()
    with locks.setting_up(layout.state / "lock") as lock:
        _set_up(layout, ready, lock, thorough)
        if not _mark(ready):
            raise SetupError(f"{ready.environment} is being removed; run this again")
    return ready


def _names(layout: Layout) -> Ready:
    for file in layout.locks():
        if not file.is_file():
            raise SetupError(f"{file} is missing: restore it, for example by git checkout")
    key = fingerprint.environment_key(layout)
    built = fingerprint.workspace_key(layout, key)
    return Ready(layout.state / f"env-{key}", layout.state / f"ws-{built}")


def _mark(ready: Ready) -> bool:
    if not ready.environment.parent.is_dir():
        return False
    return all(locks.mark_in_use(top) is not None for top in (ready.environment, ready.workspace))


def _whole(ready: Ready) -> bool:
    for top in (ready.environment, ready.workspace):
        facts = stamp.read(top)
        if facts is None or stamp.damage(top, facts):
            return False
    return True


def _set_up(layout: Layout, ready: Ready, lock: int, thorough: bool) -> None:
    """Bring both parts up to date; the caller holds the lock."""
    if not thorough and _whole(ready):
        return
    tools_present.check(layout)
    begin = time.monotonic()
    runner = LoggedRunner(_new_log(layout), lock)
    previous = signal.signal(signal.SIGTERM, _leave)
    try:
        changed = _environment(layout, ready.environment, runner, thorough)
        facts = stamp.read(ready.workspace)
        if changed or facts is None or stamp.damage(ready.workspace, facts):
            workspace.build(layout, ready.environment, ready.workspace, runner)
    finally:
        signal.signal(signal.SIGTERM, previous)
    remove_others(layout.state, {ready.environment, ready.workspace})
    _link(layout.state / "env", ready.environment)
    say(f"ready after {time.monotonic() - begin:.0f} s")


def _environment(layout: Layout, top: Path, runner: LoggedRunner, thorough: bool) -> bool:
    """Make or repair the environment; True where the workspace has to be built again."""
    facts = stamp.read(top)
    if facts is None:
        say("setting up, about two minutes; later starts take no time")
        environment.build(layout, top, runner)
        return True
    gone = stamp.damage(top, facts)
    if gone or (thorough and environment.full_check(layout, top, facts)):
        say(f"the environment is damaged ({gone[0]} is gone)" if gone else "damage found")
        environment.repair(layout, top, facts, runner)
        return True
    return False


def _leave(number: int, _: FrameType | None) -> None:
    sys.exit(128 + number)


def _new_log(layout: Layout) -> Path:
    layout.logs.mkdir(parents=True, exist_ok=True)
    (layout.state / "tmp").mkdir(exist_ok=True)
    for old in sorted(layout.logs.glob("setup-*.log"))[: -KEPT_LOGS + 1]:
        old.unlink(missing_ok=True)
    return layout.logs / time.strftime(f"setup-%Y%m%d-%H%M%S-{os.getpid()}.log")


def _link(link: Path, target: Path) -> None:
    """Let `link` point at the current environment, for editors and curious people."""
    partial = link.with_name(f"{link.name}.{os.getpid()}")
    partial.unlink(missing_ok=True)
    partial.symlink_to(target.name)
    os.replace(partial, link)
