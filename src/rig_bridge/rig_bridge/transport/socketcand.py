"""A CAN bus behind a socketcand server: it may be busy as it is opened; a packet is one piece."""

from __future__ import annotations

import socket
from collections.abc import Sequence
from typing import Any

import can
from can.interfaces.socketcand import SocketCanDaemonBus
from can.interfaces.socketcand.socketcand import convert_can_message_to_ascii_message


class SocketcandBus(SocketCanDaemonBus):
    """Takes of what the server answers no more than the answer: frames may come right behind it.

    python-can takes all that is there, and a frame among it for a wrong answer.
    """

    def _expect_msg(self, msg: str) -> None:
        connection: Any = self._SocketCanDaemonBus__socket  # type: ignore[attr-defined]
        answer = connection.recv(len(msg), socket.MSG_WAITALL).decode("ascii", "replace")
        if answer != msg:
            connection.close()
            raise can.CanError(f"Expected '{msg}' got: '{answer}'")

    def send_together(self, messages: Sequence[can.Message]) -> None:
        """Send messages in one piece: server and receivers wake once for all of them."""
        self._tcp_send("".join(map(convert_can_message_to_ascii_message, messages)))


def open_bus(options: dict[str, Any]) -> can.BusABC:
    """Return the open bus of python-can's ``options``."""
    if options["interface"] == "socketcand":
        return SocketcandBus(**{n: v for n, v in options.items() if n != "interface"})
    return can.Bus(**options)


def send_all(bus: can.BusABC, messages: Sequence[can.Message]) -> None:
    """Send messages in their order; raises can.CanError or OSError."""
    if isinstance(bus, SocketcandBus):
        bus.send_together(messages)
        return
    for message in messages:
        bus.send(message)
