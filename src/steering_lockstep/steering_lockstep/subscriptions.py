"""Subscriptions as the events executor wants them, without the property calls on each message.

The executor looks up six attributes of a subscription for every message. Those of rclpy are
properties and an enum; plain attributes cost a fraction of the time. Anything else that is asked
for comes from the real subscription.
"""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

MESSAGE_ONLY = SimpleNamespace(value=1)


class PlainSubscription:
    """Stands for a raw rclpy subscription in the executor; ``callback`` takes the bytes."""

    CallbackType = SimpleNamespace(MessageOnly=MESSAGE_ONLY)

    def __init__(self, real: Any, callback: Callable[[bytes], None]) -> None:
        self.real = real
        self.handle = real.handle
        self.msg_type = real.msg_type
        self.raw = True
        self.callback = callback
        self._callback_type = MESSAGE_ONLY

    def __getattr__(self, name: str) -> Any:
        return getattr(self.real, name)
