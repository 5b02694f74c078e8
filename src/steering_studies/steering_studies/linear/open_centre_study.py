"""The open-centre valve and steering system, linear (figs 4.3, 4.5, 4.6, 4.7)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from steering_core.parameters import ParameterSet
from steering_plant.boost_curve import FORMULA, boost_record, static_pressures
from steering_plant.linear.gear import assistance, linear_gear
from steering_plant.linear.open_centre import open_centre_point, source_model, whole_model
from steering_studies.linear.bode import TORQUES, Family, family, grid

LITRE_PER_MINUTE = 1e-3 / 60.0


@dataclass(frozen=True)
class StaticCurves:
    """Load pressure [Pa] (m, n) over load flow [m3/s] (n,), one row a torque [N m] (m,)."""

    torque: np.ndarray
    load_flow: np.ndarray
    load_pressure: np.ndarray


def static_characteristic(parameters: ParameterSet, points: int = 51) -> StaticCurves:
    """Return fig 4.3: the static map from -5 to +5 l/min, 1 to 4 N m."""
    p = boost_record(parameters)[0]
    flow = np.linspace(-5.0, 5.0, points) * LITRE_PER_MINUTE
    torques = np.array(TORQUES[1:])
    rows = [[np.subtract(*static_pressures(p, FORMULA, t, q)) for q in flow] for t in torques]
    return StaticCurves(torques, flow, np.array(rows))


def pressure_response(parameters: ParameterSet, whole: bool = True) -> Family:
    """Return fig 4.5: torsion-bar torque to load pressure [Pa/(N m)] at zero load flow.

    whole: all three volumes; otherwise the source's (4.15).
    """
    model = whole_model if whole else source_model

    def response(torque: float, omega: np.ndarray) -> np.ndarray:
        built = model(open_centre_point(parameters, torque))
        return built.channel("load_pressure", "torque", omega)

    return family("4.5", "torque to load pressure", response)


def loop_gain(parameters: ParameterSet, stiffness: float | None = None) -> Family:
    """Return fig 4.6: steering wheel angle to rack displacement, loop open; stiffness [N/m]."""
    gear = linear_gear(parameters, stiffness)

    def response(torque: float, omega: np.ndarray) -> np.ndarray:
        model = whole_model(open_centre_point(parameters, torque))
        return gear.loop_gain(assistance(model, omega))

    return family("4.6", "open-centre: loop gain", response, is_loop=True)


def closed_loop(parameters: ParameterSet, stiffness: float | None = None) -> Family:
    """Return fig 4.7: steering wheel angle to R_T x, loop closed (4.19); stiffness [N/m]."""
    opened = loop_gain(parameters, stiffness)
    response = opened.response / (1.0 + opened.response)
    return Family("4.7", "open-centre: closed loop", opened.frequency, opened.torque, response)


@dataclass(frozen=True)
class Parting:
    """Where the source's (4.15) parts most from the whole linearisation up to 100 Hz.

    torque [N m] (m,); decibel and degrees (m,): largest differences, with their frequencies [Hz];
    leaves [Hz]: the lowest frequency with more than 1 dB or 5 degrees, nan for none.
    """

    torque: np.ndarray
    decibel: np.ndarray
    decibel_frequency: np.ndarray
    degrees: np.ndarray
    degrees_frequency: np.ndarray
    leaves: np.ndarray


def parting(parameters: ParameterSet) -> Parting:
    """Compare the two linear forms of torque to load pressure."""
    whole, source = pressure_response(parameters), pressure_response(parameters, whole=False)
    hertz = grid()[grid() <= 100.0]
    ratio = (source.response / whole.response)[:, : len(hertz)]
    decibel, degrees = 20.0 * np.log10(np.abs(ratio)), np.degrees(np.angle(ratio))
    rows = np.arange(len(ratio))
    most, turned = np.abs(decibel).argmax(axis=1), np.abs(degrees).argmax(axis=1)
    beyond = (np.abs(decibel) > 1.0) | (np.abs(degrees) > 5.0)
    leaves = np.where(beyond.any(axis=1), hertz[beyond.argmax(axis=1)], np.nan)
    return Parting(
        whole.torque,
        decibel[rows, most],
        hertz[most],
        degrees[rows, turned],
        hertz[turned],
        leaves,
    )
