"""Units of other tools' files, each as a factor to the bench's SI unit."""

from __future__ import annotations

import math
import re
import unicodedata

from steering_core.errors import BenchError
from steering_core.naming import unknown

DEGREE, MINUTE, HOUR, DAY = math.pi / 180.0, 60.0, 3600.0, 86400.0
INCH, FOOT = 0.0254, 0.3048
POUND_FORCE, KILOPOND = 4.4482216152605, 9.80665
"""N, exact by definition (NIST SP 811, appendix B)."""

FACTORS: dict[str, dict[str, float]] = {
    "rad": {"rad": 1.0, "deg": DEGREE, "mrad": 1e-3, "rev": 2.0 * math.pi, "gon": math.pi / 200.0},
    "rad/s": {
        "rad/s": 1.0,
        "deg/s": DEGREE,
        "mrad/s": 1e-3,
        "rev/s": 2.0 * math.pi,
        "rpm": 2.0 * math.pi / MINUTE,
    },
    "N m": {
        "N m": 1.0,
        "mN m": 1e-3,
        "kN m": 1e3,
        "N cm": 1e-2,
        "N mm": 1e-3,
        "lbf ft": POUND_FORCE * FOOT,
        "lbf in": POUND_FORCE * INCH,
        "kp m": KILOPOND,
    },
    "Pa": {
        "Pa": 1.0,
        "bar": 1e5,
        "mbar": 1e2,
        "hPa": 1e2,
        "kPa": 1e3,
        "MPa": 1e6,
        "N/mm2": 1e6,
        "psi": POUND_FORCE / INCH**2,
        "kp/cm2": KILOPOND * 1e4,
    },
    "m": {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "in": INCH},
    "m/s": {"m/s": 1.0, "mm/s": 1e-3, "cm/s": 1e-2, "km/h": 1.0 / 3.6, "in/s": INCH},
    "N": {"N": 1.0, "kN": 1e3, "daN": 10.0, "lbf": POUND_FORCE, "kp": KILOPOND},
    "N/m": {"N/m": 1.0, "N/mm": 1e3, "kN/m": 1e3, "kN/mm": 1e6},
    "s": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": MINUTE, "h": HOUR, "d": DAY},
}
"""SI unit to the units that stand for the same quantity. The first is the SI unit itself."""

SPELLINGS: dict[str, tuple[str, ...]] = {
    # "grad" is left out on purpose: a degree in German, a gon in English.
    "deg": (
        "°",
        "º",
        "˚",
        "Deg",
        "DEG",
        "degree",
        "degrees",
        "Degree",
        "Degrees",
        "Grad",
        "arcdeg",
    ),
    "rad": ("Rad", "RAD", "radian", "radians", "Radian"),
    "rev": ("U", "turn", "turns", "revolution", "revolutions", "Umdr", "Umdrehung"),
    "gon": ("gradian", "gradians"),
    "rpm": ("RPM", "Rpm", "1/min", "r/min", "rev/min", "Upm", "U/min", "upm", "min-1", "min^-1"),
    "deg/s": ("dps", "DPS"),
    "N m": ("Nm", "NM", "Newtonmeter", "newtonmeter", "newton meter", "newton metre"),
    "mN m": ("mNm",),
    "kN m": ("kNm",),
    "N cm": ("Ncm",),
    "N mm": ("Nmm",),
    "lbf ft": ("ft lbf", "lb ft", "ft lb", "ft lbs", "lbs ft", "lbft", "ftlb", "lbfft", "ftlbf"),
    "lbf in": ("in lbf", "lb in", "in lb", "in lbs", "lbs in", "lbin", "inlb", "lbfin", "inlbf"),
    "kp m": ("kpm", "kgf m", "kgfm"),
    "bar": ("Bar", "BAR", "bars"),
    "mbar": ("mBar", "millibar"),
    "Pa": ("pascal", "Pascal"),
    "kPa": ("KPa", "kpa"),
    "MPa": ("Mpa",),
    "hPa": ("hpa",),
    "N/mm2": ("N/mm^2", "N/mm**2"),
    "psi": ("PSI", "Psi", "lbf/in2", "lbf/in^2", "psig"),
    "kp/cm2": ("kp/cm^2", "kgf/cm2", "kgf/cm^2", "at"),
    "m": ("meter", "metre", "meters", "metres", "Meter"),
    "mm": ("millimeter", "millimetre", "Millimeter", "MM"),
    "um": ("μm", "micron", "micrometer"),
    "in": ("inch", "inches", "Inch", '"'),
    "km/h": ("kph", "kmh", "KPH", "kmph"),
    "N": ("newton", "Newton"),
    "kN": ("KN", "kilonewton"),
    "lbf": ("lb", "lbs"),
    "kp": ("kgf", "kilopond"),
    "s": ("sec", "Sec", "SEC", "second", "seconds", "Sekunde", "Sekunden", "S"),
    "ms": ("msec", "millisecond", "milliseconds", "Millisekunden"),
    "us": ("μs", "usec", "microsecond", "microseconds"),
    "ns": ("nsec", "nanosecond", "nanoseconds"),
    "min": ("minute", "minutes", "Minuten"),
    "h": ("hr", "hour", "hours", "Stunden"),
}
"""A unit's name here to what else it is called in files; upper case matters (mN, MN)."""

_NAMES = {other: name for name, others in SPELLINGS.items() for other in others}
_PRODUCT = re.compile(r"\s*[.*·⋅∙•×-]\s*|\s+")
_INVERSE = re.compile(r"^(.+?)\s*[.*·⋅∙•]?\s*(s|sec|min|h)\s*\^?\(?[-−]1\)?$")


def spelled(text: str) -> str:
    """Return the name of a unit in FACTORS for any spelling of it; an unknown one as it is.

    Brackets, blanks, signs of multiplication and 's^-1' make no difference: '[N*m]' is 'N m'.
    """
    unit = unicodedata.normalize("NFC", text).replace("\N{MICRO SIGN}", "μ").strip(" \t[]()")
    unit = unit.replace("²", "2").replace("⁻¹", "-1")
    unit = _INVERSE.sub(r"\1/\2", unit)
    if unit in _NAMES:
        return _NAMES[unit]
    over, slash, under = unit.partition("/")
    if slash:
        parts = f"{_name(over)}/{_name(under)}"
        return _NAMES.get(parts, parts)
    return _name(unit)


def _name(unit: str) -> str:
    """Return the name of a unit without a fraction."""
    plain = _PRODUCT.sub(" ", unit.strip())
    return _NAMES.get(plain, plain)


def factor(given: str, wanted: str, where: str) -> float:
    """Return what a value in the unit ``given`` is multiplied by to be in SI unit ``wanted``.

    BenchError, beginning with ``where``, for a unit of another quantity.
    """
    known = FACTORS[wanted]
    unit = spelled(given)
    if unit not in known:
        raise BenchError(f"{where}: {unknown(f'unit (for {wanted})', given, known)}")
    return known[unit]


def same(given: str, named: str, wanted: str) -> bool:
    """Return whether two spellings are the same unit of the quantity ``wanted``."""
    known = FACTORS[wanted]
    first, second = spelled(given), spelled(named)
    return first == second or (first in known and known[first] == known.get(second))


def is_unit(text: str, wanted: str | None = None) -> bool:
    """Return whether a text is a unit that the bench knows, of the quantity ``wanted`` or any."""
    for quantity in [wanted] if wanted else FACTORS:
        try:
            factor(text, quantity, "")
        except BenchError:
            continue
        return True
    return False
