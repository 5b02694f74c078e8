"""Experiments to choose from: each excites something that the others leave in peace."""

from __future__ import annotations

from typing import Any

DURATION_S = 12.0

CANDIDATES: dict[str, dict[str, Any]] = {
    "on_centre_sweep": {
        "manoeuvre": {"kind": "on_centre", "amplitude_deg": 30.0, "duration_s": DURATION_S},
    },
    "slow_weave": {
        "manoeuvre": {"kind": "weave", "amplitude_deg": 40.0, "frequency_hz": 0.15},
    },
    "small_fast_chirp": {
        "manoeuvre": {
            "kind": "chirp",
            "amplitude_deg": 5.0,
            "initial_frequency_hz": 0.3,
            "final_frequency_hz": 10.0,
            "duration_s": DURATION_S,
        },
    },
    "wheel_lifted": {
        "manoeuvre": {"kind": "weave", "amplitude_deg": 60.0, "frequency_hz": 0.4},
        "load": {"kind": "none"},
    },
    "parking": {
        "manoeuvre": {"kind": "on_centre", "amplitude_deg": 28.0, "duration_s": DURATION_S},
        "load": {"kind": "dry_park"},
    },
    "held_load": {
        "manoeuvre": {"kind": "ramp", "angle_deg": 26.0, "speed_deg_s": 20.0},
        "load": {"kind": "dry_park"},
    },
    "fast_step": {
        "manoeuvre": {"kind": "step", "angle_deg": 40.0, "rise_s": 0.08},
    },
    "lock_to_lock": {
        "manoeuvre": {"kind": "ramp", "angle_deg": 568.0, "speed_deg_s": 90.0},
        "load": {"kind": "none"},
    },
    "walking_pace": {
        "manoeuvre": {"kind": "weave", "amplitude_deg": 90.0, "frequency_hz": 0.5},
        "parameters": {"vehicle.speed": 4.0},
    },
    "motorway": {
        "manoeuvre": {"kind": "weave", "amplitude_deg": 8.0, "frequency_hz": 0.8},
        "parameters": {"vehicle.speed": 36.0},
    },
    "let_go": {
        "manoeuvre": {"kind": "free_release", "angle_deg": 45.0},
    },
}
"""Name to the part of a scenario that differs. The first of equally good ones is taken."""


def scenario(name: str, node_set: str) -> dict[str, Any]:
    """Return a candidate as a whole scenario."""
    return {
        "schema": 1,
        "name": name,
        "node_set": node_set,
        "duration": DURATION_S,
        **CANDIDATES[name],
    }
