"""A number that both ends of a link must have in common: that of the channel table."""

from __future__ import annotations

from zlib import crc32

from rig_bridge.rig_file import RigFile


def signature(rig: RigFile, more: str = "") -> int:
    """Return 32 bits of everything that says what the numbers mean; ``more``: the link's own part.

    Limits are left out: the two ends may watch differently.
    """
    rows = [f"{more}"]
    for name in (*rig.measured, *rig.commanded):
        channel = rig.channels[name]
        places = f"{channel.udp} {channel.can}"
        rows.append(f"{name} {channel.scale!r} {channel.offset!r} {channel.sign} {places}")
    return crc32("\n".join(rows).encode())
