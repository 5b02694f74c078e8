"""Rig tests and validation: figures 3.4 to 3.11 and 4.8 to 4.12."""

from __future__ import annotations

import numpy as np

from steering_core.parameters import load_parameters
from steering_studies.identification.column import column_friction, inertia, stiffness
from steering_studies.identification.opening_areas import opening_areas
from steering_studies.identification.rack_friction import loop_friction, rack_friction
from steering_studies.pages import rig_tests as drawn
from steering_studies.pages.validation import channel_figure
from steering_studies.reproduce.row import Number, Row
from steering_studies.rig_tests.simulate import simulate
from steering_studies.validation import validate

BAR = 1e-5


def boost_curve() -> Row:
    """Return figs 3.4 and 3.5."""
    curve = opening_areas(simulate("boost_curve")["boost_curve"], load_parameters())
    pressure = np.interp([2.0, 4.0], curve.torque, curve.load_pressure) * BAR
    areas = [float(np.interp(t, curve.torque, curve.area_1)) * 1e6 for t in (-4.0, 0.0, 4.0)]
    return Row(
        "3.4, 3.5",
        "Boost curve and opening areas",
        [
            Number("assistance pressure at 4 N m", "bar", 90.0, float(pressure[1]), "pressure"),
            Number("assistance pressure at 2 N m", "bar", 12.0, float(pressure[0]), "pressure"),
            Number("smallest opening, at -4 N m", "mm2", 0.5, areas[0], "other", "at least"),
            Number("opening at centre", "mm2", None, areas[1]),
            Number("largest opening, at 4 N m", "mm2", 3.5, areas[2]),
        ],
        drawn.boost_figures(curve),
        words="0.5 and 3.5 mm2 are the ends of the source's axis.",
    )


def friction_of_the_rack() -> Row:
    """Return fig 3.6."""
    runs, nominal = simulate("rack_friction"), load_parameters()
    found = rack_friction(runs.values(), nominal)
    heights = [loop_friction(channels, nominal) for channels in runs.values()]
    level = found["mechanics.rack_friction"].value
    slope = found["mechanics.rack_friction_pressure_slope"].value
    return Row(
        "3.6",
        "Rack friction at six pressures",
        [
            Number("level", "N", nominal["mechanics.rack_friction"], level, "input"),
            Number(
                "slope on the sum of pressures",
                "N/bar",
                nominal["mechanics.rack_friction_pressure_slope"] * 1e5,
                slope * 1e5,
                "input",
            ),
            Number("loop at 5 bar", "N", None, heights[0], "force"),
            Number("loop at 80 bar", "N", None, heights[-1], "force"),
        ],
        [drawn.friction_figure(runs)],
        words="Loops widen linearly with the pressure, within the source's axis of +-800 N; level "
        "and slope are the data sheet's, since the source prints neither.",
    )


def friction_of_the_column() -> Row:
    """Return fig 3.7."""
    channels = simulate("column_friction")["column_friction"]
    found = column_friction(channels, load_parameters())["mechanics.column_friction"]
    return Row(
        "3.7",
        "Column friction",
        [Number("amplitude of the loop", "N m", 0.3, found.value, "torque")],
        [drawn.column_friction_figure(channels)],
    )


def stiffness_of_the_column() -> Row:
    """Return fig 3.8."""
    channels = simulate("stiffness")["stiffness"]
    found = stiffness(channels, load_parameters())["mechanics.torsion_bar_stiffness"]
    slope = float(np.radians(found.value))
    return Row(
        "3.8",
        "Stiffness of column and torsion bar",
        [Number("stiffness", "N m/deg", 1.06, slope, "input")],
        [drawn.stiffness_figure(channels)],
    )


def free_oscillation() -> Row:
    """Return fig 3.9."""
    nominal = load_parameters()
    known = column_friction(simulate("column_friction")["column_friction"], nominal)
    channels = simulate("inertia")["inertia"]
    found = inertia(channels, nominal, known)
    J = found["mechanics.steering_wheel_inertia"].value
    frequency = float(np.sqrt(nominal["mechanics.torsion_bar_stiffness"] / J) / (2.0 * np.pi))
    damping = found["mechanics.steering_wheel_damping"].value
    return Row(
        "3.9",
        "Free oscillation of the steering wheel",
        [
            Number("frequency by 3.1", "Hz", 5.15, frequency, "frequency"),
            Number("inertia", "kg m2", 0.058, J, "input"),
            Number("damping", "N m s/rad", 0.06, damping, "other"),
        ],
        [drawn.inertia_figure(channels)],
    )


def system_test() -> Row:
    """Return figs 3.10 and 3.11."""
    channels = simulate("system")["system"]
    return Row(
        "3.10, 3.11",
        "System test at 70 km/h",
        [
            Number(
                "steering wheel angle", "deg", 30.0, _peak(channels, "angle", 57.29578), "angle"
            ),
            Number("steering wheel speed", "deg/s", 400.0, _peak(channels, "speed", 57.29578)),
            Number(
                "torsion bar torque",
                "N m",
                3.0,
                float(np.max(np.abs(channels["torsion_bar_torque"]))),
                "torque",
                "at most",
            ),
            Number(
                "pump pressure",
                "bar",
                40.0,
                float(channels["supply_pressure"].max()) * BAR,
                "pressure",
            ),
        ],
        [drawn.system_figure(channels)],
        because="the source's driver turned by hand; the pump pressure follows the torque, and the "
        "torque the chosen tyres",
    )


def _peak(channels: dict[str, np.ndarray], what: str, scale: float) -> float:
    return float(np.max(np.abs(channels[f"steering_wheel_{what}"]))) * scale


def validation() -> Row:
    """Return figs 4.8 to 4.12."""
    made = validate(simulate("system")["system"], load_parameters())
    error = np.degrees(made.merits["steering_wheel_angle"].peak)
    return Row(
        "4.8 to 4.12",
        "Validation: driver and model against the system test",
        [Number("largest error of the steering wheel angle", "deg", None, float(error), "angle")]
        + [
            Number(f"fit of {name.replace('_', ' ')}", "%", None, 100.0 * m.fit)
            for name, m in made.merits.items()
        ],
        [channel_figure(made, name) for name in made.merits],
        words="The source says 'very good' and 'sufficiently well'. Here the measurement comes "
        "from the same plant, so what differs is the driver model alone.",
    )


ROWS = (
    boost_curve,
    friction_of_the_rack,
    friction_of_the_column,
    stiffness_of_the_column,
    free_oscillation,
    system_test,
    validation,
)
