"""./steer test: the linter, the type checker and the tests, each shown before it runs."""

import shlex
import subprocess
from collections.abc import Mapping
from pathlib import Path

from bootstrap.layout import Layout
from bootstrap.progress import say

# Only these plug-ins: a sourced ROS brings others, which do not fit the locked pytest.
PLUGINS = ("xdist.plugin", "_hypothesis_pytestplugin")
NO_TESTS = 5

# Two processes, a file's tests in one of them: what a file prepares is prepared once. In the order
# of the folders: those with the most tests are not those that take longest. Tests of the ROS graph
# start processes of their own and look at the clock: they come after what computes.
TWO_PROCESSES = ("-n", "2", "--dist", "loadfile", "--no-loadscope-reorder")
PURE_SUITE = (*TWO_PROCESSES, "--ignore=tests/ros")
ROS_SUITE = (*TWO_PROCESSES, "tests/ros")


def commands(python: Path, arguments: list[str]) -> dict[str, list[str]]:
    """Name of each check -> its command; without arguments the whole suite, in two parts."""
    pytest = [str(python), "-m", "pytest", *(w for plugin in PLUGINS for w in ("-p", plugin))]
    parts = {"pytest": arguments} if arguments else {"pytest": PURE_SUITE, "pytest, ROS": ROS_SUITE}
    return {
        "ruff": [str(python), "-m", "ruff", "check", "."],
        "mypy": [str(python), "-m", "mypy"],
        **{name: [*pytest, *words] for name, words in parts.items()},
    }


def run(layout: Layout, python: Path, variables: Mapping[str, str], arguments: list[str]) -> int:
    """Run all checks, even after one failed; 0 only where all passed and tests did run."""
    environ = {**variables, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    failed = []
    for name, command in commands(python, arguments).items():
        say(f"running {shlex.join(['python', *command[1:]])}")
        status = subprocess.run(command, cwd=layout.root, env=environ, check=False).returncode
        if status != 0:
            reason = "no test ran" if _empty(name, status) else f"status {status}"
            failed.append(f"{name} ({reason})")
    say(f"FAILED: {', '.join(failed)}" if failed else "all checks passed")
    return 1 if failed else 0


def _empty(name: str, status: int) -> bool:
    return name.startswith("pytest") and status == NO_TESTS
