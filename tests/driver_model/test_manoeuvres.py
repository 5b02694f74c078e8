from dataclasses import asdict, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import TypeAdapter, ValidationError

from driver_model.manoeuvres import MANOEUVRES, ManoeuvreError, make_manoeuvre

TIMES = np.arange(20001) / 1000.0
SMOOTH = [kind for kind in MANOEUVRES if kind != "table"]
DEFAULTS = {kind: made() for kind, made in MANOEUVRES.items()}


def degrees(kind: str, times=TIMES, **values) -> np.ndarray:
    return np.degrees(make_manoeuvre(kind, **values).angle(times))


def speed(kind: str, times, **values) -> np.ndarray:
    """Return the speed [deg/s] by central differences."""
    h = 1e-6
    return (degrees(kind, times + h, **values) - degrees(kind, times - h, **values)) / (2.0 * h)


@pytest.mark.parametrize("kind", MANOEUVRES)
def test_registered_under_its_own_kind_with_a_description(kind):
    assert MANOEUVRES[kind].kind == kind
    assert (MANOEUVRES[kind].__doc__ or "").strip()


@pytest.mark.parametrize("kind", SMOOTH)
def test_starts_at_rest_and_moves_without_jumps(kind):
    angle = np.degrees(DEFAULTS[kind].angle(TIMES))
    assert angle[0] == 0.0
    assert abs(angle[1]) < 1e-3
    # A jump of the speed would be a large second difference at one tick.
    assert np.abs(np.diff(angle, 2)).max() < 0.01


@pytest.mark.parametrize("kind", MANOEUVRES)
def test_value_at_a_time_does_not_depend_on_the_other_times(kind):
    """Runs of different length follow the same reference, to the bit."""
    manoeuvre = DEFAULTS[kind]
    whole = manoeuvre.angle(TIMES)
    for count in (1, 2, 7, 1234):
        assert manoeuvre.angle(TIMES[:count]).tobytes() == whole[:count].tobytes()


def test_on_centre_reaches_the_amplitude_and_377_deg_per_second():
    angle = degrees("on_centre")
    assert np.abs(angle).max() == pytest.approx(30.0, abs=0.01)
    assert speed("on_centre", np.array([10.0]))[0] == pytest.approx(30.0 * 2.0 * np.pi * 2.0)
    assert 30.0 * 2.0 * np.pi * 2.0 == pytest.approx(377.0, abs=0.05)
    assert angle[10000] == pytest.approx(0.0, abs=1e-9)


def test_on_centre_at_2_12_hz_reaches_the_sources_400_deg_per_second():
    fast = speed("on_centre", np.linspace(8.0, 12.0, 4001), final_frequency_hz=2.12)
    assert np.abs(fast).max() == pytest.approx(400.0, abs=1.0)


@pytest.mark.parametrize("initial", [0.0, 0.1, 1.0])
def test_on_centre_speed_is_the_analytic_derivative(initial):
    t = np.linspace(0.1, 12.0, 200)
    inside = np.minimum(t, 10.0)
    frequency = initial + (2.0 - initial) * inside / 10.0
    cycles = initial * inside + (2.0 - initial) * inside**2 / 20.0 + 2.0 * (t - inside)
    expected = 30.0 * 2.0 * np.pi * frequency * np.cos(2.0 * np.pi * cycles)
    found = speed("on_centre", t, initial_frequency_hz=initial)
    assert found == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize("sweep", ["linear", "logarithmic"])
def test_chirp_frequency_rises_as_asked(sweep):
    """Instantaneous frequency from zero crossings, against the closed form."""
    values = {"initial_frequency_hz": 0.5, "final_frequency_hz": 8.0, "duration_s": 20.0}
    t = np.linspace(0.0, 24.0, 2_400_001)
    angle = degrees("chirp", t, sweep=sweep, **values)
    crossings = t[np.flatnonzero(np.diff(np.sign(angle[1:])))]
    found, middle = 0.5 / np.diff(crossings), 0.5 * (crossings[1:] + crossings[:-1])
    part = np.minimum(middle, 20.0) / 20.0
    expected = 0.5 + 7.5 * part if sweep == "linear" else 0.5 * 16.0**part
    assert found[5:] == pytest.approx(expected[5:], rel=0.01)
    assert found[-1] == pytest.approx(8.0, rel=1e-3)


def test_chirp_with_equal_ends_is_a_sine():
    t = np.linspace(2.0, 5.0, 100)
    for sweep in ("linear", "logarithmic"):
        values = {"initial_frequency_hz": 1.5, "final_frequency_hz": 1.5, "sweep": sweep}
        assert degrees("chirp", t, **values) == pytest.approx(10.0 * np.sin(3.0 * np.pi * t))


def test_step_is_a_quintic_between_its_ends():
    values = {"angle_deg": 45.0, "start_s": 1.0, "rise_s": 0.4}
    at = np.array([0.0, 1.0, 1.2, 1.4, 9.0])
    assert degrees("step", at, **values) == pytest.approx([0.0, 0.0, 22.5, 45.0, 45.0])
    u = np.linspace(0.01, 0.99, 50)
    expected = 45.0 / 0.4 * 30.0 * u**2 * (1.0 - u) ** 2
    assert speed("step", 1.0 + 0.4 * u, **values) == pytest.approx(expected, abs=1e-4)


def test_ramp_runs_at_its_speed_and_ends_at_its_angle():
    values = {"angle_deg": -60.0, "speed_deg_s": 30.0, "start_s": 0.5, "blend_s": 0.2}
    assert speed("ramp", np.array([0.6, 1.5, 2.4]), **values) == pytest.approx([-15.0, -30, -30])
    assert degrees("ramp", np.array([0.5, 2.7, 9.0]), **values) == pytest.approx([0, -60, -60])


def test_ramp_shorter_than_its_blend_still_arrives():
    values = {"angle_deg": 1.0, "speed_deg_s": 100.0, "blend_s": 0.5}
    assert degrees("ramp", np.array([5.0]), **values)[0] == pytest.approx(1.0)
    assert np.diff(degrees("ramp", **values)).min() > -1e-9


def test_weave_is_the_sine_after_its_entry():
    t = np.linspace(1.0, 10.0, 200)
    expected = 20.0 * 2.0 * np.pi * 0.2 * np.cos(2.0 * np.pi * 0.2 * t)
    assert speed("weave", t + 1e-5) == pytest.approx(expected, abs=1e-2)
    assert degrees("weave", t) == pytest.approx(20.0 * np.sin(2.0 * np.pi * 0.2 * t))


def test_hands_let_go_at_their_times():
    for kind, manoeuvre in DEFAULTS.items():
        released = manoeuvre.released(TIMES)
        assert released.dtype == np.bool_
        assert released.shape == TIMES.shape
        assert released.any() == (kind in ("free_release", "lane_change"))
    released = make_manoeuvre("free_release", release_s=3.0).released(TIMES)
    assert TIMES[released][0] == 3.0
    assert released[3000:].all()
    changing = make_manoeuvre("lane_change", start_s=1.0, change_s=1.5, hold_s=0.5)
    held = TIMES[~changing.released(TIMES)]
    assert (held[0], held[-1]) == (1.0, pytest.approx(2.999))


def test_a_lane_change_leaves_the_course_as_it_was():
    """Its angle is odd about its middle, so the yaw rate's integral is none."""
    angle = make_manoeuvre("lane_change", start_s=1.0, change_s=3.0).angle(TIMES)
    assert abs(np.sum(angle)) < 1e-9 * np.sum(np.abs(angle))
    assert np.max(np.abs(angle)) == pytest.approx(np.radians(12.0), rel=1e-3)


@pytest.mark.parametrize("kind", MANOEUVRES)
def test_travels_as_plain_values_and_through_pydantic(kind):
    manoeuvre = DEFAULTS[kind]
    assert make_manoeuvre(kind, **asdict(manoeuvre)) == manoeuvre
    adapter = TypeAdapter(MANOEUVRES[kind])
    assert adapter.validate_python(adapter.dump_python(manoeuvre)) == manoeuvre


def test_pydantic_refuses_what_the_manoeuvre_refuses():
    adapter = TypeAdapter(MANOEUVRES["weave"])
    with pytest.raises(ValidationError, match="frequency_hz must be from 0 to 100, got -1"):
        adapter.validate_python({"frequency_hz": -1.0})
    with pytest.raises(ValidationError, match="amplitude"):
        adapter.validate_python({"amplitude": 1.0})


WRONG = [
    ("on_center", {}, "unknown manoeuvre 'on_center'; did you mean 'on_centre'"),
    ("weave", {"frequenzy_hz": 1.0}, "unknown field 'frequenzy_hz'; did you mean 'frequency_hz'"),
    ("weave", {"amplitude_deg": float("nan")}, "weave: amplitude_deg must be finite, got nan"),
    ("weave", {"amplitude_deg": 5000}, "amplitude_deg must be from -1080 to 1080, got 5000"),
    ("weave", {"amplitude_deg": "ten"}, "amplitude_deg 'ten' is not a number"),
    ("weave", {"amplitude_deg": True}, "amplitude_deg 'True' is not a number"),
    ("weave", {"entry_s": 0.0}, "entry_s must be at least 0.001, got 0"),
    ("on_centre", {"duration_s": -1.0}, "duration_s must be at least 0.001, got -1"),
    ("on_centre", {"initial_frequency_hz": 3.0}, "below initial_frequency_hz 3"),
    ("chirp", {"initial_frequency_hz": 0.0}, "initial_frequency_hz must be from 0.001"),
    ("chirp", {"sweep": "cubic"}, "sweep is linear or logarithmic, got 'cubic'"),
    ("step", {"rise_s": 0.0}, "rise_s must be at least 0.001"),
    ("ramp", {"speed_deg_s": 0.0}, "speed_deg_s must be from 0.001"),
    ("free_release", {"release_s": 1.0}, "release_s 1 comes before the angle is reached"),
]


@pytest.mark.parametrize(("kind", "values", "message"), WRONG)
def test_wrong_values_are_named(kind, values, message):
    with pytest.raises(ManoeuvreError, match=message):
        make_manoeuvre(kind, **values)


amplitudes = st.floats(-500.0, 500.0)
frequencies = st.floats(0.01, 20.0)
durations = st.floats(0.01, 100.0)


def drawn(kind: str) -> st.SearchStrategy:
    """Draw a manoeuvre with any allowed values."""
    pair = st.tuples(frequencies, frequencies).map(sorted)
    if kind in ("on_centre", "chirp"):
        return st.builds(
            lambda a, f, d: make_manoeuvre(
                kind,
                amplitude_deg=a,
                initial_frequency_hz=f[0],
                final_frequency_hz=f[1],
                duration_s=d,
            ),
            amplitudes,
            pair,
            durations,
        )
    fields = {
        "step": {"angle_deg": amplitudes, "start_s": durations, "rise_s": durations},
        "ramp": {"angle_deg": amplitudes, "speed_deg_s": frequencies, "blend_s": durations},
        "weave": {"amplitude_deg": amplitudes, "frequency_hz": frequencies, "entry_s": durations},
        "free_release": {"angle_deg": amplitudes, "release_s": st.floats(1.5, 100.0)},
        "lane_change": {"angle_deg": amplitudes, "start_s": durations, "change_s": durations},
        "hold": {},
    }[kind]
    return st.builds(lambda v: make_manoeuvre(kind, **v), st.fixed_dictionaries(fields))


@settings(max_examples=120, deadline=None)
@given(st.sampled_from(SMOOTH).flatmap(drawn))
def test_any_manoeuvre_is_bounded_starts_at_zero_and_mirrors_exactly(manoeuvre):
    angle = manoeuvre.angle(TIMES[::10])
    assert angle[0] == 0.0
    if manoeuvre.kind == "hold":
        assert not angle.any()
        return
    name = "amplitude_deg" if hasattr(manoeuvre, "amplitude_deg") else "angle_deg"
    size = getattr(manoeuvre, name)
    assert np.abs(angle).max() <= np.radians(abs(size)) * (1.0 + 1e-9) + 1e-12
    mirrored = replace(manoeuvre, **{name: -size})
    assert (mirrored.angle(TIMES[::10]) == -angle).all()
