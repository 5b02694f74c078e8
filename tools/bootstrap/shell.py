"""./steer env: lines that turn a shell into one on the bench's ROS, for eval."""

import argparse
import os
import shlex
import sys
from collections.abc import Callable, Mapping
from pathlib import Path

from bootstrap.ensure import Ready
from bootstrap.layout import Layout
from bootstrap.variables import for_run

SHELLS = ("bash", "zsh", "fish")
OF_THE_TERMINAL = "PYTHONIOENCODING"
"""Settled for a command's own output: here that is read by the shell."""
LAST_DOMAIN = 232
"""Beyond it the ports of DDS end."""
EXAMPLES = """examples:
  eval "$(./steer env)"               bash and zsh
  ./steer env --shell fish | source   fish
  eval "$(./steer env --domain 42)"

Then python3 has rclpy and the bench's messages, colcon builds packages on top, and ros2, where it
is installed, sees the runs that are started in this shell (docs/ros.md)."""


def run(layout: Layout, ready: Ready, arguments: list[str]) -> int:
    """Answer `./steer env`."""
    parser = argparse.ArgumentParser(
        prog="steer env",
        description="Print what makes a shell one on the bench's ROS.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--shell", choices=SHELLS, default=_own_shell(), help="default: $SHELL")
    parser.add_argument(
        "--domain",
        metavar="N",
        type=_domain,
        help="ROS domain (default: ROS_DOMAIN_ID, or 0)",
    )
    options = parser.parse_args(arguments)
    wanted = variables(layout, ready, os.environ)
    if options.domain is not None:
        wanted["ROS_DOMAIN_ID"] = options.domain
    print("\n".join(lines(os.environ, wanted, options.shell)))
    return 0


def variables(layout: Layout, ready: Ready, base: Mapping[str, str]) -> dict[str, str]:
    """Return the whole environment of the shell."""
    sys.path.append(str(layout.source / "steering_lockstep"))
    from steering_lockstep.middleware import ros_environment

    result = for_run(layout, ready.environment, ready.workspace, base)
    result.pop(OF_THE_TERMINAL)
    result |= {OF_THE_TERMINAL: base[OF_THE_TERMINAL]} if OF_THE_TERMINAL in base else {}
    result |= ros_environment(result)
    result["ROS_DOMAIN_ID"] = base.get("ROS_DOMAIN_ID") or "0"
    if not layout.system_ros:
        # What colcon and the ROS tools ask for.
        prefixes = [str(ready.workspace / "install"), str(ready.environment)]
        own = result.get("CMAKE_PREFIX_PATH", "")
        result["CMAKE_PREFIX_PATH"] = os.pathsep.join([*prefixes, *([own] if own else [])])
        result |= {"ROS_DISTRO": "jazzy", "ROS_VERSION": "2", "ROS_PYTHON_VERSION": "3"}
    return result


def lines(before: Mapping[str, str], after: Mapping[str, str], shell: str) -> list[str]:
    """Return the commands that lead from one environment to the other, in a shell's language."""
    put, drop, quoted = _LANGUAGES[shell]
    changed = [put.format(n, quoted(v)) for n, v in after.items() if before.get(n) != v]
    return [drop.format(name) for name in before if name not in after] + changed


def _quoted_for_fish(text: str) -> str:
    return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"


_POSIX = ("export {}={}", "unset {}", shlex.quote)
_LANGUAGES: dict[str, tuple[str, str, Callable[[str], str]]] = {
    "bash": _POSIX,
    "zsh": _POSIX,
    "fish": ("set -gx {} {}", "set -e {}", _quoted_for_fish),
}


def _domain(text: str) -> str:
    if not (text.isascii() and text.isdigit() and int(text) <= LAST_DOMAIN):
        raise argparse.ArgumentTypeError(f"must be from 0 to {LAST_DOMAIN}, it is '{text}'")
    return text


def _own_shell() -> str:
    name = Path(os.environ.get("SHELL", "")).name
    return name if name in SHELLS else "bash"
