"""What is known about a run only after it, added to its bag's metadata."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from steering_bringup.bags.errors import BagError
from steering_bringup.bags.places import METADATA_FILE, RUN_FILE
from steering_bringup.bags.run_metadata import plain
from steering_bringup.bags.writer import RUN_KEY


def note_in_bag(path: Path, more: Mapping[str, Any]) -> None:
    """Add ``more`` to the run's metadata of a closed bag; the messages are not touched.

    Raises BagError where the disk takes no more; the bag is then as it was.
    """
    data = plain(more)
    try:
        _change(path / RUN_FILE, lambda run: run.update(data))
        if (path / METADATA_FILE).exists():
            _change(path / METADATA_FILE, lambda document: _add(document, data))
    except OSError as error:
        raise BagError(
            f"bag '{path}': its metadata cannot be added to: {error.strerror}"
        ) from error


def _add(document: dict[str, Any], data: dict[str, Any]) -> None:
    custom = document["rosbag2_bagfile_information"].setdefault("custom_data", {})
    custom[RUN_KEY] = json.dumps({**json.loads(custom.get(RUN_KEY, "{}")), **data})


def _change(file: Path, change: Any) -> None:
    """Rewrite a YAML file; the new one takes the old one's place at once or not at all."""
    document = yaml.safe_load(file.read_text(encoding="utf-8")) or {}
    change(document)
    new = file.with_suffix(".new")
    try:
        text = yaml.safe_dump(document, sort_keys=False, allow_unicode=True)
        new.write_text(text, encoding="utf-8")
        os.replace(new, file)
    finally:
        new.unlink(missing_ok=True)
