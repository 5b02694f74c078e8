"""A rig's file for tests in wall time: it and its emulated rig put up with a loaded machine.

The emulated rig runs in slow motion: answers that come late make a steering gear unstable, and a
loaded machine is late by more than a millisecond.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml
from healthy_rig import EMULATED

SLOWNESS = 4.0
PATIENT = {
    "stale_ticks": 1000,
    "command_stale_ticks": 1000,
    "bad_frames": 1e6,
    "clock_offset_s": 60.0,
    "check_ticks": 20,
    "check_timeout_ticks": 20_000,
    "entry_ticks": 20,
}


def patient_rig(folder: Path, emulator: dict[str, Any] | None = None, **watching: Any) -> Path:
    """Write rig, emulator and DBC file to ``folder`` and return the rig's; others than given."""
    own = yaml.safe_load(EMULATED.with_name("emulator.yaml").read_text())
    own |= {"stale_ticks": 100_000, "clock_drift": SLOWNESS - 1.0, **(emulator or {})}
    (folder / "emulator.yaml").write_text(yaml.safe_dump(own))
    (folder / "emulated.dbc").write_bytes(EMULATED.with_name("emulated.dbc").read_bytes())
    rig = yaml.safe_load(EMULATED.read_text())
    rig["watching"] = {**PATIENT, **watching}
    rig["relations"], rig["rates"] = {}, {}
    for channel in rig["channels"].values():
        if channel["direction"] == "measured":
            channel["rate"] = 1e12
    path = folder / "patient.yaml"
    path.write_text(yaml.safe_dump(rig, sort_keys=False))
    return path
