"""Tables written in any dialect that spreadsheets and loggers have, and what is true in them.

A writer of its own: it shares nothing with the reader that it tests.
"""

from __future__ import annotations

import math
import random
from dataclasses import dataclass, field
from decimal import Decimal
from typing import Any

from hypothesis import strategies as st

NAMES = (
    "angle", "Lenkwinkel", "pos #1", "Druck;links", "p, rechts", "Öl°", "x Weg", "% load", "#3",
    "torque/sensor", "F_rack\\ETKC:1", "12V", "a|b",
)  # fmt: skip
WORDS = ("NaN", "#NV", "-", "n/a", "--", "", "1.#QNAN", "null", "inf")
TEXTS = ("SNA", "1.2.3", "4:5", "12,,3", "0x1F", "5 bar", "7_5", "1-2", "??")
UNITS = ("deg", "bar", "mm", "N", "-", "")
NOTES = ('say "x"', "brake; hard", "a, b", "two\nlines", "1,5", "t", "#", "")


@dataclass(frozen=True)
class Dialect:
    """How a table is written. given: the keys that the mapping gets."""

    separator: str
    decimal: str
    thousands: str
    quoting: str
    encoding: str
    line_end: str
    preamble: tuple[str, ...]
    sep_line: bool
    units: str
    trailing: str
    blank_lines: bool
    comments: bool
    header_again: bool
    ended: bool
    padded: bool
    notes_column: bool
    index_column: bool
    ragged: str
    clock: str
    given: frozenset[str]
    seed: int

    @property
    def sloppy(self) -> bool:
        """Whether cells may hold the separator without quotes: no reader can get this right."""
        return self.quoting == "none" and self.separator in (self.decimal, self.thousands)


@dataclass
class Written:
    """A file and its truth. values: by name, for each row; NaN where no number was written."""

    data: bytes
    mapping: dict
    values: dict[str, list[float]]
    time: list[float]
    lines: list[int]
    bad: set[int] = field(default_factory=set)


@st.composite
def dialects(draw: st.DrawFn) -> Dialect:
    """Draw any dialect."""

    def pick(*values: Any) -> Any:
        return draw(st.sampled_from(values))

    separator = pick(";", ",", "\t", "|", " ")
    decimal = pick(".", ",")
    thousands = pick("", "", "", ".", ",", "'", "\u00a0", " ")
    if thousands == decimal or (separator == " " and thousands in " \u00a0"):
        thousands = ""
    keys = ("separator", "decimal", "thousands", "encoding", "header_line", "units_line")
    return Dialect(
        separator=separator,
        decimal=decimal,
        thousands=thousands,
        quoting=pick("minimal", "minimal", "all", "none"),
        encoding=pick("utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "cp1252"),
        line_end=pick("\n", "\r\n", "\r"),
        preamble=tuple(draw(st.lists(st.sampled_from(PREAMBLE), max_size=3))),
        sep_line=pick(False, False, True),
        units=pick("none", "line", "brackets", "line and ids"),
        trailing=pick("none", "none", "rows", "both"),
        blank_lines=pick(False, True),
        comments=pick(False, True),
        header_again=pick(False, False, False, True),
        ended=pick(True, True, False),
        padded=pick(False, False, True),
        notes_column=pick(False, True),
        index_column=pick(False, True),
        ragged=pick("none", "none", "none", "short", "long", "cut"),
        clock=pick("s", "ms", "ns", "epoch_ns", "epoch_s", "iso", "german", "of_day", "us_slash"),
        given=frozenset(draw(st.sets(st.sampled_from(keys), max_size=3))),
        seed=draw(st.integers(0, 2**32)),
    )


PREAMBLE = (
    "Messung{s}Prüfstand 3", "Datum: 03.05.2024", "", "1{s}2{s}3", "{names}", "NN",
    "Kanäle:{s}{names}", "min{s}0{s}-20{s}4", "# {reversed}", "NN", "", "Rig 3", "x{s}y",
    "0{s}1{s}2{s}3{s}4",
)  # fmt: skip


def write(dialect: Dialect, rows: int) -> Written:
    """Return a file of ``rows`` rows in a dialect."""
    return _Writer(dialect, rows).file()


class _Writer:
    def __init__(self, dialect: Dialect, rows: int) -> None:
        self.d, self.n = dialect, rows
        self.random = random.Random(dialect.seed)
        names = [name for name in NAMES if self._allowed(name)]
        self.names = self.random.sample(names, self.random.randint(1, 3))
        self.lines: list[str] = []

    def file(self) -> Written:
        d = self.d
        time_cells, seconds, unit = self._clock()
        columns = {name: self._column() for name in self.names}
        heads = [self._head(name) for name in ("t", *self.names)]
        order = [*(["nr"] if d.index_column else []), *heads, *(["note"] if d.notes_column else [])]
        if d.sep_line:
            self.lines.append(f"sep={d.separator}")
        for text in d.preamble:
            self.lines.append(self._preamble(text, order))
        header = self._row([*order, *([""] if d.trailing == "both" else [])])
        self._add(header)
        header_line = len(self.lines)
        units_line = self._units(order)
        mapping = self._mapping(unit, header_line, units_line)
        written = Written(b"", mapping, {name: [] for name in self.names}, [], [])
        for k in range(self.n):
            self._between(header, k)
            self._data_row(k, time_cells, seconds, columns, written)
        text = "\n".join(self.lines).replace("\n", d.line_end)
        if d.ragged == "cut":
            text = self._cut(text)
        elif d.ended:
            text += d.line_end
        written.data = text.encode(d.encoding)
        return written

    def _allowed(self, name: str) -> bool:
        quoted = self.d.quoting != "none"
        if self.d.separator == " " and (" " in name) and not quoted:
            return False
        return quoted or self.d.separator not in name

    def _head(self, name: str) -> str:
        return f"{name} [{'s' if name == 't' else 'deg'}]" if self._bracketed() else name

    def _bracketed(self) -> bool:
        return self.d.units == "brackets" and not (
            self.d.separator == " " and self.d.quoting == "none"
        )

    def _preamble(self, text: str, order: list[str]) -> str:
        s = self.d.separator
        return text.format(s=s, names=self._row(order), reversed=self._row(order[::-1]))

    def _units(self, order: list[str]) -> int | None:
        if "line" not in self.d.units:
            return None
        words = [self.random.choice(("deg", "bar", "mm")) for _ in order]
        self._add(self._row(words))
        if "ids" in self.d.units:
            self._add(self._row([f"ID{k}" for k in range(len(order))]))
            return len(self.lines) - 1
        return len(self.lines)

    def _mapping(self, unit: str, header_line: int, units_line: int | None) -> dict:
        d = self.d
        channels = ("steering_wheel_angle", "torsion_bar_torque", "rack_position")
        units = ("deg", "Nm", "mm")
        mapping: dict = {
            "valve_system": "open_centre",
            "time": "t",
            "channels": {
                channel: {"from": name, "unit": unit_}
                for channel, unit_, name in zip(channels, units, self.names, strict=False)
            },
        }
        mapping["time_unit"] = unit
        if "separator" in d.given:
            mapping["separator"] = d.separator
        if "decimal" in d.given:
            mapping["decimal"] = d.decimal
        if "thousands" in d.given and d.thousands in (".", ",", "'", " "):
            mapping["thousands"] = d.thousands
            if not d.thousands:
                del mapping["thousands"]
        if "encoding" in d.given:
            mapping["encoding"] = d.encoding
        if "header_line" in d.given:
            mapping["header_line"] = header_line
        if "units_line" in d.given and units_line:
            mapping["units_line"] = units_line
        return mapping

    def _between(self, header: str, k: int) -> None:
        if self.d.blank_lines and self.random.random() < 0.2:
            self.lines.append(self.random.choice(("", "  ")))
        if self.d.comments and self.random.random() < 0.2:
            self.lines.append(self.random.choice(("# 1;2;3", "// x,y", '% "quote', "#")))
        if self.d.header_again and k == 2 * self.n // 3:
            self._add(header)

    def _data_row(
        self,
        k: int,
        time_cells: list[str],
        seconds: list[float],
        columns: dict[str, list[tuple[str, float]]],
        written: Written,
    ) -> None:
        d = self.d
        cells, truth = [time_cells[k]], []
        for name in self.names:
            text, value = columns[name][k]
            cells.append(text)
            truth.append(value)
        if d.index_column:
            cells.insert(0, str(k))
        if d.notes_column:
            note = self.random.choice(NOTES)
            if d.quoting == "none" or d.separator == " ":
                note = "note" if d.separator == " " else note.replace("\n", " ").replace('"', "")
                note = note.replace(d.separator, "_")
            cells.append(note)
        if d.trailing != "none":
            cells.append("")
        if d.ragged in ("short", "long") and k % 11 == 5:
            cells = cells[:-2] if d.ragged == "short" else [*cells, "7", "8"]
            if len(cells) < 1:
                cells = ["9"]
            written.bad.add(k)
        written.lines.append(len(self.lines) + 1)
        self._add(self._row(cells))
        written.time.append(seconds[k])
        for name, value in zip(self.names, truth, strict=True):
            written.values[name].append(value)

    def _add(self, row: str) -> None:
        self.lines += row.split("\n")

    def _row(self, cells: list[str]) -> str:
        return self.d.separator.join(map(self._cell, cells))

    def _cell(self, text: str) -> str:
        d = self.d
        special = (
            d.separator in text or '"' in text or "\n" in text or (d.separator == " " and not text)
        )
        if d.quoting == "all" or (d.quoting == "minimal" and special):
            return '"' + text.replace('"', '""') + '"'
        return f" {text} " if d.padded and d.separator not in " \t" else text

    def _number(self, value: Decimal, digits: int, exponent: bool = False) -> str:
        d = self.d
        if exponent:
            return f"{value:.{max(digits, 1)}E}".replace(".", d.decimal)
        whole, _, part = f"{abs(value):.{digits}f}".partition(".")
        if d.thousands:
            whole = f"{int(whole):,}".replace(",", d.thousands)
        sign = "-" if value < 0 else ("+" if self.random.random() < 0.02 else "")
        return sign + whole + (d.decimal + part if part else "")

    def _column(self) -> list[tuple[str, float]]:
        kind = self.random.choice(("wave", "large", "three", "trimmed", "exponent", "integers"))
        digits = {"three": 3, "integers": 0, "large": self.random.choice((0, 0, 2, 3))}.get(
            kind, self.random.randint(1, 6)
        )
        low, high = {"large": (500, 3e6), "three": (1, 999.999), "integers": (-5000, 5000)}.get(
            kind, (-20, 20)
        )
        lossy = self.random.random() < 0.3
        result = []
        for k in range(self.n):
            value = round(Decimal(self.random.uniform(low, high)), digits)
            text = self._number(value, digits, kind == "exponent")
            if kind == "exponent":
                value = Decimal(f"{value:.{max(digits, 1)}E}")
            if kind == "trimmed":
                value = Decimal(k) if k < self.n // 2 else value
                text = self._number(value, digits)
                if self.d.decimal in text:
                    text = text.rstrip("0").rstrip(self.d.decimal)
            if lossy and self.random.random() < 0.05:
                text, value = self._lost(), Decimal("NaN")
            result.append((text, float(value) if not value.is_nan() else math.nan))
        return result

    def _lost(self) -> str:
        words = [w for w in (*WORDS, *TEXTS) if self._allowed(w)]
        if self.d.separator == " " or self.d.quoting == "none":
            words = [w for w in words if w and " " not in w and self.d.separator not in w]
        return self.random.choice(words)

    def _clock(self) -> tuple[list[str], list[float], str]:
        """Return the cells of the time, seconds from the first row, and the unit."""
        d, step = self.d, self.random.choice((1, 1, 10, 7))
        kind = d.clock
        if d.separator == " " and d.quoting == "none" and kind in ("german", "us_slash"):
            kind = "of_day"
        late = self.random.choice((0, 86_400_000 - 40_000 - self.n * step // 2))
        ms = [k * step for k in range(self.n)]
        seconds = [t / 1000 for t in ms]
        if kind in ("s", "epoch_s"):
            start = 1_714_728_000_000 if kind == "epoch_s" else self.random.choice((0, 12_345))
            texts = [self._number(Decimal(start + t) / 1000, 3) for t in ms]
            return texts, seconds, "s"
        if kind == "ms":
            return [self._number(Decimal(t), 0) for t in ms], seconds, "ms"
        if kind in ("ns", "epoch_ns"):
            start = 1_714_728_000_000_000_123 if kind == "epoch_ns" else 0
            return [str(start + t * 1_000_000) for t in ms], seconds, "ns"
        texts = []
        for t in ms:
            at = 40_000 + late + t
            day, rest = divmod(at, 86_400_000)
            s, part = divmod(rest, 1000)
            clock = f"{s // 3600:02d}:{s // 60 % 60:02d}:{s % 60:02d}"
            sign = "." if d.separator == "," and d.quoting == "none" else d.decimal
            clock += f"{sign}{part:03d}"
            texts.append(
                {
                    "iso": f"2024-05-{30 + day:02d}T{clock}+02:00",
                    "german": f"{30 + day:02d}.05.2024 {clock}",
                    "of_day": clock,
                    "us_slash": f"05/{30 + day:02d}/2024 {clock}",
                }[kind]
            )
        return texts, seconds, "s"

    def _cut(self, text: str) -> str:
        begin = text.rfind(self.d.line_end) + len(self.d.line_end)
        return text[: self.random.randint(begin + 1, len(text))]
