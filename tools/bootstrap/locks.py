"""Locks between several ./steer at once: one sets up, any number run."""

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from bootstrap.progress import say


@contextmanager
def setting_up(file: Path) -> Iterator[int]:
    """Hold the only right to change the environment; yields the descriptor.

    Children that inherit the descriptor keep the lock, should this process be killed.
    """
    descriptor = os.open(file, os.O_RDWR | os.O_CREAT, 0o644)
    try:
        _acquire(descriptor)
        os.ftruncate(descriptor, 0)
        os.pwrite(descriptor, str(os.getpid()).encode(), 0)
        yield descriptor
    finally:
        os.close(descriptor)


def _acquire(descriptor: int) -> None:
    """Take the lock, and say so where that means waiting."""
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        holder = os.pread(descriptor, 20, 0).decode(errors="replace") or "unknown"
        say(f"another steer (process {holder}) is setting up; waiting for it")
        fcntl.flock(descriptor, fcntl.LOCK_EX)


def mark_in_use(top: Path) -> int | None:
    """Descriptor that keeps `top` from being removed while this process lives, exec included.

    None where `top` is just being removed.
    """
    try:
        descriptor = os.open(top.with_name(top.name + ".in-use"), os.O_RDONLY | os.O_CREAT, 0o644)
    except OSError:
        return None
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(descriptor)
        return None
    os.set_inheritable(descriptor, True)
    return descriptor


@contextmanager
def unused(top: Path) -> Iterator[bool]:
    """True while nobody uses `top` and nobody can begin to."""
    descriptor = os.open(top.with_name(top.name + ".in-use"), os.O_RDONLY | os.O_CREAT, 0o644)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield True
    except BlockingIOError:
        yield False
    finally:
        os.close(descriptor)
