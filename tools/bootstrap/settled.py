"""Keeps to the Python whose environment is there, whichever comes first on PATH today."""

import json
import os
import sys
from pathlib import Path

from bootstrap import ensure, interpreter, stamp
from bootstrap.layout import Layout, python_of
from bootstrap.progress import say

# Set before the other interpreter starts: it does not look for a third one.
SWITCHED = "_STEER_INTERPRETER"


def keep_interpreter(layout: Layout, arguments: list[str]) -> None:
    """Start again under the Python of a finished environment, where this one has none.

    ``./steer setup`` does not come here: it makes an environment for the Python that runs it.
    """
    if os.environ.pop(SWITCHED, None) or layout.system_ros or not layout.state.is_dir():
        return
    mine = ensure.names(layout).environment
    if stamp.file_of(mine).is_file():
        return
    for file in sorted(layout.state.glob("env-*.json")):
        other = base_of(file)
        if other is not None:
            say(
                f"using {other}, which the environment in {layout.state} was made for, and not "
                f"{sys.executable}; for that one: {sys.executable} ./steer setup"
            )
            os.environ[SWITCHED] = "1"
            os.execv(other, [other, str(layout.root / "steer"), *arguments])


def base_of(file: Path) -> str | None:
    """Return the interpreter that a finished environment was made with, None where it is gone."""
    try:
        made_for = json.loads(file.read_bytes())["python"]
    except (OSError, ValueError, KeyError, TypeError):
        return None
    python = os.path.realpath(python_of(file.with_suffix("")))
    if made_for == _running() or not os.access(python, os.X_OK):
        return None
    return python if interpreter.version_of(python) in interpreter.SUPPORTED else None


def _running() -> str:
    from bootstrap import fingerprint

    return fingerprint.python_name()
