"""Steering loop with pressure control valves and with servo valves: figures 6.11 to 7.7."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from steering_core.parameters import load_parameters
from steering_studies.linear import open_centre_study, steering_study
from steering_studies.linear.bode import TORQUES, Family
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
        _margins(made),
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
        [bode(made, HERTZ, (-60.0, 0.0), (-15.0, 0.0), "axes of -60 to 0 dB, -15 to 0 deg")],
        words="More lag than the open centre, most at low torque, as the source says. The "
        "source's phase axis ends at -15 deg, near 10 Hz in ours.",
    )


def servo_valves_loop_gain() -> Row:
    """Return fig 7.6."""
    made = steering_study.servo_loop_gain(servo_as_printed(load_parameters()))
    calm = [
        torque
        for torque, loop in zip(made.torque, made.response, strict=True)
        if closes_stably(loop)
    ]
    return Row(
        "7.6",
        "Steering loop with servo valves, loop gain",
        [
            *_margins(made, calm),
            Number("largest torque with a stable loop, of 0 to 4", "N m", None, max(calm)),
        ],
        [bode(made, HERTZ, (-100.0, 50.0), (-400.0, 0.0), "axes of -100 to 50 dB, -400 to 0 deg")],
        words="More phase lag than with the pressure control valves and, as the source is "
        "concerned about, less gain margin at high torque; here the loop is unstable beyond "
        f"{max(calm):g} N m. The source's rig is for low torque, and so is this controller.",
    )  # fmt: skip


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
              "axes of -60 to 0 dB, -30 to 0 deg, from 10 Hz")],
        words="Additional phase lag, more than with the pressure control valves, and a slight "
        "overshoot, as the source says; the curves of 3 and 4 N m belong to an unstable loop.",
    )  # fmt: skip


def closes_stably(loop: np.ndarray) -> bool:
    """Return whether a stable loop gain (n,), over rising frequency, is stable when closed.

    Nyquist: 1 + L, from the lowest frequency to where L has died out, does not turn round zero.
    """
    angle = np.unwrap(np.angle(1.0 + loop))
    return bool(abs(angle[-1] - angle[0]) < np.pi)


def _margins(made: Family, torques: Sequence[float] = TORQUES) -> list[Number]:
    """Return phase and gain margins at the lowest, the middle and the highest torque given."""
    found = dict(zip(made.torque, made.margins(), strict=True))
    chosen = sorted({torques[0], torques[len(torques) // 2], torques[-1]})
    phases = [Number(f"phase margin, {t:g} N m", "deg", None, found[t].phase) for t in chosen]
    gains = [
        Number(f"gain margin, {t:g} N m", "dB", None, float(20.0 * np.log10(found[t].gain)))
        for t in chosen
    ]
    return phases + gains


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
