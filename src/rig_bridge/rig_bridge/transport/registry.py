"""The one table of transports: a new one is a class with the methods of ``link.Link``."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from rig_bridge.rig_file import RigFile
from rig_bridge.transport.can_codec import CanCodec
from rig_bridge.transport.can_link import CanLink
from rig_bridge.transport.dbc import load_dbc
from rig_bridge.transport.link import Link
from rig_bridge.transport.settings import CanSettings, UdpSettings
from rig_bridge.transport.udp import UdpLink
from rig_bridge.transport.udp_codec import UdpCodec
from steering_core.errors import BenchError
from steering_core.naming import unknown


def _udp(rig: RigFile, folder: Path, rig_end: bool, values: Mapping[str, Any]) -> Link:
    return UdpLink(rig, UdpSettings.model_validate(values), rig_end)


def _can(rig: RigFile, folder: Path, rig_end: bool, values: Mapping[str, Any]) -> Link:
    return CanLink(rig, CanSettings.model_validate(values), _dbc(rig, folder))


def _dbc(rig: RigFile, folder: Path) -> Path:
    if rig.dbc is None:
        raise BenchError(f"the rig '{rig.name}' has no DBC file (dbc: FILE), which CAN needs")
    return folder / rig.dbc


Maker = Callable[[RigFile, Path, bool, Mapping[str, Any]], Link]
TRANSPORTS: Mapping[str, Maker] = {"udp": _udp, "can": _can}


def _check_udp(rig: RigFile, folder: Path) -> None:
    UdpCodec(rig)


def _check_can(rig: RigFile, folder: Path) -> None:
    CanCodec(rig, load_dbc(_dbc(rig, folder)))


CHECKS: Mapping[str, Callable[[RigFile, Path], None]] = {"udp": _check_udp, "can": _check_can}


def check_link(kind: str, rig: RigFile, folder: Path) -> None:
    """Raise BenchError where a rig's table or DBC file does not fit a link, without opening it."""
    if kind not in CHECKS:
        raise BenchError(unknown("transport", kind, CHECKS))
    CHECKS[kind](rig, folder)


def open_link(
    kind: str,
    rig: RigFile,
    folder: Path,
    values: Mapping[str, Any] | None = None,
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
