"""Hardware that is the clock, as the lock step sees it. Pure."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, Protocol


class Status(NamedTuple):
    """State of the hardware for /diagnostics: "ok", "warn" or "error", and a text."""

    level: str
    text: str


class Outside(Protocol):
    """The hardware as the clock sees it.

    ``preparing``: it is not ready for tick 0 yet; ``failure``: why the run must end, or None;
    ``answer_by``: until when commands are waited for, ns of the monotonic clock.
    """

    @property
    def preparing(self) -> bool: ...  # noqa: D102

    @property
    def failure(self) -> str | None: ...  # noqa: D102

    @property
    def answer_by(self) -> int: ...  # noqa: D102

    def open(self) -> None:
        """Begin; called once, when every node is there."""

    def receive(self, most: int) -> list[tuple[float, ...]]:
        """Wait for the hardware, a few ticks at most; return a row for each tick that began.

        most: how many are left of the run; what comes after them is nobody's.
        """

    def answer(
        self, tick: int, values: Sequence[float], age: int, late: str | None, ahead: int
    ) -> None:
        """Send commands at ``tick``: ``age`` ticks old, because ``late`` owes newer ones.

        ahead: how many ticks of the same ``receive`` are still to come.
        """

    def status(self) -> Status:
        """Return the present state."""

    def numbers(self) -> dict[str, str]:
        """Return counts and latencies as texts."""

    def report(self) -> dict[str, Any]:
        """Return what the run's outcome tells of the hardware."""

    def close(self) -> None:
        """Leave the hardware in its safe state."""
