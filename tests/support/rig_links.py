"""Both ends of each kind of link on this machine, and packets to send over it."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from healthy_rig import EMULATED

from rig_bridge.rig_file import RigFile, load_rig
from rig_bridge.transport.can_hub import CanHub
from rig_bridge.transport.packets import Demand, Frame, Order
from rig_bridge.transport.registry import open_link

RIG = load_rig(EMULATED)
MEASURED = (0.1, -1.0, 2.0, 6e5, 1.2e6, 2e7, 0.01, -0.02, 1500.0)
COMMANDED = (3.0, 1.5e6, 16.0, 6e5, 14.0, -200.0, 5e4, 0.01)
FRAME = Frame(7, 12_345_678_000, MEASURED)
DEMAND = Demand(9, 7, Order.RUN, COMMANDED)


def free_port() -> int:
    """Return a UDP port that nobody uses at present."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@contextmanager
def link_settings(kind: str, hub: CanHub | None = None) -> Iterator[dict[str, Any]]:
    """Give the settings of a link of this kind; CAN has a bus behind it, ``hub`` or a plain one."""
    if kind == "udp":
        yield {"bench": f"127.0.0.1:{free_port()}", "rig": f"127.0.0.1:{free_port()}"}
        return
    hub = hub or CanHub()
    try:
        where = {"host": "127.0.0.1", "port": hub.port}
        yield {"interface": "socketcand", "channel": "can0", **where}
    finally:
        hub.close()


@contextmanager
def both_ends(
    kind: str, rig: RigFile = RIG, hub: CanHub | None = None, key: bytes | None = None
) -> Iterator[tuple[Any, Any]]:
    """Give the bench's and the rig's end; with a key they have yet to meet."""
    with link_settings(kind, hub) as settings:
        bench = open_link(kind, rig, EMULATED.parent, settings, key=key)
        try:
            far = open_link(kind, rig, EMULATED.parent, settings, rig_end=True, key=key)
            try:
                yield bench, far
            finally:
                far.close()
        finally:
            bench.close()


def meet(bench: Any, far: Any, tries: int = 20) -> None:
    """Let both ends meet: question, answer, the bench's first packet, the rig's first."""
    for _ in range(tries):
        bench.send_demand(DEMAND._replace(order=Order.ARM))
        far.receive_demands(0.1)
        bench.receive_frames(0.02)
        far.send_frame(FRAME)
        if bench.receive_frames(0.1) and not bench.peer.meeting:
            return
    raise AssertionError(bench.unheard())
