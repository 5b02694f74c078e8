"""The one table of transports: a new one is a class with the methods of ``link.Link``.

CAN's libraries are imported where CAN is used: they take a second, in every process.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from rig_bridge.rig_file import RigFile
from rig_bridge.transport.link import Link
from rig_bridge.transport.settings import CanSettings, UdpSettings, several
from rig_bridge.transport.udp import UdpLink
from rig_bridge.transport.udp_codec import UdpCodec
from rig_bridge.trust.policy import trust_of
from steering_core.errors import BenchError
from steering_core.naming import unknown

Settings = Mapping[str, Any] | Sequence[Mapping[str, Any]]


def _udp(rig: RigFile, folder: Path, rig_end: bool, values: Settings, key: bytes | None) -> Link:
    return UdpLink(rig, UdpSettings.model_validate(values), rig_end, key)


def _can(rig: RigFile, folder: Path, rig_end: bool, values: Settings, key: bytes | None) -> Link:
    from rig_bridge.transport.can_check import dbc_path
    from rig_bridge.transport.can_link import CanLink

    buses = [CanSettings.model_validate(one) for one in several(values)]
    return CanLink(rig, buses, dbc_path(rig, folder, buses), rig_end, key)


Maker = Callable[[RigFile, Path, bool, Settings, bytes | None], Link]
TRANSPORTS: Mapping[str, Maker] = {"udp": _udp, "can": _can}


def _check_udp(rig: RigFile, folder: Path, key: bytes | None) -> list[str]:
    UdpCodec(rig, key)
    return []


def _check_can(rig: RigFile, folder: Path, key: bytes | None) -> list[str]:
    from rig_bridge.transport.can_check import check_can

    return check_can(rig, folder, key)


Check = Callable[[RigFile, Path, bytes | None], list[str]]
CHECKS: Mapping[str, Check] = {"udp": _check_udp, "can": _check_can}


def check_link(kind: str, rig: RigFile, folder: Path) -> list[str]:
    """Check that a rig's table, files and key fit a link, without opening it.

    Returns what the user should know, as the load of a bus. Raises BenchError.
    """
    if kind not in CHECKS:
        raise BenchError(unknown("transport", kind, CHECKS))
    key, note = trust_of(rig, folder, kind, rig.settings(kind))
    return [*CHECKS[kind](rig, folder, key), *([note] if note else [])]


def trusted_link(
    kind: str,
    rig: RigFile,
    folder: Path,
    values: Settings | None = None,
    rig_end: bool = False,
) -> Link:
    """Open either end of a link with the key that the rig's file asks for; see ``open_link``."""
    if kind not in TRANSPORTS:
        raise BenchError(unknown("transport", kind, TRANSPORTS))
    with _named(kind):
        key = trust_of(rig, folder, kind, values).key
    return open_link(kind, rig, folder, values, rig_end, key)


def open_link(
    kind: str,
    rig: RigFile,
    folder: Path,
    values: Settings | None = None,
    rig_end: bool = False,
    key: bytes | None = None,
) -> Link:
    """Open either end of a link of a rig whose file lies in ``folder``.

    values: the transport's settings. key: of the rig; None where nobody checks who sends. Raises
    BenchError.
    """
    if kind not in TRANSPORTS:
        raise BenchError(unknown("transport", kind, TRANSPORTS))
    with _named(kind):
        return TRANSPORTS[kind](rig, folder, rig_end, values or {}, key)


@contextmanager
def _named(kind: str) -> Iterator[None]:
    """Name the setting of a link that is wrong, as BenchError."""
    try:
        yield
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = ".".join(map(str, first["loc"]))
        raise BenchError(f"setting of the {kind} link: {where}: {first['msg']}") from None
