"""The end of the stroke, where one chamber is small: what the gain has to be there."""

from __future__ import annotations

from typing import Any

import numpy as np

from steering_core.parameters import load_parameters
from steering_studies.beyond.drawing import over_time
from steering_studies.beyond.study import Answer, Study, Table, simulate

ANGLES_DEG = (0.0, 250.0, 450.0, 530.0)
RESONANCES = (200.0, 400.0, 700.0, 1200.0)
"""Of the controller [rad/s]; the last is the data sheet's."""
SETTLED_S = 3.5


def _held(angle_deg: float) -> dict[str, Any]:
    """Return a scenario that holds the wheel at an angle and nudges it by 2 degrees."""
    times = np.linspace(0.0, 7.0, 1401)
    share = np.clip(times / 2.5, 0.0, 1.0)
    angle = angle_deg * share * share * (3.0 - 2.0 * share)
    nudge = 2.0 * np.sin(2.0 * np.pi * 1.5 * (times - SETTLED_S)) * (times > SETTLED_S)
    return {
        "duration": 7.0,
        "node_set": "closed_centre",
        "manoeuvre": {
            "kind": "table",
            "time_s": tuple(times.tolist()),
            "steering_wheel_angle_deg": tuple((angle + nudge).tolist()),
        },
        "load": {"kind": "none"},
    }


def ripple(angle_deg: float, resonance: float, parameters: dict[str, float]) -> tuple[float, Any]:
    """Return the load pressure's ripple above 20 Hz [Pa, rms] while nudged, and the trace."""
    from scipy.signal import butter, sosfiltfilt

    trace = simulate(_held(angle_deg), {"valve_controller.resonance": resonance, **parameters})
    load = trace.pressure[:, 1] - trace.pressure[:, 0]
    fast = sosfiltfilt(butter(4, 20.0, "highpass", fs=1000.0, output="sos"), load)
    return float(np.std(fast[round(SETTLED_S * 1e3) : -200])), load


def answer(parameters: dict[str, float]) -> Answer:
    """Nudge the wheel at several places of the stroke with several gains."""
    sheet = load_parameters().with_values(parameters)
    ratio, area = sheet["mechanics.gear_ratio"], sheet["mechanics.piston_area"]
    volume, beta = sheet["open_centre.chamber_volume"], sheet["oil.bulk_modulus"]
    rows, numbers, curves = [], {}, {}
    for angle in ANGLES_DEG:
        x = np.radians(angle) / ratio
        small, large = volume - area * x, volume + area * x
        spring = beta * area**2 * (1.0 / small + 1.0 / large)
        resonance = float(np.sqrt(spring / sheet["mechanics.rack_mass"]))
        found = {gain: ripple(angle, gain, parameters) for gain in RESONANCES}
        numbers[f"{angle:.0f} deg"] = {
            "small_chamber_m3": small,
            "oil_spring_rad_s": resonance,
            "ripple_Pa": {f"{gain:.0f}": value for gain, (value, _) in found.items()},
        }
        rows.append(
            (
                f"{angle:.0f}",
                f"{small * 1e6:.1f}",
                f"{resonance:.0f}",
                *(f"{value * 1e-5:.3f}" for value, _ in found.values()),
            )
        )
        load = found[RESONANCES[-1]][1]
        curves[f"{angle:.0f} deg"] = (np.arange(len(load)) * 1e-3, load * 1e-5)
    far = numbers[f"{ANGLES_DEG[-1]:.0f} deg"]
    return Answer(
        f"At {ANGLES_DEG[-1]:.0f} deg the small chamber holds {far['small_chamber_m3'] * 1e6:.0f} "
        f"cm3 and the oil spring's resonance rises to {far['oil_spring_rad_s']:.0f} rad/s; the "
        f"ripple there is {far['ripple_Pa']['1200'] * 1e-5:.1f} bar with the data sheet's 1200 "
        f"rad/s, {far['ripple_Pa']['400'] * 1e-5:.2f} bar with 400 rad/s.",
        numbers,
        [
            over_time(
                "Load pressure at 1200 rad/s, nudged from 3.5 s on",
                {"load pressure [bar]": curves},
                320,
            )
        ],
        [
            Table(
                (
                    "Wheel angle [deg]",
                    "Small chamber [cm3]",
                    "Oil spring [rad/s]",
                    *(f"Ripple at {gain:.0f} rad/s [bar]" for gain in RESONANCES),
                ),
                rows,
            )
        ],
        (
            (
                "The wheel is turned to the angle within 2.5 s, then nudged by 2 deg at 1.5 Hz. "
                "Ripple is the load pressure above 20 Hz, rms."
            ),
        ),
    )


STUDY = Study(
    "end_of_stroke",
    "Which gain is calm at the end of the stroke, where a chamber is small?",
    answer,
)
