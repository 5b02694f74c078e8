"""Two tanks above each other, with overflow: a public benchmark (Schoukens and others)."""

import os
import sys
from pathlib import Path

from balance_diagnosis import Model, Record, between, diagnose, ode

FULL = 150.0


def rates(x, u, p):
    """Return the levels' rates: pump, Bernoulli's law, and what runs over the brim."""
    upper, lower = max(x[0], 0.0), max(x[1], 0.0)
    inflow = p.pump * u[0] * (1.0 + p.bent * u[0])
    out = p.k1 * upper ** (0.5 + p.upper_power)
    over = 0.0
    brim = min(p.brim, p.lost_brim)
    if upper >= brim:
        over = max(inflow - out, 0.0) + (upper - brim)
    into = p.share * over if p.brim <= p.lost_brim else 0.0
    down = p.k3 * lower ** (0.5 + p.lower_power)
    return inflow - out - over - p.leak * upper, out - down + into - p.drip * lower


def level(x, record, p):
    """Return the measured level."""
    return {"level": (x.lower + p.offset).clip(max=p.clamp)}


MODEL = Model(
    ode(rates, level, states=("upper", "lower"), inputs=("pump",), steps=4, held=True),
    parameters={
        "k1": between(0.005, 0.5),
        "k3": between(0.005, 0.5),
        "pump": between(0.005, 0.5),
    },
    starts={"upper": between(0.0, 80.0), "lower": between(0.0, 15.0)},
    causes={
        "overflow into the lower tank": {"brim": (FULL, 2.0, FULL), "share": (0.5, 0.0, 1.5)},
        "overflow is lost": {"lost_brim": (FULL, 2.0, FULL)},
        "sensor clamp": {"clamp": (15.0, 5.0, 15.0)},
        "sensor offset": {"offset": (0.0, -3.0, 3.0)},
        "upper outflow has another power": {"upper_power": (0.0, -0.3, 0.3)},
        "lower outflow has another power": {"lower_power": (0.0, -0.3, 0.3)},
        "pump is not linear": {"bent": (0.0, -0.1, 0.1)},
        "upper tank leaks": {"leak": (0.0, 0.0, 0.02)},
        "lower tank leaks": {"drip": (0.0, 0.0, 0.02)},
    },
    units=dict.fromkeys(("brim", "lost_brim", "clamp", "offset", "upper", "lower"), "V"),
    name="cascaded tanks",
)


def records(folder):
    """Return the record to fit and the one to hold out."""
    file = Path(folder) / "dataBenchmark.csv"
    names = {"fit": ("uEst", "yEst"), "held out": ("uVal", "yVal")}
    return [
        Record.from_csv(file, 4.0, {"pump": u, "level": y}, {"pump": "V", "level": "V"}, name=name)
        for name, (u, y) in names.items()
    ]


if __name__ == "__main__":
    fit, held = records(os.environ["STEER_TANKS_DATA"])
    print(diagnose(MODEL, fit=[fit], holdout=[held]).write(sys.argv[1]))
