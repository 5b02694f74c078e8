"""The right pressure sensor shows a pressure where there is none."""

from __future__ import annotations

from steering_plant.effects.base import Effect, Parameter, added_to

EFFECT = Effect(
    name="pressure_sensor_offset_right",
    summary="the right pressure sensor shows a pressure where there is none",
    sees="right pressure at rest differs from the other; closed centre: assistance to one side",
    equation="p_measured = p + offset",
    source="E. O. Doebelin, Measurement Systems (2004), chapter 3: bias",
    balance="pressure sensors",
    excitation="both pressures through their lowest values",
    separating="supply off, both chambers vented to the tank",
    parameters={"offset": Parameter("measured minus true pressure", "Pa", 0, -2e6, 2e6, 1e5)},
    sets={"offset": added_to("right_pressure_sensor.offset")},
)
