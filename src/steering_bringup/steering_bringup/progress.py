"""The progress bar: simulated time and real-time factor, on a terminal only."""

from __future__ import annotations

import sys
from types import TracebackType

FORMAT = "{desc} |{bar:30}| {n:6.1f} of {total:.1f} s{postfix}"


class Bar:
    """A bar over ``duration`` s of simulated time. Use as a context manager.

    Nothing is written where standard output is no terminal.
    """

    def __init__(self, title: str, duration: float) -> None:
        self.title = title
        self.shown = sys.stdout.isatty() and sys.stderr.isatty()
        self._bar = None
        if self.shown:
            from tqdm import tqdm

            self._bar = tqdm(total=duration, desc=title, bar_format=FORMAT, leave=False)

    def update(self, tick: int, factor: float, phase: str = "running") -> None:
        """Show that ``tick`` ticks are done at ``factor`` times real time."""
        if self._bar is None:
            return
        running = phase == "running"
        self._bar.set_description_str(self.title if running else f"{self.title}: {phase}", False)
        self._bar.set_postfix_str(f"{factor:.1f} x real time" if running and factor else "", False)
        self._bar.n = tick * 1e-3
        self._bar.refresh()

    def __enter__(self) -> Bar:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._bar is not None:
            self._bar.close()
