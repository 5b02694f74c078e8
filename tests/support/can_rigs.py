"""Rigs on CAN made of the shipped one: other DBC files, buses and channels; bits read by hand."""

from __future__ import annotations

import itertools
import struct
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import can
from healthy_rig import EMULATED
from rig_links import RIG

from rig_bridge.channels import CanPlace, Channel
from rig_bridge.rig_file import RigFile
from rig_bridge.transport.registry import open_link
from rig_bridge.transport.settings import Links

DBC = EMULATED.with_suffix(".dbc").read_text()
FD_ATTRIBUTES = """
BA_DEF_ BO_ "VFrameFormat" ENUM "StandardCAN","ExtendedCAN","reserved","J1939PG",
 %s "StandardCAN_FD","ExtendedCAN_FD";
BA_DEF_DEF_ "VFrameFormat" "StandardCAN";
""" % ('"reserved",' * 10)
CHANNELS = itertools.count()


def extended(text: str, numbers: Sequence[int]) -> str:
    """Return a DBC text whose messages ``numbers`` have identifiers of 29 bits."""
    for number in numbers:
        text = text.replace(f"BO_ {number} ", f"BO_ {number | 1 << 31} ")
    return text


def fd_dbc() -> str:
    """Return a DBC text with one long message for the measurements and one for the commands."""
    text = 'VERSION ""\n\nBU_: Bench Rig\n'
    for number, name, channels in ((256, "Measured", RIG.measured), (512, "Asked", RIG.commanded)):
        text += f"\nBO_ {number} {name}: 48 Rig\n"
        for index, channel in enumerate(channels):
            text += f' SG_ {channel} : {7 + 32 * index}|32@0- (1,0) [0|0] "" Bench\n'
        text += ' SG_ Counter : 320|8@1+ (1,0) [0|0] "" Bench\n'
    for message in (
        *("BO_ 259 RigStatus", "BO_ 260 RigMeet", "BO_ 261 RigTag"),
        *("BO_ 516 BenchStatus", "BO_ 517 BenchMeet", "BO_ 518 BenchTag"),
    ):
        block = DBC[DBC.index(message) :].split("\n\n")[0].rstrip()
        text += "\n" + block.replace(": 60|4@", ": 56|8@").replace("16|44@", "16|40@") + "\n"
    return text


def rig_of(folder: Path, buses: Any = None, dbc: str = DBC) -> RigFile:
    """Return the emulated rig with other buses (``links.can``), its DBC text written to a file."""
    (folder / "rig.dbc").write_text(dbc)
    links = Links.model_validate({"can": buses or virtual()})
    changes: dict[str, Any] = {"links": links, "dbc": "rig.dbc"}
    if "BO_ 256 Measured" in dbc:
        changes["channels"] = {name: _in_fd_dbc(name, row) for name, row in RIG.channels.items()}
    return RIG.model_copy(update=changes)


def _in_fd_dbc(name: str, row: Channel) -> Channel:
    message = "Measured" if row.direction == "measured" else "Asked"
    return row.model_copy(update={"can": CanPlace(message=message, signal=name)})


def virtual(**more: Any) -> dict[str, Any]:
    """Return the settings of a bus of this process that nobody else has."""
    return {"interface": "virtual", "channel": f"bus{next(CHANNELS)}", **more}


@contextmanager
def ends(folder: Path, buses: Any, dbc: str = DBC) -> Iterator[tuple[Any, Any]]:
    """Give the bench's and the rig's end of a rig on these buses."""
    rig = rig_of(folder, buses, dbc)
    bench = open_link("can", rig, folder, buses)
    try:
        far = open_link("can", rig, folder, buses, rig_end=True)
        try:
            yield bench, far
        finally:
            far.close()
    finally:
        bench.close()


@contextmanager
def wire(settings: dict[str, Any]) -> Iterator[can.BusABC]:
    """Give somebody else's access to a virtual bus."""
    bus = can.Bus(interface="virtual", channel=settings["channel"])
    try:
        yield bus
    finally:
        bus.shutdown()


def heard(bus: can.BusABC) -> list[can.Message]:
    """Return what has come on a bus."""
    return list(iter(lambda: bus.recv(0.02), None))


def bit(data: bytes, place: int) -> int:
    """Return a bit by its number in a DBC file: eight in each byte, the lowest first."""
    return data[place // 8] >> (place % 8) & 1


def places(start: int, length: int, motorola: bool) -> list[int]:
    """Return the places of a signal's bits, the lowest first."""
    if not motorola:
        return list(range(start, start + length))
    down = [start]
    while len(down) < length:
        down.append(down[-1] - 1 if down[-1] % 8 else down[-1] + 15)
    return down[::-1]


def count_in(data: bytes, start: int, length: int, motorola: bool, kind: str) -> float:
    """Return the number of a signal; kind: "+" without, "-" with sign, "f" a float."""
    bits = [bit(data, place) for place in places(start, length, motorola)]
    count = sum(value << index for index, value in enumerate(bits))
    if kind == "f":
        code = {16: ">e", 32: ">f", 64: ">d"}[length]
        return float(struct.unpack(code, count.to_bytes(length // 8, "big"))[0])
    return count - (bits[-1] << length) if kind == "-" else count
