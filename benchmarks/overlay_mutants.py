"""Every broken source of the torque overlay's arbiter against its tests.

    python benchmarks/overlay_mutants.py [FILE ...] [--json FILE]

Prints what is not caught; exit status 0 only if that is nothing. Those that nobody can tell from
the right source are listed, with the reason, in tests/support/overlay_mutants.py.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "support"))

from overlay_mutants import EQUIVALENT, MODULES, broken, caught, interpreted


def main() -> int:
    """Try all of them, file by file."""
    parser = argparse.ArgumentParser(description="Every broken source of the overlay's arbiter.")
    parser.add_argument("files", metavar="FILE", nargs="*", help=f"of {', '.join(MODULES)}")
    parser.add_argument("--json", metavar="FILE", type=Path)
    options = parser.parse_args()
    with interpreted(None, "") as modules:
        if caught(modules):
            sys.exit("the source as it is does not pass its own tests")
    began = time.monotonic()
    numbers = {}
    for module in options.files or MODULES:
        tried = [entry for entry in broken(module) if (module, entry[0]) not in EQUIVALENT]
        alive = [what for what, text in tried if not _is_caught(module, text)]
        numbers[module] = {"tried": len(tried), "caught": len(tried) - len(alive), "alive": alive}
        print(f"{module:18}{len(tried) - len(alive):5} of {len(tried)} caught", *alive, sep="\n  ")
    if options.json:
        options.json.write_text(json.dumps(numbers, indent=2) + "\n", encoding="utf-8")
    print(f"{time.monotonic() - began:.0f} s; {len(EQUIVALENT)} more are equivalent to the source")
    return 1 if any(n["alive"] for n in numbers.values()) else 0


def _is_caught(module: str, text: str) -> bool:
    with interpreted(module, text) as modules:
        return caught(modules)


if __name__ == "__main__":
    sys.exit(main())
