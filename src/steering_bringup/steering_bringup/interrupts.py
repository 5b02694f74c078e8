"""Ctrl-C before a run: end at once, for an exception would not always arrive."""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Iterator


@contextlib.contextmanager
def nothing_to_lose() -> Iterator[None]:
    """Let SIGINT end the process at once, as long as there is nothing to close in order.

    While modules are imported and equations compiled, KeyboardInterrupt may be raised in a
    callback of C code (llvmlite's, a weak reference's), where it is dropped, and the run goes on.
    A SIGINT that is ignored or has another handler stays as it is, as it does outside the main
    thread.
    """
    main = threading.current_thread() is threading.main_thread()
    if not main or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        yield
        return
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)
