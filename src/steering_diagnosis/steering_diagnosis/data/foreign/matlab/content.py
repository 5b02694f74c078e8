"""The content of a MAT file: variables by name, whatever version wrote it."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np

from steering_core.errors import BenchError

HDF5 = b"\x89HDF\r\n\x1a\n"
PLACES_OF_HDF5 = (0, 512, 1024, 2048)
"""Where the signature may stand: MATLAB 7.3 puts a text of 512 bytes before it (HDF5 format
specification, section II.A)."""

LARGEST_V4_TYPE = 4052
"""Of the first number of a version 4 file: its digits are M, O, P, T (MAT-File Format, R2023b)."""

HEADER = b"MATLAB"


def load(path: Path) -> dict[str, Any]:
    """Return the variables of a MAT file, version 4 to 7.3.

    BenchError: the file is broken, or none.
    """
    hdf5 = _kind(path)
    try:
        with warnings.catch_warnings():
            # Of objects that cannot be converted: they are told by name, where they are asked for.
            warnings.simplefilter("ignore")
            return _plain_hdf5(path) if hdf5 and not _by_matlab(path) else _by_library(path)
    # Libraries raise whatever comes up in the middle of damaged bytes.
    except Exception as error:
        text = " ".join(str(error).split()) or type(error).__name__
        raise BenchError(f"'{path}' is a damaged MAT file: {text}") from None


def _kind(path: Path) -> bool:
    """Return whether the file is HDF5; BenchError where it is no MAT file at all."""
    with path.open("rb") as file:
        head = file.read(PLACES_OF_HDF5[-1] + len(HDF5))
    if not head:
        raise BenchError(f"'{path}' is no MAT file: it is empty")
    if any(head[at : at + len(HDF5)] == HDF5 for at in PLACES_OF_HDF5):
        return True
    if head.startswith(HEADER) or head[124:128] in (b"\x00\x01IM", b"\x01\x00MI"):
        if len(head) < 128:
            raise BenchError(f"'{path}' is a MAT file that was cut off in its header")
        return False
    first = {int.from_bytes(head[:4], order) for order in ("little", "big")}
    if len(head) >= 20 and min(first) <= LARGEST_V4_TYPE:
        return False
    raise BenchError(f"'{path}' is no MAT file: it begins with {head[:16]!r}")


def _by_matlab(path: Path) -> bool:
    """Return whether an HDF5 file says of its variables what class MATLAB has them in."""
    import h5py

    with h5py.File(path, "r") as file:
        return any("MATLAB_class" in item.attrs for item in file.values())


def _by_library(path: Path) -> dict[str, Any]:
    import matio

    return {k: v for k, v in matio.load_from_mat(path).items() if not k.startswith("__")}


def _plain_hdf5(path: Path) -> dict[str, Any]:
    """Return groups as dictionaries and datasets as arrays, as other programs write them."""
    import h5py

    def content(item: Any) -> Any:
        if isinstance(item, h5py.Group):
            return {name: content(member) for name, member in item.items()}
        return np.asarray(item[()])

    with h5py.File(path, "r") as file:
        return {name: content(item) for name, item in file.items() if not name.startswith("#")}
