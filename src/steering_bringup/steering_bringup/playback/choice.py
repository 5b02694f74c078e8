"""Which topics of a bag are played, under which names."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence

from steering_bringup.errors import BenchError
from steering_core.naming import unknown


def chosen_topics(
    known: Collection[str], topics: Sequence[str], exclude: Sequence[str]
) -> tuple[str, ...]:
    """Return the topics to play, in the bag's order; all where ``topics`` is empty.

    Raises BenchError naming a topic that the bag does not have and the nearest one.
    """
    for name in (*topics, *exclude):
        if name not in known:
            raise BenchError(f"{unknown('topic', name, known)} in the bag")
    return tuple(n for n in known if (not topics or n in topics) and n not in exclude)


def parse_remaps(texts: Iterable[str], chosen: Collection[str]) -> dict[str, str]:
    """Return {topic: new name} of "OLD:=NEW"; no two played topics may get one name."""
    names = {name: name for name in chosen}
    for text in texts:
        old, sign, new = text.partition(":=")
        if not sign or not old or not new.startswith("/"):
            raise BenchError(f"--remap {text}: write OLD:=NEW, such as /driver/torque:=/my/torque")
        if old not in names:
            raise BenchError(f"--remap {text}: {unknown('topic', old, chosen)} among those played")
        names[old] = new
    for old, new in names.items():
        other = next((o for o, n in names.items() if n == new and o != old), None)
        if other is not None:
            raise BenchError(f"{old} and {other} would both be published as {new}")
    return names
