"""The diagnoses of a fleet's records: whole records side by side, each kept as it is done."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, as_completed
from pathlib import Path

from steering_bringup.outputs import write_json
from steering_core.errors import BenchError
from steering_diagnosis.report import Report

FILE = "report.json"


def found_in(data: Sequence[Path]) -> dict[str, Path]:
    """Return the records of bags, files and folders of these, by name. BenchError: none, or twice.

    A folder that is no bag stands for the bags and files in it, in the order of their names.
    """
    paths = [path for given in data for path in _records(given)]
    if not paths:
        raise BenchError(f"no bag and no measured file in {', '.join(map(str, data))}")
    found: dict[str, Path] = {}
    for path in paths:
        if path.stem in found:
            raise BenchError(f"two records are called '{path.stem}': {found[path.stem]} and {path}")
        found[path.stem] = path
    return found


def _records(given: Path) -> list[Path]:
    from steering_diagnosis.data.foreign import READERS

    if not given.exists():
        raise BenchError(f"there is no '{given}'")
    if given.is_file() or _is_bag(given):
        return [given]
    ends = {".mcap", ".db3", *READERS}
    inside = sorted(given.iterdir())
    return [p for p in inside if _is_bag(p) or (p.is_file() and p.suffix.lower() in ends)]


def _is_bag(path: Path) -> bool:
    return path.is_dir() and any(any(path.glob(f"*{end}*")) for end in (".mcap", ".db3"))


def diagnosed(
    records: Mapping[str, Path],
    mapping: Path | None,
    folder: Path,
    executor: Executor | None,
    tell: Callable[[str], None] = lambda _: None,
) -> tuple[dict[str, Report], dict[str, str]]:
    """Return the report of every record, and why others have none, by name.

    What ``folder`` has of the same bytes and software already is taken from there. tell: called
    with each name as it is done.
    """
    reports: dict[str, Report] = {}
    failed: dict[str, str] = {}
    for name, answer in _answers(records, mapping, folder, executor):
        if isinstance(answer, str):
            failed[name] = answer
        else:
            reports[name] = answer
        tell(name)
    return {n: reports[n] for n in records if n in reports}, failed


def _answers(
    records: Mapping[str, Path], mapping: Path | None, folder: Path, executor: Executor | None
) -> Iterator[tuple[str, Report | str]]:
    if executor is None:
        yield from ((n, _one(path, mapping, folder / n / FILE)) for n, path in records.items())
        return
    waiting = {
        executor.submit(_one, path, mapping, folder / name / FILE): name
        for name, path in records.items()
    }
    for future in as_completed(waiting):
        yield waiting[future], future.result()


def _one(path: Path, mapping: Path | None, file: Path) -> Report | str:
    """Return a record's report, or why it has none."""
    from steering_diagnosis.data.cut import cut
    from steering_diagnosis.data.read import read_record
    from steering_diagnosis.steering.diagnose_record import diagnose_record, software

    try:
        record = cut(read_record(path, mapping), None, None)
        kept = _kept(file, record.sha256, software())
        if kept is not None:
            return kept
        report = diagnose_record(record).report
        file.parent.mkdir(parents=True, exist_ok=True)
        write_json(file, report.model_dump(mode="json"))
    except BenchError as error:
        return str(error)
    return report


def _kept(file: Path, sha256: str, software: str) -> Report | None:
    from steering_diagnosis.writing import read_report

    if not file.exists():
        return None
    try:
        report = read_report(file)
    except BenchError:
        return None
    same = report.bag.sha256 == sha256 and report.software == software
    return report if same and report.learned is not None else None
