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

from steering_lockstep.urgency import without_pauses

LARGEST_BACKLOG = 1 << 20
FRAMES = {"send": "frame", "fdsend": "fdframe"}


class CanHub:
    """Serves on ``host``:``port`` (0: any free one) from a thread until ``close``."""

    def __init__(self, host: str = "127.0.0.1", port: int = 0) -> None:
        self.server = socket.create_server((host, port))
        self.port: int = self.server.getsockname()[1]
        self.selector = selectors.DefaultSelector()
        self.selector.register(self.server, selectors.EVENT_READ)
        self.rest: dict[socket.socket, str] = {}
        self.opened: dict[socket.socket, str] = {}
        self.on_bus: set[socket.socket] = set()
        self.closing = False
        self.thread = threading.Thread(target=self._serve, name="can_hub", daemon=True)
        self.thread.start()

    def close(self) -> None:
        """Stop serving and drop all clients."""
        self.closing = True
        self.thread.join(timeout=2.0)

    def _serve(self) -> None:
        while not self.closing:
            for key, _ in self.selector.select(timeout=0.2):
                if key.fileobj is self.server:
                    self._welcome()
                else:
                    self._hear(key.fileobj)  # type: ignore[arg-type]
        for client in list(self.rest):
            self._drop(client)
        self.selector.close()
        self.server.close()

    def _welcome(self) -> None:
        client, _ = self.server.accept()
        client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.selector.register(client, selectors.EVENT_READ)
        self.rest[client] = ""
        client.sendall(b"< hi >")

    def _hear(self, client: socket.socket) -> None:
        try:
            data = client.recv(65536)
        except OSError:
            data = b""
        if not data:
            self._drop(client)
            return
        *whole, self.rest[client] = (self.rest[client] + data.decode("ascii", "replace")).split(">")
        if len(self.rest[client]) > LARGEST_BACKLOG:
            self._drop(client)
            return
        sent = []
        for text in whole:
            words = text.replace("<", " ").split()
            if words and words[0] in FRAMES and len(words) > 2:
                octets = "".join(word.zfill(2) for word in words[3:]).upper()
                sent.append(f"< {FRAMES[words[0]]} {words[1]} {time.time():.6f} {octets} >")
            elif words:
                if words[0] == "open":
                    self.opened[client] = words[-1]
                self._answer(client, words[0])
        if sent:
            self._pass_on(client, "".join(sent).encode())

    def _answer(self, client: socket.socket, word: str) -> None:
        if word == "rawmode":
            self.on_bus.add(client)
        self._write(client, b"< ok >")

    def _pass_on(self, sender: socket.socket, data: bytes) -> None:
        for client in list(self.on_bus):
            if client is not sender and self.opened.get(client) == self.opened.get(sender):
                self._write(client, data)

    def _write(self, client: socket.socket, data: bytes) -> None:
        try:
            client.sendall(data)
        except OSError:
            self._drop(client)

    def _drop(self, client: socket.socket) -> None:
        if client in self.rest:
            self.selector.unregister(client)
            del self.rest[client]
            self.on_bus.discard(client)
            self.opened.pop(client, None)
            client.close()


def main() -> None:
    """Serve a bus until standard input is closed."""
    hub = CanHub(port=int(sys.argv[1]))
    without_pauses()
    print(json.dumps({"port": hub.port}), flush=True)
    sys.stdin.read()
    hub.close()


if __name__ == "__main__":
    main()
