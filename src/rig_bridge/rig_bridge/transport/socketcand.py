"""A CAN bus behind a socketcand server that may be busy as it is opened."""

from __future__ import annotations

import socket
from typing import Any

import can
from can.interfaces.socketcand import SocketCanDaemonBus


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


def open_bus(options: dict[str, Any]) -> can.BusABC:
    """Return the open bus of python-can's ``options``."""
    if options["interface"] == "socketcand":
        return SocketcandBus(**{n: v for n, v in options.items() if n != "interface"})
    return can.Bus(**options)
