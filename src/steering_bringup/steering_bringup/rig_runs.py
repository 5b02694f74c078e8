"""A run with a rig in the plant's place: the node set's change, the processes beside it, checks.

The rig bridge is imported where there is a rig: every other run starts sooner.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from steering_bringup.errors import BenchError
from steering_bringup.schema import NodeSet
from steering_lockstep.graph import CLOCK, RECORDER_KIND, Graph
from steering_lockstep.kinds import FACTORIES
from steering_lockstep.topics import TABLE, wire

if TYPE_CHECKING:
    from rig_bridge.helpers import Helper
    from rig_bridge.rig_file import RigFile

RIG_KIND = "rig_bridge"
PRIORITY = 20
"""Of the real-time scheduler, where it is permitted: bridge, nodes and emulated rig alike."""

OnFault = Literal["end", "hold"]


@dataclass(frozen=True)
class RigChoice:
    """Which rig takes the plant's place.

    ``path`` of its file; ``link``: udp or can; ``told``: what the check of the link says.
    """

    path: Path
    rig: RigFile
    link: str
    on_fault: OnFault = "end"
    told: tuple[str, ...] = ()

    def metadata(self) -> dict[str, Any]:
        """Return what a bag tells of the rig before the run."""
        content = self.rig.model_dump(mode="json", by_alias=True, exclude_none=True)
        emulated = self.rig.emulator is not None
        return {"file": str(self.path), "emulated": emulated, "link": self.link, "content": content}

    def notes(self, effects: Mapping[str, Any]) -> list[str]:
        """Return what a reader of the results must know."""
        kind = "emulated rig" if self.rig.emulator else "rig"
        where = f"the {kind} '{self.rig.name}' over {self.link}: {self.path}"
        notes = [f"measured on {where}", *self.told]
        if effects:
            listed = ", ".join(effects)
            notes.append(f"the rig has its own physics: effects of the plant do nothing ({listed})")
        return notes

    def own_connection(self) -> Connection:
        """Return the connection to a rig that somebody else starts; BenchError for an emulated one.

        Its link's places are only known when it is started.
        """
        if self.rig.emulator is not None:
            raise BenchError(
                f"the rig '{self.rig.name}' is emulated: start it with its nodes, by 'steer run "
                "--plant rig' or 'ros2 launch steering_bringup rig.launch.py'"
            )
        return Connection(self._parameters())

    def launched(self) -> tuple[Connection, list[str]]:
        """Return the connection, and the command that starts an emulated rig; empty for hardware.

        BenchError for a link that is more than one process.
        """
        if self.rig.emulator is None:
            return self.own_connection(), []
        from rig_bridge.emulated import command

        settings, words = command(self.path, self.rig, self.link, PRIORITY)
        return Connection({**self._parameters(), "settings": json.dumps(settings)}), words

    def _parameters(self) -> dict[str, Any]:
        return {"rig": str(self.path), "link": self.link, "on_fault": self.on_fault}

    @contextmanager
    def connected(self) -> Iterator[Connection]:
        """Start the emulated rig, if it is one; it ends with the context."""
        own = self._parameters()
        if self.rig.emulator is None:
            yield Connection(own)
            return
        from rig_bridge.emulated import emulated

        with emulated(self.path, self.rig, self.link, PRIORITY) as (settings, process):
            yield Connection({**own, "settings": json.dumps(settings)}, process)


@dataclass(frozen=True)
class Connection:
    """``parameters``: ROS parameters of the bridge; ``emulator``: its process, if there is one."""

    parameters: dict[str, Any]
    emulator: Helper | None = None

    def notes(self) -> list[str]:
        """Return what became of the emulated rig, where that was not the run's doing."""
        how = None if self.emulator is None else self.emulator.ended()
        return [] if how is None else [f"the emulated rig's process had ended ({how})"]


def rig_layout(graph: Graph) -> dict[str, str]:
    """Return which node is in which process.

    The bench's own nodes are beside the bridge, which they answer without a detour. No other node
    can stop the bridge, and the recorder's writing holds up neither.
    """
    layout = {node.name: "rig" if node.kind in FACTORIES else "nodes" for node in graph.nodes}
    return layout | {node.name: "recorder" for node in graph.nodes if node.kind == RECORDER_KIND}


def choose_rig(name: str, link: str | None, on_fault: OnFault) -> RigChoice:
    """Return the checked choice of a rig by name or file; BenchError tells what is wrong."""
    from rig_bridge.rig_file import load_rig
    from rig_bridge.shipped import find_rig
    from rig_bridge.transport.registry import check_link

    path = find_rig(name).resolve()
    rig = load_rig(path)
    chosen = link or rig.link
    told = check_link(chosen, rig, path.parent)
    return RigChoice(path, rig, chosen, on_fault, tuple(told))


def with_rig(node_set: NodeSet, choice: RigChoice) -> NodeSet:
    """Return the node set with the rig's bridge in the place of the node that is the clock.

    BenchError where the rig does not fit.
    """
    from rig_bridge.session import columns_of

    rig = choice.rig
    if rig.valve_system != node_set.valve_system:
        raise BenchError(
            f"rig '{rig.name}' has the valve system {rig.valve_system}, node set "
            f"'{node_set.name}' is for {node_set.valve_system}: choose another with --node-set"
        )
    name = next((n for n, entry in node_set.nodes.items() if CLOCK in entry.outputs), None)
    if name is None:
        raise BenchError(f"node set '{node_set.name}' has no plant whose place a rig could take")
    plant = node_set.nodes[name]
    known = [topic for topic in plant.inputs if topic in TABLE]
    columns_of(rig, [(topic, part) for topic in known for part in wire(topic).fields])
    bridge = plant.model_copy(update={"kind": RIG_KIND, "truth": (), "parameters": {}})
    changed = {"nodes": node_set.nodes | {name: bridge}, "name": f"{node_set.name}_rig"}
    return node_set.model_copy(update=changed)
