"""The start, faults and end of nodes on /rosout, one publisher a process.

rclpy's own logger would need an endpoint for every node, and writes to the terminal too, which
belongs to the command line.
"""

from __future__ import annotations

from rcl_interfaces.msg import Log
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from steering_lockstep.errors import LockstepError
from steering_lockstep.node import LockstepNode

TOPIC = "/rosout"
QUALITY = QoSProfile(
    depth=1000,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
    lifespan=Duration(seconds=10),
)
"""As rcl publishes on /rosout."""
LINGER = Duration(nanoseconds=100_000_000)
"""For the last words to arrive, where somebody listens."""


class Rosout:
    """Tells of ``nodes``, all of one process."""

    def __init__(self, nodes: list[LockstepNode]) -> None:
        self._nodes = nodes
        self._publisher = nodes[0].create_publisher(Log, TOPIC, QUALITY)

    def started(self) -> None:
        """Tell that each node has all its connections."""
        for node in self._nodes:
            takes, gives = len(node.spec.inputs), len(node.spec.outputs)
            text = f"ready: {node.spec.kind}, takes {takes} topics, gives {gives}"
            self._tell(node, Log.INFO, text)

    def ended(self, error: LockstepError | None) -> None:
        """Tell how each node ended, and what went wrong."""
        if error is not None:
            named = [node for node in self._nodes if node.spec.name == error.node]
            self._tell((named or self._nodes)[0], Log.ERROR, str(error))
        for node in self._nodes:
            done = node.run.ticks if node.finished else node.barrier.tick
            if node.finished:
                self._tell(node, Log.INFO, f"finished after {done} ticks")
            else:
                self._tell(node, Log.WARN, f"ended at tick {done} of {node.run.ticks}")
        self._publisher.wait_for_all_acked(LINGER)

    def _tell(self, node: Node, level: int, text: str) -> None:
        name = node.get_fully_qualified_name().lstrip("/").replace("/", ".")
        stamp = node.get_clock().now().to_msg()
        self._publisher.publish(Log(stamp=stamp, level=level, name=name, msg=text))
