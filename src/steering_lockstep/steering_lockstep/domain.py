"""A ROS domain for this run alone, so that two runs on one machine never meet.

Unless one is asked for: by ``--domain``, which sets ROS_DOMAIN_ID, or by that variable. In one
domain two runs need namespaces.
"""

from __future__ import annotations

import os
import socket
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

# Domains up to 101 have ports below the kernel's ephemeral range.
CANDIDATES = tuple(range(1, 102))
DISCOVERY_PORT = 7400
PORTS_PER_DOMAIN = 250
LONGEST_NAME = 100
"""Bytes of a name in the kernel's socket space, with room to spare."""
VARIABLE = "ROS_DOMAIN_ID"
LAST_DOMAIN = 232
"""Beyond it the ports of DDS end."""


class DomainError(RuntimeError):
    """No domain is free, or the one asked for is in use by another run."""


@dataclass
class DomainClaim:
    """A claimed ROS_DOMAIN_ID; the kernel frees it when the process ends, however it does."""

    number: int
    _socket: socket.socket

    def release(self) -> None:
        """Give the domain back."""
        self._socket.close()


def asked_domain(environment: Mapping[str, str]) -> int | None:
    """Return the domain that ROS_DOMAIN_ID asks for, None where it is not set.

    Raises ``DomainError`` for what is no domain.
    """
    text = environment.get(VARIABLE, "").strip()
    return checked_domain(text, VARIABLE) if text else None


def checked_domain(text: str, name: str) -> int:
    """Return the number of a domain; ``DomainError`` with the ``name`` of who asks for it."""
    if not (text.isascii() and text.isdigit() and int(text) <= LAST_DOMAIN):
        raise DomainError(f"{name} must be a number from 0 to {LAST_DOMAIN}, it is '{text}'")
    return int(text)


def claim_domain(
    asked: int | None = None, candidates: Iterable[int] = CANDIDATES, namespace: str = ""
) -> DomainClaim:
    """Claim ``asked``, or a domain that no other run and no DDS participant here uses.

    In an asked-for domain there may be other runs, each in a ``namespace`` of its own. Raises
    ``DomainError``.
    """
    if asked is not None:
        claim = _claim(asked, namespace)
        if claim is None:
            raise DomainError(
                f"ROS_DOMAIN_ID {asked} is used by another run on this machine"
                f"{f' in the namespace {namespace}' if namespace else ''}: take another --domain "
                "or --namespace"
            )
        return claim
    candidates = tuple(candidates)
    start = os.getpid() % len(candidates)
    for number in candidates[start:] + candidates[:start]:
        claim = _claim(number) if _is_quiet(number) else None
        if claim is not None:
            return claim
    raise DomainError("no free ROS_DOMAIN_ID on this machine")


def _claim(number: int, namespace: str = "") -> DomainClaim | None:
    """Bind a name in the kernel's abstract socket space: no file, one owner, gone with it."""
    holder = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    try:
        holder.bind(f"\0steering-bench-domain-{number}{namespace}"[:LONGEST_NAME])
    except OSError:
        holder.close()
        return None
    return DomainClaim(number, holder)


def _is_quiet(number: int) -> bool:
    """Return whether no participant listens on the domain's discovery port."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind(("", DISCOVERY_PORT + PORTS_PER_DOMAIN * number))
        except OSError:
            return False
    return True
