"""What rigs get wrong, done to a record: each kind on each channel that it happens to."""

# mypy: allow-untyped-defs

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy import signal

from steering_core.errors import BenchError
from steering_core.parameters import load_parameters
from steering_diagnosis.benchmark.bags import record_of
from steering_diagnosis.benchmark.cases import draw_case
from steering_diagnosis.benchmark.doors.channel_sets import RIG, measured
from steering_diagnosis.benchmark.truth.course import draw_course
from steering_diagnosis.benchmark.truth.disturbance import RESOLUTION, disturbance
from steering_diagnosis.benchmark.truth.effects import TRUE_EFFECTS
from steering_diagnosis.benchmark.truth.effects import changed as with_effects
from steering_diagnosis.benchmark.truth.run import run_closed_loop
from steering_diagnosis.benchmark.truth.singing import sings
from steering_diagnosis.benchmark.truth.specimen import draw_specimen
from steering_diagnosis.data.record import PERIOD_S, Record
from steering_diagnosis.data.units import FACTORS
from steering_diagnosis.steering.suspicions import suspicions

ANGLE, SPEED = "steering_wheel_angle", "steering_wheel_speed"
TORQUE, FORCE = "torsion_bar_torque", "rack_force"
POSITION, RACK_SPEED = "rack_position", "rack_speed"
LEFT, RIGHT, SUPPLY = PRESSURES = ("left_pressure", "right_pressure", "supply_pressure")
DEGREES, PSI = 180.0 / np.pi, FACTORS["Pa"]["psi"]
ATMOSPHERE = 1.01325e5
OWN_UNIT = {"rad": "deg", "rad/s": "deg/s", "Pa": "bar", "m": "mm", "m/s": "mm/s"}


@dataclass(frozen=True)
class Mistake:
    """done: the record with the mistake in it. channels, said: what has to be suspected of it."""

    channels: tuple[str, ...]
    done: Callable[[Record], Record]
    said: str

    def possible(self, record):
        """Return whether the record has the channels."""
        return set(self.channels) <= set(record.channels)

    def found(self, record):
        """Return whether all channels are suspected of the right mistake."""
        told = suspicions(self.done(record))
        about = [s for s in told if self.said in s.text]
        named = {c for s in about for c in s.channels}
        named |= {c for s in about if not s.channels for c in self.channels if c in s.text}
        return set(self.channels) <= named


def changed(record, **channels):
    """Return the record with some channels replaced."""
    return replace(record, channels={**record.channels, **channels})


def scaled(factor, said, *channels):
    """Channels are too large by a factor."""
    return Mistake(
        channels, lambda r: changed(r, **{c: factor * r[c] for c in channels if c in r}), said
    )


def shifted(offset, said, *channels, suspected=None):
    """Channels have another zero."""
    return Mistake(
        suspected or channels, lambda r: changed(r, **{c: r[c] + offset for c in channels}), said
    )


def magnitude(channel):
    """The sign of a channel is on another one."""
    return Mistake((channel,), lambda r: changed(r, **{channel: np.abs(r[channel])}), "magnitude")


def exchanged(first, second):
    """Two channels are in each other's place."""
    return Mistake(
        (first, second), lambda r: changed(r, **{first: r[second], second: r[first]}), "swapped"
    )


def copied(from_, to):
    """A channel holds another one's signal."""
    return Mistake((from_, to), lambda r: changed(r, **{to: r[from_].copy()}), "copies")


def late(seconds, *channels, suspected=None):
    """Channels are late; the logger began with a value that it held."""
    ticks = round(seconds / PERIOD_S)

    def done(r):
        return changed(r, **{c: np.r_[np.full(ticks, r[c][0]), r[c][:-ticks]] for c in channels})

    return Mistake(suspected or channels, done, "s late")


def coupled(seconds, channel):
    """A channel is AC-coupled with a time constant."""
    keep = seconds / (seconds + PERIOD_S)

    def done(r):
        swing = signal.lfilter([keep, -keep], [1.0, -keep], r[channel] - r[channel][0])
        return changed(r, **{channel: swing})

    return Mistake((channel,), done, "AC-coupled")


def wrapped(channel, period=None):
    """A channel is told within one period; None: six tenths of what it moves."""

    def done(r):
        turn = period or 0.6 * np.ptp(r[channel])
        return changed(r, **{channel: (r[channel] + turn / 2.0) % turn - turn / 2.0})

    return Mistake((channel,), done, "jumps")


def saturated(channel):
    """A channel ends at seven tenths of what it reaches."""

    def done(r):
        low, high = np.min(r[channel]), np.max(r[channel])
        middle, reach = 0.5 * (low + high), 0.35 * (high - low)
        return changed(r, **{channel: np.clip(r[channel], middle - reach, middle + reach)})

    return Mistake((channel,), done, "clipped")


def frozen(channel, seconds=1.2):
    """A channel holds its value for a while in the middle of the record."""

    def done(r):
        values, first = r[channel].copy(), len(r) // 2
        values[first : first + round(seconds / PERIOD_S)] = values[first]
        return changed(r, **{channel: values})

    return Mistake((channel,), done, "stuck")


def dead(channel):
    """A channel is zero."""
    return Mistake((channel,), lambda r: changed(r, **{channel: 0.0 * r[channel]}), "constant")


def lost(channel, number=-999.0):
    """A number stands for no measurement in a fiftieth of the samples."""

    def done(r):
        values = r[channel].copy()
        at = np.random.default_rng(3).uniform(size=len(values)) < 0.02
        values[at] = number * {"Pa": 1e5, "m": 1e-3, "rad": 1.0 / DEGREES}.get(unit, 1.0)
        return changed(r, **{channel: values})

    from steering_diagnosis.data.channels import MEASURED

    unit = MEASURED[channel].unit
    return Mistake((channel,), done, "no measurement")


KINDS = {
    "sign": [scaled(-1.0, "wrong sign", c) for c in (ANGLE, TORQUE, POSITION, FORCE)],
    "magnitude": [magnitude(c) for c in (ANGLE, TORQUE, POSITION, FORCE)],
    "degrees": [
        scaled(DEGREES, "in deg", ANGLE),
        scaled(1.0 / DEGREES, "in rad, taken for deg", ANGLE),
    ],
    "degrees_and_sign": [scaled(-DEGREES, "wrong sign", ANGLE)],
    "ten": [
        *(scaled(f, f"{1.0 / f:g}`", ANGLE) for f in (10.0, 0.1)),
        *(scaled(f, "taken for", c) for c in (POSITION, TORQUE, FORCE) for f in (10.0, 0.1)),
    ],
    "bar_mpa": [scaled(f, s, *PRESSURES) for f, s in ((10.0, "in bar"), (0.1, "in MPa"))],
    "one_bar_mpa": [scaled(10.0, "in bar", c) for c in PRESSURES],
    "thousand": [
        scaled(1e3, "in mm", POSITION),
        scaled(1e-3, "in kN", FORCE),
        scaled(1e3, "in mN m", TORQUE),
    ],
    "bar_pa": [scaled(1e-5, "in bar", *PRESSURES), scaled(1e-5, "in bar", LEFT, RIGHT)],
    "imperial": [
        scaled(1e5 / PSI, "in psi, taken for bar", *PRESSURES),
        scaled(1.0 / FACTORS["m"]["in"], "in in", POSITION),
    ],
    "kilopond": [
        scaled(1.0 / FACTORS["N"]["kp"], "kp", FORCE),
        scaled(1.0 / FACTORS["N"]["lbf"], "in lbf", FORCE),
    ],
    "speeds": [
        scaled(DEGREES, "in deg/s", SPEED),
        scaled(60.0 / 2.0 / np.pi, "in rpm", SPEED),
        scaled(3.6, "in km/h", RACK_SPEED),
        scaled(1e3, "in mm/s", RACK_SPEED),
        scaled(-1.0, "wrong sign", SPEED),
        scaled(-1.0, "wrong sign", RACK_SPEED),
    ],
    "swapped": [exchanged(LEFT, RIGHT), exchanged(LEFT, SUPPLY), exchanged(ANGLE, SPEED)],
    "copied": [copied(LEFT, RIGHT), copied(TORQUE, FORCE)],
    "late": [
        *(late(t, c) for t in (0.3, 0.1) for c in (ANGLE, POSITION, TORQUE, FORCE)),
        *(late(t, *PRESSURES, suspected=(LEFT, RIGHT)) for t in (0.3, 0.1)),
    ],
    "ac_coupled": [coupled(t, c) for t in (0.3, 1.0) for c in (ANGLE, POSITION, FORCE)],
    "ratio": [
        Mistake((ANGLE, POSITION), scaled(f, "", POSITION, RACK_SPEED).done, "another ratio")
        for f in (0.75, 1.3)
    ],
    "road_wheel": [scaled(1.0 / 16.0, "road wheel", ANGLE)],
    "reduction": [scaled(16.0, "reduction", TORQUE)],
    "absolute": [shifted(ATMOSPHERE, "absolute", *PRESSURES)],
    "zero": [
        shifted(0.5, "apart", ANGLE, suspected=(ANGLE, POSITION)),
        shifted(0.01, "apart", POSITION, suspected=(ANGLE, POSITION)),
    ],
    "wrapped": [wrapped(ANGLE), wrapped(POSITION)],
    "clipped": [saturated(c) for c in (ANGLE, TORQUE, LEFT, POSITION, FORCE)],
    "stuck": [frozen(c) for c in (ANGLE, TORQUE, LEFT, POSITION, FORCE)],
    "dead": [dead(c) for c in (ANGLE, TORQUE, LEFT, SUPPLY, POSITION, FORCE)],
    "lost": [lost(c) for c in (ANGLE, TORQUE, LEFT, POSITION)],
}
"""Kind to its mistakes, one for each channel or size."""


def clean_record(seed, seconds):
    """Return a record of the sealed benchmark's generator in which nothing is hidden."""
    drawn = draw_case("clean", seed, seconds=seconds)
    sealed = drawn.sealed
    return record_of(drawn.signals, drawn.nominal, sealed.valve_system, sealed.load, sealed.case)


def effect_records(seed, seconds):
    """Yield records in which one effect of the generator is as large as it gets, one for each."""
    nominal = load_parameters()
    for system, effects in TRUE_EFFECTS.items():
        for k, (name, effect) in enumerate(effects.items()):
            for sign in (1.0, -1.0) if effect.signed else (1.0,):
                random = np.random.default_rng([seed, k])
                record = _with_effect(random, nominal, system, name, sign * effect.largest, seconds)
                if record is not None:
                    yield record


def _with_effect(random, nominal, system, name, size, seconds):
    """Return a record with an effect, None where no manoeuvre that is tried bears it."""
    effect = TRUE_EFFECTS[system][name]
    for _ in range(6):
        load = str(random.choice(effect.loads)) if effect.loads else None
        course = draw_course(random, seconds, effect.kinds[0] if effect.kinds else None, load)
        truth = with_effects(draw_specimen(nominal, random), nominal, system, {name: size})
        noise = disturbance(random, len(course.angle))
        try:
            signals = run_closed_loop(
                truth, nominal, course, system == "closed_centre", noise, RESOLUTION
            )
        except BenchError:
            continue
        if not sings(signals):
            return record_of(signals, nominal, system, course.load, name)
    return None


def rig(record):
    """Return the record with a rig's seven channels alone."""
    return replace(record, channels=measured(record.channels, RIG), vehicle_load="")


def in_own_units(record):
    """Return the record as if a mapping had brought it in from the units that rigs have."""
    from steering_diagnosis.data.channels import MEASURED

    units = {n: OWN_UNIT[c.unit] for n, c in MEASURED.items() if c.unit in OWN_UNIT}
    return replace(record, units=units)
