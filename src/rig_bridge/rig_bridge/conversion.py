"""Raw numbers to SI and back: SI = sign x (scale x raw + offset)."""

from __future__ import annotations

from typing import Protocol


class Scaled(Protocol):
    """What a conversion needs to know of a channel."""

    @property
    def scale(self) -> float:
        """SI unit per raw count."""

    @property
    def offset(self) -> float:
        """Added after the scale, SI unit."""

    @property
    def sign(self) -> int:
        """1, or -1 where the rig counts the other way."""


def si_of(channel: Scaled, raw: float) -> float:
    """Return the SI value of a ``raw`` number."""
    return channel.sign * (channel.scale * raw + channel.offset)


def raw_of(channel: Scaled, value: float) -> float:
    """Return the raw number (not yet rounded) of an SI ``value``."""
    return (channel.sign * value - channel.offset) / channel.scale
