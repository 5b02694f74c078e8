"""MDF files, version 4 and 3."""

from __future__ import annotations

import contextlib
import gc
import io
import logging
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from steering_core.errors import BenchError
from steering_diagnosis.data.foreign.raw import Raw
from steering_diagnosis.data.mapping import Mapping

UNFINISHED = b"UnFinMF"
"""The first bytes of a file that its logger did not close."""


def read_mdf(path: Path, mapping: Mapping) -> dict[str, Raw]:
    """Read channels of an MDF file, each with the clock of its own group."""
    with _quiet(), contextlib.ExitStack() as stack:
        files = [stack.enter_context(_opened(path))]
        if mapping.database:
            files.append(stack.enter_context(_decoded(files[0], Path(mapping.database), path)))
        try:
            return _channels(files, mapping, path)
        except BenchError:
            raise
        except Exception as error:
            # The library trips over what is broken with errors of every kind.
            raise BenchError(f"'{path}' is damaged: {_line(error)}") from None


def _channels(files: Sequence[Any], mapping: Mapping, path: Path) -> dict[str, Raw]:
    from steering_diagnosis.data.foreign.mdf_channels import find
    from steering_diagnosis.data.foreign.mdf_clock import clock, unit_of
    from steering_diagnosis.data.foreign.mdf_values import numbers

    found = {}
    # What is true of the whole file or of a group is told once.
    told: set[str] = set()
    cut = _cut_off(path)
    for name, channel in mapping.channels.items():
        place = find(files, channel, path)
        values, lost = numbers(place)
        time, time_unit, notes = clock(place, mapping)
        if time is not None and len(time) != len(values):
            # A file that breaks off inside a column; what has both is kept.
            kept = min(len(time), len(values))
            time, values = time[:kept], values[:kept]
        shared = tuple(note for note in (*cut, *notes) if note not in told)
        told.update(shared)
        found[name] = Raw(values, time, unit_of(place), time_unit, notes=(*lost, *shared))
    return found


def _opened(path: Path) -> Any:
    from asammdf import MDF

    with path.open("rb") as file:
        begins = file.read(8)
    if begins.strip(b" \0") not in (b"MDF", UNFINISHED):
        what = f"begins with {begins!r}" if begins else "is empty"
        raise BenchError(f"'{path}' cannot be read as MDF: it {what}")
    try:
        return MDF(path)
    except Exception as error:
        # What the library says of its own buffers is no help.
        problem = "" if "mmap" in str(error) or "buffer" in str(error) else f" ({_line(error)})"
    # What the library left half made is to be deleted now, while it is kept quiet.
    gc.collect(1)
    size = path.stat().st_size
    raise BenchError(
        f"'{path}' cannot be read as MDF: it is cut off or damaged ({size} bytes): copy it again "
        f"from the logger{problem}"
    )


def _cut_off(path: Path) -> tuple[str, ...]:
    with path.open("rb") as file:
        if file.read(7) != UNFINISHED:
            return ()
    return ("the logger did not close the file: read as far as it goes",)


def _decoded(file: Any, database: Path, path: Path) -> Any:
    """Return the channels that a CAN database makes of a file's bus frames, as an MDF."""
    if not database.is_file():
        raise BenchError(f"there is no CAN database '{database}'")
    try:
        decoded = file.extract_bus_logging({"CAN": [(str(database), 0)]})
    except Exception as error:
        raise BenchError(f"'{path}': '{database}' does not decode it: {_line(error)}") from None
    if not decoded.groups:
        raise BenchError(f"'{path}': no frame of it is in the CAN database '{database}'")
    return decoded


def _line(error: Exception) -> str:
    return " ".join(str(error).split())[:200] or type(error).__name__


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Keep the library's own log and tracebacks off the terminal: its errors are told here."""
    logger = logging.getLogger("asammdf")
    before, hook = logger.level, sys.unraisablehook
    logger.setLevel(logging.CRITICAL + 1)
    # An MDF that could not be opened raises once more when it is deleted.
    sys.unraisablehook = lambda _: None
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            yield
    finally:
        logger.setLevel(before)
        sys.unraisablehook = hook
