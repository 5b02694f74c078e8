"""Environment variables under which the workspace builds and the commands run."""

import os
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path

from bootstrap import inherited, overlay
from bootstrap.layout import Layout, site_packages


def _joined(first: Iterable[Path | str], *later: str) -> str:
    """A search path without empty or repeated entries."""
    parts = [str(part) for part in first]
    parts += [part for text in later for part in text.split(os.pathsep)]
    return os.pathsep.join(dict.fromkeys(part for part in parts if part))


def for_build(layout: Layout, environment: Path, base: Mapping[str, str]) -> dict[str, str]:
    """Variables for pip and colcon."""
    result = _common(layout, environment, base)
    if not layout.system_ros:
        result["AMENT_PREFIX_PATH"] = result["CMAKE_PREFIX_PATH"] = str(environment)
        result["LD_LIBRARY_PATH"] = _joined(_libraries(environment))
    for name in ("PIP_USER", "PIP_TARGET", "PIP_PREFIX", "PIP_REQUIRE_HASHES"):
        result.pop(name, None)
    result.update(
        PIP_USER="0",
        PIP_NO_INPUT="1",
        PIP_DISABLE_PIP_VERSION_CHECK="1",
        PIP_ROOT_USER_ACTION="ignore",
        TMPDIR=str(layout.state / "tmp"),
    )
    return result


def for_run(
    layout: Layout, environment: Path, workspace: Path, base: Mapping[str, str]
) -> dict[str, str]:
    """Variables for the command line and the nodes; set before Python starts."""
    result = _common(layout, environment, base)
    install = workspace / "install"
    built = site_packages(install)
    # The sources come before the links to them, so that error messages name the sources.
    modules = [p for p in layout.packages() if (p / "setup.py").is_file()]
    links = [workspace / "build" / p.name for p in modules]
    result["PYTHONPATH"] = _joined([*modules, built, *links], result.get("PYTHONPATH", ""))
    if layout.system_ros:
        result["AMENT_PREFIX_PATH"] = _joined([install], result.get("AMENT_PREFIX_PATH", ""))
        libraries: list[Path] = []
    else:
        result["AMENT_PREFIX_PATH"] = _joined([install, environment])
        libraries = _libraries(environment)
        # The wheels would otherwise start Python a second time to set the library path.
        result["_ROS_WHEELS_BOOTSTRAP_COMPLETE"] = "1"
    result["LD_LIBRARY_PATH"] = _joined(
        [install / "lib", *libraries], result.get("LD_LIBRARY_PATH", "")
    )
    # Behind ours: a run does what it does without them.
    for name, path in overlay.search_paths(layout, base).items():
        if path:
            result[name] = _joined([], result.get(name, ""), path)
    inherited.without_own_profile(result, layout.profile)
    inherited.on_the_network(result)
    inherited.one_thread(result)
    inherited.with_log_folder(result, layout.logs / "ros")
    result["PYTHONUTF8"] = "1"
    result["PYTHONIOENCODING"] = _terminal(base)
    return result


def _common(layout: Layout, environment: Path, base: Mapping[str, str]) -> dict[str, str]:
    result = inherited.without_foreign(base, layout.system_ros)
    result["VIRTUAL_ENV"] = str(environment)
    result["PATH"] = _joined([environment / "bin"], base.get("PATH", os.defpath))
    result["PYTHONNOUSERSITE"] = "1"
    return result


def _terminal(base: Mapping[str, str]) -> str:
    """The terminal's encoding, in which what it cannot show is replaced and ends nothing."""
    given = base.get("PYTHONIOENCODING", "").partition(":")[0]
    return f"{given or getattr(sys.stdout, 'encoding', None) or 'utf-8'}:replace"


def _libraries(environment: Path) -> list[Path]:
    """Folders with the shared libraries of the wheels."""
    return [environment / "lib", *sorted(site_packages(environment).glob("ros_*.libs"))]
