"""What ``can.Bus`` is given, checked by what the interface takes: its signature and its text."""

from __future__ import annotations

import importlib
import inspect
import logging
import re
from collections.abc import Mapping
from typing import Any, NamedTuple

import can
from can.interfaces import BACKENDS

from rig_bridge.transport.settings import CanSettings
from steering_core.errors import BenchError
from steering_core.naming import unknown

PARAMETER = re.compile(r":param\s+(?:[^:\n]*\s)?(\w+):")
TAKEN = re.compile(r"""(?:kwargs|config)(?:\.get\(|\.pop\(|\[)\s*["']([a-z]\w*)["']""")
OF_THE_BUS = ("fd", "bitrate", "data_bitrate")
"""Passed on where the interface takes them; where it does not, the bus is set up elsewhere."""

OF_THE_BENCH = {"interface", "timing", "dbc", "messages"}
"""Settings that are no arguments, or another one."""

CARRIES_ANY = ("virtual", "socketcand")
"""Interfaces without an option ``fd`` that carry CAN FD frames: the second only with the hub."""


class Interface(NamedTuple):
    """An interface's class and the names of what it takes."""

    bus: type[can.BusABC]
    takes: frozenset[str]


class Rates(NamedTuple):
    """Bit rates [bit/s] of arbitration and data phase; equal without a switch of the rate."""

    nominal: int
    data: int


def interface(name: str) -> Interface:
    """Return the interface called ``name``; BenchError where this machine has none."""
    if name not in BACKENDS:
        raise BenchError(f"{unknown('CAN interface', name, BACKENDS)} (of python-can)")
    module, bus = BACKENDS[name]
    before = logging.root.manager.disable
    logging.disable(logging.CRITICAL)  # each driver that is not there would say so in its own words
    try:
        made: type[can.BusABC] = getattr(importlib.import_module(module), bus)
    except Exception as error:
        raise BenchError(f"CAN interface '{name}' cannot be used here: {error}") from None
    finally:
        logging.disable(before)
    return Interface(made, _takes(made))


def _takes(bus: type[can.BusABC]) -> frozenset[str]:
    names: set[str] = set()
    for ancestor in bus.__mro__[:-1]:
        names.update(PARAMETER.findall(ancestor.__doc__ or ""))
        if "__init__" not in vars(ancestor):
            continue
        made = inspect.unwrap(ancestor.__init__)  # type: ignore[misc]
        names.update(inspect.signature(made).parameters)
        names.update(PARAMETER.findall(made.__doc__ or ""))
        names.update(TAKEN.findall(inspect.getsource(made)))
    return frozenset(names - {"self", "kwargs", "args"})


def bus_options(settings: CanSettings) -> dict[str, Any]:
    """Return the arguments of the interface's class; BenchError names one that it does not take.

    The bit rates go to interfaces that set them. Of others, as of socketcan, the bus is set up
    elsewhere, and a bit timing is refused, so that nobody takes it for the one that is used.
    """
    takes = interface(settings.interface).takes
    given = settings.model_dump(exclude_none=True, exclude=OF_THE_BENCH)
    known = takes | OF_THE_BENCH | set(OF_THE_BUS)
    for name in given:
        if name not in known:
            what = f"option of the CAN interface '{settings.interface}'"
            raise BenchError(f"links.can: {unknown(what, name, known)}")
    if settings.fd and not ("fd" in takes or settings.interface in CARRIES_ANY):
        raise BenchError(f"links.can: the CAN interface '{settings.interface}' carries no CAN FD")
    options = {n: v for n, v in given.items() if n in takes or n not in OF_THE_BUS}
    if settings.interface == "socketcand":
        options.setdefault("tcp_tune", True)
    if (timing := bit_timing(settings)) is not None:
        if "timing" not in takes:
            raise BenchError(
                f"links.can: the CAN interface '{settings.interface}' takes no bit timing (the bus "
                "is set up elsewhere, as by 'ip link set can0 type can bitrate ...'): give bitrate "
                "for the check of the bus load"
            )
        options = {n: v for n, v in options.items() if n not in ("bitrate", "data_bitrate")}
        options["timing"] = timing
    if isinstance(options.get("state"), str):
        options["state"] = _state(options["state"])
    return options


def _state(name: str) -> can.BusState:
    known = can.BusState.__members__
    if name.upper() not in known:
        raise BenchError(f"links.can: {unknown('state of a CAN bus', name, known)}")
    return known[name.upper()]


def bit_timing(settings: CanSettings) -> can.BitTiming | can.BitTimingFd | None:
    """Return the bit timing of the settings, from segments, registers or a sample point."""
    if settings.timing is None:
        return None
    whole = {n: v if n.endswith("point") else round(v) for n, v in settings.timing.items()}
    try:
        made = _maker(whole)(**whole)
    except (TypeError, ValueError) as error:
        text = re.sub(r"^\w+\.(\w+)\(\) ", "", str(error)).replace("__init__() ", "")
        raise BenchError(f"links.can: bit timing: {text}") from None
    if isinstance(made, can.BitTimingFd) != settings.fd:
        need = "nom_brp, nom_tseg1, ..., data_brp, ..." if settings.fd else "brp, tseg1, tseg2, sjw"
        raise BenchError(f"links.can: bit timing of a bus with fd: {settings.fd} needs {need}")
    return made


def _maker(timing: Mapping[str, float]) -> Any:
    of_fd = any(name.startswith(("nom_", "data_")) for name in timing)
    kind: Any = can.BitTimingFd if of_fd else can.BitTiming
    if any(name.endswith("sample_point") for name in timing):
        return kind.from_sample_point
    if "btr0" in timing:
        return kind.from_registers
    rate = any(name.endswith("bitrate") for name in timing)
    return kind.from_bitrate_and_segments if rate else kind


def rates(settings: CanSettings) -> Rates | None:
    """Return the bit rates that the settings tell; None where they do not."""
    timing = bit_timing(settings)
    if isinstance(timing, can.BitTimingFd):
        return Rates(timing.nom_bitrate, timing.data_bitrate)
    nominal = settings.bitrate if timing is None else timing.bitrate
    return None if nominal is None else Rates(nominal, settings.data_bitrate or nominal)


def switches(settings: CanSettings) -> bool:
    """Return whether CAN FD frames switch to the rate of the data phase."""
    found = rates(settings)
    of_its_own = settings.data_bitrate is not None
    return settings.fd and (of_its_own if found is None else found.data != found.nominal)
