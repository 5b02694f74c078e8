"""Spins the nodes of one process in an events executor until all are done."""

from __future__ import annotations

from collections.abc import Sequence
from time import monotonic_ns
from typing import Any

from rclpy.context import Context
from rclpy.executors import Executor
from rclpy.experimental.events_executor import EventsExecutor
from rclpy.task import Future

from steering_lockstep.clock_node import ClockNode
from steering_lockstep.errors import LockstepError
from steering_lockstep.node import LockstepNode

# Without a deadline the executor never runs a callback; with one it just starts again.
LONG = 3600.0


class Spinner:
    """Owns the executor of ``nodes``. ``stop()`` may be called from any thread, at any time."""

    def __init__(self, context: Context, nodes: Sequence[LockstepNode], executor: Any = None):
        self.context = context
        self.nodes = list(nodes)
        self.error: LockstepError | None = None
        self.stopped = False
        self._wake_at: int | None = None
        self._future = Future()
        self.executor: Executor = executor or EventsExecutor(context=context)
        for node in self.nodes:
            node.on_finished = self._check_finished
            node.on_error = self.fail
            node.in_events_executor = executor is None
            if isinstance(node, ClockNode):
                node.sleep_until = self._sleep_until
            self.executor.add_node(node)

    @property
    def finished(self) -> bool:
        """Whether every node has done its last tick."""
        return all(node.finished for node in self.nodes)

    def unmatched(self) -> list[str]:
        """Return what is still missing before the first tick."""
        return [f"{n.spec.name}: {what}" for n in self.nodes for what in n.unmatched()]

    def spin_for(self, seconds: float) -> None:
        """Serve callbacks for a while; less when stopped."""
        self.executor.spin_until_future_complete(self._future, timeout_sec=seconds)

    def start(self) -> None:
        """Let the nodes start, from any thread: the clock, and whoever waits for nobody."""
        for node in self.nodes:
            self.executor.create_task(node.start)

    def run(self) -> None:
        """Serve callbacks until all nodes are finished, an error comes up, or ``stop``."""
        while self.alive():
            if self._wake_at is None:
                self.spin_for(LONG)
                self._renew()
                continue
            remaining = (self._wake_at - monotonic_ns()) * 1e-9
            if remaining > 0.0:
                self.spin_for(remaining)
                self._renew()
            else:
                self._wake_at = None
                self._resume()

    def alive(self) -> bool:
        """Whether there is anything left to do."""
        done = self.finished or self.stopped or self.error is not None
        return not done and self.context.ok()

    def stop(self) -> None:
        """Leave ``run`` soon."""
        self.stopped = True
        self._future.set_result(None)

    def close(self) -> None:
        """Let go of the nodes, so that they can leave the ROS graph; not while ``run`` runs."""
        for node in self.nodes:
            self.executor.remove_node(node)
        self.executor.shutdown()

    def _renew(self) -> None:
        """A future that is done ends every later spin at once: take a new one."""
        if self._future.done():
            self._future = Future()

    def _check_finished(self) -> None:
        if self.finished:
            self._future.set_result(None)

    def fail(self, error: LockstepError) -> None:
        """Leave ``run`` with ``error``, from any thread; the first one counts."""
        if self.error is None:
            self.error = error
            for node in self._clocks():
                node.failed(error)
        self._future.set_result(None)

    def _sleep_until(self, due: int) -> None:
        self._wake_at = due
        self._future.set_result(None)

    def _resume(self) -> None:
        for node in self._clocks():
            node.resume()

    def _clocks(self) -> list[ClockNode]:
        return [node for node in self.nodes if isinstance(node, ClockNode)]
