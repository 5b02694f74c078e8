"""Writes version 7.3 files the way MATLAB does: HDF5 behind a user block, column by column."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np

CLASSES = {"float64": "double", "float32": "single", "bool": "logical"}


def save73(path: Path, variables: dict[str, Any]) -> Path:
    """Write arrays, texts, dicts as structures, lists of dicts as arrays, objects as cells."""
    with h5py.File(path, "w", userblock_size=512) as file:
        references = file.create_group("#refs#", track_order=True)
        for name, value in variables.items():
            _write(file, references, name, value)
    header = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Mon Jan  1 00:00:00 2024 HDF5"
    with path.open("r+b") as opened:
        opened.write(header.ljust(116) + bytes(8) + b"\x00\x02IM")
    return path


def _write(group: h5py.Group, references: h5py.Group, name: str, value: Any) -> None:
    if isinstance(value, np.ndarray) and value.dtype == object:
        _refer(group, references, name, list(value.flat))
        _of_class(group[name], "cell")
    elif isinstance(value, dict):
        structure = group.create_group(name, track_order=True)
        _of_class(structure, "struct")
        for field, child in value.items():
            _write(structure, references, field, child)
    elif isinstance(value, list):
        structure = group.create_group(name, track_order=True)
        _of_class(structure, "struct")
        for field in value[0]:
            _refer(structure, references, field, [item[field] for item in value])
    elif isinstance(value, str):
        units = np.frombuffer(value.encode("utf-16-le"), np.uint16)
        _of_class(group.create_dataset(name, data=units[:, np.newaxis]), "char", 2)
    else:
        _array(group, name, np.asarray(value))


def _array(group: h5py.Group, name: str, array: np.ndarray) -> None:
    kind = CLASSES.get(array.dtype.name, array.dtype.name)
    if array.size == 0:
        empty = group.create_dataset(name, data=np.array([0, 0], np.uint64))
        empty.attrs["MATLAB_empty"] = np.uint8(1)
        return _of_class(empty, kind)
    stored = np.atleast_2d(array).T
    if array.dtype == bool:
        return _of_class(group.create_dataset(name, data=stored.astype(np.uint8)), kind, 1)
    pressed = {"compression": "gzip", "chunks": True} if array.size > 1000 else {}
    return _of_class(group.create_dataset(name, data=stored, **pressed), kind)


def _refer(group: h5py.Group, references: h5py.Group, name: str, items: list[Any]) -> None:
    table = group.create_dataset(name, (len(items), 1), dtype=h5py.ref_dtype)
    for k, item in enumerate(items):
        key = f"{len(references)}"
        _write(references, references, key, item)
        table[k, 0] = references[key].ref


def _of_class(item: Any, name: str, decode: int | None = None) -> None:
    item.attrs["MATLAB_class"] = np.bytes_(name)
    if decode is not None:
        item.attrs["MATLAB_int_decode"] = np.int32(decode)
