"""The check of a rig on CAN before a run: files, table, options of the buses, load of each bus."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rig_bridge.rig_file import RigFile
from rig_bridge.signals import PERIOD_S
from rig_bridge.transport.can_codec import CanCodec
from rig_bridge.transport.can_layout import Bus, Slot
from rig_bridge.transport.can_link import described
from rig_bridge.transport.can_load import FrameShape, worst_load
from rig_bridge.transport.can_options import Rates, bus_options, rates
from rig_bridge.transport.settings import CanSettings
from steering_core.errors import BenchError


def dbc_path(rig: RigFile, folder: Path, buses: Sequence[CanSettings]) -> Path:
    """Return the DBC file of a rig; BenchError where a bus has none."""
    name = rig.dbc or buses[0].dbc
    if name is None or (rig.dbc is None and any(bus.dbc is None for bus in buses)):
        raise BenchError(f"the rig '{rig.name}' has no DBC file (dbc: FILE), which CAN needs")
    return folder / name


def check_can(rig: RigFile, folder: Path, key: bytes | None = None) -> list[str]:
    """Return what the user should know of the buses; BenchError where the rig cannot run on them.

    Nothing is opened.
    """
    settings = rig.links.can
    buses = described(settings, dbc_path(rig, folder, settings))
    codec = CanCodec(rig, buses, key)
    for one in settings:
        bus_options(one)
        if one.fd and one.interface == "socketcand" and rig.emulator is None:
            raise BenchError("links.can: a socketcand server carries no CAN FD")
    notes = [
        _check_load(one, bus, [slot for slot in codec.slots if slot.bus == index], rig)
        for index, (one, bus) in enumerate(zip(settings, buses, strict=True))
    ]
    return [note for note in (*notes, _unread(buses)) if note]


def _check_load(settings: CanSettings, bus: Bus, slots: Sequence[Slot], rig: RigFile) -> str:
    found = rates(settings)
    if found is None:
        unknown = f"CAN bus {bus.name}: its load is not known, as links.can gives no bitrate"
        return "" if rig.emulator else unknown
    shapes = [FrameShape(s.length, s.key[2], s.fd, s.fd and bus.switched) for s in slots]
    load = worst_load(shapes, found)
    of_rate = f"of {_described(found)}"
    if load > 1.0:
        raise BenchError(
            f"CAN bus {bus.name}: {len(slots)} messages in each {1e3 * PERIOD_S:g} ms take up to "
            f"{100.0 * load:.1f} % {of_rate}: use CAN FD (fd, data_bitrate), a second bus, or "
            "fewer and longer messages"
        )
    return (
        f"CAN bus {bus.name}: the rig takes up to {100.0 * load:.1f} % {of_rate}, "
        f"{100.0 * (1.0 - load):.1f} % remain"
    )


def _described(found: Rates) -> str:
    nominal = f"{found.nominal * 1e-6:g}"
    return (
        f"{nominal} Mbit/s"
        if found.data == found.nominal
        else (f"{nominal} and {found.data * 1e-6:g} Mbit/s")
    )


def _unread(buses: Sequence[Bus]) -> str:
    """Return which messages have a fault; the rig uses none of them, or the codec had refused."""
    faults: dict[str, str] = {}
    for bus in buses:
        faults |= getattr(bus.database, "faults", {})
    if not faults:
        return ""
    name, why = next(iter(faults.items()))
    return f"DBC file: {len(faults)} messages that the rig does not use have faults ({name}: {why})"
