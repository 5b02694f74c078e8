"""CAN buses taken together: waits for a frame on any of them, sends each frame on its own."""

from __future__ import annotations

import queue
import select
import threading
from collections import deque
from collections.abc import Iterable, Sequence
from contextlib import suppress

import can

from rig_bridge.transport.can_codec import CanFrame
from rig_bridge.transport.can_options import bus_options, switches
from rig_bridge.transport.settings import CanSettings
from rig_bridge.transport.socketcand import SocketcandBus
from steering_core.errors import BenchError

Come = tuple[int, can.Message]
ERRORS = (can.CanError, OSError)
AT_ONCE = 64
"""Frames taken of one bus before the others have their turn."""

ECHOING = ("udp_multicast",)
"""Interfaces that give a sender his own frames back as if they were somebody's."""

LOOK_S = 0.1
"""How often a reading thread looks whether it shall end."""


class BusError(Exception):
    """A bus that failed: which one, and how."""


def _failed(name: str, error: Exception) -> BusError:
    return BusError(f"CAN bus {name}: {error}")


def open_bus(settings: CanSettings) -> can.BusABC:
    """Return the open bus; BenchError says why it cannot be opened."""
    options = bus_options(settings)
    try:
        if settings.interface == "socketcand":
            return SocketcandBus(fd=settings.fd, **options)
        return can.Bus(interface=settings.interface, ignore_config=True, **options)
    except Exception as error:
        raise BenchError(f"cannot open the CAN bus {settings.name}: {error}") from None


class CanBuses:
    """All buses of a rig, open. Raises BenchError where one cannot be opened."""

    def __init__(self, settings: Sequence[CanSettings]) -> None:
        self.names = [one.name for one in settings]
        self.switched = [switches(one) for one in settings]
        self.echoing = [one.interface in ECHOING for one in settings]
        self.buses: list[can.BusABC] = []
        try:
            for one in settings:
                self.buses.append(open_bus(one))
        except BenchError:
            self.close()
            raise
        self.reader = _reader(self.names, self.buses)

    def receive(self, wait_s: float) -> Come | None:
        """Return the next frame and its bus; None if none has come. Raises BusError."""
        return self.reader.receive(wait_s)

    def send(self, frames: Iterable[CanFrame]) -> None:
        """Send frames, in their order on each bus. Raises BusError, after the others were tried."""
        messages: list[list[can.Message]] = [[] for _ in self.buses]
        for frame in frames:
            message = can.Message(
                arbitration_id=frame.number,
                data=frame.data,
                is_extended_id=frame.extended,
                is_fd=frame.fd,
                bitrate_switch=frame.fd and self.switched[frame.bus],
            )
            messages[frame.bus].append(message)
        failed = []
        for name, bus, some in zip(self.names, self.buses, messages, strict=True):
            try:
                _send(bus, some)
            except ERRORS as error:
                failed.append(str(_failed(name, error)))
        if failed:
            raise BusError("; ".join(failed))

    def close(self) -> None:
        """Leave all buses."""
        if hasattr(self, "reader"):
            self.reader.close()
        for bus in self.buses:
            with suppress(*ERRORS):
                bus.shutdown()


def _send(bus: can.BusABC, messages: Sequence[can.Message]) -> None:
    if isinstance(bus, SocketcandBus):
        if messages:
            bus.send_together(messages)
        return
    for message in messages:
        bus.send(message)


class _One:
    """Waits for the only bus."""

    def __init__(self, name: str, bus: can.BusABC) -> None:
        self.name = name
        self.bus = bus

    def receive(self, wait_s: float) -> Come | None:
        try:
            message = self.bus.recv(wait_s)
        except ERRORS as error:
            raise _failed(self.name, error) from None
        return None if message is None else (0, message)

    def close(self) -> None:
        pass


class _Polled:
    """Waits for several buses at once, by the operating system."""

    def __init__(self, names: Sequence[str], buses: Sequence[can.BusABC]) -> None:
        self.names = names
        self.buses = buses
        self.poller = select.poll()
        self.index = {bus.fileno(): i for i, bus in enumerate(buses)}
        for number in self.index:
            self.poller.register(number, select.POLLIN)
        self.come: deque[Come] = deque()
        self.unread: set[int] = set()

    def receive(self, wait_s: float) -> Come | None:
        if not self.come:
            # What a bus has read and not yet given, the operating system knows nothing of.
            ready = self.poller.poll(0 if self.unread else max(wait_s, 0.0) * 1e3)
            turn = self.unread | {self.index[number] for number, _ in ready}
            self.unread = set()
            for index in sorted(turn):
                self._take(index)
        return self.come.popleft() if self.come else None

    def _take(self, index: int) -> None:
        bus = self.buses[index]
        try:
            for _ in range(AT_ONCE):
                message = bus.recv(0.0)
                if message is None:
                    return
                self.come.append((index, message))
        except ERRORS as error:
            raise _failed(self.names[index], error) from None
        self.unread.add(index)

    def close(self) -> None:
        pass


class _Threads:
    """Waits for several buses of which the operating system knows nothing, each in a thread."""

    def __init__(self, names: Sequence[str], buses: Sequence[can.BusABC]) -> None:
        self.names = names
        self.come: queue.SimpleQueue[Come | BusError] = queue.SimpleQueue()
        self.closing = False
        self.threads = [
            threading.Thread(target=self._read, args=(i, bus), name=f"can_{i}", daemon=True)
            for i, bus in enumerate(buses)
        ]
        for thread in self.threads:
            thread.start()

    def receive(self, wait_s: float) -> Come | None:
        try:
            come = self.come.get(timeout=wait_s) if wait_s > 0.0 else self.come.get_nowait()
        except queue.Empty:
            return None
        if isinstance(come, BusError):
            raise come
        return come

    def close(self) -> None:
        self.closing = True
        for thread in self.threads:
            thread.join()

    def _read(self, index: int, bus: can.BusABC) -> None:
        while not self.closing:
            try:
                message = bus.recv(LOOK_S)
            except ERRORS as error:
                self.come.put(_failed(self.names[index], error))
                return
            if message is not None:
                self.come.put((index, message))


def _reader(names: Sequence[str], buses: Sequence[can.BusABC]) -> _One | _Polled | _Threads:
    if len(buses) == 1:
        return _One(names[0], buses[0])
    try:
        return _Polled(names, buses)
    except (NotImplementedError, ValueError, AttributeError):
        return _Threads(names, buses)
