"""What of a person's shell the bench does not take over, and what it refuses to guess about."""

import os
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from bootstrap.errors import SetupError

# What another ROS, or another Python, would mix into ours.
FOREIGN = (
    "PYTHONHOME",
    "PYTHONPATH",
    "AMENT_PREFIX_PATH",
    "CMAKE_PREFIX_PATH",
    "COLCON_PREFIX_PATH",
    "LD_LIBRARY_PATH",
    "ROS_DISTRO",
    "ROS_VERSION",
    "ROS_PYTHON_VERSION",
    "RMW_IMPLEMENTATION",
    "RCL_ASSERT_RMW_ID_MATCHES",
    "RCL_LOGGING_IMPLEMENTATION",
    "CYCLONEDDS_URI",
)
# Of these families nothing is kept: a value that their library does not know floods the terminal,
# ends a process, or changes what is computed.
FOREIGN_FAMILIES = ("NUMBA_", "RCUTILS_", "ZENOH_", "RMW_FASTRTPS_")

# Python's own settings that cannot make a right program go wrong; all others are left out.
KEPT_OF_PYTHON = (
    "PYTHONDONTWRITEBYTECODE",
    "PYTHONFAULTHANDLER",
    "PYTHONHASHSEED",
    "PYTHONIOENCODING",
    "PYTHONNOUSERSITE",
    "PYTHONPATH",
    "PYTHONPYCACHEPREFIX",
    "PYTHONUNBUFFERED",
    "PYTHONUTF8",
)

RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
RANGES = ("LOCALHOST", "SUBNET", "OFF", "SYSTEM_DEFAULT")
# What leads the middleware to other computers, which only a wider range than LOCALHOST asks for.
OF_THE_NETWORK = (
    "FASTDDS_ENVIRONMENT_FILE",
    "ROS_DISCOVERY_SERVER",
    "ROS_SUPER_CLIENT",
    "SKIP_DEFAULT_XML",
)
PROFILE = "FASTRTPS_DEFAULT_PROFILES_FILE"
THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS")


def without_foreign(base: Mapping[str, str], system_ros: bool) -> dict[str, str]:
    """Return the variables that are taken over; a sourced ROS keeps its own."""
    kept = {name: value for name, value in base.items() if not _of_python_to_leave(name)}
    if system_ros:
        kept.pop("PYTHONHOME", None)
        return kept
    return {
        name: value
        for name, value in kept.items()
        if name not in FOREIGN and not name.startswith(FOREIGN_FAMILIES)
    }


def _of_python_to_leave(name: str) -> bool:
    return name.startswith("PYTHON") and name not in KEPT_OF_PYTHON and name != "PYTHONHOME"


def without_own_profile(variables: dict[str, str], own: Path) -> None:
    """Leave out what `./steer env` put into the shell: it is settled anew for each run.

    A range that was asked for since counts.
    """
    if variables.get(PROFILE) == str(own):
        del variables[PROFILE]
        if variables.get(RANGE) == "SYSTEM_DEFAULT":
            variables[RANGE] = "LOCALHOST"


def on_the_network(variables: dict[str, str]) -> None:
    """Settle how far a run is seen; SetupError for what is not clear or not secured."""
    if variables.pop("ROS_LOCALHOST_ONLY", "0") == "1":
        variables[RANGE] = "LOCALHOST"
    how_far = variables.setdefault(RANGE, "LOCALHOST") or "LOCALHOST"
    if how_far not in RANGES:
        raise SetupError(f"{RANGE} is '{how_far}'; it can be {', '.join(RANGES)}")
    variables[RANGE] = how_far
    profile = variables.get(PROFILE)
    if profile and not os.access(profile, os.R_OK):
        raise SetupError(f"{PROFILE} names '{profile}', which cannot be read: correct or unset it")
    secured = variables.get("ROS_SECURITY_ENABLE", "").lower() == "true"
    if secured and how_far != "LOCALHOST":
        raise SetupError(
            f"ROS_SECURITY_ENABLE: the bench has no keys for ROS, and {RANGE}={how_far} would be "
            "seen unsecured: unset one of the two"
        )
    for name in [n for n in variables if n.startswith("ROS_SECURITY_")]:
        del variables[name]
    if how_far == "LOCALHOST":
        for name in OF_THE_NETWORK:
            variables.pop(name, None)


def one_thread(variables: dict[str, str]) -> None:
    """Let numerical libraries compute in one thread, unless a number of them is asked for.

    Processes share the cores. Threads for small matrices would only wait for one another, and their
    number would change the last digits.
    """
    for name in THREADS:
        asked = variables.get(name, "")
        if not (asked.isascii() and asked.isdigit() and int(asked) > 0):
            variables[name] = "1"


def with_log_folder(variables: dict[str, str], own: Path) -> None:
    """Name a folder for ROS's logs that can be written, where its usual one cannot.

    ``own``: taken then; a temporary one where that cannot be written either.
    """
    if usable(ros_logs(variables)):
        return
    temporary = Path(tempfile.gettempdir(), f"steer-ros-log-{os.getuid()}")
    chosen = own if usable(own) else temporary
    with suppress(OSError):
        chosen.mkdir(mode=0o700, parents=True, exist_ok=True)
    variables["ROS_LOG_DIR"] = str(chosen)


def ros_logs(variables: Mapping[str, str]) -> Path | None:
    """Return where ROS would write its logs; None where it would find no folder."""
    if variables.get("ROS_LOG_DIR"):
        return _absolute(variables["ROS_LOG_DIR"])
    home = variables.get("HOME")
    if variables.get("ROS_HOME"):
        return _absolute(os.path.join(variables["ROS_HOME"], "log"))
    return Path(home, ".ros", "log") if home else None


def _absolute(name: str) -> Path:
    return Path(os.path.abspath(os.path.expanduser(name)))


def usable(folder: Path | None) -> bool:
    """Return whether ``folder`` can be written, or made; nothing is left behind."""
    if folder is None or not folder.is_absolute():
        return False
    try:
        there = next(place for place in (folder, *folder.parents) if place.exists())
        with tempfile.TemporaryDirectory(dir=there):
            return True
    except OSError:
        return False
