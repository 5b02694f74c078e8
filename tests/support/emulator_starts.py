"""Many starts of the emulated rig, each ended right behind its first line.

Usage: ``emulator_starts COUNT BENCH RIG``, the ends of a UDP link.
Each is a fork of this process, which has compiled everything, so that a start takes a moment only.
Prints how each has ended, [exit status, last line], as JSON.
"""

from __future__ import annotations

import json
import os
import signal
import sys

from healthy_rig import EMULATED

from rig_bridge.emulator.main import main
from rig_bridge.emulator.rig import EmulatedRig
from rig_bridge.emulator.settings import load_settings
from rig_bridge.rig_file import load_rig


def start(words: list[str]) -> tuple[int, int, int]:
    """Return the pid of a new emulated rig, its standard input and its standard output."""
    theirs_in, ours_in = os.pipe()
    ours_out, theirs_out = os.pipe()
    pid = os.fork()
    if pid == 0:
        os.dup2(theirs_in, 0)
        os.dup2(theirs_out, 1)
        for end in (theirs_in, ours_in, ours_out, theirs_out):
            os.close(end)
        sys.argv[1:] = words
        sys.exit(main())
    os.close(theirs_in)
    os.close(theirs_out)
    return pid, ours_in, ours_out


def end(pid: int, ours_in: int, number: int) -> int:
    """End it by one signal (number 0), two, its input and one, or signals until it is gone."""
    os.kill(pid, signal.SIGTERM)
    if number % 4 == 1:
        os.kill(pid, signal.SIGINT)
    if number % 4 == 2:
        os.close(ours_in)
    while True:
        gone, status = os.waitpid(pid, os.WNOHANG if number % 4 == 3 else 0)
        if gone:
            break
        os.kill(pid, signal.SIGTERM)
    if number % 4 != 2:
        os.close(ours_in)
    return os.waitstatus_to_exitcode(status)


def starts(count: int, words: list[str]) -> list[tuple[int, str]]:
    """Return how ``count`` emulated rigs have ended, one after the other."""
    settings = load_settings(EMULATED.with_name("emulator.yaml"))
    EmulatedRig(load_rig(EMULATED), settings, 16).step([])
    ends = []
    for number in range(count):
        pid, ours_in, ours_out = start(words)
        with open(ours_out) as said:
            assert "ready" in said.readline()
            status = end(pid, ours_in, number)
            ends.append((status, said.read()))
    return ends


if __name__ == "__main__":
    bench, rig = sys.argv[2:]
    link = ["--setting", f"bench={bench}", "--setting", f"rig={rig}"]
    print(json.dumps(starts(int(sys.argv[1]), ["--attached", "--link", "udp", *link])))
