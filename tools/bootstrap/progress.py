"""What a person sees during set-up: one line a step, with the time it took."""

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager


def say(text: str) -> None:
    """Print one line for the person at the terminal."""
    print(f"steer: {text}", file=sys.stderr, flush=True)


class Step:
    """One step of set-up; `tick` shows the elapsed time where there is a terminal."""

    def __init__(self, title: str) -> None:
        self.title = title
        self.start = time.monotonic()

    def tick(self) -> None:
        """Renew the line on a terminal; a log file gets no ticks."""
        if sys.stderr.isatty():
            print(f"\r  {self.title} ... {self._elapsed()}", end="", file=sys.stderr, flush=True)

    def finish(self, result: str) -> None:
        """End the line."""
        begin = "\r" if sys.stderr.isatty() else ""
        text = f"{begin}  {self.title} ... {result} ({self._elapsed()})"
        print(text, file=sys.stderr, flush=True)

    def _elapsed(self) -> str:
        return f"{time.monotonic() - self.start:.0f} s"


@contextmanager
def step(title: str) -> Iterator[Step]:
    """Show a step from begin to end; its failure too."""
    current = Step(title)
    current.tick()
    try:
        yield current
    except BaseException:
        current.finish("stopped")
        raise
    current.finish("done")
