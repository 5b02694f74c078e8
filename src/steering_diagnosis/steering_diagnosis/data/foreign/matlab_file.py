"""MATLAB files."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from steering_core.errors import BenchError
from steering_core.naming import unknown
from steering_diagnosis.data.foreign.raw import Raw
from steering_diagnosis.data.mapping import Mapping


def read_matlab(path: Path, mapping: Mapping) -> dict[str, Raw]:
    """Read vectors of a MAT file up to version 7; names with dots look into structures."""
    from scipy.io import loadmat

    try:
        content = loadmat(path, squeeze_me=True, struct_as_record=False)
    except NotImplementedError:
        raise BenchError(f"'{path}' is a version 7.3 file: save it with '-v7' in MATLAB") from None
    except (ValueError, OSError, TypeError) as error:
        raise BenchError(f"'{path}' cannot be read as a MAT file: {error}") from None
    vectors = dict(_vectors("", {k: v for k, v in content.items() if not k.startswith("__")}))
    time = mapping.time
    names = [channel.source for channel in mapping.channels.values()]
    for name in [*names, time] if time else names:
        if name not in vectors:
            raise BenchError(f"'{path}': {unknown('vector', name, vectors)}")
    instants = vectors[time] if time else None
    for name in names:
        if instants is not None and len(vectors[name]) != len(instants):
            raise BenchError(
                f"'{path}': '{name}' has {len(vectors[name])} values, '{time}' {len(instants)}"
            )
    return {
        name: Raw(vectors[channel.source], instants) for name, channel in mapping.channels.items()
    }


def _vectors(prefix: str, items: dict[str, Any]) -> Iterable[tuple[str, np.ndarray]]:
    for name, value in items.items():
        if hasattr(value, "_fieldnames"):
            fields = {field: getattr(value, field) for field in value._fieldnames}
            yield from _vectors(f"{prefix}{name}.", fields)
        elif isinstance(value, np.ndarray) and value.ndim == 1 and value.dtype.kind in "fiub":
            yield prefix + name, value.astype(np.float64)
