"""From arrays to recorded payloads: the way back of the reader."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields as dataclass_fields
from typing import Any

import numpy as np

from steering_bringup.bags.definitions import typestore
from steering_bringup.bags.errors import BagError
from steering_bringup.bags.layout import layout_of


def encode(
    msgtype: str, stamps_ns: np.ndarray, values: Mapping[str, Any], frame_id: str = ""
) -> np.ndarray:
    """CDR payloads (n, size) uint8 of n messages.

    stamps_ns: (n,). values: field name -> (n,) or a constant; what is not named is zero or empty.
    Raises BagError for an unknown field or a type without a fixed layout.
    """
    store = typestore()
    sample = bytes(store.serialize_cdr(_empty(store, msgtype, frame_id), msgtype))
    layout = layout_of(msgtype, store, sample)
    if layout is None:
        raise BagError(f"{msgtype} has no fixed layout, so it cannot be encoded from arrays")
    payloads = np.tile(np.frombuffer(sample, np.uint8), (len(stamps_ns), 1))
    rows = layout.rows(payloads)
    names = rows.dtype.names or ()
    if "header.stamp.sec" in names:
        rows["header.stamp.sec"] = stamps_ns // 10**9
        rows["header.stamp.nanosec"] = stamps_ns % 10**9
    for name, value in values.items():
        if name not in names:
            raise BagError(f"{msgtype} has no field {name}; it has {', '.join(names)}")
        rows[name] = value
    return payloads


def _empty(store: Any, msgtype: str, frame_id: str) -> Any:
    """A message of zeros and empty texts, with its frame_id."""
    kind: Any = store.types[msgtype]
    arguments: dict[str, Any] = {}
    for name, (node, detail) in store.fielddefs[msgtype][1]:
        if name == "frame_id":
            arguments[name] = frame_id
        elif node.name == "NAME":
            arguments[name] = _empty(store, detail, frame_id)
        elif node.name == "BASE":
            arguments[name] = "" if detail[0] in ("string", "wstring") else 0
        elif node.name == "ARRAY":
            arguments[name] = np.zeros(detail[1], detail[0][1][0])
        else:
            arguments[name] = []
    return kind(
        **{f.name: arguments[f.name] for f in dataclass_fields(kind) if f.name in arguments}
    )
