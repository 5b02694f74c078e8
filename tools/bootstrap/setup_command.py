"""./steer setup: set up, check every file, or start from nothing."""

import argparse

from bootstrap import locks
from bootstrap.ensure import ensure
from bootstrap.errors import SetupError
from bootstrap.layout import Layout
from bootstrap.progress import say
from bootstrap.removal import remove_if_unused


def run(layout: Layout, arguments: list[str]) -> int:
    """Answer `./steer setup`."""
    parser = argparse.ArgumentParser(
        prog="steer setup",
        description="Make the environment and build the workspace, or repair them.",
        epilog="example: ./steer setup --check",
    )
    choice = parser.add_mutually_exclusive_group()
    choice.add_argument("--check", action="store_true", help="compare every installed file first")
    choice.add_argument("--clean", action="store_true", help="remove everything and set up again")
    options = parser.parse_args(arguments)
    if options.clean:
        clean(layout)
    ensure(layout, thorough=options.check)
    say("environment and workspace are complete")
    return 0


def clean(layout: Layout) -> None:
    """Remove every environment and workspace; refuse where one is in use."""
    if not layout.state.is_dir():
        return
    with locks.setting_up(layout.state / "lock"):
        for pattern in ("env-*", "ws-*"):
            for top in layout.state.glob(pattern):
                if top.is_dir() and not remove_if_unused(top):
                    raise SetupError(f"{top} is in use by a running command; end that first")
