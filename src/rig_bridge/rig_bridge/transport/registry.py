"""The one table of transports: a new one is a class with the methods of ``link.Link``.

CAN's libraries are imported where CAN is used: they take a second, in every process.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from rig_bridge.rig_file import RigFile
from rig_bridge.transport.link import Link
from rig_bridge.transport.settings import CanSettings, UdpSettings, several
from rig_bridge.transport.udp import UdpLink
from rig_bridge.transport.udp_codec import UdpCodec
from steering_core.errors import BenchError
from steering_core.naming import unknown

Settings = Mapping[str, Any] | Sequence[Mapping[str, Any]]


def _udp(rig: RigFile, folder: Path, rig_end: bool, values: Settings) -> Link:
    return UdpLink(rig, UdpSettings.model_validate(values), rig_end)


def _can(rig: RigFile, folder: Path, rig_end: bool, values: Settings) -> Link:
    from rig_bridge.transport.can_check import dbc_path
    from rig_bridge.transport.can_link import CanLink

    buses = [CanSettings.model_validate(one) for one in several(values)]
    return CanLink(rig, buses, dbc_path(rig, folder, buses))


Maker = Callable[[RigFile, Path, bool, Settings], Link]
TRANSPORTS: Mapping[str, Maker] = {"udp": _udp, "can": _can}


def _check_udp(rig: RigFile, folder: Path) -> list[str]:
    UdpCodec(rig)
    return []


def _check_can(rig: RigFile, folder: Path) -> list[str]:
    from rig_bridge.transport.can_check import check_can

    return check_can(rig, folder)


CHECKS: Mapping[str, Callable[[RigFile, Path], list[str]]] = {"udp": _check_udp, "can": _check_can}


def check_link(kind: str, rig: RigFile, folder: Path) -> list[str]:
    """Check that a rig's table and files fit a link, without opening it.

    Returns what the user should know, as the load of a bus. Raises BenchError.
    """
    if kind not in CHECKS:
        raise BenchError(unknown("transport", kind, CHECKS))
    return CHECKS[kind](rig, folder)


def open_link(
    kind: str,
    rig: RigFile,
    folder: Path,
    values: Settings | None = None,
    rig_end: bool = False,
) -> Link:
    """Open either end of a link of a rig whose file lies in ``folder``.

    values: the transport's settings. Raises BenchError.
    """
    if kind not in TRANSPORTS:
        raise BenchError(unknown("transport", kind, TRANSPORTS))
    try:
        return TRANSPORTS[kind](rig, folder, rig_end, values or {})
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = ".".join(map(str, first["loc"]))
        raise BenchError(f"setting of the {kind} link: {where}: {first['msg']}") from None
