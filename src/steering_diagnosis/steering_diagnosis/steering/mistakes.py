"""Mistakes of a record that one channel or group of channels explains: signs, units, exchanges.

Every relation between channels is right, off (by a factor or a sign) or unclear. A mistake is
suspected where undoing it puts every relation right that it touches, and breaks none.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from steering_core.parameters import ParameterSet
from steering_diagnosis.data.channels import MEASURED
from steering_diagnosis.data.record import Record
from steering_diagnosis.data.units import FACTORS
from steering_diagnosis.steering.relations import CHAMBERS, RELATIONS, Link, Signals, link

POUND, GRAVITY, INCH = 4.4482216152605, 9.80665, 0.0254
SPELT = {"Nm", "mNm"}
"""Other spellings of the same units."""
UNITS: Mapping[str, Mapping[str, float]] = {
    "rad": {**FACTORS["rad"], "0.1 deg": np.pi / 1800.0, "gon": np.pi / 200.0},
    "rad/s": {**FACTORS["rad/s"], "0.1 deg/s": np.pi / 1800.0},
    "N m": {**FACTORS["N m"], "N cm": 1e-2, "kgf cm": GRAVITY * 1e-2, "lbf in": POUND * INCH},
    "Pa": {**FACTORS["Pa"], "0.1 bar": 1e4, "0.01 bar": 1e3},
    "m": {**FACTORS["m"], "0.1 mm": 1e-4, "in": INCH},
    "m/s": {**FACTORS["m/s"], "cm/s": 1e-2, "in/s": INCH},
    "N": {**FACTORS["N"], "daN": 10.0, "kgf": GRAVITY, "lbf": POUND},
}
"""SI unit to the units that a channel may be in while another one of them is said. Those of mapping
files (data/units.py), counts of a bus, and such as are in use (NIST SP 811, appendix B)."""

USUAL = {"rad", "deg", "rad/s", "deg/s", "N m", "Pa", "bar", "MPa", "m", "mm", "m/s", "mm/s", "N"}
"""Units of which one at least takes part in a mistake."""

NEAR = 1.3
"""Factor that a comparison may be off by beside a mistake's own. Friction moves that of the rack's
forces by 1.25 on clean records."""

ROAD_WHEEL = (1.0 / 25.0, 1.0 / 11.0)
"""Angle at a road wheel over that at the steering wheel: ratios of passenger cars, 11 to 25."""

COLUMN = (11.0, 25.0)
"""Torque behind a reduction, or at a road wheel's axle, over that at the torsion bar: as above."""

GROUPS = (
    ("left_pressure", "right_pressure", "supply_pressure"),
    CHAMBERS,
    ("steering_wheel_angle", "steering_wheel_speed"),
    ("rack_position", "rack_speed"),
)
"""Channels that come from one device or line of a mapping and are wrong together."""

EQUAL = 1.2
"""Rests of two mistakes' explanations over each other within which they explain as well."""

SIMPLE = {"degrees": "deg", "radians": "rad"}


@dataclass(frozen=True)
class Mistake:
    """What may be wrong. factor: what the channels are too large by; nan: they are swapped."""

    channels: tuple[str, ...]
    text: str
    factor: float

    def undone(self, s: Signals) -> dict[str, np.ndarray]:
        """Return the signals as they would be without it."""
        found = dict(s)
        if np.isfinite(self.factor):
            return found | {c: s[c] / self.factor for c in self.channels}
        first, second = self.channels
        return found | {first: s[second], second: s[first]}


@dataclass(frozen=True)
class Explained:
    """A mistake that explains what is off. links: the relations that it puts right, as they are."""

    mistake: Mistake
    links: tuple[Link, ...]
    rest: float

    @property
    def text(self) -> str:
        """Return what is suspected, with the evidence."""
        names = " and ".join(self.mistake.channels)
        verb = "seem" if len(self.mistake.channels) > 1 else "seems"
        own = [x for x in self.links if x.relation.name in self.mistake.channels]
        return f"{names} {verb} to {self.mistake.text}: {_evidence((own or self.links)[0])}"


def mistakes(record: Record, signals: Signals) -> list[list[Explained]]:
    """Return what explains the relations that are off, one mistake after the other.

    Each is a list of what explains it equally well, nothing else being known.
    """
    left, found = dict(signals), []
    for _ in signals:
        best = _best(record, left)
        if not best:
            break
        found.append(best)
        gone = {c for e in best for c in e.mistake.channels}
        left = {n: x for n, x in left.items() if n not in gone}
    return found


def _best(record: Record, s: Signals) -> list[Explained]:
    relations = [r for r in RELATIONS if r.present(record, s)]
    before = [link(r, s, record.nominal) for r in relations]
    if all(x.state != "off" for x in before):
        return []
    tried = (_explained(m, before, s, record.nominal) for m in candidates(s))
    found = [e for e in tried if e is not None]
    most = max((len(e.links) for e in found), default=0)
    found = sorted((e for e in found if len(e.links) == most), key=lambda e: e.rest)
    kept: list[Explained] = []
    for e in found:
        known = {c for k in kept for c in k.mistake.channels}
        # Less than it explains as well, and of one explanation the nearest factor only.
        if e.rest <= EQUAL * found[0].rest and not known & set(e.mistake.channels):
            kept.append(e)
    return kept


def _explained(
    mistake: Mistake, before: list[Link], s: Signals, nominal: ParameterSet
) -> Explained | None:
    """Return what a mistake explains; None where something touched is not right afterwards."""
    undone = mistake.undone(s)
    fixed, rests = [], []
    for old in before:
        if not set(mistake.channels) & set(old.relation.members):
            continue
        new = link(old.relation, undone, nominal)
        off = new.state == "off" or (old.state == "right" and new.state != "right")
        far = old.state == "off" and not (1.0 / NEAR < new.factor < NEAR) and old.relation.sized
        if off or (old.state == "off" and (new.state != "right" or far)):
            return None
        if old.state == "off":
            fixed.append(old)
            rests.append(new.rest)
    return Explained(mistake, tuple(fixed), float(np.mean(rests))) if fixed else None


def candidates(s: Signals) -> Iterator[Mistake]:
    """Yield everything that may be wrong with the channels of a record, the simplest first."""
    if set(CHAMBERS) <= set(s):
        yield Mistake(CHAMBERS, "be swapped", np.nan)
    for name in MEASURED:
        if name in s and "pressure" not in name:
            yield Mistake((name,), "have the wrong sign", -1.0)
    groups = [g for g in GROUPS if set(g) <= set(s)] + [(n,) for n in MEASURED if n in s]
    for group in groups:
        for factor, text in factors(MEASURED[group[0]].unit):
            yield Mistake(group, f"have a wrong unit ({text})", factor)
        if group[0] == "steering_wheel_angle":
            for factor in np.geomspace(*ROAD_WHEEL, 4):
                text = "be measured at the road wheel, behind the steering ratio"
                yield Mistake(group, text, float(factor))
        if group == ("torsion_bar_torque",):
            for factor in np.geomspace(*COLUMN, 4):
                text = "be measured behind a reduction, not at the torsion bar"
                yield Mistake(group, text, float(factor))


def factors(si: str) -> list[tuple[float, str]]:
    """Return what a unit in another's place makes values too large by, and the units' names."""
    found: dict[str, tuple[float, list[str]]] = {}
    units = {name: one for name, one in UNITS[si].items() if name not in SPELT}
    for said, one in units.items():
        for true, other in units.items():
            ratio = one / other
            if abs(np.log(ratio)) > np.log(2.0) and {said, true} & USUAL:
                found.setdefault(f"{ratio:.2g}", (ratio, []))[1].append(f"{true} for {said}")
    return [(ratio, _units(ratio, names)) for ratio, names in found.values()]


def _units(ratio: float, names: list[str]) -> str:
    """Return the names of a factor, the simplest first."""
    names = sorted(names, key=len)
    text = " or ".join(names[:2])
    for long, short in SIMPLE.items():
        text = " ".join(long if word == short else word for word in text.split(" "))
    powers = {3: "thousandths", -3: "kilo-units"}
    power = powers.get(round(np.log10(ratio), 6), "")
    return f"{text}, {power}" if power else text


def _evidence(off: Link) -> str:
    return off.evidence if off.relation.sized else f"{off.relation.name}: {off.evidence}"
