"""Options of every command that speaks ROS: the domain, and how the bench is called in it."""

from __future__ import annotations

import argparse
import os

from steering_bringup.errors import BenchError
from steering_lockstep.domain import VARIABLE, DomainError, asked_domain, checked_domain


def add_domain(group: argparse._ActionsContainer, default: str = "a free one") -> None:
    """Declare ``--domain`` in a parser or a group of it."""
    text = f"ROS domain (default: {VARIABLE}, or {default})"
    group.add_argument("--domain", metavar="N", help=text)


def settle_domain(options: argparse.Namespace) -> int | None:
    """Return the domain asked for by option or variable, None where by neither.

    From now on it is that of everything that this process starts. BenchError for what is none.
    """
    try:
        if options.domain is not None:
            os.environ[VARIABLE] = str(checked_domain(options.domain, "--domain"))
        return asked_domain(os.environ)
    except DomainError as error:
        raise BenchError(str(error)) from None


def add_names(group: argparse._ActionsContainer) -> None:
    """Declare ``--namespace`` and ``--remap``."""
    group.add_argument(
        "--namespace", metavar="NS", default="", help="before all names of topics, such as /car1"
    )
    group.add_argument(
        "--remap",
        metavar="OLD:=NEW",
        action="append",
        default=[],
        help="another name for a topic; repeatable",
    )
