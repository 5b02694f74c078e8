"""Checks what the machine must bring; everything missing comes in one line."""

import importlib.util
import os
import platform
import re
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

from bootstrap.errors import SetupError
from bootstrap.layout import Layout

LEAST_CMAKE = (3, 20)
LEAST_GLIBC = (2, 28)
LEAST_SPACE = 2_500_000_000


def check(layout: Layout) -> None:
    """Raise SetupError where set-up cannot succeed on this machine."""
    _place(layout.root)
    if not layout.system_ros:
        _platform()
    _programs(layout)
    _space(layout.root)


def _place(root: Path) -> None:
    # Search paths are lists with these separators, and CMake expands the dollar.
    bad = sorted(set(str(root)) & set(":;$\"'\\"))
    if bad:
        raise SetupError(f"move the project: colcon cannot build below a path with {' '.join(bad)}")


def _platform() -> None:
    if sys.platform != "linux" or platform.machine() != "x86_64":
        raise SetupError(
            f"there are no ROS 2 wheels for {platform.system()} on {platform.machine()}, only for "
            "Linux on x86-64; with ROS 2 Jazzy installed, source its setup.bash and run this again"
        )
    name, version = platform.libc_ver()
    found = tuple(int(part) for part in re.findall(r"\d+", version)[:2])
    if name != "glibc" or found < LEAST_GLIBC:
        text = f"{name or 'another C library'} {version}"
        raise SetupError(f"the ROS 2 wheels need glibc 2.28 or newer, found {text}")


def missing_packages(layout: Layout) -> dict[str, str]:
    """What is missing: name of the thing -> Debian package that brings it."""
    version = f"python{sys.version_info[0]}.{sys.version_info[1]}"
    header = Path(sysconfig.get_paths()["include"], "Python.h")
    present = {
        ("C compiler", "gcc"): _any("CC", "cc", "gcc", "clang"),
        ("C++ compiler", "g++"): _any("CXX", "c++", "g++", "clang++"),
        ("cmake", "cmake"): shutil.which("cmake"),
        ("make", "make"): shutil.which("make"),
        ("Python headers", f"{version}-dev"): header.is_file(),
        ("Python's ensurepip", f"{version}-venv"): importlib.util.find_spec("ensurepip"),
        ("Python's ctypes", f"lib{version}-stdlib"): importlib.util.find_spec("_ctypes"),
    }
    if layout.system_ros:
        colcon = importlib.util.find_spec("colcon_core")
        present["colcon", "python3-colcon-common-extensions"] = colcon
    return {thing: package for (thing, package), found in present.items() if not found}


def _any(variable: str, *names: str) -> str | None:
    chosen = os.environ.get(variable, "").split()
    return shutil.which(chosen[0]) if chosen else next(filter(None, map(shutil.which, names)), None)


def _programs(layout: Layout) -> None:
    missing = missing_packages(layout)
    if missing:
        packages = " ".join(sorted(set(missing.values())))
        raise SetupError(f"missing: {', '.join(missing)}. Install: sudo apt install {packages}")
    answer = subprocess.run(["cmake", "--version"], capture_output=True, text=True, check=False)
    found = tuple(int(part) for part in re.findall(r"\d+", answer.stdout)[:2])
    if found < LEAST_CMAKE:
        raise SetupError("cmake 3.20 or newer is needed. Install: sudo apt install cmake")


def _space(root: Path) -> None:
    free = shutil.disk_usage(root).free
    if free < LEAST_SPACE:
        raise SetupError(
            f"the disk has {free / 1e9:.1f} GB free, set-up needs {LEAST_SPACE / 1e9:.1f} GB"
        )
