"""What a change moves: two runs over the same sealed cases, case by case."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from steering_core.errors import BenchError
from steering_diagnosis.benchmark.runner import kept_results

MOVED = 0.02
"""Change of a size, relative, that is told; the sum of rounding is far below it."""


@dataclass(frozen=True)
class Side:
    """What one run says of a case: verdict, causes with their sizes, and whether that is right."""

    verdict: str
    sizes: Mapping[str, float]
    right: bool

    @property
    def text(self) -> str:
        """Return verdict and names."""
        names = sorted({name.partition(".")[0] for name in self.sizes})
        return f"{self.verdict}: {', '.join(names)}" if names else self.verdict


def changes(before: Path, after: Path, method: str) -> Iterator[tuple[str, str]]:
    """Yield (case, what changed) for two folders of records that hold the same cases.

    The last line counts. BenchError where a folder holds no results, or the two share none.
    """
    first, second = _sides(before, method), _sides(after, method)
    shared = sorted(first.keys() & second.keys())
    if not shared:
        raise BenchError(f"'{before}' and '{after}' have no case in common: run the same seed")
    counts = {"verdicts or names": 0, "sizes": 0, "became right": 0, "became wrong": 0}
    for case in shared:
        one, two = first[case], second[case]
        told = one.text != two.text
        moved = [] if told else list(_moved(one.sizes, two.sizes))
        counts["verdicts or names"] += told
        counts["sizes"] += bool(moved)
        counts["became right"] += two.right and not one.right
        counts["became wrong"] += one.right and not two.right
        turn = {(False, True): " (now right)", (True, False): " (now wrong)"}
        if told or one.right != two.right:
            yield case, f"{one.text} -> {two.text}{turn.get((one.right, two.right), '')}"
        for line in moved:
            yield case, line
    alone = len(first.keys() ^ second.keys())
    listed = ", ".join(f"{what}: {count}" for what, count in counts.items())
    yield f"{len(shared)} cases", f"{listed}; {alone} in one of the two only"


def _sides(folder: Path, method: str) -> dict[str, Side]:
    found = {}
    for judgement, report in kept_results(folder, method):
        causes: Iterable[Mapping[str, Any]] = report.get("causes", ())
        sizes = {
            f"{cause['effect']}.{name}": float(told["value"])
            for cause in causes
            for name, told in cause["parameters"].items()
        }
        found[judgement.case] = Side(judgement.verdict, sizes, judgement.as_it_should)
    if not found:
        raise BenchError(f"'{folder}' holds no results of '{method}': it is a folder of --records")
    return found


def _moved(before: Mapping[str, float], after: Mapping[str, float]) -> Iterator[str]:
    for name in sorted(before.keys() & after.keys()):
        change = abs(after[name] - before[name])
        if change > MOVED * max(abs(before[name]), abs(after[name])):
            yield f"{name}: {before[name]:.4g} -> {after[name]:.4g}"
