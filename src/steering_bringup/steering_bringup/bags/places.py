"""Where bags lie: the names in a bag's folder, and making room for a new one."""

from __future__ import annotations

import shutil
from pathlib import Path

from steering_bringup.bags.errors import BagError

RUN_FILE = "run.yaml"
METADATA_FILE = "metadata.yaml"


def remove_bag(path: Path) -> None:
    """Remove a bag folder that is to be overwritten; refuse anything that is not a bag."""
    if not path.exists():
        return
    known = {RUN_FILE, METADATA_FILE}
    foreign = [
        f.name
        for f in (path.iterdir() if path.is_dir() else [path])
        if f.name not in known and ".mcap" not in f.suffixes
    ]
    if foreign or not path.is_dir():
        raise BagError(f"'{path}' is not overwritten: it holds '{foreign[0]}', so it is no bag")
    try:
        shutil.rmtree(path)
    except OSError as error:
        raise BagError(f"bag '{path}' cannot be overwritten: {error.strerror}") from error
