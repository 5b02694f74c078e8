"""Standard streams as commands need them: all three there, and none that a character can stop."""

from __future__ import annotations

import os
import select
import sys
from contextlib import suppress
from typing import TextIO

STREAMS = (("stdin", os.O_RDONLY, "r"), ("stdout", os.O_WRONLY, "w"), ("stderr", os.O_WRONLY, "w"))


def prepare() -> None:
    """Open what is closed, let what a terminal cannot show be replaced, and keep files one's own.

    A file that is opened while a standard stream is closed takes its number: a bag would get what
    is printed.
    """
    for number, (name, flags, mode) in enumerate(STREAMS):
        try:
            os.fstat(number)
        except OSError:
            # The lowest free number is this one, as all below it are open.
            os.set_inheritable(os.open(os.devnull, flags), True)
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(number, mode, encoding="utf-8", closefd=False))
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace" if stream is sys.stdout else "backslashreplace")
    # A mask that takes files from their owner would make folders nobody can write into.
    os.umask(os.umask(0o077) & 0o077)


def reader_is_gone() -> bool:
    """Return whether the reader of standard output (head, less) has had enough; then be quiet."""
    poll = select.poll()
    poll.register(sys.stdout.fileno(), select.POLLOUT)
    gone = any(events & select.POLLERR for _, events in poll.poll(0))
    if gone:
        be_quiet(sys.stdout)
    return gone


def is_refused(stream: TextIO, error: OSError) -> bool:
    """Return whether it is this stream that cannot be written (a full disk), by one more line."""
    try:
        os.write(stream.fileno(), b"\n")
    except OSError as again:
        return again.errno == error.errno
    except ValueError:
        return False
    return False


def be_quiet(stream: TextIO) -> None:
    """Drop what is still buffered: it would raise once more when the interpreter ends."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
