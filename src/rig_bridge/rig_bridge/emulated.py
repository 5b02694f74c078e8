"""Starts what stands for a rig that is not there: the emulated one, with a CAN bus if needed."""

from __future__ import annotations

import json
import socket
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from rig_bridge.helpers import Helper, helper
from rig_bridge.rig_file import RigFile
from rig_bridge.transport.settings import address
from rig_bridge.trust.policy import is_loopback
from steering_core.errors import BenchError
from steering_lockstep.urgency import hasten

READY_S = 180.0
"""Until the emulated rig is there: its kernels may have to be compiled first."""

BUS_READY_S = 30.0


@contextmanager
def emulated(
    path: Path, rig: RigFile, kind: str, priority: int = 0
) -> Iterator[tuple[Any, Helper]]:
    """Start the emulated rig of the file ``path`` on its link; give the link's settings.

    priority: of the real-time scheduler, where this is permitted; 0: none. Raises BenchError for a
    link that leaves this machine.
    """
    assert rig.emulator is not None
    settings = rig.settings(kind)
    with ExitStack() as stack:
        if kind == "udp":
            settings = _places(settings)
        else:
            _serve(settings, stack, priority)
        words = ["--attached", *_words(path, rig, kind, settings)]
        rig_process = stack.enter_context(helper("rig_bridge.emulator.main", words, READY_S))
        _hurry(rig_process, priority)
        yield settings, rig_process


def command(path: Path, rig: RigFile, kind: str, priority: int) -> tuple[Any, list[str]]:
    """Return the link's settings and the command of the emulated rig, for whoever starts it.

    priority: of the real-time scheduler, where this is permitted. The rig says "ready" in its first
    line. Raises BenchError for CAN, which needs a bus beside it.
    """
    if kind != "udp":
        raise BenchError(
            f"an emulated rig on {kind} needs a bus that 'steer run --plant rig --rig-link {kind}' "
            "serves: take udp here"
        )
    settings = _places(rig.settings(kind))
    start = [sys.executable, "-m", "rig_bridge.emulator.main"]
    words = [*start, *_words(path, rig, kind, settings)]
    return settings, [*words, "--priority", str(priority)]


def _words(path: Path, rig: RigFile, kind: str, settings: Any) -> list[str]:
    words = ["--link", kind, "--rig", str(path), "--emulator", str(path.parent / str(rig.emulator))]
    return [*words, "--settings", json.dumps(settings)]


def _places(settings: dict[str, Any]) -> dict[str, str]:
    return {end: _place(str(place)) for end, place in settings.items()}


def _serve(buses: list[dict[str, Any]], stack: ExitStack, priority: int) -> None:
    """Start a server for each port that a socketcand bus names, and note free ones that it takes.

    BenchError for a bus that does not connect two processes of this machine, and only those.
    """
    served: dict[int, int] = {}
    for bus in buses:
        kind, port = bus["interface"], bus.get("port", 0)
        if kind == "socketcand":
            _check_loopback(bus.get("host", ""))
            if port not in served:
                words = [str(port)]
                hub = stack.enter_context(
                    helper("rig_bridge.transport.can_hub", words, BUS_READY_S)
                )
                served[port] = hub.said["port"]
                _hurry(hub, priority)
            bus["port"] = served[port]
        elif kind == "virtual":
            raise BenchError(
                "an emulated rig is a process of its own, and a virtual CAN bus ends with the "
                "process: use socketcand with host 127.0.0.1"
            )
        elif kind == "udp_multicast" and bus.get("hop_limit") != 0:
            raise BenchError(
                "an emulated rig stays on this machine: give udp_multicast hop_limit 0"
            )


def _place(endpoint: str) -> str:
    """Return HOST:PORT with a free port in place of 0."""
    host, port = address(endpoint)
    _check_loopback(host)
    if port:
        return endpoint
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind((host, 0))
        return f"{host}:{probe.getsockname()[1]}"


def _check_loopback(host: str) -> None:
    if is_loopback(host):
        return
    raise BenchError(
        f"an emulated rig stays on this machine, but its link leads to '{host}': name 127.0.0.1, "
        "or leave out 'emulator' in the rig's file if it is hardware"
    )


def _hurry(process: Helper, priority: int) -> None:
    if priority:
        hasten(process.process.pid, priority)
