"""What the bench imports from outside, and what to say where some of it is missing. Pure.

ROS's own packages know most of it under other names or in other versions, so that rosdep cannot
install it: see docs/ros.md.
"""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec

MODULES = {
    "numpy": "numpy",
    "scipy": "scipy",
    "numba": "numba",
    "pydantic": "pydantic",
    "yaml": "PyYAML",
    "rosbags": "rosbags",
    "mcap": "mcap",
    "plotly": "plotly",
    "tqdm": "tqdm",
    "can": "python-can",
    "cantools": "cantools",
    "statsmodels": "statsmodels",
    "asammdf": "asammdf",
    "control": "control",
    "pymoo": "pymoo",
    "h5py": "h5py",
    "matio": "mat-io",
    "chardet": "chardet",
    "zstandard": "zstandard",
    "fmpy": "fmpy",
}
"""Module to its name in a package index; the versions are those of requirements/runtime-*.txt."""

LEAST = {"pydantic": 2}
"""Major versions below which an import fails: those of some distributions."""


def missing() -> list[str]:
    """Return the names of what is not installed, or too old."""
    absent = [name for module, name in MODULES.items() if find_spec(module) is None]
    old = [f"{name} {least} or newer" for name, least in LEAST.items() if _major(name) < least]
    return absent + [text for text in old if text.split()[0] not in absent]


def missing_text(error: ImportError) -> str:
    """Return what to do about an import that failed, as one line."""
    names = missing()
    if not names:
        return f"{error}: is the workspace built, and its setup file sourced?"
    return (
        f"{error}. Not installed: {', '.join(names)}; in the bench's folder: "
        "python3 -m pip install -r requirements/runtime-3.12.txt (docs/ros.md)"
    )


def _major(name: str) -> int:
    try:
        return int(version(name).split(".")[0])
    except (PackageNotFoundError, ValueError):
        return 0
