"""How a run's topics and services are called in the ROS graph: namespace and new names. Pure.

Inside the bench, in node sets and in bags, a topic keeps its one name, such as /steering/torque.
Its endpoints are made under the relative name, steering/torque, so that a namespace moves a whole
bench and ROS's own rules (``-r __ns:=/car1``, ``-r driver/torque:=/other``) hold for every node.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field

from steering_core.errors import BenchError
from steering_core.naming import unknown

_PART = r"[A-Za-z_][A-Za-z0-9_]*"
_NAME = re.compile(rf"/?{_PART}(/{_PART})*")


@dataclass(frozen=True)
class Names:
    """``namespace``: empty or such as "/car1"; ``remaps``: {topic: its new name}."""

    namespace: str = ""
    remaps: Mapping[str, str] = field(default_factory=dict)

    def arguments(self) -> list[str]:
        """Return the ROS arguments of a node of the run."""
        rules = [f"{relative(old)}:={new}" for old, new in self.remaps.items()]
        rules += [f"__ns:={self.namespace}"] if self.namespace else []
        return ["--ros-args", *(word for rule in rules for word in ("-r", rule))] if rules else []


NAMES = Names()
"""As they are, in no namespace."""


def relative(name: str) -> str:
    """Return the name under which endpoints of the topic or service ``name`` are made."""
    return name.removeprefix("/")


def parse_namespace(text: str) -> str:
    """Return a namespace as ROS writes it, "/car1"; BenchError for what is none."""
    if text in ("", "/"):
        return ""
    if not _NAME.fullmatch(text):
        raise BenchError(f"--namespace '{text}': write a name such as car1 or /fleet/car1")
    return "/" + relative(text)


def parse_remaps(texts: Iterable[str], known: Collection[str]) -> dict[str, str]:
    """Return {topic: new name} of "OLD:=NEW", where OLD is one of the ``known`` topics.

    Raises BenchError for anything else, and where two topics would get one name.
    """
    remaps: dict[str, str] = {}
    for text in texts:
        old, sign, new = text.partition(":=")
        if not sign or not _NAME.fullmatch(old) or not _NAME.fullmatch(new):
            raise BenchError(f"--remap {text}: write OLD:=NEW, such as driver/torque:=my/torque")
        old = "/" + relative(old)
        if old not in known:
            raise BenchError(f"--remap {text}: {unknown('topic', old, known)}")
        remaps[old] = new
    taken: dict[str, str] = {}
    for name in known:
        new = remaps.get(name, relative(name))
        if new in taken:
            raise BenchError(f"{taken[new]} and {name} would both be called {new}: see --remap")
        taken[new] = name
    return remaps
