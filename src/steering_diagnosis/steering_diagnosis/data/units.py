"""Units of other tools' files, each as a factor to the bench's SI unit."""

from __future__ import annotations

import math

from steering_core.errors import BenchError
from steering_core.naming import unknown

DEGREE, MINUTE, LITRE = math.pi / 180.0, 60.0, 1e-3
HOUR, DAY = 60.0 * MINUTE, 24.0 * 60.0 * MINUTE

FACTORS: dict[str, dict[str, float]] = {
    "rad": {"rad": 1.0, "deg": DEGREE, "mrad": 1e-3, "rev": 2.0 * math.pi},
    "rad/s": {"rad/s": 1.0, "deg/s": DEGREE, "rpm": 2.0 * math.pi / MINUTE},
    "N m": {"N m": 1.0, "Nm": 1.0, "mN m": 1e-3, "mNm": 1e-3, "kN m": 1e3},
    "Pa": {"Pa": 1.0, "bar": 1e5, "mbar": 1e2, "kPa": 1e3, "MPa": 1e6, "psi": 6894.757293168},
    "m": {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "um": 1e-6},
    "m/s": {"m/s": 1.0, "mm/s": 1e-3, "km/h": 1.0 / 3.6},
    "N": {"N": 1.0, "kN": 1e3},
    "N/m": {"N/m": 1.0, "N/mm": 1e3, "kN/m": 1e3},
    "s": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": MINUTE, "h": HOUR, "d": DAY},
}
"""SI unit to the units that stand for the same quantity. The first is the SI unit itself."""


def factor(given: str, wanted: str, where: str) -> float:
    """Return what a value in the unit ``given`` is multiplied by to be in SI unit ``wanted``.

    BenchError, beginning with ``where``, for a unit of another quantity.
    """
    known = FACTORS[wanted]
    if given not in known:
        raise BenchError(f"{where}: {unknown(f'unit (for {wanted})', given, known)}")
    return known[given]


def same(given: str, named: str, wanted: str) -> bool:
    """Return whether two spellings are the same unit of the quantity ``wanted``."""
    known = FACTORS[wanted]
    return given == named or (given in known and known[given] == known.get(named))


def is_unit(text: str, wanted: str | None = None) -> bool:
    """Return whether a text is a unit that the bench knows, of the quantity ``wanted`` or any."""
    for quantity in [wanted] if wanted else FACTORS:
        try:
            factor(text, quantity, "")
        except BenchError:
            continue
        return True
    return False
