"""Files and folders that a command is asked to write: refused before the work where they cannot be.

A file that cannot be written after all (a full disk) is named.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from steering_core.errors import BenchError


def check_folder(folder: Path) -> None:
    """Refuse a folder that is a file, cannot be made, or cannot be written into."""
    above = next(place for place in (folder, *folder.absolute().parents) if place.exists())
    if not above.is_dir():
        told = "is a file, no folder" if above == folder else f"cannot be made: '{above}' is a file"
        raise BenchError(f"'{folder}' {told}: name another one")
    if not os.access(above, os.W_OK | os.X_OK):
        raise BenchError(f"no permission to write into '{above}': name another folder")


def check_file(file: Path) -> None:
    """Refuse a file that is a folder or cannot be written."""
    if file.is_dir():
        raise BenchError(f"'{file}' is a folder: name a file")
    if not file.exists():
        check_folder(file.parent)
    elif not os.access(file, os.W_OK):
        raise BenchError(f"no permission to write '{file}': name another file")


def write_json(file: Path, data: Any) -> None:
    """Write data for machines, with the folders above the file; BenchError names the file."""
    write_text(file, json.dumps(data, indent=2) + "\n")


def write_text(file: Path, text: str) -> None:
    """Write a text, with the folders above the file; BenchError names the file."""
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8", errors="replace")
    except OSError as error:
        raise BenchError(f"'{file}' cannot be written: {error.strerror}") from None
