"""Ctrl-C before a run: end at once, for an exception would not always arrive."""

from __future__ import annotations

import contextlib
import signal
from collections.abc import Iterator


@contextlib.contextmanager
def nothing_to_lose() -> Iterator[None]:
    """Let SIGINT end the process at once, as long as there is nothing to close in order.

    While modules are imported and equations compiled, KeyboardInterrupt may be raised in a
    callback of C code (llvmlite's, a weak reference's), where it is dropped, and the run goes on.
    A SIGINT that is ignored or has another handler stays as it is, as it does outside the main
    thread.
    """
    usual = signal.default_int_handler
    with contextlib.suppress(ValueError):
        if signal.getsignal(signal.SIGINT) is usual:
            signal.signal(signal.SIGINT, signal.SIG_DFL)
    try:
        yield
    finally:
        with contextlib.suppress(ValueError):
            if signal.getsignal(signal.SIGINT) is signal.SIG_DFL:
                signal.signal(signal.SIGINT, usual)
