"""Progress bars, on a terminal only: simulated time of a run, or the share of a study."""

from __future__ import annotations

import sys
from types import TracebackType
from typing import Self

FORMAT = "{desc} |{bar:30}| {n:6.1f} of {total:.1f} s{postfix}"
SHARE_FORMAT = "{desc} |{bar:30}| {percentage:3.0f} %{postfix}"


class _Shown:
    """A tqdm bar where standard output is a terminal; nothing is written elsewhere."""

    def __init__(self, title: str, total: float, look: str) -> None:
        self.title = title
        self.shown = sys.stdout.isatty() and sys.stderr.isatty()
        self._bar = None
        if self.shown:
            from tqdm import tqdm

            self._bar = tqdm(total=total, desc=title, bar_format=look, leave=False)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._bar is not None:
            self._bar.close()


class Steps(_Shown):
    """Progress by the share done (0 to 1) and what is being done. Use as a context manager."""

    def __init__(self, title: str) -> None:
        super().__init__(title, 1.0, SHARE_FORMAT)

    def __call__(self, share: float, what: str = "") -> None:
        """Show that ``share`` of the work is done; it never goes back."""
        if self._bar is not None:
            self._bar.set_postfix_str(what, False)
            self._bar.n = min(max(share, self._bar.n), 1.0)
            self._bar.refresh()


class Bar(_Shown):
    """A bar over ``duration`` s of simulated time. Use as a context manager."""

    def __init__(self, title: str, duration: float) -> None:
        super().__init__(title, duration, FORMAT)

    def update(self, tick: int, factor: float, phase: str = "running") -> None:
        """Show that ``tick`` ticks are done at ``factor`` times real time."""
        if self._bar is None:
            return
        running = phase == "running"
        self._bar.set_description_str(self.title if running else f"{self.title}: {phase}", False)
        self._bar.set_postfix_str(f"{factor:.1f} x real time" if running and factor else "", False)
        self._bar.n = tick * 1e-3
        self._bar.refresh()
