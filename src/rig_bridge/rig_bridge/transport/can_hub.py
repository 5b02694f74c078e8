"""CAN buses on a TCP port of this machine, for machines without one: speaks as socketcand does.

What one client sends, all others receive that have opened a bus of the same name. python-can opens
it as interface "socketcand". CAN FD frames go the same way, as ``fdsend`` and ``fdframe``. As a
program it takes the port (0: any free one), prints it, and ends with its standard input.
"""

from __future__ import annotations

import json
import selectors
import socket
import sys
import threading
import time
from collections.abc import Sequence

from steering_lockstep.urgency import without_pauses

LARGEST_BACKLOG = 1 << 20
"""Bytes that wait for a client who does not read, or for the end of what one says; then it goes."""

PIECE = 65536
FRAMES = {"send": "frame", "fdsend": "fdframe"}
LONGEST = {"send": 8, "fdsend": 64}
"""Bytes of data of a frame."""

STANDARD_DIGITS, LARGEST_STANDARD, LARGEST_EXTENDED = 3, 0x7FF, 0x1FFFFFFF


class Client:
    """One connection: what it has said so far, what waits for it, and the bus that it opened."""

    def __init__(self, connection: socket.socket) -> None:
        self.connection = connection
        self.rest = ""
        self.waiting = b""
        self.bus: str | None = None
        self.on_bus = False


class CanHub:
    """Serves on ``host``:``port`` (0: any free one) from a thread until ``close``.

    Nothing that a client says or leaves undone stops it: what is no frame is answered with an error
    and counted in ``malformed``; one who does not read is dropped once too much waits for him.
    exclusive: an identifier is its first sender's while he is connected, as on a bus each has one
    sender; what others send on it is counted in ``refused`` and goes nowhere.
    """

    def __init__(self, host: str = "127.0.0.1", port: int = 0, exclusive: bool = False) -> None:
        self.server = socket.create_server((host, port))
        self.server.setblocking(False)
        self.port: int = self.server.getsockname()[1]
        self.selector = selectors.DefaultSelector()
        self.selector.register(self.server, selectors.EVENT_READ)
        self.clients: list[Client] = []
        self.owners: dict[tuple[str | None, str], Client] | None = {} if exclusive else None
        self.malformed = 0
        self.refused = 0
        self.closing = False
        self.thread = threading.Thread(target=self._serve, name="can_hub", daemon=True)
        self.thread.start()

    def close(self) -> None:
        """Stop serving and drop all clients."""
        self.closing = True
        self.thread.join(timeout=2.0)

    def _serve(self) -> None:
        while not self.closing:
            for key, events in self.selector.select(timeout=0.2):
                client: Client | None = key.data
                if client is None:
                    self._welcome()
                    continue
                if events & selectors.EVENT_WRITE:
                    self._write(client, b"")
                if events & selectors.EVENT_READ:
                    self._hear(client)
        for client in list(self.clients):
            self._drop(client)
        self.selector.close()
        self.server.close()

    def _welcome(self) -> None:
        try:
            connection, _ = self.server.accept()
        except OSError:
            return
        connection.setblocking(False)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        client = Client(connection)
        self.clients.append(client)
        self.selector.register(connection, selectors.EVENT_READ, client)
        self._write(client, b"< hi >")

    def _hear(self, client: Client) -> None:
        try:
            data = client.connection.recv(PIECE)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        *whole, client.rest = (client.rest + data.decode("ascii", "replace")).split(">")
        if not data or len(client.rest) > LARGEST_BACKLOG:
            self._drop(client)
            return
        sent = []
        for text in whole:
            words = text.replace("<", " ").split()
            if words and words[0] in FRAMES:
                sent += self._frame(client, words)
            elif words:
                self._answer(client, words)
        if sent:
            self._pass_on(client, "".join(sent).encode())

    def _frame(self, client: Client, words: Sequence[str]) -> list[str]:
        """Return what the others get of a frame; nothing of one that cannot be or may not be."""
        number, octets = _checked(words)
        if number is None:
            self.malformed += 1
            self._write(client, b"< error malformed frame >")
            return []
        if self.owners is not None:
            owner = self.owners.setdefault((client.bus, number), client)
            if owner is not client:
                self.refused += 1
                return []
        return [f"< {FRAMES[words[0]]} {number} {time.time():.6f} {octets} >"]

    def _answer(self, client: Client, words: Sequence[str]) -> None:
        if words[0] == "open":
            client.bus = words[-1]
        if words[0] == "rawmode":
            client.on_bus = True
        self._write(client, b"< ok >")

    def _pass_on(self, sender: Client, data: bytes) -> None:
        for client in list(self.clients):
            if client.on_bus and client is not sender and client.bus == sender.bus:
                self._write(client, data)

    def _write(self, client: Client, data: bytes) -> None:
        """Send as much as goes at once; the rest waits until the client reads."""
        if client not in self.clients:
            return
        waiting = client.waiting + data
        try:
            sent = client.connection.send(waiting) if waiting else 0
        except BlockingIOError:
            sent = 0
        except OSError:
            self._drop(client)
            return
        client.waiting = waiting[sent:]
        if len(client.waiting) > LARGEST_BACKLOG:
            self._drop(client)
            return
        both = selectors.EVENT_READ | selectors.EVENT_WRITE
        wanted = both if client.waiting else selectors.EVENT_READ
        if self.selector.get_key(client.connection).events != wanted:
            self.selector.modify(client.connection, wanted, client)

    def _drop(self, client: Client) -> None:
        if client not in self.clients:
            return
        self.clients.remove(client)
        self.selector.unregister(client.connection)
        client.connection.close()
        if self.owners is not None:
            self.owners = {key: one for key, one in self.owners.items() if one is not client}


def _checked(words: Sequence[str]) -> tuple[str | None, str]:
    """Return identifier and data of ``send ID LENGTH BYTES``; (None, "") for what is no frame."""
    try:
        kind, number, length, *octets = words
        data = bytes.fromhex("".join(octet.zfill(2) for octet in octets))
        largest = LARGEST_STANDARD if len(number) <= STANDARD_DIGITS else LARGEST_EXTENDED
        fits = int(length, 16) == len(data) <= LONGEST[kind]
        if fits and 0 <= int(number, 16) <= largest and number.isalnum():
            return number.upper(), data.hex().upper()
    except ValueError:
        pass
    return None, ""


def main() -> None:
    """Serve a bus until standard input is closed."""
    hub = CanHub(port=int(sys.argv[1]), exclusive=True)
    without_pauses()
    print(json.dumps({"port": hub.port}), flush=True)
    sys.stdin.read()
    hub.close()
    if hub.malformed or hub.refused:
        print(json.dumps({"malformed": hub.malformed, "refused": hub.refused}), flush=True)


if __name__ == "__main__":
    main()
