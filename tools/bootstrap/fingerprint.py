"""Names of what is built: a hash of all that it depends on, so that a change asks for a new one."""

import hashlib
import os
import sys
from collections.abc import Iterable
from pathlib import Path

from bootstrap.layout import Layout

# To be raised when set-up itself changes what it makes.
FORMAT = "2"
BUILD_FILES = ("package.xml", "CMakeLists.txt", "setup.py", "setup.cfg")
INTERFACES = ("msg/*.msg", "srv/*.srv", "action/*.action")


def digest(parts: Iterable[bytes]) -> str:
    """First 12 hexadecimal digits over all parts, each with its length."""
    total = hashlib.sha256()
    for part in parts:
        total.update(len(part).to_bytes(8, "little") + part)
    return total.hexdigest()[:12]


def python_name() -> str:
    """The running Python, the same inside and outside of a virtual environment."""
    return f"{sys.version} in {sys.base_prefix}"


def environment_key(layout: Layout) -> str:
    """Key of the virtual environment: locks, Python, place of the project, source of ROS."""
    ros = os.environ.get("AMENT_PREFIX_PATH", "") if layout.system_ros else "wheels"
    about = [FORMAT, python_name(), str(layout.root), ros]
    return digest([text.encode() for text in about] + [f.read_bytes() for f in layout.locks()])


def build_files(package: Path) -> list[Path]:
    """Files of a package whose change needs a new build; Python modules are linked, not copied."""
    files = [package / name for name in BUILD_FILES]
    files += [file for pattern in INTERFACES for file in package.glob(pattern)]
    return sorted(file for file in files if file.is_file())


def workspace_key(layout: Layout, environment: str) -> str:
    """Key of the built workspace: its environment, its packages and their build files."""
    parts = [environment.encode()]
    for package in layout.packages():
        for file in build_files(package):
            parts += [str(file.relative_to(layout.source)).encode(), file.read_bytes()]
    return digest(parts)
