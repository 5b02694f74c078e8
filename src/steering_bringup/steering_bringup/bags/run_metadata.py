"""What must be known to repeat a run, as one plain dictionary."""

from __future__ import annotations

import os
import platform
import subprocess
import sys
from collections.abc import Mapping
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

SCHEMA = 1
_LIBRARIES = ("numpy", "scipy", "numba", "llvmlite", "rosbags", "pydantic", "ros-jazzy-rclpy")


def run_metadata(
    *,
    scenario: Mapping[str, Any] | None = None,
    node_set: Mapping[str, Any] | None = None,
    parameters: Mapping[str, Any] | None = None,
    overrides: Mapping[str, Any] | None = None,
    effects: Mapping[str, Any] | None = None,
    domain: int | None = None,
    layout: str | Mapping[str, str] | None = None,
    runner: str = "graph",
    **more: Any,
) -> dict[str, Any]:
    """Everything that a run depends on, ready for YAML and JSON.

    parameters: flat names -> values as used, overrides included; overrides: those that were
    changed; layout: process layout ("one", "each" or {node: process}); runner: "graph" or "direct".
    """
    data = {
        "schema": SCHEMA,
        "started": datetime.now(UTC).isoformat(timespec="seconds"),
        "runner": runner,
        "scenario": scenario or {},
        "node_set": node_set or {},
        "parameters": parameters or {},
        "overrides": overrides or {},
        "effects": effects or {},
        "domain": domain,
        "layout": layout,
        "software": software(),
        "libraries": libraries(),
        "machine": machine(),
        **more,
    }
    return {key: plain(value) for key, value in data.items()}


def plain(value: Any) -> Any:
    """Reduce mappings, sequences, paths and numpy scalars to what YAML and JSON can hold."""
    if isinstance(value, Mapping):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple, set, frozenset)):
        return [plain(v) for v in value]
    if hasattr(value, "tolist"):
        return value.tolist()
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    return str(value)


@cache
def software() -> dict[str, str]:
    """Version of this software: the package's, and the repository's state if there is one."""
    try:
        package = version("steering_bringup")
    except PackageNotFoundError:
        package = "not installed"
    return {"package": package, "revision": _revision()}


def _revision() -> str:
    here = Path(__file__).resolve()
    root = next((p for p in here.parents if (p / ".git").exists()), None)
    if root is None:
        return "unknown"
    command = ["git", "-C", str(root), "describe", "--always", "--dirty", "--tags"]
    environment = {**os.environ, "GIT_OPTIONAL_LOCKS": "0"}
    try:
        result = subprocess.run(
            command, capture_output=True, text=True, timeout=5, check=True, env=environment
        )
    except (OSError, subprocess.SubprocessError):
        return "unknown"
    return result.stdout.strip()


@cache
def libraries() -> dict[str, str]:
    """Versions of the libraries that the numbers of a run depend on."""
    found = {"python": platform.python_version()}
    for name in _LIBRARIES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found


@cache
def machine() -> dict[str, str]:
    """CPU type and system: bit identity holds for one CPU type."""
    return {"cpu": _cpu_model(), "system": platform.platform(), "byte_order": sys.byteorder}


def _cpu_model() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or "unknown"
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()
