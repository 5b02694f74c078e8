"""Compiled kernels whose cache on disk is never stale.

numba's own cache looks at the file of a function only: an edit to a function that it calls from
another file goes unseen. Here the cache folder is named after the content of every core source
file, the Python, numba and llvmlite versions and the processor, so an edit anywhere simply leads
to another folder.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import platform
import shutil
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import llvmlite
import llvmlite.binding
import numba

from steering_core.errors import BenchError

CORE_PACKAGES = (
    "steering_core",
    "steering_plant",
    "pressure_control",
    "driver_model",
    "vehicle_model",
    "steering_bringup.direct",
    "steering_bringup.lane_keeping",
    "steering_diagnosis.steering.kernels",
    "steering_diagnosis.engine.kernels",
    "steering_diagnosis.benchmark.truth",
)
"""Packages with kernels; the rest of the bring-up has none, and its edits cost no compilation."""
KEPT_CACHES = 8

# A kernel compiled for a record also takes a longer one that begins with the same fields and reads
# the same numbers from it; numba calls that experimental.
warnings.filterwarnings("ignore", category=numba.NumbaExperimentalFeatureWarning)

Function = TypeVar("Function", bound=Callable[..., Any])


def core_sources() -> Iterator[Path]:
    """Yield every Python source file of the installed core packages, in a fixed order."""
    for package in CORE_PACKAGES:
        spec = importlib.util.find_spec(package)
        for folder in (spec.submodule_search_locations or ()) if spec else ():
            yield from sorted(Path(folder).rglob("*.py"))


def content_key(sources: Iterator[Path]) -> str:
    """Return a key of the files' content, the compiler's versions and the processor."""
    digest = hashlib.sha256()
    parts = (sys.version, numba.__version__, llvmlite.__version__, platform.machine(), _processor())
    digest.update("\n".join(parts).encode())
    for source in sources:
        digest.update(source.name.encode())
        digest.update(source.read_bytes())
    return digest.hexdigest()[:24]


def cache_root() -> Path:
    """Return the folder that holds the caches: ``STEER_KERNEL_CACHE`` or the user's cache.

    A temporary folder where the user's cannot be written. BenchError where the named one cannot.
    """
    named = os.environ.get("STEER_KERNEL_CACHE")
    if named:
        if not _writable(Path(named)):
            raise BenchError(f"STEER_KERNEL_CACHE names '{named}', which cannot be written")
        return Path(named)
    given = Path(os.environ.get("XDG_CACHE_HOME", ""))
    base = given if given.is_absolute() else Path(os.path.expanduser("~/.cache"))
    root = base / "steering-kernels"
    return root if base.is_absolute() and _writable(root) else _temporary_root()


def _writable(folder: Path) -> bool:
    """Return whether a file can be made in ``folder``, which is made where it is not there."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


def _temporary_root() -> Path:
    """Return a folder of our own among everybody's temporary ones.

    What lies in it is loaded and run, so a folder that somebody else has put there is not used.
    """
    root = Path(tempfile.gettempdir()) / f"steering-kernels-{os.getuid()}"
    root.mkdir(mode=0o700, exist_ok=True)
    if root.is_symlink() or root.stat().st_uid != os.getuid():
        return Path(tempfile.mkdtemp(prefix="steering-kernels-"))
    return root


@cache
def cache_folder() -> Path:
    """Return (and make) the cache folder of the present sources; old folders are removed."""
    root = cache_root()
    folder = root / content_key(core_sources())
    folder.mkdir(parents=True, exist_ok=True)
    os.utime(folder)
    kept = sorted((f for f in root.iterdir() if f.is_dir()), key=_modified, reverse=True)
    for old in kept[KEPT_CACHES:]:
        shutil.rmtree(old, ignore_errors=True)
    return folder


def kernel(function: Function) -> Function:
    """Compile ``function`` with numba (nopython, no fast-math) and keep it on disk.

    IEEE arithmetic in the written order: the same inputs give the same bits whether the kernel
    is called from Python or from inside another kernel. A kernel allocates nothing: it works in
    the arrays that it is given, so no references are counted, which took half of the plant's time.
    """
    numba.config.CACHE_DIR = str(cache_folder())
    return numba.njit(cache=True, error_model="numpy", _nrt=False)(function)


def _processor() -> str:
    features = llvmlite.binding.get_host_cpu_features().flatten()
    return f"{llvmlite.binding.get_host_cpu_name()} {features}"


def _modified(folder: Path) -> float:
    try:
        return folder.stat().st_mtime
    except FileNotFoundError:
        return 0.0
