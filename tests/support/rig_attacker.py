"""A process without the key that tries to move the rig and to make the bench believe it.

    python rig_attacker.py squat BENCH RIG       has the bench's address before the bench
    python rig_attacker.py relay FRONT BACK FAR  on the path: the bench takes FRONT for the rig, the
                                                  rig takes BACK for the bench; FAR is the rig
    python rig_attacker.py can PORT               on the bus, with everybody's identifiers

Until standard input is closed; then a line of JSON tells what was tried.
"""

from __future__ import annotations

import json
import os
import select
import socket
import sys
import time
from collections import Counter, deque

from rig_links import COMMANDED, MEASURED, RIG

from rig_bridge.transport.packets import Demand, Frame, Order
from rig_bridge.transport.settings import CanSettings, address
from rig_bridge.transport.udp_codec import SEAL, UdpCodec
from rig_bridge.trust.peer import BenchPeer, RigPeer

PERIOD_S = 1e-3
QUIET_S = 0.05
PUSH = (30.0, *COMMANDED[1:])
LIE = (1.0, *MEASURED[1:])
CODEC = UdpCodec(RIG)


def asked_to_end() -> bool:
    return bool(select.select([sys.stdin], [], [], 0.0)[0])


def push(k: int) -> Demand:
    return Demand(k, k, Order.ARM if k < 20 else Order.RUN, PUSH)


def squat(bench: str, rig: str) -> Counter[str]:
    """Bind the bench's address, ask for a meeting, push with no tag and with guessed ones."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as own:
        own.bind(address(bench))
        own.connect(address(rig))
        own.setblocking(False)
        keyed = UdpCodec(RIG, bytes(32))
        done: Counter[str] = Counter()
        print("ready", flush=True)
        while not asked_to_end():
            k = done["pushes"]
            own.send(CODEC.pack_demand(push(k)))
            own.send(CODEC.pack_demand(push(k)) + os.urandom(SEAL.size))
            if k % 10 == 0:
                own.send(keyed.greeting(os.urandom(16)))
            done["pushes"] += 1
            time.sleep(PERIOD_S)
            try:
                while data := own.recv(2048):
                    done["measurements" if data[:2] == b"SR" else "answers"] += 1
            except OSError:
                pass
    return done


class Relay:
    """Passes on what comes, and beside it whatever it can make of what has come."""

    def __init__(self, front: str, back: str, far: str) -> None:
        self.front, self.back = (socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in "12")
        self.front.bind(address(front))
        self.back.bind(address(back))
        self.far = address(far)
        self.bench: tuple[str, int] | None = None
        self.down: deque[bytes] = deque(maxlen=1000)
        self.up: deque[bytes] = deque(maxlen=1000)
        self.done: Counter[str] = Counter()
        self.last = time.monotonic()

    def run(self) -> Counter[str]:
        print("ready", flush=True)
        while not asked_to_end():
            come, _, _ = select.select([self.front, self.back], [], [], PERIOD_S)
            if self.front in come:
                self._from_bench()
            if self.back in come:
                self._from_rig()
            if self.down and time.monotonic() - self.last > QUIET_S:
                self._go_on_alone()
        return self.done

    def _from_bench(self) -> None:
        data, self.bench = self.front.recvfrom(2048)
        self.back.sendto(data, self.far)
        if data[:2] != b"SR":
            return
        self.last = time.monotonic()
        self.down.append(data)
        body, seal = data[: -SEAL.size], data[-SEAL.size :]
        demand = CODEC.unpack_demand(body)
        forged = CODEC.pack_demand(demand._replace(order=Order.RUN, values=PUSH))
        self._inject(self.far, self.down[0], forged + seal, forged)
        self._inject(self.bench, data)
        if demand.order is Order.HOLD:
            self.done["holds"] += 1

    def _from_rig(self) -> None:
        data = self.back.recv(2048)
        if self.bench is None:
            return
        self.front.sendto(data, self.bench)
        if data[:2] != b"SR":
            return
        self.up.append(data)
        body, seal = data[: -SEAL.size], data[-SEAL.size :]
        forged = CODEC.pack_frame(CODEC.unpack_frame(body)._replace(values=LIE))
        self._inject(self.bench, self.up[0], forged + seal, forged)

    def _go_on_alone(self) -> None:
        for data in list(self.down):
            self._inject(self.far, data)
        self.last = time.monotonic()
        self.done["alone"] += 1

    def _inject(self, to: tuple[str, int], *packets: bytes) -> None:
        way = self.back if to == self.far else self.front
        for data in packets:
            way.sendto(data, to)
            self.done["injected"] += 1


def on_can(port: str) -> Counter[str]:
    """Send whole packets of both directions with guessed tags, a thousand a second."""
    from healthy_rig import EMULATED

    from rig_bridge.transport.can_bus import CanBuses
    from rig_bridge.transport.can_codec import CanCodec
    from rig_bridge.transport.can_link import described

    where = {"interface": "socketcand", "channel": "can0", "host": "127.0.0.1", "port": port}
    settings = [CanSettings.model_validate(where)]
    dbc = EMULATED.with_suffix(".dbc")
    codec = CanCodec(RIG, described(settings, dbc))
    keyed = [CanCodec(RIG, described(settings, dbc), bytes(32), end) for end in (False, True)]
    for one in keyed:
        assert isinstance(one.peer, BenchPeer | RigPeer)
        one.peer.hear(b"n" * 8)
        one.peer.current = one.peer.pending
    buses = CanBuses(settings)
    done: Counter[str] = Counter()
    print("ready", flush=True)
    while not asked_to_end():
        k = done["pushes"]
        lie = Frame(k, k * 1_000_000, LIE)
        buses.send(codec.pack_demand(push(k)) + codec.pack_frame(lie))
        buses.send(keyed[0].pack_demand(push(k)) + keyed[1].pack_frame(lie))
        if k % 10 == 0:
            buses.send([keyed[0].greeting(os.urandom(8))])
        done["pushes"] += 1
        until = time.monotonic() + PERIOD_S
        while (left := until - time.monotonic()) > 0.0:
            buses.receive(left)
    buses.close()
    return done


if __name__ == "__main__":
    kind, *words = sys.argv[1:]
    if kind == "relay":
        done = Relay(*words).run()
    else:
        done = on_can(*words) if kind == "can" else squat(*words)
    print(json.dumps(done), flush=True)
