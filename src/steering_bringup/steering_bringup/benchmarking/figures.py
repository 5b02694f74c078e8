"""Figures in the documentation that a benchmark measured: found and rewritten by their markers.

A figure stands between ``<!-- bench: NAME.ROW -->`` and ``<!-- /bench -->``, which no viewer shows.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

MARKED = re.compile(r"(<!-- bench: (\w+)\.(\w+) -->)(.*?)(<!-- /bench -->)", re.DOTALL)
Rows = Mapping[str, Mapping[str, Mapping[str, Any]]]
"""Benchmark to row to its entry in the JSON file."""


def pages(root: Path) -> list[Path]:
    """Return the pages of the documentation."""
    return [root / "README.md", *sorted((root / "docs").glob("*.md"))]


def marked(text: str) -> Iterator[tuple[str, str, str]]:
    """Yield (benchmark, row, figure) of each marker of a page."""
    for found in MARKED.finditer(text):
        yield found[2], found[3], found[4]


def named(root: Path) -> set[str]:
    """Return the benchmarks that the documentation has figures of."""
    return {name for page in pages(root) for name, _, _ in marked(page.read_text("utf-8"))}


def rewritten(text: str, rows: Rows) -> str:
    """Return the page with the figures of ``rows``; one that was not measured stays."""

    def figure(found: re.Match[str]) -> str:
        entry = rows.get(found[2], {}).get(found[3])
        if entry is None or entry["value"] is None:
            return found[0]
        return f"{found[1]}{entry['text']}{found[5]}"

    return MARKED.sub(figure, text)


def rewrite(root: Path, rows: Rows) -> tuple[list[Path], list[str]]:
    """Rewrite all pages; return those that changed, and the figures that were not measured."""
    changed, stale = [], []
    for page in pages(root):
        before = page.read_text("utf-8")
        after = rewritten(before, rows)
        if after != before:
            page.write_text(after, "utf-8")
            changed.append(page)
        for name, row, _ in marked(before):
            if (rows.get(name, {}).get(row) or {}).get("value") is None:
                stale.append(f"{name}.{row}")
    return changed, sorted(set(stale))
