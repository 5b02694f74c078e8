"""One row of the reproduction: a figure of the source, its numbers, ours, and the verdict."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Literal

from steering_bringup.pages import Figure

Kind = Literal["input", "time", "frequency", "pressure", "torque", "force", "angle", "other"]

RELATIVE: dict[Kind, float] = {"input": 0.01}
"""Tolerance relative to the source's number; 10 % for the other kinds."""

ABSOLUTE: dict[Kind, float] = {"pressure": 0.5, "torque": 0.05, "force": 20.0}
"""Tolerance in the shown unit (bar, N m, N) where that is larger."""

Verdict = Literal["reproduced", "differs", "shape only"]


@dataclass(frozen=True)
class Number:
    """A number of the source beside ours, in the unit that is shown.

    sense: "is" within its tolerance, "at most" it, or "at least". source None: nothing is printed.
    """

    what: str
    unit: str
    source: float | None
    ours: float
    kind: Kind = "other"
    sense: Literal["is", "at most", "at least"] = "is"

    @property
    def tolerance(self) -> float:
        """What may lie between them, in the shown unit."""
        size = abs(self.source or 0.0)
        return max(RELATIVE.get(self.kind, 0.1) * size, ABSOLUTE.get(self.kind, 0.0))

    @property
    def good(self) -> bool | None:
        """Whether ours meets the source's; None where the source prints no number."""
        if self.source is None:
            return None
        if self.sense == "at most":
            return bool(self.ours <= self.source + self.tolerance)
        if self.sense == "at least":
            return bool(self.ours >= self.source - self.tolerance)
        return bool(abs(self.ours - self.source) <= self.tolerance)


@dataclass(frozen=True, repr=False)
class Row:
    """A figure of the source. because: what stands between ours and the source's, where it does.

    words: what a person should see in the shape, where the source prints no number.
    """

    figure: str
    title: str
    numbers: Sequence[Number]
    figures: Sequence[Figure] = field(default_factory=tuple)
    words: str = ""
    because: str = ""

    @property
    def name(self) -> str:
        """The figure's name; a row that is none of the source's has no number."""
        return f"fig {self.figure}" if self.figure[0].isdigit() else self.figure

    @property
    def place(self) -> tuple[int, ...]:
        """Order in the source: "8.2, 8.3" is (8, 2); what is no figure of it comes last."""
        found = re.match(r"(\d+)\.(\d+)", self.figure)
        return tuple(int(part) for part in found.groups()) if found else (1000,)

    @property
    def verdict(self) -> Verdict:
        """Reproduced, differs, or a shape that nothing printed can judge."""
        judged = [number.good for number in self.numbers if number.good is not None]
        if not judged:
            return "shape only"
        return "reproduced" if all(judged) else "differs"

    def sentence(self) -> str:
        """Return the verdict in words."""
        if self.verdict == "reproduced":
            return "Reproduced." + (f" {self.words}" if self.words else "")
        if self.verdict == "shape only":
            return f"Cannot be judged by a number: the source prints none. {self.words}"
        missed = ", ".join(n.what for n in self.numbers if n.good is False)
        return f"Differs in {missed}, because {self.because or 'no cause is known'}."


Maker = Callable[[], Row]
