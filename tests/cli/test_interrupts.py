"""Ctrl-C before a run: nothing can drop it, and nothing else about signals changes."""

import contextlib
import signal
import subprocess
import sys

import pytest

from steering_bringup.interrupts import nothing_to_lose

DROPPED = """
import signal, sys, time
from steering_bringup.interrupts import nothing_to_lose

class Callback:
    def __del__(self):
        signal.raise_signal(signal.SIGINT)

def compile_equations():
    callback = Callback()

if sys.argv[1] == "guarded":
    with nothing_to_lose():
        compile_equations()
else:
    compile_equations()
"""


@pytest.mark.parametrize(("how", "status"), [("guarded", -signal.SIGINT), ("plain", 0)])
def test_a_callback_cannot_drop_an_interrupt(how, status):
    done = subprocess.run(
        [sys.executable, "-c", DROPPED, how],
        env={"PYTHONPATH": ":".join(sys.path)},
        stderr=subprocess.DEVNULL,
        check=False,
    )
    assert done.returncode == status


def test_afterwards_an_interrupt_is_an_exception_again():
    before = signal.getsignal(signal.SIGINT)
    try:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        with contextlib.suppress(ValueError), nothing_to_lose():
            assert signal.getsignal(signal.SIGINT) is signal.SIG_DFL
            raise ValueError("no plan")
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize("handler", [signal.SIG_IGN, signal.SIG_DFL, print])
def test_a_handler_of_somebody_else_stays(handler):
    before = signal.signal(signal.SIGINT, handler)
    try:
        with nothing_to_lose():
            assert signal.getsignal(signal.SIGINT) is handler
        assert signal.getsignal(signal.SIGINT) is handler
    finally:
        signal.signal(signal.SIGINT, before)
