"""A diagnosis run on this machine: processes, and a progress bar on a terminal."""

from __future__ import annotations

from steering_bringup.progress import Steps
from steering_diagnosis.data.record import Record
from steering_diagnosis.report import Diagnosis
from steering_studies.parallel import pool


def run_diagnosis(record: Record, holdout: Record | None, jobs: int) -> Diagnosis:
    """Diagnose a record with ``jobs`` processes; 1: in this one. BenchError tells what is wrong."""
    from steering_diagnosis.steering.diagnose_record import diagnose_record

    with pool(jobs) as executor, Steps("diagnosis") as progress:
        return diagnose_record(record, holdout, executor=executor, progress=progress)
