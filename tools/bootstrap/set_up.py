"""Makes or repairs environment and workspace, one process at a time."""

import os
import shutil
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

from bootstrap import environment, fingerprint, locks, machine, stamp, workspace
from bootstrap.ensure import Ready, whole
from bootstrap.layout import Layout
from bootstrap.logged import LoggedRunner
from bootstrap.progress import say
from bootstrap.removal import remove_outdated

KEPT_LOGS = 10


def set_up(layout: Layout, ready: Ready, thorough: bool) -> None:
    """Bring both parts up to date; waits while another process does so."""
    layout.state.mkdir(exist_ok=True)
    # Plain colcon in the project's root must not take the links in here for packages.
    (layout.state / "COLCON_IGNORE").touch()
    with locks.setting_up(layout.state / "lock") as lock:
        if thorough or not whole(ready):
            machine.check(layout)
            with _ended_by_signal():
                _bring_up_to_date(layout, ready, lock, thorough)


def _bring_up_to_date(layout: Layout, ready: Ready, lock: int, thorough: bool) -> None:
    begin = time.monotonic()
    shutil.rmtree(layout.state / "tmp", ignore_errors=True)
    (layout.state / "tmp").mkdir()
    runner = LoggedRunner(_new_log(layout), lock)
    changed = _environment(layout, ready.environment, runner, thorough)
    facts = stamp.read(ready.workspace)
    if changed or facts is None or stamp.damage(ready.workspace, facts):
        workspace.build(layout, ready.environment, ready.workspace, runner)
        say(f"ready after {time.monotonic() - begin:.0f} s")
    remove_outdated(layout.state, set(ready), fingerprint.python_name())
    _link(layout.state / "env", ready.environment)


def _environment(layout: Layout, top: Path, runner: LoggedRunner, thorough: bool) -> bool:
    """Make or repair the environment; True where the workspace has to be built again."""
    facts = stamp.read(top)
    if facts is None:
        say("setting up, about two minutes; later starts take no time")
        environment.build(layout, top, runner)
        return True
    gone = stamp.damage(top, facts)
    if gone or (thorough and environment.full_check(layout, top, facts)):
        say(f"the environment is damaged: {gone[0] + ' is gone' if gone else 'files changed'}")
        environment.repair(layout, top, facts, runner)
        return True
    return False


@contextmanager
def _ended_by_signal() -> Iterator[None]:
    """Let SIGTERM leave through the clean-up that ends pip or colcon."""
    previous = signal.signal(signal.SIGTERM, _leave)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, previous)


def _leave(number: int, _: FrameType | None) -> None:
    sys.exit(128 + number)


def _new_log(layout: Layout) -> Path:
    layout.logs.mkdir(parents=True, exist_ok=True)
    for old in sorted(layout.logs.glob("setup-*.log"))[: -KEPT_LOGS + 1]:
        old.unlink(missing_ok=True)
    return layout.logs / time.strftime(f"setup-%Y%m%d-%H%M%S-{os.getpid()}.log")


def _link(link: Path, target: Path) -> None:
    """Let `link` point at the current environment, for editors and curious people."""
    partial = link.with_name(f"{link.name}.{os.getpid()}")
    partial.unlink(missing_ok=True)
    partial.symlink_to(target.name)
    os.replace(partial, link)
