"""Repairs paths of the wheels' build machine in their exported CMake files."""

import hashlib
import re
import subprocess
from collections.abc import Mapping
from pathlib import Path

_BUILD_MACHINE = r"/opt/python/cp3\d+-cp3\d+"
_HEADERS = re.compile(_BUILD_MACHINE + r"/include/python3\.\d+")
_NUMPY = re.compile(
    _BUILD_MACHINE + r"/lib/python3\.\d+/site-packages/numpy/(?:_core|core)/include"
)
_ASK = """
import sysconfig, numpy
print(sysconfig.get_paths()["include"])
print(numpy.get_include())
"""


def includes_of(python: Path, environ: Mapping[str, str]) -> tuple[str, str]:
    """Folders of the headers of Python and of numpy, as the environment's Python knows them."""
    answer = subprocess.run(
        [python, "-c", _ASK], env=dict(environ), capture_output=True, text=True, check=True
    )
    headers, numpy = answer.stdout.splitlines()
    return headers, numpy


def fix(share: Path, headers: str, numpy: str) -> dict[str, str]:
    """Rewrite the CMake files below `share`; returns SHA-256 of each changed file by its path."""
    changed = {}
    for file in sorted(share.rglob("*.cmake")):
        old = file.read_text(encoding="utf-8", errors="surrogateescape")
        new = _NUMPY.sub(lambda _: numpy, _HEADERS.sub(lambda _: headers, old))
        if new != old:
            file.write_text(new, encoding="utf-8", errors="surrogateescape")
            changed[str(file)] = hashlib.sha256(file.read_bytes()).hexdigest()
    return changed
