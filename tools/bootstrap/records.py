"""The full check: every installed file against the hash in its distribution's RECORD."""

import base64
import csv
import hashlib
from collections.abc import Mapping
from pathlib import Path

from bootstrap.layout import site_packages
from bootstrap.lockfile import canonical

# Written by pip or changed by it after the hash was taken.
_UNCHECKED = ("RECORD", "INSTALLER", "REQUESTED", "direct_url.json")


def damaged(
    environment: Path, versions: Mapping[str, str], patched: Mapping[str, str]
) -> dict[str, list[str]]:
    """Damaged distributions: canonical name -> what is wrong.

    `versions` gives the locked version of every distribution, `patched` the SHA-256 of files that
    set-up changed on purpose, by absolute path.
    """
    found = {}
    result: dict[str, list[str]] = {}
    for folder in site_packages(environment).glob("*.dist-info"):
        name, _, version = folder.name.removesuffix(".dist-info").partition("-")
        found[canonical(name)] = version
        problems = _problems(folder, patched)
        if problems and canonical(name) in versions:
            result[canonical(name)] = problems
    for name, version in versions.items():
        if found.get(name) != version:
            result[name] = [f"is {found.get(name, 'absent')}, not {version}"]
    return result


def _problems(folder: Path, patched: Mapping[str, str]) -> list[str]:
    """Files of one distribution that are gone or changed."""
    record = folder / "RECORD"
    if not record.is_file() or not (folder / "METADATA").is_file():
        return [f"{folder.name} is incomplete"]
    problems = []
    with record.open(newline="", encoding="utf-8") as lines:
        for path, digest, *_ in csv.reader(lines):
            if not digest or path.endswith(".pyc") or Path(path).name in _UNCHECKED:
                continue
            problem = _compare((folder.parent / path).resolve(), digest, patched)
            problems += [problem] if problem else []
    return problems


def _compare(file: Path, digest: str, patched: Mapping[str, str]) -> str | None:
    """What is wrong with one file; None where it is as recorded."""
    try:
        content = file.read_bytes()
    except OSError:
        return f"{file} is gone"
    algorithm, _, expected = digest.partition("=")
    if str(file) in patched:
        same = hashlib.sha256(content).hexdigest() == patched[str(file)]
    else:
        value = base64.urlsafe_b64encode(hashlib.new(algorithm, content).digest())
        same = value.rstrip(b"=").decode() == expected
    return None if same else f"{file} differs"
