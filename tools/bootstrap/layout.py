"""Where things lie: the project, and what set-up makes inside it."""

import os
import sys
from pathlib import Path
from typing import NamedTuple

from bootstrap.interpreter import ros_python

GROUPS_OF_WHEELS = ("runtime", "dev", "ros")
GROUPS_BESIDE_ROS = ("runtime", "dev")


class Layout(NamedTuple):
    """Folders of one project, and whether a sourced ROS is used instead of the wheels."""

    root: Path
    system_ros: bool = False

    @classmethod
    def here(cls, root: Path) -> "Layout":
        """Layout of the project at `root` in this process's environment."""
        return cls(root, ros_python(os.environ) == sys.version_info[:2])

    @property
    def state(self) -> Path:
        """Everything that set-up makes; git ignores it."""
        return self.root / ".steer"

    @property
    def logs(self) -> Path:
        """What pip and colcon said."""
        return self.state / "log"

    @property
    def source(self) -> Path:
        """The ROS packages."""
        return self.root / "src"

    @property
    def profile(self) -> Path:
        """The middleware's profile of a run that this computer alone sees."""
        return self.source / "steering_lockstep" / "steering_lockstep" / "fastdds.xml"

    @property
    def groups(self) -> tuple[str, ...]:
        """Groups of requirements that are installed."""
        return GROUPS_BESIDE_ROS if self.system_ros else GROUPS_OF_WHEELS

    def locks(self) -> list[Path]:
        """Lock files of the running Python version, in the order of their groups."""
        version = f"{sys.version_info[0]}.{sys.version_info[1]}"
        return [self.root / "requirements" / f"{group}-{version}.txt" for group in self.groups]

    def packages(self) -> list[Path]:
        """Folders of the ROS packages, sorted by name."""
        return sorted(file.parent for file in self.source.glob("*/package.xml"))


def site_packages(environment: Path) -> Path:
    """Folder of the installed distributions of a virtual environment."""
    version = f"python{sys.version_info[0]}.{sys.version_info[1]}"
    return environment / "lib" / version / "site-packages"


def python_of(environment: Path) -> Path:
    """Interpreter of a virtual environment."""
    return environment / "bin" / "python"
