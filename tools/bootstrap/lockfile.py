"""Reads lock files: blocks of one pinned distribution with its hashes."""

import re
from collections.abc import Iterable
from pathlib import Path


def canonical(name: str) -> str:
    """Name of a distribution as package indexes compare it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def blocks(files: Iterable[Path]) -> dict[str, str]:
    """Every pinned distribution: canonical name -> its lines."""
    result = {}
    for file in files:
        for block in re.findall(r"^[A-Za-z0-9](?:.*\\\n)*.*\n", file.read_text(), re.MULTILINE):
            result[canonical(re.split(r"[\[=]", block, maxsplit=1)[0])] = block
    return result


def version_in(block: str) -> str:
    """Pinned version of a block."""
    match = re.search(r"==([^\s\\;]+)", block)
    if match is None:
        raise ValueError(f"no pinned version in {block!r}")
    return match.group(1)
