"""The middleware's environment of a run: this computer alone, no shared memory. Pure.

rmw_fastrtps overrides the transports of an XML profile as long as it sets the discovery range
itself, shared memory included. So for LOCALHOST, our default, the profile says all of it and the
range is left to it; for a wider range that the user asks for, only shared memory is left out.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

PROFILE = Path(__file__).with_name("fastdds.xml")
RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
PROFILE_VARIABLE = "FASTRTPS_DEFAULT_PROFILES_FILE"


def ros_environment(given: Mapping[str, str]) -> dict[str, str]:
    """Return what to set on top of the environment ``given``; the user's own profile is kept."""
    if is_alone(given):
        return {
            RANGE: "SYSTEM_DEFAULT",
            PROFILE_VARIABLE: str(PROFILE),
            "RMW_FASTRTPS_USE_QOS_FROM_XML": "1",
        }
    wider = {"FASTDDS_BUILTIN_TRANSPORTS": given.get("FASTDDS_BUILTIN_TRANSPORTS", "UDPv4")}
    if _has_ours(given):
        wider |= {PROFILE_VARIABLE: "", "RMW_FASTRTPS_USE_QOS_FROM_XML": "0"}
    return wider


def is_alone(given: Mapping[str, str]) -> bool:
    """Return whether an environment asks for this computer alone, with no profile of the user's.

    One that ``ros_environment`` was applied to, such as a shell of ``./steer env``, does.
    """
    if _has_ours(given):
        return given.get(RANGE, "LOCALHOST") in ("LOCALHOST", "SYSTEM_DEFAULT")
    return given.get(RANGE, "LOCALHOST") == "LOCALHOST" and not given.get(PROFILE_VARIABLE)


def _has_ours(given: Mapping[str, str]) -> bool:
    return given.get(PROFILE_VARIABLE) == str(PROFILE)
