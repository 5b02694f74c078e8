"""Reading a DBC file, and what of it both ends must have in common."""

from __future__ import annotations

from pathlib import Path

import cantools
from cantools.database.can import Database

from steering_core.errors import BenchError


def load_dbc(path: Path) -> Database:
    """Read a DBC file; BenchError names it and the line if it cannot be read."""
    try:
        database = cantools.database.load_file(path, database_format="dbc", cache_dir=None)
    except FileNotFoundError:
        raise BenchError(f"there is no DBC file '{path}'") from None
    except (OSError, UnicodeDecodeError, cantools.database.errors.Error) as error:
        reason = str(error).splitlines()[0]
        raise BenchError(f"cannot read the DBC file '{path}': {reason}") from None
    if not isinstance(database, Database):
        raise BenchError(f"'{path}' is no DBC file of a CAN bus")
    return database


def layout_text(database: Database) -> str:
    """Return the frames' layout as text: identifiers, and each signal's place and scale."""
    rows = []
    for message in sorted(database.messages, key=lambda message: message.frame_id):
        rows.append(f"{message.frame_id} {message.name} {message.length}")
        for s in sorted(message.signals, key=lambda signal: signal.name):
            place = f"{s.start} {s.length} {s.byte_order} {s.is_signed}"
            rows.append(f" {s.name} {place} {float(s.scale)!r} {float(s.offset)!r}")
    return "\n".join(rows)
