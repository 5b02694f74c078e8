"""A CAN bus behind a socketcand server: it may be busy as it is opened; a packet is one piece.

socketcand itself carries classic frames. The hub beside (``can_hub``) carries CAN FD too, in words
of its own: ``fdsend`` and ``fdframe`` for ``send`` and ``frame``.
"""

from __future__ import annotations

import select
import socket
from collections import deque
from collections.abc import Sequence
from typing import Any

import can
from can.interfaces.socketcand import SocketCanDaemonBus

PIECE = 65536
LONGEST = 1024
"""Characters of an answer; of a server that speaks otherwise no more than this is kept."""


class SocketcandBus(SocketCanDaemonBus):
    """Takes of what the server answers no more than the answer: frames may come right behind it.

    python-can takes all that is there, and a frame among it for a wrong answer.
    """

    def __init__(self, channel: Any, host: str, port: int, fd: bool = False, **more: Any) -> None:
        self.come: deque[can.Message] = deque()
        self.rest = ""
        super().__init__(channel, host, port, **more)
        self._can_protocol = can.CanProtocol.CAN_FD if fd else can.CanProtocol.CAN_20

    @property
    def connection(self) -> Any:
        """The socket."""
        return self._SocketCanDaemonBus__socket  # type: ignore[attr-defined]

    def fileno(self) -> int:
        """Return the socket's number, to wait for several buses at once."""
        return int(self.connection.fileno())

    def _expect_msg(self, msg: str) -> None:
        answer = self.connection.recv(len(msg), socket.MSG_WAITALL).decode("ascii", "replace")
        if answer != msg:
            self.connection.close()
            raise can.CanError(f"Expected '{msg}' got: '{answer}'")

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        if not self.come:
            if not select.select([self.connection], [], [], timeout)[0]:
                return None, False
            self._read()
        return (self.come.popleft() if self.come else None), False

    def _read(self) -> None:
        data = self.connection.recv(PIECE)
        if not data:
            raise can.CanOperationError("the server has closed the connection")
        *whole, self.rest = (self.rest + data.decode("ascii", "replace")).split(">")
        if len(self.rest) > LONGEST:
            raise can.CanOperationError("the server does not speak as socketcand does")
        self.come.extend(_message(text) for text in whole)

    def send_together(self, messages: Sequence[can.Message]) -> None:
        """Send messages in one piece: server and receivers wake once for all of them."""
        self._tcp_send("".join(map(_text, messages)))


def _text(message: can.Message) -> str:
    width = 8 if message.is_extended_id else 3
    word = "fdsend" if message.is_fd else "send"
    octets = message.data.hex(" ")
    return f"< {word} {message.arbitration_id:0{width}X} {len(message.data):X} {octets} >"


def _message(text: str) -> can.Message:
    """Return the message of ``< frame ID TIME DATA``; raises can.CanError for anything else."""
    words = text.replace("<", " ").split()
    try:
        kind, number, time = words[:3]
        if kind == "error":
            return can.Message(float(time), int(number, 16), is_error_frame=True)
        if kind not in ("frame", "fdframe"):
            raise ValueError
        return can.Message(
            timestamp=float(time),
            arbitration_id=int(number, 16),
            data=bytes.fromhex("".join(words[3:])),
            is_extended_id=len(number) > 3,
            is_fd=kind == "fdframe",
        )
    except ValueError:
        said = " ".join(words)[:60]
        raise can.CanOperationError(f"the server said '< {said} >'") from None
