"""Every broken source of the torque overlay's arbiter against its tests.

    steer bench overlay_mutants
    steer python benchmarks/overlay_mutants.py overlay.arbiter

Prints what is not caught. Those that nobody can tell from the right source are listed, with the
reason, in tests/support/overlay_mutants.py.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "support"))

from overlay_mutants import EQUIVALENT, MODULES, broken, caught, interpreted

from steering_bringup.benchmarking.program import Measured, main
from steering_bringup.errors import BenchError
from steering_core.naming import unknown


def measure(options: argparse.Namespace) -> Measured:
    """Try all of them, file by file."""
    for name in options.files:
        if name not in MODULES:
            raise BenchError(unknown("file", name, MODULES))
    with interpreted(None, "") as modules:
        if caught(modules):
            raise BenchError("the source as it is does not pass its own tests")
    numbers = {}
    for module in options.files or MODULES:
        found = [entry for entry in broken(module) if (module, entry[0]) not in EQUIVALENT]
        tried = found[:: options.every]
        alive = [what for what, text in tried if not _is_caught(module, text)]
        numbers[module] = {"tried": len(tried), "alive": alive}
        print(f"{module:18}{len(tried) - len(alive):5} of {len(tried)} caught", *alive, sep="\n  ")
    values = {
        "alive": sum(len(n["alive"]) for n in numbers.values()),
        "tried": sum(n["tried"] for n in numbers.values()),
    }
    return Measured(values, numbers)


def _is_caught(module: str, text: str) -> bool:
    with interpreted(module, text) as modules:
        return caught(modules)


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what is tried."""
    parser.add_argument("files", metavar="FILE", nargs="*", help=f"of {', '.join(MODULES)}")
    parser.add_argument("--every", metavar="N", type=int, default=1, help="each N-th of a file")


if __name__ == "__main__":
    sys.exit(main("overlay_mutants", measure, arguments, __doc__))
