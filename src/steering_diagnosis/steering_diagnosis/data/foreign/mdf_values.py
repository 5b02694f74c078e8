"""The numbers of one MDF channel: raw values, what is invalid or a text, and the conversion.

asammdf reads the bytes. The conversion is applied here where the library's would hide a fault: it
truncates tables' keys to integers, mixes texts with numbers, and returns raw values where a formula
cannot be evaluated.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from asammdf.blocks import v2_v3_constants as v3
from asammdf.blocks import v4_constants as v4

from steering_core.errors import BenchError
from steering_diagnosis.data.foreign.mdf_channels import BUS_FRAMES, Place, components

TEXTS = (v4.CONVERSION_TYPE_TTAB, v4.CONVERSION_TYPE_TRANS)
"""Conversions that take texts."""


@dataclass
class Texts:
    """Samples that a conversion turned into a text, by that text."""

    counts: dict[str, int] = field(default_factory=dict)

    def add(self, text: bytes | None, count: int) -> None:
        """Count samples; an empty text is a table's for values that it does not list."""
        if count:
            shown = "" if text is None else text.decode("utf-8", "replace").strip("\0 ")
            self.counts[shown] = self.counts.get(shown, 0) + count

    def __str__(self) -> str:
        named = {text: f"'{text}'" if text else "not in the table" for text in self.counts}
        shown = [f"{named[text]} ({count})" for text, count in self.counts.items()]
        return ", ".join(shown[:4]) + (", ..." if len(shown) > 4 else "")


def numbers(place: Place) -> tuple[np.ndarray, tuple[str, ...]]:
    """Return a channel's physical values (n,), NaN where there is none, and what was lost.

    BenchError: no plain numbers, no sample, or a conversion that cannot be computed.
    """
    block = place.block
    where = f"'{place.path}': channel '{block.name}'"
    if block.conversion is None and block.conversion_addr:
        # The library goes on without a conversion that it cannot read.
        raise BenchError(f"{where}: its conversion is damaged, its numbers mean nothing")
    raw, invalid = place.file.get(
        group=place.group,
        index=place.index,
        raw=True,
        samples_only=True,
        ignore_invalidation_bits=True,
    )
    _check_kind(raw, place, where)
    texts = Texts()
    values = _physical(block.conversion, raw, place.file.version < "4", texts, where)
    notes = []
    invalid = _invalid(place, invalid, len(values))
    if invalid.any():
        values = np.where(invalid, np.nan, values)
        notes.append(f"{np.count_nonzero(invalid)} samples are marked invalid in the file")
    if texts.counts:
        notes.append(f"samples that are texts and no numbers: {texts}")
    expected = place.file.groups[place.group].channel_group.cycles_nr
    if len(values) < expected:
        notes.append(f"the file breaks off: {len(values)} of {expected} samples are there")
    if not len(values):
        raise BenchError(f"{where} has no samples")
    return values, tuple(notes)


def _check_kind(raw: np.ndarray, place: Place, where: str) -> None:
    name = place.block.name
    if name.split(".")[0] in BUS_FRAMES and raw.dtype.names:
        raise BenchError(
            f"{where} is whole bus frames that were never decoded: name the CAN database with "
            "'database: FILE.dbc' in the mapping, and its signals with 'from'"
        )
    if parts := components(place):
        shown = ", ".join(f"{name}.{part}" for part in parts)
        raise BenchError(f"{where} is a structure: name one of its parts, {shown}")
    if raw.dtype.names and raw.dtype[0].shape:
        first = name + "[0]" * len(raw.dtype[0].shape)
        raise BenchError(f"{where} is an array: name one of its elements, such as {first}")
    conversion = place.block.conversion
    from_text = raw.dtype.kind in "SU" and getattr(conversion, "conversion_type", 0) in TEXTS
    if raw.ndim != 1 or (raw.dtype.kind not in "fiub" and not from_text):
        kinds = {"S": "texts", "U": "texts", "c": "complex numbers"}
        shown = kinds.get(raw.dtype.kind, "structures" if raw.dtype.names else "bytes")
        raise BenchError(f"{where} does not hold plain numbers but {shown}")


def _invalid(place: Place, bits: np.ndarray | None, count: int) -> np.ndarray:
    """Return (n,) bool; the flags say whether there are invalidation bits to be looked at."""
    flags = getattr(place.block, "flags", 0) if place.file.version >= "4" else 0
    if flags & v4.FLAG_CN_ALL_INVALID:
        return np.ones(count, dtype=bool)
    if bits is None:
        return np.zeros(count, dtype=bool)
    return np.asarray(bits, dtype=bool)


def _physical(conversion: Any, raw: np.ndarray, old: bool, texts: Texts, where: str) -> np.ndarray:
    """Return physical values, NaN for texts, which are counted in ``texts``."""
    if conversion is None:
        return raw.astype(np.float64)
    kind = conversion.conversion_type
    if old:
        if kind in (v3.CONVERSION_TYPE_TABX, v3.CONVERSION_TYPE_RTABX):
            return _old_table(conversion, raw, texts)
        if kind == v3.CONVERSION_TYPE_FORMULA:
            return _formula(conversion.formula, raw.astype(np.float64), where)
        return _computed(conversion, raw.astype(np.float64), where)
    if kind in (v4.CONVERSION_TYPE_TABX, v4.CONVERSION_TYPE_RTABX):
        return _table(conversion, raw, texts, where)
    if kind == v4.CONVERSION_TYPE_ALG:
        return _formula(conversion.formula, raw.astype(np.float64), where)
    if kind == v4.CONVERSION_TYPE_RTAB:
        return _ranges(conversion, raw)
    if kind in TEXTS:
        return _from_texts(conversion, raw, texts)
    if kind == v4.CONVERSION_TYPE_BITFIELD:
        raise BenchError(f"{where} is a field of bits with texts, no number")
    return _computed(conversion, raw.astype(np.float64), where)


def _computed(conversion: Any, raw: np.ndarray, where: str) -> np.ndarray:
    """Return what the library computes of float64: linear, rational, interpolated and the like."""
    try:
        values = np.asarray(conversion.convert(raw))
        return values.astype(np.float64)
    except Exception as error:
        raise BenchError(f"{where}: its conversion cannot be computed: {error}") from None


def _table(conversion: Any, raw: np.ndarray, texts: Texts, where: str) -> np.ndarray:
    """Return values of a table from a number or a range to a text or a further conversion."""
    blocks = conversion.referenced_blocks
    ranged = conversion.conversion_type == v4.CONVERSION_TYPE_RTABX
    values = np.full(len(raw), np.nan)
    left = np.ones(len(raw), dtype=bool)
    for k in range(conversion.val_param_nr // (2 if ranged else 1)):
        inside = _within(raw, conversion, k) if ranged else raw == conversion[f"val_{k}"]
        _fill(values, raw, left & inside, blocks[f"text_{k}"], texts, where)
        left &= ~inside
    # What the table does not list and has no default for is no number: its scale is not known.
    _fill(values, raw, left, blocks.get("default_addr"), texts, where)
    return values


def _fill(
    values: np.ndarray, raw: np.ndarray, at: np.ndarray, block: Any, texts: Texts, where: str
) -> None:
    """Put what a table's entry makes of the raw values ``at`` into ``values``."""
    if block is None or isinstance(block, bytes):
        texts.add(block, int(np.count_nonzero(at)))
    elif at.any():
        values[at] = _physical(block, raw[at], False, texts, where)


def _within(raw: np.ndarray, conversion: Any, k: int) -> np.ndarray:
    """Return what is in a table's range: both ends count for integers, the lower for floats."""
    low, high = conversion[f"lower_{k}"], conversion[f"upper_{k}"]
    if raw.dtype.kind == "f":
        return np.asarray(((low <= raw) & (raw < high)) | ((raw == low) & (low == high)))
    return np.asarray((low <= raw) & (raw <= high))


def _ranges(conversion: Any, raw: np.ndarray) -> np.ndarray:
    """Return values of a table from ranges to numbers."""
    values = np.full(len(raw), float(conversion.default))
    for k in reversed(range((conversion.val_param_nr - 1) // 3)):
        values[_within(raw, conversion, k)] = conversion[f"phys_{k}"]
    return values


def _from_texts(conversion: Any, raw: np.ndarray, texts: Texts) -> np.ndarray:
    """Return the numbers that a table gives to texts; NaN for those that it does not know."""
    converted = np.asarray(conversion.convert(raw))
    if converted.dtype.kind in "fiub":
        values = converted.astype(np.float64)
        lost = ~np.isfinite(values)
    else:
        values, lost = np.full(len(raw), np.nan), np.ones(len(raw), dtype=bool)
    for text, count in zip(*np.unique(raw[lost], return_counts=True), strict=True):
        texts.add(bytes(text), int(count))
    return values


def _formula(formula: str, raw: np.ndarray, where: str) -> np.ndarray:
    """Return what a formula in X makes of the raw values."""
    import numexpr

    try:
        given = {"X": raw, "X1": raw, "INF": np.inf, "NaN": np.nan}
        # The library writes every x of a formula as X, that of exp too.
        values = numexpr.evaluate(formula.replace("eXp", "exp"), local_dict=given, global_dict={})
    except Exception:
        raise BenchError(f"{where}: its formula '{formula}' cannot be computed") from None
    return np.broadcast_to(np.asarray(values, dtype=np.float64), raw.shape)


def _old_table(conversion: Any, raw: np.ndarray, texts: Texts) -> np.ndarray:
    """Return values of an MDF3 table of texts, whose default may be a text with a formula."""
    ranged = conversion.conversion_type == v3.CONVERSION_TYPE_RTABX
    values = np.full(len(raw), np.nan)
    left = np.ones(len(raw), dtype=bool)
    for k in range(conversion.ref_param_nr - ranged):
        text = conversion.referenced_blocks[f"text_{k}"] if ranged else conversion[f"text_{k}"]
        inside = _within(raw, conversion, k) if ranged else raw == conversion[f"param_val_{k}"]
        texts.add(text, int(np.count_nonzero(left & inside)))
        left &= ~inside
    default = conversion.referenced_blocks.get("default_addr") if ranged else None
    if ranged and default and b"{X}" in default:
        # The standard's form is "a*{X}+b", in quotation marks.
        formula = default.decode("latin-1").replace("{X}", "X").split('"')[1]
        factor, _, rest = formula.partition("*X")
        values[left] = float(factor) * raw[left].astype(np.float64) + float(rest or 0.0)
    else:
        texts.add(default, int(np.count_nonzero(left)))
    return values
