"""Start-up checks: every channel alive and plausible for a while before pressure is raised."""

from __future__ import annotations

from collections.abc import Sequence

from rig_bridge.safety.channel_watch import ChannelWatch
from rig_bridge.safety.faults import Fault, Kind
from rig_bridge.watching import Watching


class StartUp:
    """Counts good ticks in a row; anything wrong starts the count again, the time-out ends it.

    ``last_wrong`` names every channel that failed.
    """

    def __init__(self, watching: Watching) -> None:
        self.watching = watching
        self.reset()

    def reset(self) -> None:
        """Begin again."""
        self.ticks = 0
        self.good = 0
        self.last_wrong = "no measurements have come"

    def see(self, channels: Sequence[ChannelWatch], fresh: bool, fault: Fault | None) -> bool:
        """Take a tick; return whether the checks have passed."""
        self.ticks += 1
        wrong = None if fault is None else str(fault)
        if not fresh and wrong is None:
            return False  # one that is missing is counted elsewhere, and several are a fault
        wrong = _implausible(channels) or wrong if fresh else wrong
        if wrong is not None:
            self.good, self.last_wrong = 0, wrong
            return False
        self.good += 1
        still = [watch.name for watch in channels if not watch.is_alive()]
        if self.good < self.watching.check_ticks:
            return False
        if still:
            self.last_wrong = "; ".join(f"{name}: does not move at all" for name in still)
        return not still

    def fault(self) -> Fault | None:
        """Return the failure of the checks once their time is over."""
        if self.ticks < self.watching.check_timeout_ticks:
            return None
        return Fault(Kind.START_UP, None, self.last_wrong)


def _implausible(channels: Sequence[ChannelWatch]) -> str | None:
    return "; ".join(_describe(watch) for watch in channels if not watch.is_plausible()) or None


def _describe(watch: ChannelWatch) -> str:
    low, high = watch.channel.plausible or watch.channel.range
    value = "no value" if watch.seen is None else f"{watch.seen:g} {watch.channel.unit}"
    return f"{watch.name}: {value} is not plausible ({low:g} to {high:g})"
