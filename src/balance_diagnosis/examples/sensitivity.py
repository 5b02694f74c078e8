"""What halving and doubling each deciding constant does to the verdicts on the public records.

Needs STEER_EMPS_DATA and STEER_SEALS_DATA. Some ten seconds of one core a line.
"""

import os
from dataclasses import fields

import emps_axis
import seal_friction

from balance_diagnosis import diagnose
from balance_diagnosis.constants import DEFAULT


def verdicts(constants):
    """Return what is said of the axis and of both seals."""
    axis, _ = emps_axis.records(os.environ["STEER_EMPS_DATA"])
    folder = os.environ["STEER_SEALS_DATA"]
    said = [diagnose(emps_axis.MODEL, [axis], constants=constants)]
    for seal in ("O-ring", "PK"):
        halves = [seal_friction.record(folder, seal, bar).part(0.0, 0.5) for bar in (1, 3, 5, 7)]
        said.append(diagnose(seal_friction.MODEL, halves, constants=constants))
    return [f"{d.verdict.word}: {', '.join(d.verdict.named) or '-'}" for d in said]


if __name__ == "__main__":
    usual = verdicts(DEFAULT)
    print("as they are", *usual, sep=" | ")
    for constant in fields(DEFAULT):
        for factor in (0.5, 2.0):
            said = verdicts(DEFAULT.scaled(constant.name, factor))
            told = ["same" if a == b else a for a, b in zip(said, usual, strict=True)]
            print(constant.name, f"x {factor:g}", *told, sep=" | ", flush=True)
