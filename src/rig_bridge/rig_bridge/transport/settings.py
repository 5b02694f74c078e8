"""Where the two ends of a link are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

from pydantic import BeforeValidator, ConfigDict, Field, model_validator

from steering_core.strict import Number, Strict, fault

Endpoint = Annotated[str, Field(pattern=r"^[^:]+:\d{1,5}$")]
Rate = Annotated[int, Field(gt=0)]


class UdpSettings(Strict):
    """Addresses HOST:PORT of the bench's and of the rig's end; port 0: a free one, if emulated."""

    bench: Endpoint = "127.0.0.1:47010"
    rig: Endpoint = "127.0.0.1:47011"


TIMING = (
    *("f_clock", "brp", "tseg1", "tseg2", "sjw", "nof_samples"),
    *("nom_brp", "nom_tseg1", "nom_tseg2", "nom_sjw"),
    *("data_brp", "data_tseg1", "data_tseg2", "data_sjw"),
)
"""Keys of python-can's bit timings, which may also stand beside the others."""


class CanSettings(Strict):
    """How python-can opens a bus, and what the bus is; any other key is an option of its interface.

    Which options an interface has is checked before a run. An emulated rig's socketcand bus is
    served by the run itself, on port 0 on any free one.
    """

    model_config = ConfigDict(extra="allow")

    interface: str = Field("socketcan", description="python-can's name of the interface")
    channel: str | int = "can0"
    host: str | None = Field(default=None, description="of a socketcand server")
    port: Annotated[int, Field(ge=0, le=65535)] | None = None
    fd: bool = Field(default=False, description="the bus carries CAN FD frames")
    bitrate: Rate | None = Field(
        default=None, description="bit/s; the check of the bus load needs it"
    )
    data_bitrate: Rate | None = Field(default=None, description="bit/s of the data phase of CAN FD")
    timing: dict[str, Number] | None = Field(
        default=None, description="python-can's BitTiming or BitTimingFd: f_clock, brp, tseg1, ..."
    )
    dbc: str | None = Field(
        default=None, description="DBC file of this bus, where it has one of its own"
    )
    messages: list[str] | None = Field(
        default=None, description="messages on this bus; one of several buses may leave it out"
    )

    @model_validator(mode="before")
    @classmethod
    def _known_keys(cls, data: Any) -> Any:
        """Gather a bit timing that stands beside the other keys, as in python-can's own files."""
        if not isinstance(data, Mapping) or "f_clock" not in data:
            return data
        if "timing" in data:
            raise fault("f_clock", "f_clock stands beside timing: give the bit timing once")
        timing = {name: data[name] for name in TIMING if name in data}
        return {n: v for n, v in data.items() if n not in timing} | {"timing": timing}

    @model_validator(mode="after")
    def _consistent(self) -> CanSettings:
        if self.data_bitrate is not None and not self.fd:
            raise fault("data_bitrate", "data_bitrate is for CAN FD (fd: true)")
        return self

    @property
    def name(self) -> str:
        """What the bus is called in messages."""
        return f"{self.interface} {self.channel}"

    @property
    def more(self) -> dict[str, Any]:
        """Options of the interface that are not among the fields here."""
        return dict(self.model_extra or {})


def several(given: Any) -> Any:
    """Return a list of buses; one alone needs no list."""
    return [given] if isinstance(given, Mapping | CanSettings) else given


Buses = Annotated[
    Sequence[CanSettings],
    BeforeValidator(several, json_schema_input_type=CanSettings | list[CanSettings]),
    Field(min_length=1, max_length=8),
]


class Links(Strict):
    """Where a rig is on each link that it has; ``can`` is one bus or a list of them."""

    udp: UdpSettings = Field({}, validate_default=True)
    can: Buses = Field({}, validate_default=True)


def address(endpoint: str) -> tuple[str, int]:
    """Return host and port of HOST:PORT."""
    host, port = endpoint.rsplit(":", 1)
    return host, int(port)
