"""Which key a link uses, and which link starts without one."""

from __future__ import annotations

import ipaddress
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from rig_bridge.rig_file import RigFile
from rig_bridge.transport.settings import CanSettings, UdpSettings, address, several
from rig_bridge.trust.key_file import load_key, own_key
from steering_core.errors import BenchError


class Trust(NamedTuple):
    """The key of a link, or None; ``note``: what the user must know."""

    key: bytes | None
    note: str = ""


def trust_of(rig: RigFile, folder: Path, kind: str, settings: Any) -> Trust:
    """Return the key of a rig whose file lies in ``folder``.

    settings: of the link, as it is opened. BenchError for a key that cannot be used, and for a
    link beyond this machine without one.
    """
    if rig.authentication == "none":
        return Trust(None, _unprotected(rig, "as its file says (authentication: none)"))
    if rig.key is not None:
        return Trust(load_key(folder / Path(rig.key).expanduser()))
    if rig.emulator is not None:
        return Trust(load_key(own_key()))
    where = beyond(kind, settings)
    if where is not None:
        raise BenchError(
            f"the rig '{rig.name}' has no key, and its link leaves this machine ({where}): make "
            "one with 'steer rig-key FILE' and name it in the rig's file (key: FILE), or write "
            "'authentication: none' if the rig cannot check one"
        )
    return Trust(None, _unprotected(rig, "as it has no key (steer rig-key)"))


def _unprotected(rig: RigFile, why: str) -> str:
    return f"whoever reaches its link can move the rig '{rig.name}': no authentication, {why}"


def beyond(kind: str, settings: Any) -> str | None:
    """Return where a link leaves this machine; None where it does not."""
    if kind == "udp":
        ends = UdpSettings.model_validate(settings or {})
        return next((e for e in (ends.bench, ends.rig) if not is_loopback(address(e)[0])), None)
    buses = [CanSettings.model_validate(one) for one in several(settings or {})]
    return next((bus.name for bus in buses if not _is_here(bus)), None)


def _is_here(bus: CanSettings) -> bool:
    if bus.interface == "socketcand":
        return is_loopback(bus.host or "")
    if bus.interface == "socketcan":
        return str(bus.channel).startswith("vcan")
    more: Mapping[str, Any] = bus.more
    return bus.interface == "virtual" or more.get("hop_limit") == 0


def is_loopback(host: str) -> bool:
    """Return whether an address stays on this machine."""
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False
