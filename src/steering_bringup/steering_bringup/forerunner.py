"""The process that nodes are forked from, started before anything else: its imports take long."""

from __future__ import annotations

from steering_lockstep.kinds import programs
from steering_lockstep.zygote import Zygote

USUAL = ("plant", "valve_controller", "driver", "vehicle", "recorder")
"""Kinds of nodes of most graphs; what others need is imported once they are known."""


def forerunner() -> Zygote:
    """Start a zygote that imports, in the background, what most graphs need."""
    return Zygote(["steering_bringup.cores", *programs(USUAL)])
