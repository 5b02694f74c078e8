"""The full check: every installed file against the hash in its distribution's RECORD."""

import base64
import csv
import hashlib
from collections import defaultdict
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
    folders = sorted(site_packages(environment).glob("*.dist-info"))
    recorded = {folder: _recorded(folder) for folder in folders}
    # A file of two distributions is as the one of them recorded it that was installed last.
    digests: dict[Path, set[str]] = defaultdict(set)
    for entries in recorded.values():
        for file, digest in (entries or {}).items():
            digests[file].add(digest)
    for folder in folders:
        name, _, version = folder.name.removesuffix(".dist-info").partition("-")
        found[canonical(name)] = version
        entries = recorded[folder]
        own = {file: digests[file] for file in entries or ()}
        problems = [f"{folder.name} is incomplete"] if entries is None else _problems(own, patched)
        if problems and canonical(name) in versions:
            result[canonical(name)] = problems
    for name, version in versions.items():
        if found.get(name) != version:
            result[name] = [f"is {found.get(name, 'absent')}, not {version}"]
    return result


def _recorded(folder: Path) -> dict[Path, str] | None:
    """Return the files of one distribution and their digests, None where it is incomplete."""
    record = folder / "RECORD"
    if not record.is_file() or not (folder / "METADATA").is_file():
        return None
    with record.open(newline="", encoding="utf-8") as lines:
        return {
            (folder.parent / path).resolve(): digest
            for path, digest, *_ in csv.reader(lines)
            if digest and not path.endswith(".pyc") and Path(path).name not in _UNCHECKED
        }


def _problems(recorded: Mapping[Path, set[str]], patched: Mapping[str, str]) -> list[str]:
    """Files that are gone or changed."""
    compared = (_compare(file, digests, patched) for file, digests in recorded.items())
    return [problem for problem in compared if problem]


def _compare(file: Path, digests: set[str], patched: Mapping[str, str]) -> str | None:
    """What is wrong with one file; None where it is as recorded."""
    try:
        content = file.read_bytes()
    except OSError:
        return f"{file} is gone"
    if str(file) in patched:
        same = hashlib.sha256(content).hexdigest() == patched[str(file)]
    else:
        same = any(digest == _digest(content, digest.partition("=")[0]) for digest in digests)
    return None if same else f"{file} differs"


def _digest(content: bytes, algorithm: str) -> str:
    """Return a file's digest as a RECORD has it."""
    value = base64.urlsafe_b64encode(hashlib.new(algorithm, content).digest())
    return f"{algorithm}={value.rstrip(b'=').decode()}"
