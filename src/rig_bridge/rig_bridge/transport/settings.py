"""Where the two ends of a link are."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field

from steering_core.strict import Strict

Endpoint = Annotated[str, Field(pattern=r"^[^:]+:\d{1,5}$")]


class UdpSettings(Strict):
    """Addresses HOST:PORT of the bench's and of the rig's end; port 0: a free one, if emulated."""

    bench: Endpoint = "127.0.0.1:47010"
    rig: Endpoint = "127.0.0.1:47011"


class CanSettings(Strict):
    """How python-can opens the bus; ``host`` and ``port`` for socketcand only.

    An emulated rig's socketcand bus is served by the run itself, on port 0 on any free one.
    """

    interface: str = Field("socketcan", description="python-can's name of the interface")
    channel: str = "can0"
    host: str | None = None
    port: Annotated[int, Field(ge=0, le=65535)] | None = None

    def options(self) -> dict[str, Any]:
        """Return the arguments of ``can.Bus``."""
        options: dict[str, Any] = {"interface": self.interface, "channel": self.channel}
        if self.interface == "socketcand":
            options |= {"host": self.host, "port": self.port, "tcp_tune": True}
        return options


class Links(Strict):
    """Where a rig is on each link that it has."""

    udp: UdpSettings = Field({}, validate_default=True)
    can: CanSettings = Field({}, validate_default=True)


def address(endpoint: str) -> tuple[str, int]:
    """Return host and port of HOST:PORT."""
    host, port = endpoint.rsplit(":", 1)
    return host, int(port)
