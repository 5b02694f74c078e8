"""What rigs get wrong in a record, and how often it is suspected with its right name.

    steer bench rig_mistakes
    steer python benchmarks/rig_mistakes.py --records 4 --table

Records of the sealed benchmark's generator, clean and with every effect at its largest, are looked
at as they are: nothing may be suspected. Then each mistake of tests/support/rig_mistakes.py is done
to the clean ones, with all channels and with a rig's seven. A record that cannot show a mistake,
such as a force of the wrong sign without a load, counts as missed.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "support"))

from rig_mistakes import KINDS, clean_record, effect_records, rig

from steering_bringup.benchmarking.program import Measured, main
from steering_bringup.benchmarking.registry import BENCHMARKS
from steering_diagnosis.steering.suspicions import suspicions

FIRST_SEED = 700_000
SETS = {"all": lambda record: record, "rig": rig}


def measure(options: argparse.Namespace) -> Measured:
    """Look at all records, then do every mistake to the clean ones."""
    clean = [clean_record(FIRST_SEED + k, options.seconds) for k in range(options.records)]
    details: dict[str, Any] = {"suspected": []}
    values: dict[str, float | None] = {"clean": _suspected(clean, details["suspected"])}
    if not options.no_effects:
        effects = effect_records(FIRST_SEED, options.seconds)
        values["effects"] = _suspected(effects, details["suspected"])
    for kind, mistakes in KINDS.items():
        for name, of in SETS.items():
            tried = [
                (record.name, mistake.channels, mistake.found(of(record)))
                for record in clean[: options.changed]
                for mistake in mistakes[: options.each]
                if mistake.possible(of(record))
            ]
            if tried:
                values[f"{kind}_{name}"] = 100.0 * sum(hit for *_, hit in tried) / len(tried)
                details[f"{kind}_{name}"] = [t[:2] for t in tried if not t[2]]
    for name in SETS:
        rates = [x for row, x in values.items() if row.endswith(f"_{name}") and x is not None]
        values[f"named_{name}"] = sum(rates) / len(rates)
    if options.table:
        print(table(values))
    return Measured(values, details)


def _suspected(records: Any, told: list[str]) -> float:
    """Return the share of records [%], with either set of channels, in which much is suspected."""
    count, found = 0, 0
    for record in records:
        for of in SETS.values():
            texts = [s.text for s in suspicions(of(record))]
            count, found = count + 1, found + bool(texts)
            told += [f"{record.name}: {text}" for text in texts]
    return 100.0 * found / count


def table(values: dict[str, float | None]) -> str:
    """Return the rates as the table of docs/diagnosis_model.md."""
    what = {row.name: row.what for row in BENCHMARKS["rig_mistakes"].rows}
    lines = ["| mistake | all channels | a rig's seven |", "|---|---|---|"]
    for kind in KINDS:
        cells = [
            f"<!-- bench: rig_mistakes.{kind}_{name} -->{round(value)}<!-- /bench --> %"
            if (value := values.get(f"{kind}_{name}")) is not None
            else "-"
            for name in SETS
        ]
        lines.append(f"| {what[f'{kind}_all'].split(';')[0]} | {' | '.join(cells)} |")
    return "\n".join(lines)


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the size."""
    parser.add_argument("--records", type=int, default=30, help="clean ones")
    parser.add_argument("--changed", type=int, default=12, help="of these get mistakes")
    parser.add_argument(
        "--each", type=int, default=None, help="mistakes of a kind, all unless given"
    )
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--no-effects", action="store_true")
    parser.add_argument("--table", action="store_true", help="print the table of the docs")


if __name__ == "__main__":
    sys.exit(main("rig_mistakes", measure, arguments, __doc__))
