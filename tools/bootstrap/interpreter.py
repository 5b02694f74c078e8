"""Finds a Python that the bench runs on. Written so that an old Python can still read it."""

import os
import sys
from typing import Iterator, List, Mapping, Optional, Tuple

SUPPORTED = ((3, 11), (3, 12), (3, 13))
_PROBE = "import sys; print('%d.%d' % sys.version_info[:2])"


def ros_python(environ: Mapping[str, str]) -> Optional[Tuple[int, int]]:
    """Python version that a sourced ROS 2 Jazzy was built for; None where none is sourced."""
    if environ.get("ROS_DISTRO") != "jazzy":
        return None
    import re  # here and below: a call that only passes on shall not wait for such modules

    for folder in environ.get("PYTHONPATH", "").split(os.pathsep):
        package = os.path.join(folder, "rclpy")
        if not os.path.isdir(package):
            continue
        for name in sorted(os.listdir(package)):
            match = re.match(r"_rclpy_pybind11\.cpython-(\d)(\d+)-", name)
            if match:
                return int(match.group(1)), int(match.group(2))
    return None


def candidates(versions: Tuple[Tuple[int, int], ...], path: str) -> Iterator[str]:
    """Every executable on `path` that is named like one of the versions."""
    for major, minor in versions:
        for folder in path.split(os.pathsep):
            name = os.path.join(folder or ".", "python%d.%d" % (major, minor))
            if os.access(name, os.X_OK) and not os.path.isdir(name):
                yield name


def version_of(command: str) -> Optional[Tuple[int, int]]:
    """Version that the command really runs; None where it does not run (a shim without Python)."""
    import subprocess

    try:
        answer = subprocess.run(
            [command, "-c", _PROBE], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, timeout=20
        )
        major, minor = answer.stdout.decode().split(".")
        return int(major), int(minor)
    except (OSError, ValueError, subprocess.SubprocessError):
        return None


def wanted(environ: Mapping[str, str]) -> Tuple[Tuple[int, int], ...]:
    """Versions that serve here: those of the locks, or the one of a sourced ROS."""
    ros = ros_python(environ)
    return (ros,) if ros is not None and ros in SUPPORTED else SUPPORTED


def require(arguments: List[str]) -> None:
    """Return under a suitable Python; otherwise start again under one, or leave with one line."""
    versions = wanted(os.environ)
    if sys.version_info[:2] in versions:
        return
    for command in candidates(versions, os.environ.get("PATH", os.defpath)):
        if version_of(command) in versions:
            os.execv(command, [command] + arguments)
    names = ", ".join("%d.%d" % version for version in versions)
    package = "python%d.%d" % versions[0]
    sys.exit(
        "steer: needs Python %s, found only %d.%d. Install one, for example: "
        "sudo apt install %s %s-venv %s-dev"
        % (names, sys.version_info[0], sys.version_info[1], package, package, package)
    )
