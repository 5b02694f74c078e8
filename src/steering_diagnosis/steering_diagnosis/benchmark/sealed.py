"""The sealed truth about a case."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Literal, get_args

from steering_core.errors import BenchError

Kind = Literal["clean", "visible", "invisible", "pair", "outside"]
KINDS: tuple[Kind, ...] = get_args(Kind)


@dataclass(frozen=True)
class Sealed:
    """The truth about a case, which no diagnosis sees.

    sizes: of the hidden effects, in the truth's own terms. parameters: effect to the library's
    parameters that are judged. neutral: effect to their values without it. mistaken: effect to
    those that this record cannot tell it from. ratios: signal to noise of each beside the others.
    door: what the record came in through. unseen: of the hidden effects those that its channels do
    not show.
    """

    case: str
    kind: Kind
    seed: int
    valve_system: str
    manoeuvre: str
    load: str
    sizes: Mapping[str, float] = field(default_factory=dict)
    parameters: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    neutral: Mapping[str, float] = field(default_factory=dict)
    mistaken: Mapping[str, list[str]] = field(default_factory=dict)
    ratios: Mapping[str, float] = field(default_factory=dict)
    door: Mapping[str, Any] = field(default_factory=dict)
    unseen: Sequence[str] = field(default_factory=list)

    @property
    def hidden(self) -> tuple[str, ...]:
        """Return the names of what is hidden."""
        return tuple(self.sizes)

    def write(self, file: Path) -> None:
        """Write the truth with a hash of itself."""
        content = asdict(self)
        file.write_text(json.dumps({"truth": content, "sha256": _digest(content)}, indent=1) + "\n")


def read_sealed(file: Path) -> Sealed:
    """Return the truth of a file; BenchError where somebody has changed it."""
    try:
        document = json.loads(file.read_text(encoding="utf-8"))
        content, digest = document["truth"], document["sha256"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise BenchError(f"'{file}' is no sealed truth: {error}") from None
    if _digest(content) != digest:
        raise BenchError(f"'{file}' has been changed since it was sealed: draw the case again")
    return Sealed(**content)


def _digest(content: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()
