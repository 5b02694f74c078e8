"""Steering loop with pressure control valves and with servo valves: figures 6.11 to 7.7."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pressure_control.servo_loop import servo_spectral_radius
from pressure_control.servo_point import servo_point
from steering_core.parameters import ParameterSet, load_parameters
from steering_plant.linear.gear import linear_gear
from steering_studies.linear import open_centre_study, steering_study
from steering_studies.linear.bode import Family
from steering_studies.linear.source_figures import servo_as_printed
from steering_studies.reproduce.bode import bode
from steering_studies.reproduce.row import Number, Row

HERTZ = (1.0, 490.0)
"""The source's axis ends at 1000 Hz; the controllers sample at 1 kHz, so ours at 490."""

AT_HERTZ = 20.0
"""Where the closed loops' phase lags are compared: the end of the source's phase axis."""


def control_valves_loop_gain() -> Row:
    """Return fig 6.11."""
    made = steering_study.closed_centre_loop_gain(load_parameters())
    return Row(
        "6.11",
        "Steering loop with pressure control valves, loop gain",
        [*_phase_margins(made, (0.0, 2.0, 4.0)), *_gain_margins(made, (0.0, 2.0, 4.0))],
        [bode(made, HERTZ, (-100.0, 50.0), (-400.0, 0.0), "axes of -100 to 50 dB, -400 to 0 deg")],
        words="As the source says: more phase lag than the open centre at low torque, less gain "
        "margin at high. Beyond 2 N m the margin rises again, because the wanted resonance falls "
        "with the pressure, the remedy that the source proposes.",
    )


def control_valves_closed_loop() -> Row:
    """Return fig 6.12."""
    parameters = load_parameters()
    made = steering_study.closed_centre_closed_loop(parameters)
    return Row(
        "6.12",
        "Steering loop with pressure control valves, closed loop",
        _lags(made, open_centre_study.closed_loop(parameters)),
        [
            bode(
                made,
                HERTZ,
                (-60.0, 0.0),
                (-15.0, 0.0),
                "axes of -60 to 0 dB, -15 to 0 deg to 20 Hz",
                phase_to=AT_HERTZ,
            )
        ],
        words="More lag than the open centre, most at low torque, as the source says. The "
        "source's phase axis ends at -15 deg, near 10 Hz in ours.",
    )


def servo_valves_loop_gain() -> Row:
    """Return fig 7.6."""
    parameters = servo_as_printed(load_parameters())
    made, stable = steering_study.servo_loop_gain(parameters), stable_up_to(parameters)
    return Row(
        "7.6",
        "Steering loop with servo valves, loop gain",
        [
            *_phase_margins(made, (0.0, 2.0)),
            *_gain_margins(made, (0.0, 2.0, 3.0)),
            Number("largest torque with a stable loop", "N m", None, stable, "torque"),
        ],
        [bode(made, HERTZ, (-100.0, 50.0), (-400.0, 0.0), "axes of -100 to 50 dB, -400 to 0 deg")],
        words="More phase lag than with the pressure control valves and, as the source is "
        "concerned about, less gain margin at high torque; here the loop is unstable beyond "
        f"{stable:.1f} N m. The source's rig is for low torque, and so is this controller.",
    )


def servo_valves_closed_loop() -> Row:
    """Return fig 7.7."""
    parameters = load_parameters()
    made = steering_study.servo_closed_loop(servo_as_printed(parameters))
    over = [float(made.decibel[k].max()) for k in (0, 2)]
    return Row(
        "7.7",
        "Steering loop with servo valves, closed loop",
        [
            *_lags(made, open_centre_study.closed_loop(parameters)),
            Number("overshoot of the amplitude, 0 N m", "dB", None, over[0]),
            Number("overshoot of the amplitude, 2 N m", "dB", None, over[1]),
        ],
        [bode(made, (10.0, 490.0), (-60.0, 0.0), (-30.0, 0.0),
              "axes of -60 to 0 dB, -30 to 0 deg, from 10 Hz", phase_to=AT_HERTZ)],
        words="Additional phase lag, more than with the pressure control valves, and a slight "
        "overshoot, as the source says; at 4 N m the loop is unstable.",
    )  # fmt: skip


def stable_up_to(parameters: ParameterSet) -> float:
    """Return the largest torque [N m], in tenths up to 4, to which the sampled loop is stable."""
    gain, stiffness = (
        parameters["servo_valve.controller_gain"],
        linear_gear(parameters).stiffness,
    )
    last = float("nan")
    for torque in np.linspace(0.0, 4.0, 41):
        point = servo_point(parameters, float(torque), 0.0, stiffness=stiffness)
        if servo_spectral_radius(point, gain) >= 1.0:
            return last
        last = float(torque)
    return last


def _phase_margins(made: Family, torques: Sequence[float]) -> list[Number]:
    found = dict(zip(made.torque, made.margins(), strict=True))
    return [Number(f"phase margin, {t:g} N m", "deg", None, found[t].phase) for t in torques]


def _gain_margins(made: Family, torques: Sequence[float]) -> list[Number]:
    found = dict(zip(made.torque, made.margins(), strict=True))
    return [
        Number(f"gain margin, {t:g} N m", "dB", None, float(20.0 * np.log10(found[t].gain)))
        for t in torques
    ]


def _lags(made: Family, original: Family) -> list[Number]:
    """Return the closed loop's lags beside the open centre's [deg], at low and higher torque."""
    ours, theirs = made.at(AT_HERTZ)[1], original.at(AT_HERTZ)[1]
    return [
        Number(f"lag at {AT_HERTZ:g} Hz, {made.torque[k]:g} N m, {name}", "deg", None, -float(x[k]))
        for k in (0, 2)
        for name, x in (("closed centre", ours), ("open centre", theirs))
    ]


ROWS = (
    control_valves_loop_gain,
    control_valves_closed_loop,
    servo_valves_loop_gain,
    servo_valves_closed_loop,
)
