"""Notes what is told on /diagnostics and /rosout, and on the topics of the command line.

    python ros_ear.py OUT [TOPIC=package/Name ...]

Prints "ready"; writes OUT as JSON lines {"topic": ..., what it says} and ends on SIGTERM.
"""

from __future__ import annotations

import importlib
import json
import signal
import sys
from pathlib import Path
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import Log
from rclpy.qos import QoSProfile
from rclpy.signals import SignalHandlerOptions


def plain(value: Any) -> Any:
    """Return a message as JSON has it."""
    if hasattr(value, "get_fields_and_field_types"):
        return {name: plain(getattr(value, name)) for name in value.get_fields_and_field_types()}
    if isinstance(value, bytes):
        return int.from_bytes(value, "little")
    if isinstance(value, (str, int, float, bool)):
        return value
    return [plain(item) for item in value]


def main() -> None:
    out, stop = Path(sys.argv[1]), []
    signal.signal(signal.SIGTERM, lambda *_: stop.append(1))
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node("ear")
    lines: list[dict[str, Any]] = []

    def listen(name: str, kind: Any) -> None:
        def note(message: Any) -> None:
            lines.append({"topic": name, **plain(message)})

        node.create_subscription(kind, name, note, QoSProfile(depth=1000))

    listen("/diagnostics", DiagnosticArray)
    listen("/rosout", Log)
    for word in sys.argv[2:]:
        name, kind = word.split("=")
        package, message = kind.split("/")
        listen(name, getattr(importlib.import_module(f"{package}.msg"), message))
    print("ready", flush=True)
    while not stop:
        rclpy.spin_once(node, timeout_sec=0.05)
    out.write_text("\n".join(json.dumps(line) for line in lines))


if __name__ == "__main__":
    main()
