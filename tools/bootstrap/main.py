"""Decides what a call of ./steer does: set-up, tests, or the command line in the environment."""

import os
import sys
from pathlib import Path
from typing import NoReturn

from bootstrap import settled
from bootstrap.ensure import Ready, ensure
from bootstrap.errors import SetupError
from bootstrap.layout import Layout, python_of
from bootstrap.start import RETRIED
from bootstrap.variables import for_run


def main(root: Path, arguments: list[str]) -> int:
    """Exit status of the call; does not return where the command line takes over."""
    open_standard_streams()
    try:
        status = dispatch(Layout.here(root), arguments)
        if sys.stdout is not None:
            sys.stdout.flush()
        return status
    except SetupError as error:
        print(f"steer: {error}", file=sys.stderr)
        return 1
    except BrokenPipeError:
        # The reader (head, less) has had enough; what is buffered would raise once more at the end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except PermissionError as error:
        print(
            f"steer: no permission for {error.filename}; does it belong to another user?",
            file=sys.stderr,
        )
        return 1
    except OSError as error:
        print(
            f"steer: {error.filename or 'standard output'}: {error.strerror or error}",
            file=sys.stderr,
        )
        return 1
    except KeyboardInterrupt:
        print("\nsteer: interrupted; the next call goes on from here", file=sys.stderr)
        return 130


def open_standard_streams() -> None:
    """Open those that are closed: a lock file would take their number, and what is printed."""
    for number, flags in enumerate((os.O_RDONLY, os.O_WRONLY, os.O_WRONLY)):
        try:
            os.fstat(number)
        except OSError:
            os.set_inheritable(os.open(os.devnull, flags), True)


def dispatch(layout: Layout, arguments: list[str]) -> int:
    """Hand the call to whoever answers it."""
    command = arguments[0] if arguments else "--help"
    if command in ("-h", "--help", "help"):
        from bootstrap import help_text

        print(help_text.text(layout.root))
        return 0
    if command == "setup":
        from bootstrap import setup_command

        return setup_command.run(layout, arguments[1:])
    settled.keep_interpreter(layout, arguments)
    if command == "test":
        from bootstrap import checks

        ready = ensure(layout)
        variables = for_run(layout, ready.environment, ready.workspace, os.environ)
        variables.pop("ROS_DOMAIN_ID", None)  # each run of the tests takes its own
        return checks.run(layout, python_of(ready.environment), variables, arguments[1:])
    if command == "env":
        from bootstrap import shell

        return shell.run(layout, ensure(layout), arguments[1:])
    return hand_over(layout, ensure(layout, thorough=RETRIED in os.environ), arguments)


def hand_over(layout: Layout, ready: Ready, arguments: list[str]) -> NoReturn:
    """Become the command line: its exit status and its signals are those of this process."""
    variables = for_run(layout, ready.environment, ready.workspace, os.environ)
    python = str(python_of(ready.environment))
    start = str(layout.root / "tools" / "bootstrap" / "start.py")
    os.execve(python, [python, "-P", start, *arguments], variables)
