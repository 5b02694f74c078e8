"""The rig bridge as a node: it takes the plant's place, and the rig is the clock.

Parameters: ``rig``, the rig's file; ``link`` and ``settings`` (JSON), where they differ from what
the file says; ``on_fault``: "end" or "hold". The service /rig/reset leaves the safe state.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rclpy.context import Context
from std_srvs.srv import Trigger

from rig_bridge.rig_file import load_rig
from rig_bridge.session import Session
from rig_bridge.transport.registry import trusted_link
from steering_lockstep.core_parameters import check_own
from steering_lockstep.free_clock import FreeClock
from steering_lockstep.graph import NodeSpec
from steering_lockstep.names import relative
from steering_lockstep.ports import Ports
from steering_lockstep.settings import RunSettings
from steering_lockstep.topics import wire

RESET = "/rig/reset"
OWN = {
    "rig": "file of the rig",
    "link": "link that is used, udp or can",
    "settings": "addresses or interface of the link as JSON",
    "on_fault": "what a fault does to the run: end it, or hold it in the safe state until a reset",
}


class BridgeNode(FreeClock):
    """Publishes what the rig measures and sends it what the nodes command."""

    ports = Ports(gives=("/steering/torque", "/steering/pressure", "/steering/rack", "/clock"))

    def __init__(
        self,
        context: Context,
        spec: NodeSpec,
        run: RunSettings,
        parameters: Mapping[str, Any] | None,
    ) -> None:
        super().__init__(context, spec, run, parameters)
        self.core: Session = build_session(spec, self.values())
        self.create_service(Trigger, relative(RESET), self._reset)

    def description(self, name: str) -> str:
        """Return what the node's parameter ``name`` is."""
        return OWN.get(name) or super().description(name)

    def _reset(self, request: Any, response: Any) -> Any:
        response.success, response.message = self.core.reset()
        return response


def build_session(spec: NodeSpec, values: Mapping[str, Any]) -> Session:
    """Return the session of a node's parameter values; the link is opened when the run starts."""
    check_own(values, OWN, ())
    path = Path(values["rig"])
    rig = load_rig(path)
    kind = values.get("link", rig.link)
    settings = json.loads(values.get("settings", "null")) or rig.settings(kind)
    columns = [(name, part) for name in spec.inputs for part in wire(name).fields]

    def connect() -> Any:
        return trusted_link(kind, rig, path.parent, settings)

    return Session(rig, columns, connect, values.get("on_fault", "end"))


def make(
    context: Context, spec: NodeSpec, run: RunSettings, parameters: Mapping[str, Any] | None
) -> BridgeNode:
    """Return the bridge's node for a run."""
    return BridgeNode(context, spec, run, parameters)
