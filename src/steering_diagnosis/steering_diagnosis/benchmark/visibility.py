"""How visible an effect is on a record, and what it can be mistaken for: the truth's own answer.

The truth runs along the record's true wheel angle, rack force and commands, as a replay would, with
and without each effect and with each nuisance one standard deviation off. In units of the noise,
D = difference by an effect, N = differences by nuisances: an effect's signal-to-noise ratio is
sqrt(D' (1 + N N')^-1 D), what is left of it after the nuisances, within their tolerances, have
taken up what they can. Every tenth sample counts, as the noise is coloured.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from steering_core.errors import BenchError
from steering_core.parameters import ParameterSet
from steering_diagnosis.benchmark.truth import states as s
from steering_diagnosis.benchmark.truth.changes import TrueEffect
from steering_diagnosis.benchmark.truth.course import Course
from steering_diagnosis.benchmark.truth.disturbance import COLOURED, WHITE
from steering_diagnosis.benchmark.truth.effects import changed
from steering_diagnosis.benchmark.truth.listed import LISTED
from steering_diagnosis.benchmark.truth.run import Signals, run_clamped
from steering_diagnosis.benchmark.truth.specimen import GROUPS, RATES, SENSOR_OF, Specimen
from steering_diagnosis.data.channels import MEASURED

VISIBLE = 25.0
"""Signal-to-noise ratio from which an effect counts as visible, if it is also no mere trifle."""

BEYOND = 10.0
"""The same where only a tolerance hides it (offsets, levels): so many standard deviations of it."""

TRIFLE = 0.1
"""Share of the typical size below which nobody would name an effect, however well it is seen."""

OUTSTANDING = 1.0
"""Root mean square over a channel's noise from which what has no name in the catalogue is visible:
nobody has a template of it."""

TYRE = "tyre_relaxation"
"""The effect that acts on the load's command alone, which these runs are given."""

COLUMNS = (
    "torsion_bar_torque",
    "left_pressure",
    "right_pressure",
    "supply_pressure",
    "rack_position",
    "rack_speed",
    "driver_torque",
    "load_force",
)
"""Of a whitened difference: six outputs, and the balances that two commands make known."""

SCALED = 10.0
"""Typical sizes to which the catalogue's effects may be scaled to imitate what is not in it."""

INVISIBLE = 2.0
"""And below which nobody can see it."""

TELLING, HALF = 5.0, 0.5
"""Signal-to-noise ratio beside a rival's best imitation below which the two look the same; and
share of its own that this may be: what can hardly be seen is imitated by everything."""

EVERY = 10
STEPS = {False: 5, True: 12}
"""Steps of a tick in these runs, without and with spools in them: 200 and 83 us are stable."""

DRIVER_NOISE, LOAD_NOISE = 0.03, 3.0
"""Of the torque that the column needs [N m], mostly from differentiating, and of the load [N]."""


@dataclass(frozen=True, repr=False)
class Sensitivity:
    """Whitened differences: effects by name, (rows,) each; nuisances (rows, k).

    columns: so many blocks of rows, one below the other.
    """

    effects: Mapping[str, np.ndarray]
    sizes: Mapping[str, float]
    nuisances: np.ndarray
    columns: int = len(COLUMNS)

    def strength(self, difference: np.ndarray) -> float:
        """Return the signal-to-noise ratio of a whitened difference."""
        return float(np.linalg.norm(self._reduced(difference)))

    def ratio(self, name: str) -> float:
        """Return the signal-to-noise ratio of an effect of its typical size."""
        return self.strength(self.effects[name])

    def visible(self, difference: np.ndarray) -> bool:
        """Return whether a whitened difference is visible beside the nuisances."""
        left, raw = self.strength(difference), np.linalg.norm(difference)
        return bool(left >= (BEYOND if left < 0.05 * raw else VISIBLE))

    def outstanding(self, name: str, difference: np.ndarray) -> float:
        """Return how far a difference stands above the noise, whatever tolerances and rivals do.

        The root mean square of the channel that shows most of what neither nuisances nor the other
        effects, each scaled at will, take up; in units of the noise.
        """
        rivals = [SCALED * d for n, d in self.effects.items() if n != name]
        columns = np.column_stack([self.nuisances, *rivals])
        gram = columns.T @ columns + np.eye(columns.shape[1])
        left = difference - columns @ np.linalg.solve(gram, columns.T @ difference)
        return float(np.sqrt(np.mean(left.reshape(self.columns, -1) ** 2, axis=1)).max())

    def smallest_visible(self, name: str) -> float:
        """Return about the size's magnitude from which an effect is visible: linear in its size."""
        typical, ratio = abs(self.sizes[name]), max(self.ratio(name), 1e-9)
        raw = float(np.linalg.norm(self.effects[name]))
        needed = BEYOND if ratio < 0.05 * raw else VISIBLE
        return max(TRIFLE * typical, typical * needed / ratio)

    def mistaken(self, name: str, difference: np.ndarray) -> list[str]:
        """Return the effects that this record cannot tell from ``name`` with this difference."""
        d = self._reduced(difference)
        found = []
        for rival in self.effects:
            if rival == name:
                continue
            r = self._reduced(self.effects[rival])
            length = float(np.linalg.norm(r))
            if length < 1e-9:
                continue
            left = float(np.linalg.norm(d - r * float(r @ d) / length**2))
            if left < TELLING and left < HALF * np.linalg.norm(d):
                found.append(rival)
        return found

    def _reduced(self, d: np.ndarray) -> np.ndarray:
        """Return a difference after the nuisances: the d with |d|^2 = D' (1 + N N')^-1 D."""
        u, sv, _ = self._svd
        along = u.T @ d
        return np.asarray(d - u @ (along * (1.0 - 1.0 / np.sqrt(1.0 + sv * sv))))

    @property
    def _svd(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        if not hasattr(self, "_kept"):
            object.__setattr__(self, "_kept", np.linalg.svd(self.nuisances, full_matrices=False))
        return self._kept  # type: ignore[attr-defined]


class Probe:
    """Clamped runs of one record, whitened.

    pressed: the chambers' pressures are inputs as well, where the valves' commands are not known.
    """

    def __init__(
        self,
        specimen: Specimen,
        nominal: ParameterSet,
        system: str,
        course: Course,
        given: Signals,
        pressed: bool = False,
    ) -> None:
        self.specimen, self.nominal, self.course, self.given = specimen, nominal, course, given
        self.pressed = pressed
        self.system, self.closed = system, system == "closed_centre"
        self.base = self.rows(specimen)

    def rows(self, specimen: Specimen) -> np.ndarray:
        """Return whitened outputs, one long vector: what is measured while the inputs are given.

        The sensors of inputs act inversely: the replay is driven by what they report.
        """
        return self._run(specimen, self._felt(specimen))

    def shaken(self, *channels: int) -> np.ndarray:
        """Return what the noise of inputs makes of each column, in units of its own, (8,).

        channels: of the inputs (truth.states). Their noise is held over the rows that count, as it
        is coloured.
        """
        random, true = np.random.default_rng(0), self.given.true.copy()
        for row in channels:
            level = WHITE[row] * np.hypot(1.0, COLOURED)
            drawn = level * random.standard_normal(-(-len(true) // EVERY))
            true[:, row] += np.repeat(drawn, EVERY)[: len(true)]
        change = self._run(self.specimen, replace(self.given, true=true)) - self.base
        return np.asarray(np.std(change.reshape(len(COLUMNS), -1), axis=1))

    def _run(self, specimen: Specimen, felt: Signals) -> np.ndarray:
        steps = STEPS[self.closed and not self.pressed]
        run = run_clamped(
            specimen, self.nominal, self.course, felt, self.closed, steps, self.pressed
        )
        scale = WHITE * np.hypot(1.0, COLOURED)
        # The angle drives the replay: its noise comes back in the torque.
        stiffness = self.nominal["mechanics.torsion_bar_stiffness"]
        scale[s.TORQUE_OUT] = np.hypot(scale[s.TORQUE_OUT], stiffness * scale[s.ANGLE_OUT])
        outputs = run.measured[:, 2:8] / scale[2:8]
        balance = run.balance - self.given.driver[:, :1] * [1.0, 0.0]
        cell = (felt.true[:, s.FORCE_OUT] - self.given.true[:, s.FORCE_OUT])[:, None] * [0.0, 1.0]
        stacked = np.column_stack([outputs, (balance + cell) / [DRIVER_NOISE, LOAD_NOISE]])
        return stacked[EVERY // 2 :: EVERY].T.ravel()

    def difference(self, specimen: Specimen) -> np.ndarray:
        """Return the whitened change of the outputs by what differs from the record's specimen."""
        return np.asarray(self.rows(specimen) - self.base)

    def effect(self, effect: TrueEffect, size: float) -> np.ndarray:
        """Return the whitened change by an effect; for a tyre, by its own law."""
        if effect.name == TYRE:
            return self._tyre(size)
        return self.difference(
            changed(self.specimen, self.nominal, self.system, {effect.name: size})
        )

    def beside(self, sizes: Mapping[str, float]) -> dict[str, np.ndarray]:
        """Return the whitened change by each effect where all others are there as well."""

        def with_effects(chosen: Mapping[str, float]) -> np.ndarray:
            return self.rows(changed(self.specimen, self.nominal, self.system, chosen))

        whole, found = with_effects(sizes), {}
        for name, size in sizes.items():
            others = {n: x for n, x in sizes.items() if n != name}
            found[name] = self._tyre(size) if name == TYRE else whole - with_effects(others)
        return found

    def _felt(self, specimen: Specimen) -> Signals:
        """Return the inputs that must have been true for the same readings on another specimen."""
        true = self.given.true.copy()
        mine, other = self.specimen, specimen
        chambers = (s.RIGHT_OUT, s.LEFT_OUT) if self.pressed else ()
        for row in (s.ANGLE_OUT, s.SPEED_OUT, s.FORCE_OUT, *chambers):
            felt = true[:, row] + _leaking(mine, row, self.given.true)
            read = felt * mine.sensors[row, 0] + mine.sensors[row, 1]
            felt = (read - other.sensors[row, 1]) / other.sensors[row, 0]
            true[:, row] = felt - _leaking(other, row, true)
        ticks = np.arange(len(true))
        for row in (s.ANGLE_OUT, s.SPEED_OUT, s.FORCE_OUT):
            later = other.delays[row, 0] - mine.delays[row, 0]
            if later != 0.0:
                true[:, row] = np.interp(ticks + later * 1e3, ticks, true[:, row])
        return replace(self.given, true=true)

    def _tyre(self, length: float) -> np.ndarray:
        """Return the change of the load's balance by a relaxing tyre."""
        from scipy.signal import lfilter

        share = 1.0 - np.exp(-self.nominal["vehicle.speed"] * 1e-3 / length)
        force = self.given.true[:, s.FORCE_OUT]
        lagged = lfilter([share], [1.0, share - 1.0], force - force[0]) + force[0]
        change = np.zeros((len(force), len(COLUMNS)))
        change[:, COLUMNS.index("load_force")] = (lagged - force) / LOAD_NOISE
        return change[EVERY // 2 :: EVERY].T.ravel()


def _leaking(specimen: Specimen, row: int, true: np.ndarray) -> np.ndarray | float:
    """Return what the left pressure's sensor has of the right one's signal [Pa]."""
    share = specimen.extras["crosstalk"] if row == s.LEFT_OUT else 0.0
    return share * true[:, s.RIGHT_OUT] if share else 0.0


def sensitivity(probe: Probe, include: Mapping[str, TrueEffect]) -> Sensitivity:
    """Return the differences by effects at their typical sizes and by all nuisances."""
    effects, sizes = {}, {}
    for name, effect in include.items():
        try:
            effects[name] = probe.effect(effect, effect.typical)
            sizes[name] = effect.typical
        except BenchError:
            continue
    return Sensitivity(effects, sizes, np.column_stack([*_nuisances(probe)]))


def catalogue_for(system: str, course: Course) -> dict[str, TrueEffect]:
    """Return the catalogue's effects that can act on a record."""
    return {
        e.name: e
        for e in LISTED
        if system in e.systems
        and (not e.kinds or course.kind in e.kinds)
        and (not e.loads or course.load in e.loads)
    }


def _nuisances(probe: Probe) -> list[np.ndarray]:
    """Return the differences by one standard deviation of every parameter and sensor."""
    found = []
    own = {"open_centre": "pressure_control_valve.", "closed_centre": "?"}[probe.system]
    for name in probe.nominal:
        tolerance = probe.nominal.info(name).tolerance if name.split(".")[0] in GROUPS else 0.0
        if tolerance == 0.0 or name.startswith(own):
            continue
        sheet = {
            **probe.specimen.sheet,
            name: probe.specimen.sheet[name] + 0.5 * tolerance * probe.nominal[name],
        }
        found.append(probe.difference(replace(probe.specimen, sheet=sheet)))
    for row, channel in enumerate(MEASURED.values()):
        for column, width in ((0, channel.gain), (1, channel.offset)):
            if width == 0.0 or (row in RATES and SENSOR_OF[row] == SENSOR_OF[row - 1]):
                continue
            sensors = probe.specimen.sensors.copy()
            rows = (
                [r for r in range(s.CHANNELS) if SENSOR_OF[r] == SENSOR_OF[row]]
                if column == 0
                else [row]
            )
            sensors[rows, column] += 0.5 * width
            found.append(probe.difference(replace(probe.specimen, sensors=sensors)))
    return [d for d in found if np.linalg.norm(d) > 1e-6]
