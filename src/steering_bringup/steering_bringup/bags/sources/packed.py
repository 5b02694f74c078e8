"""What rosbag2 has compressed: whole files, and messages one by one. Told by their first bytes."""

from __future__ import annotations

from pathlib import Path

import zstandard

from steering_bringup.bags.errors import BagError

ZSTD = b"\x28\xb5\x2f\xfd"
PORTION = 1 << 20


def unpack_message(data: bytes) -> bytes:
    """Return the content of one zstd frame; ValueError where it is damaged or cut off."""
    reader = zstandard.ZstdDecompressor().decompressobj()
    try:
        content = reader.decompress(data)
    except zstandard.ZstdError as error:
        raise ValueError(str(error)) from None
    if not reader.eof:
        raise ValueError("it is cut off")
    return content


def unpack_file(file: Path, folder: Path) -> tuple[Path, str]:
    """Unpack ``file`` into ``folder``; return the new file, and what was wrong with the old one.

    What is before a damage is kept. BagError where there is no room.
    """
    target = folder / file.name.removesuffix(".zstd").removesuffix(".zst")
    damage = ""
    unpacker = zstandard.ZstdDecompressor()
    reader = unpacker.decompressobj()
    try:
        with file.open("rb") as source, target.open("wb") as sink:
            while portion := source.read(PORTION):
                while portion:
                    reader = unpacker.decompressobj() if reader.eof else reader
                    sink.write(reader.decompress(portion))
                    portion = reader.unused_data  # of a further frame
    except zstandard.ZstdError as error:
        damage = f"it is damaged ({error})"
    except OSError as error:
        raise BagError(f"'{file}' cannot be unpacked: {error.strerror}") from error
    if not damage and not reader.eof:
        damage = "it is cut off"
    return target, damage
