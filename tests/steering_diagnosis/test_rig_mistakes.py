"""What rigs get wrong is suspected with evidence on a rig's seven channels, and nothing else is."""

# mypy: allow-untyped-defs

from dataclasses import replace
from functools import cache
from itertools import cycle

import numpy as np
import pytest
from bench_records import NOISE, bench_record
from rig_mistakes import (
    GRAVITY,
    POUND,
    PRESSURES,
    copied,
    coupled,
    exchanged,
    held,
    late,
    magnitude,
    quantised,
    rig,
    saturated,
    scaled,
    shifted,
    wrapped,
)

from steering_core.parameters import load_parameters
from steering_diagnosis.benchmark.bags import record_of
from steering_diagnosis.benchmark.cases import TRUE_EFFECTS, _record
from steering_diagnosis.benchmark.truth.course import draw_course
from steering_diagnosis.benchmark.truth.effects import changed as with_effects
from steering_diagnosis.benchmark.truth.specimen import draw_specimen
from steering_diagnosis.steering.mistakes import factors
from steering_diagnosis.steering.suspicions import suspicions, without

ANGLE, POSITION = "steering_wheel_angle", "rack_position"
TORQUE, FORCE = "torsion_bar_torque", "rack_force"
LEFT, RIGHT, SUPPLY = PRESSURES
CHAMBERS = {LEFT, RIGHT}
DEGREES = 180.0 / np.pi

RECORDS = (
    ("open_centre", "on_centre"),
    ("closed_centre", "on_centre"),
    ("open_centre", "weave"),
    ("closed_centre", "dry_park"),
)


@cache
def made(system, scenario):
    return rig(bench_record(system, scenario=scenario, duration=8.0, noise=NOISE))


LEFT_OUT = {
    "angle in degrees": (scaled(DEGREES, ANGLE), {ANGLE}, "degrees for radians"),
    "angle in radians, degrees said": (
        scaled(1.0 / DEGREES, ANGLE),
        {ANGLE},
        "radians for degrees",
    ),
    "angle in tenths of degrees": (scaled(10.0, ANGLE), {ANGLE}, "0.1 degrees for degrees"),
    "angle in degrees, tenths said": (scaled(0.1, ANGLE), {ANGLE}, "degrees for 0.1 degrees"),
    "angle at the road wheel": (scaled(1.0 / 16.0, ANGLE), {ANGLE}, "road wheel"),
    "angle of the wrong sign": (scaled(-1.0, ANGLE), {ANGLE}, "wrong sign"),
    "angle without its sign": (magnitude(ANGLE), {ANGLE}, "magnitude without its sign"),
    "torque without its sign": (magnitude(TORQUE), {TORQUE}, "magnitude without its sign"),
    "position without its sign": (magnitude(POSITION), {POSITION}, "magnitude without its sign"),
    "force without its sign": (magnitude(FORCE), {FORCE}, "magnitude without its sign"),
    "position in mm": (scaled(1e3, POSITION), {POSITION}, "mm for m"),
    "position in cm, mm said": (scaled(0.1, POSITION), {POSITION}, "cm for mm"),
    "position in inches": (scaled(1.0 / 0.0254, POSITION), {POSITION}, "in for m"),
    "position of the wrong sign": (scaled(-1.0, POSITION), {POSITION}, "wrong sign"),
    "force in kgf": (scaled(1.0 / GRAVITY, FORCE), {FORCE}, "kgf for N"),
    "force in lbf": (scaled(1.0 / POUND, FORCE), {FORCE}, "lbf for N"),
    "force in kN": (scaled(1e-3, FORCE), {FORCE}, "kN for N"),
    "force of the wrong sign": (scaled(-1.0, FORCE), {FORCE}, "wrong sign"),
    "torque in N mm": (scaled(1e3, TORQUE), {TORQUE}, "mN m for N m"),
    "torque behind a reduction": (scaled(16.0, TORQUE), {TORQUE}, "behind a reduction"),
    "torque of the wrong sign": (scaled(-1.0, TORQUE), {TORQUE}, "wrong sign"),
    "pressures in MPa, bar said": (scaled(0.1, *PRESSURES), {*PRESSURES}, "MPa for bar"),
    "pressures in bar, MPa said": (scaled(10.0, *PRESSURES), {*PRESSURES}, "bar for MPa"),
    "pressures in psi, bar said": (scaled(14.5038, *PRESSURES), {*PRESSURES}, "psi for bar"),
    "pressures in bar": (scaled(1e-5, *PRESSURES), {*PRESSURES}, "bar for Pa"),
    "chambers in bar, MPa said": (scaled(10.0, LEFT, RIGHT), CHAMBERS, "bar for MPa"),
    "one chamber in bar, MPa said": (scaled(10.0, LEFT), {LEFT}, "bar for MPa"),
    "supply in bar, MPa said": (scaled(10.0, SUPPLY), {SUPPLY}, "bar for MPa"),
    "chambers swapped": (exchanged(LEFT, RIGHT), CHAMBERS, "swapped"),
    "a chamber twice": (copied(LEFT, RIGHT), CHAMBERS, "copies"),
    "angle late": (late(0.3, ANGLE), {ANGLE, POSITION}, "0.3"),
    "force late": (late(0.5, FORCE), {FORCE}, "0.5"),
    "force AC-coupled": (coupled(1.0, FORCE), {FORCE}, "AC-coupled"),
    "position AC-coupled": (coupled(0.3, POSITION), {POSITION}, "AC-coupled"),
    "angle wrapped at half a turn": (
        wrapped(np.pi, ANGLE),
        {ANGLE},
        "wrapped at half a turn",
    ),
    "a counter that overflows": (wrapped(4.1e-3, POSITION), {POSITION}, "counter that overflows"),
    "angle never zeroed": (shifted(0.5, ANGLE), {ANGLE, POSITION}, "never zeroed"),
    "position never zeroed": (shifted(0.01, POSITION), {ANGLE, POSITION}, "never zeroed"),
}
"""Mistake, channels that are left out at least, and what is said of them."""


@pytest.mark.parametrize(
    ("kind", "record"), list(zip(LEFT_OUT, cycle(RECORDS), strict=False)), ids=lambda x: str(x)
)
def test_a_mistake_is_suspected_and_its_channel_left_out(kind, record):
    mistake, channels, said = LEFT_OUT[kind]
    wrong = mistake(made(*record))
    found = suspicions(wrong)
    assert channels <= {c for s in found for c in s.channels}
    assert any(said in s.text for s in found if channels & set(s.channels)), [s.text for s in found]
    assert not channels & set(without(wrong, found).channels)


TOLD = {
    "angle in whole 5 degrees": (quantised(np.radians(5.0), ANGLE), ANGLE, "takes only"),
    "torque that ends": (saturated(0.7, TORQUE), TORQUE, "clipped"),
    "pressure that ends": (saturated(0.7, RIGHT), RIGHT, "clipped"),
    "angle stuck": (held(2.0, 3.2, ANGLE), ANGLE, "stuck"),
    "position stuck": (held(2.0, 3.2, POSITION), POSITION, "stuck"),
    "torque stuck": (held(2.0, 3.2, TORQUE), TORQUE, "stuck"),
    "pressure stuck": (held(2.0, 3.2, LEFT), LEFT, "stuck"),
}


@pytest.mark.parametrize(
    ("kind", "record"), list(zip(TOLD, cycle(RECORDS[:2]), strict=False)), ids=lambda x: str(x)
)
def test_what_spoils_samples_is_told_and_costs_no_channel(kind, record):
    mistake, channel, said = TOLD[kind]
    wrong = mistake(made(*record))
    found = suspicions(wrong)
    assert [s.channels for s in found] == [()]
    assert channel in found[0].text
    assert said in found[0].text
    kept = without(wrong, found)
    assert channel in kept
    assert (kept.excluded is None) == ("coarse" in found[0].text)


@pytest.mark.parametrize("record", RECORDS, ids=lambda x: str(x))
def test_a_rigs_good_record_is_not_suspected(record):
    assert suspicions(made(*record)) == []


@pytest.mark.parametrize(
    ("system", "effect", "kind"),
    [
        ("open_centre", "rack_friction_level", "chirp"),
        ("open_centre", "torque_sensor_offset", "steps"),
        ("closed_centre", "rack_force_sensor_gain", "sweep"),
        ("closed_centre", "pressure_sensor_offset_right", "large"),
    ],
)
def test_a_large_effect_of_the_benchmarks_generator_is_no_mistake(system, effect, kind):
    random, nominal = np.random.default_rng(5), load_parameters()
    course = draw_course(random, 10.0, kind, None)
    size = TRUE_EFFECTS[system][effect].largest
    truth = with_effects(draw_specimen(nominal, random), nominal, system, {effect: size})
    record = record_of(_record(random, truth, nominal, course, system), nominal, system, "", effect)
    assert suspicions(record) == []
    assert suspicions(rig(record)) == []


def test_factors_are_those_of_units_in_each_others_place():
    by_text = {text: factor for factor, text in factors("Pa")}
    assert any("MPa for bar" in text and f == pytest.approx(0.1) for text, f in by_text.items())
    assert all(abs(np.log(f)) > np.log(2.0) for f in by_text.values())
    assert {round(f, 4) for f, text in factors("rad") if text.startswith("degrees for")} == {
        57.2958
    }


def test_both_of_two_channels_are_suspected_where_nothing_tells_them_apart():
    plain = made("open_centre", "on_centre")
    two = replace(plain, channels={n: v for n, v in plain.channels.items() if n != TORQUE})
    found = suspicions(scaled(-1.0, ANGLE)(two))
    assert {c for s in found for c in s.channels} == {ANGLE, POSITION}
