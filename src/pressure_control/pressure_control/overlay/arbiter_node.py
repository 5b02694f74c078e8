"""The arbiter of torque overlays as a node.

Members of the lock step each have a topic to themselves, /torque_overlay/NAME, which is an input of
the node set. Guests, nodes of any ROS 2 machine outside the lock step, publish on /torque_overlay;
their messages count from the tick at which they come in. Parameters: any of the data sheet.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from time import monotonic_ns
from typing import Any

from rclpy.context import Context
from rclpy.qos import QoSProfile, ReliabilityPolicy

from pressure_control.overlay.arbiter import OverlayArbiter
from pressure_control.overlay.sources import HEARD
from steering_lockstep.core_parameters import check_own, parameter_set
from steering_lockstep.diagnostics import OK, WARN, Diagnostics
from steering_lockstep.graph import NodeSpec
from steering_lockstep.names import relative
from steering_lockstep.node import LockstepNode
from steering_lockstep.ports import Ports
from steering_lockstep.settings import RunSettings
from steering_lockstep.topics import APPLIED, OVERLAY, overlay_source

MEASURED = (
    ("/steering/torque", "steering_wheel_angle"),
    ("/steering/torque", "steering_wheel_speed"),
    ("/steering/torque", "torsion_bar_torque"),
    ("/vehicle/odometry", "twist.twist.linear.x"),
)
SOURCE, OVERRIDDEN, STALE, REFUSED = 6, 13, 14, 15
NUMBERS = {
    "asked_Nm": 0,
    "applied_Nm": 1,
    "driver_torque_Nm": 4,
    "authority": 5,
    "refused_count": 16,
    "stale_count": 17,
    "override_count": 18,
}
"""Places in the core's ``out`` of what is told on /diagnostics."""


class ArbiterNode(LockstepNode):
    """Answers each tick with the torque that both controllers apply."""

    def __init__(
        self,
        context: Context,
        spec: NodeSpec,
        run: RunSettings,
        parameters: Mapping[str, Any] | None,
    ) -> None:
        self.members = members(spec)
        asked = [(name, part) for name in self.members for part in ("torque", "priority")]
        self.ports = Ports(takes=(*MEASURED, *asked), gives=(APPLIED,))
        super().__init__(context, spec, run, parameters, arbiter_builder(spec, run))
        self.diagnostics = Diagnostics(self, "torque overlay")
        self._told: tuple[float, ...] = ()
        self._listen()

    def publish(self, tick: int, out: Sequence[float]) -> None:
        """Publish what is applied; a change of who is served, or of trouble, goes to others."""
        super().publish(tick, out)
        state = (out[SOURCE], out[OVERRIDDEN], out[STALE], out[REFUSED])
        if state != self._told or monotonic_ns() > self.diagnostics.due:
            self._told = state
            self._tell(tick, out, *state)

    def _tell(self, tick: int, out: Sequence[float], source: float, *troubles: float) -> None:
        served = self.source_names()[int(source) - 1] if source else "nobody"
        words = ("the driver overrides", "a source is silent", "a message was refused")
        told = [word for word, trouble in zip(words, troubles, strict=True) if trouble]
        text = "; ".join([f"serves {served}", *told])
        numbers = {name: f"{out[place]:.6g}" for name, place in NUMBERS.items()}
        values = {"tick": tick, "served": served, **numbers, **self._sources(tick)}
        self.diagnostics.tell(WARN if any(troubles[1:]) else OK, text, tick, values)

    def source_names(self) -> list[str]:
        """Return the names of all sources in the order of their numbers."""
        return [*(str(overlay_source(name)) for name in self.members), *self.core.guests]

    def _sources(self, tick: int) -> dict[str, str]:
        """Return of each source who it is, how old its word is, and how old it may get."""
        core, found = self.core, {}
        for name, kept, longest in zip(self.source_names(), core.kept, core.longest, strict=True):
            who = "guest" if name in core.guests else "member"
            age = f"{tick - kept[HEARD]:.0f} ms old" if kept[HEARD] >= 0.0 else "never heard"
            found[f"source {name}"] = f"{who}, {age}, silent after {longest:.0f} ms"
        return found

    def _listen(self) -> None:
        from steering_msgs.msg import TorqueOverlay

        quality = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
        self.create_subscription(TorqueOverlay, relative(OVERLAY), self._hear, quality)

    def _hear(self, message: Any) -> None:
        """Take a guest's message; any reliability of its publisher fits."""
        if not self.finished:
            name = message.source or "unnamed"
            self.core.hear_guest(name, self.barrier.tick, message.torque, message.priority)


def members(spec: NodeSpec) -> list[str]:
    """Return the topics of the sources in lock step, in the node set's order."""
    return [name for name in spec.inputs if overlay_source(name)]


def arbiter_builder(
    spec: NodeSpec, run: RunSettings
) -> Callable[[Mapping[str, Any]], OverlayArbiter]:
    """Return the function that makes the arbiter of a node's parameter values."""
    names = members(spec)

    def build(values: Mapping[str, Any]) -> OverlayArbiter:
        check_own(values, (), ())
        periods, delays = [run.every(n) for n in names], [spec.inputs[n] for n in names]
        return OverlayArbiter(parameter_set(values), periods, delays)

    return build


def make(
    context: Context, spec: NodeSpec, run: RunSettings, parameters: Mapping[str, Any] | None
) -> ArbiterNode:
    """Return the arbiter's node for a run."""
    return ArbiterNode(context, spec, run, parameters)
