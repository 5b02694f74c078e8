"""Runs the command line in the environment; an import that fails leads to a check and a repair.

Started by ./steer with the environment's own Python, as a file, with every search path set.
"""

import os
import sys
from pathlib import Path

# Set after a failed import: the next start compares every installed file.
RETRIED = "_STEER_RETRIED"


def main() -> int:
    """Run the command line."""
    try:
        from steering_bringup.cli import main as command_line
    except (ImportError, SyntaxError, OSError, ValueError) as error:
        if os.environ.pop(RETRIED, None):
            raise
        return check_and_retry(error)
    sys.argv[0] = "steer"
    try:
        return command_line() or 0
    except (ImportError, SyntaxError):
        print("steer: is the environment whole? ./steer setup --check", file=sys.stderr)
        raise


def check_and_retry(error: BaseException) -> int:
    """Start ./steer again, which this time looks at every installed file first."""
    print(f"steer: {type(error).__name__}: {error}; checking the environment", file=sys.stderr)
    root = Path(__file__).resolve().parents[2]
    base = getattr(sys, "_base_executable", sys.executable)
    os.environ[RETRIED] = "1"
    os.execv(base, [base, str(root / "steer"), *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
