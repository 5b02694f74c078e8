"""The replay: the steering gear bound to a record, as the engine takes it (engine.model.Replay)."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from uuid import uuid4

import numpy as np

from steering_core.errors import BenchError
from steering_diagnosis.data.record import PERIOD_S, Record
from steering_diagnosis.engine.failures import NUMERICAL, reason
from steering_diagnosis.engine.model import Effects, Hypothesis, Undecidable
from steering_diagnosis.steering import ripple, suspects
from steering_diagnosis.steering.drive import RUN_UP, Drive
from steering_diagnosis.steering.full_model import full_model
from steering_diagnosis.steering.outputs import Predicted, Run, acting, outputs_of
from steering_diagnosis.steering.simulation import Simulation
from steering_diagnosis.steering.smoothing import bridged, noise_like, spectrum

UNSETTLED = 300
"""Samples at the beginning that are not judged: hidden states are only guessed there."""

FRICTIONLESS, LONGEST = 6.0, 0.25
"""Friction displacements that the rack moves until its friction is what the motion made it; and the
share of a record that is given up for it at most."""

CUT_OFF = 100
"""Samples at the end, and before a gap, that are not judged: smooth inputs have no future there."""

BRIDGED = 4
"""Ticks without an input up to which a straight line is as good as a sample: at 50 rad/s^2 a wheel
leaves it by 1e-4 rad, half of its sensor's noise."""

SHAKING = (
    "steering_wheel_angle",
    "steering_wheel_speed",
    "rack_position",
    "rack_speed",
    "rack_force",
    "left_pressure",
    "right_pressure",
)
"""Channels whose noise shakes the replay, as far as they drive it."""

KEPT = 4
"""Replays that a process remembers."""


class SteeringReplay:
    """The nominal plant driven by a record's inputs; implements engine.model.Replay.

    BenchError where the record cannot drive a replay. ``undecidable``: effects that this record
    cannot decide, with the reason. ``judged``: (n,) bool, samples that count.
    """

    period_s = PERIOD_S

    def __init__(self, record: Record, like: SteeringReplay | None = None) -> None:
        """Bind the model to ``record``; with the outputs of ``like``, NaN where it has none."""
        self.record = record
        self._like = like
        self._key = uuid4().hex
        self.drive = Drive(record)
        self.simulation = Simulation(self.drive)
        self._predicted: tuple[Predicted, ...]
        self._predicted = outputs_of(self.drive) if like is None else like._predicted
        self.outputs = tuple(p.output for p in self._predicted)
        self.nuisances = suspects.nuisances(self.drive, record.nominal)
        self.hypotheses: Mapping[str, Hypothesis]
        self.hypotheses, self.undecidable = suspects.hypotheses(
            self.drive, self._predicted, self.nuisances
        )
        if like is None:
            self._look_for_ripple()
        self.judged = np.ones(len(record), dtype=bool)
        self.judged[: settled(self.drive)] = False
        self.judged[-CUT_OFF:] = False
        for gap in gaps(self.drive):
            self.judged[max(gap.start - CUT_OFF, 0) : settled(self.drive, gap.stop)] = False
        if record.excluded is not None:
            self.judged &= ~record.excluded

    def __reduce__(self) -> tuple[object, ...]:
        """Travel as the record alone; a process that has met this replay goes on with its own."""
        return _met, (self._key, self.record, self._like)

    def _look_for_ripple(self) -> None:
        """Begin the hypothesis of ripple at its line; leave it out where there is none."""
        if ripple.EFFECT not in self.hypotheses:
            return
        line, judged = None, slice(UNSETTLED, len(self.record) - CUT_OFF)
        if ripple.CHANNEL in self.record:
            error = ripple.supply_error(self.run({}, {}))
            line = ripple.find_line(error[judged])
        if line is None:
            self._leave_out(
                ripple.EFFECT, "no line stands out of the supply pressure between 25 and 450 Hz"
            )
            return

        def answer(amplitude: float, hz: float) -> np.ndarray:
            given = {"amplitude": amplitude, "frequency": hz, "phase": 0.0}
            return ripple.supply_error(self.run({}, {ripple.EFFECT: given}))

        try:
            amplitude, phase = ripple.estimate(line, error, answer)
        except (*NUMERICAL, BenchError) as failure:
            self._leave_out(ripple.EFFECT, f"could not be tried: {reason(failure)}")
            return
        found = ripple.at_line(self.hypotheses[ripple.EFFECT], line, amplitude, phase)
        self.hypotheses = {**self.hypotheses, ripple.EFFECT: found}
        self._predicted = (*self._predicted, *ripple.shifted(line))
        self.outputs = tuple(p.output for p in self._predicted)

    def _leave_out(self, effect: str, why: str) -> None:
        self.undecidable = (*self.undecidable, Undecidable(effect, why))
        self.hypotheses = {n: h for n, h in self.hypotheses.items() if n != effect}

    def run(self, nuisances: Mapping[str, float], effects: Effects) -> Run:
        """Return the simulation with the absolute ``nuisances`` and the ``effects`` that are on.

        Where the rack's load is measured, what acts behind the load cell is no part of it.
        """
        model = full_model(self.record.valve_system)
        parameters = self.record.nominal
        if nuisances:
            parameters = parameters.with_values(nuisances)
        parameters = model.changed(parameters, effects)
        trace = self.simulation.run(parameters, acting(self.drive, effects))
        return Run(self.drive, parameters, effects, trace)

    def residuals(self, nuisances: Mapping[str, float], effects: Effects) -> np.ndarray:
        """Return measured minus predicted, (n, outputs), SI; NaN where it is not judged.

        BenchError: the plant leaves what is possible. ParameterError: a value out of its range.
        """
        errors = self.errors(nuisances, effects)
        errors[~self.judged] = np.nan
        return errors

    def errors(self, nuisances: Mapping[str, float], effects: Effects) -> np.ndarray:
        """Return measured minus predicted, (n, outputs), samples that do not count included."""
        run = self.run(nuisances, effects)
        nothing = np.full(len(self.record), np.nan)
        return np.column_stack(
            [p.residual(run) if p.there(self.drive) else nothing for p in self._predicted]
        )

    def shaken(self, nuisances: Mapping[str, float], effects: Effects) -> np.ndarray:
        """Return what another draw of the inputs' noise changes in the errors, (n, outputs).

        Of the model in question: a heavier rack may ring where the nominal one is well damped; of
        the nominal one where such noise drives the plant out of what is possible.
        """
        other, own = self._shaken_twin
        try:
            changed = other.errors(nuisances, effects) - self.errors(nuisances, effects) - own
        except BenchError:
            if not nuisances and not effects:
                raise
            return self.shaken({}, {})
        changed[~self.judged] = np.nan
        return changed

    @cached_property
    def _shaken_twin(self) -> tuple[SteeringReplay, np.ndarray]:
        """Return a replay whose inputs have more noise, and that of the outputs, (n, outputs)."""
        random = np.random.default_rng(0)
        added = {
            name: noise_like(bridged(self.record[name]), random, self.record.rate(name))
            for name in SHAKING
            if name in self.record
        }
        channels = {name: x + added.get(name, 0.0) for name, x in self.record.channels.items()}
        own = [added.get(o.name, np.zeros(len(self.record))) for o in self.outputs]
        twin = SteeringReplay(replace(self.record, channels=channels), like=self)
        return twin, np.column_stack(own)

    def noise(self) -> np.ndarray:
        """Return the white noise of each output's channel, standard deviation, (outputs,)."""
        return np.array(
            [
                spectrum(bridged(self.record[n]), rate_hz=self.record.rate(n)).noise
                if n in self.record
                else 0.0
                for n in (o.name for o in self.outputs)
            ]
        )

    def states(self) -> Mapping[str, np.ndarray]:
        """Return what a free-form term may depend on, name [unit] to (n,), nominal model."""
        trace = self.run({}, {}).trace
        load = trace["right_pressure"] - trace["left_pressure"]
        return {
            "steering wheel angle [rad]": trace["steering_wheel_angle"],
            "rack position [m]": trace["rack_position"],
            "rack speed [m/s]": trace["rack_speed"],
            "steering wheel speed [rad/s]": trace["steering_wheel_speed"],
            "torsion-bar torque [N m]": trace.torque,
            "load pressure [Pa]": load,
            "sum of pressures [Pa]": trace["right_pressure"] + trace["left_pressure"],
        }


def settled(drive: Drive, begin: int = 0) -> int:
    """Return the first sample that is judged after ``begin``, where nothing is known of the states.

    Before it hidden states are guessed, and the rack's friction depends on how the rack came there.
    """
    nominal = drive.record.nominal
    angle = drive.curves["steering_wheel_angle"].values[RUN_UP + begin :]
    if not len(angle):
        return begin
    reach = FRICTIONLESS * nominal["mechanics.rack_friction_displacement"]
    moved = np.maximum.accumulate(angle) - np.minimum.accumulate(angle)
    free = np.flatnonzero(moved / nominal["mechanics.gear_ratio"] > reach)
    longest = max(UNSETTLED, int(LONGEST * len(angle)))
    return begin + int(np.clip(free[0] if len(free) else longest, UNSETTLED, longest))


def gaps(drive: Drive) -> list[slice]:
    """Return where an input of the replay is missing for too long to be bridged."""
    record = drive.record
    driving = [*drive.inputs(), *(["rack_force"] if drive.load == "cell" else [])]
    missing = np.any([np.isnan(record[name]) for name in driving], axis=0)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], missing.astype(np.int8), [0]])))
    return [slice(a, b) for a, b in edges.reshape(-1, 2).tolist() if b - a > BRIDGED]


_REPLAYS: OrderedDict[str, SteeringReplay] = OrderedDict()


def _met(key: str, record: Record, like: SteeringReplay | None) -> SteeringReplay:
    """Return this process's replay of a record that came from another process."""
    if key not in _REPLAYS:
        _REPLAYS[key] = SteeringReplay(record, like)
        _REPLAYS[key]._key = key
        if len(_REPLAYS) > KEPT:
            _REPLAYS.popitem(last=False)
    return _REPLAYS[key]
