"""Open-centre valve and gear: figures 2.3, 4.3 and 4.5 to 4.7."""

from __future__ import annotations

import numpy as np

from steering_bringup.pages import Axes, Curve, Figure
from steering_core.parameters import ParameterSet, load_parameters
from steering_plant.linear.gear import linear_gear
from steering_studies.beyond import heavy_vehicle
from steering_studies.linear import open_centre_study
from steering_studies.linear.bode import Family
from steering_studies.linear.sections import COLOURS
from steering_studies.reproduce.bode import bode
from steering_studies.reproduce.row import Number, Row

BAR = 1e-5


def heavy_vehicle_boost_curve() -> Row:
    """Return fig 2.3, with the parameter set heavy_vehicle."""
    torque, boost = heavy_vehicle.boost_curve(load_parameters(heavy_vehicle.SET))
    size = np.abs(boost) * BAR
    reaches = float(np.interp(150.0, size[torque >= 0.0], torque[torque >= 0.0]))
    axes = Axes(
        "torsion bar torque [N m]",
        "assistance pressure [bar]",
        [Curve(torque, size, over_time=False)],
        y_range=(0.0, 155.0),
    )
    return Row(
        "2.3",
        "Typical boost curve of a heavy vehicle",
        [
            Number("assistance pressure at 10 N m", "bar", 150.0, float(size[-1]), "pressure"),
            Number("torque at 150 bar", "N m", 10.0, reaches, "torque"),
            Number(
                "assistance pressure at 5 N m",
                "bar",
                None,
                float(np.interp(5.0, torque, size)),
                "pressure",
            ),
        ],
        [Figure("Boost curve", [[axes]])],
        words="Flat on centre, steep when parking. The set's boost curve was chosen to end at this "
        "point; the source prints no other.",
    )


def static_characteristic() -> Row:
    """Return fig 4.3."""
    made = open_centre_study.static_characteristic(load_parameters())
    flow = made.load_flow / open_centre_study.LITRE_PER_MINUTE
    pressure = made.load_pressure * BAR
    curves = [
        Curve(
            np.abs(flow[side]),
            row[side],
            f"{torque:g} N m, {name} flow",
            colour,
            mode="lines+markers" if name == "positive" else "lines",
            dash="solid" if name == "positive" else "dash",
            over_time=False,
        )
        for torque, row, colour in zip(made.torque, pressure, COLOURS[1:], strict=True)
        for name, side in (("positive", flow >= 0.0), ("negative", flow <= 0.0))
    ]
    axes = Axes(
        "load flow [l/min]",
        "assistance pressure [bar]",
        curves,
        y_range=(-15.0, 285.0),
        limits=(0.0, 250.0),
    )
    at = {q: float(np.interp(q, flow, pressure[-1])) for q in (-5.0, 0.0, 5.0)}
    return Row(
        "4.3",
        "Static characteristic of the open-centre valve",
        [
            Number("at 4 N m, no load flow", "bar", 90.0, at[0.0], "pressure"),
            Number("at 4 N m, 5 l/min into the cylinder", "bar", None, at[5.0], "pressure"),
            Number("at 4 N m, 5 l/min out of the cylinder", "bar", None, at[-5.0], "pressure"),
        ],
        [Figure("Assistance pressure over load flow", [[axes]], height=380)],
        words="90 bar is fig 3.4's. The source's axis ends at 250 bar (dotted); ours reaches that "
        f"at 4 N m and {_flow_at(250.0, flow, pressure[-1]):.1f} l/min. It is the static map: the "
        "pump's relief valve, open at 120 bar, is left out as in the source.",
    )


def _flow_at(level: float, flow: np.ndarray, falling: np.ndarray) -> float:
    return float(np.interp(level, falling[::-1], flow[::-1]))


def pressure_response() -> Row:
    """Return fig 4.5."""
    made = open_centre_study.pressure_response(load_parameters())
    corner = made.corner()
    return Row(
        "4.5",
        "Open-centre valve, torque to load pressure",
        [
            Number("amplitude at low frequency, 0 N m", "dB", 100.0, made.decibel[0, 0],
                   "other", "at least"),
            Number("amplitude at low frequency, 4 N m", "dB", 140.0, made.decibel[-1, 0],
                   "other", "at most"),
            Number("45 deg behind, 0 N m", "Hz", None, float(corner[0])),
            Number("45 deg behind, 4 N m", "Hz", None, float(corner[-1])),
        ],
        [
            bode(made, (0.1, 100.0), (100.0, 140.0), (-100.0, 0.0),
                 "axis of 100 to 140 dB; fast at low torque, slow at high")
        ],
        words="100 and 140 dB are the ends of the source's axis. Fast at low torque and slow at "
        "high, as the source says.",
    )  # fmt: skip


def loop_gain() -> Row:
    """Return fig 4.6."""
    made = open_centre_study.loop_gain(load_parameters())
    found = made.margins()
    return Row(
        "4.6",
        "Open-centre steering, loop gain",
        [
            Number("phase margin, 0 N m", "deg", None, found[0].phase, "angle"),
            Number("phase margin, 4 N m", "deg", None, found[-1].phase, "angle"),
            Number("gain margin, 0 N m", "dB", None, _decibel(found[0].gain)),
            Number("gain margin, 4 N m", "dB", None, _decibel(found[-1].gain)),
        ],
        [
            bode(made, (0.1, 100.0), (-20.0, 20.0), (-200.0, 0.0),
                 "axes of -20 to 20 dB and -200 to 0 deg (dotted)")
        ],
        words="Gain rises and the margins fall with the torque, as in the source. Its axis ends "
        f"at 20 dB; ours starts at {made.decibel[-1, 0]:.0f} dB at 4 N m, so the source's family "
        "may end at a lower torque or lie against a stiffer load.",
    )  # fmt: skip


def closed_loop() -> Row:
    """Return fig 4.7."""
    parameters = load_parameters()
    made = open_centre_study.closed_loop(parameters)
    stiff = open_centre_study.closed_loop(parameters, 10.0 * linear_gear(parameters).stiffness)
    damped = open_centre_study.closed_loop(_damped(parameters, 30.0))
    return Row(
        "4.7",
        "Open-centre steering, closed loop",
        [
            Number("amplitude at low frequency, 0 N m", "dB", None, made.decibel[0, 0]),
            Number("largest amplitude, 0 N m", "dB", None, _peak(made, 0)),
            Number("largest amplitude, 4 N m", "dB", None, _peak(made, -1)),
            Number("phase at 20 Hz, 0 N m", "deg", None, float(made.at(20.0)[1][0]), "angle"),
        ],
        [
            bode(made, (0.1, 100.0), (-20.0, 0.0), (-20.0, 5.0),
                 "axes of -20 to 0 dB to 100 Hz and -20 to 5 deg below 20 Hz (dotted)",
                 phase_to=20.0)
        ],
        words="At low torque it is the source's. At high torque ours has a resonance near 80 Hz "
        "that the source's axis, ending at 0 dB, has no room for. Friction is off in a linear "
        f"model; ten times the load's stiffness still leaves {_peak(stiff, -1):.0f} dB, thirty "
        f"times the rack's damping {_peak(damped, -1):.0f} dB. The source prints neither value.",
    )  # fmt: skip


def _damped(parameters: ParameterSet, factor: float) -> ParameterSet:
    name = "mechanics.rack_damping"
    return parameters.with_values({name: factor * parameters[name]})


def _peak(family: Family, torque: int) -> float:
    return float(family.decibel[torque].max())


def _decibel(factor: float) -> float:
    return float(20.0 * np.log10(factor))


ROWS = (
    heavy_vehicle_boost_curve,
    static_characteristic,
    pressure_response,
    loop_gain,
    closed_loop,
)
