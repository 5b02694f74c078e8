"""Whatever goes wrong in one candidate model costs that candidate: the one place for it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

from steering_diagnosis.engine.failures import NUMERICAL, GivenUpError, reason
from steering_diagnosis.engine.fit import Fit

Made = TypeVar("Made")


class Attempts:
    """Models by their causes. fits: those that were fitted. failed: those that are out, and why."""

    fits: dict[frozenset[str], Fit]
    failed: dict[frozenset[str], str]

    def tried(self, names: frozenset[str], work: Callable[[], Made]) -> Made | None:
        """Return what some work on a model gives, or None where it fails: it costs this model."""
        if names in self.failed:
            return None
        try:
            return work()
        except NUMERICAL as error:
            self.give_up(names, reason(error))
            return None

    @contextmanager
    def judging(self, names: frozenset[str]) -> Iterator[None]:
        """Say of whatever fails in here that it costs this model: see ``begin_without``."""
        try:
            yield
        except GivenUpError:
            raise
        except NUMERICAL as error:
            raise GivenUpError(names, reason(error)) from error

    def give_up(self, names: frozenset[str], why: str) -> None:
        """Leave a model out of the search. GivenUpError: it is the nominal one."""
        if not names:
            raise GivenUpError(names, why)
        self.failed.setdefault(names, why)
        self.fits.pop(names, None)
