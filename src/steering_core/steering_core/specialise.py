"""Compile a module or package of kernels again with other text in it.

numba compiles a kernel together with the functions that it names. To make it name others (the
slots of chosen effects), its source is copied, edited and imported under another name; the copy
is kept in the kernels' cache under a key of its content, so that it compiles once.
"""

from __future__ import annotations

import hashlib
import importlib
import os
import re
import sys
import tempfile
from collections.abc import Iterable, Mapping
from importlib import resources
from pathlib import Path
from types import ModuleType

from steering_core.compiled import cache_folder


def specialised_package(package: str, files: Mapping[str, str]) -> ModuleType:
    """Return a copy of ``package`` in which some files (name to text) are replaced.

    The package's modules must import each other relatively. The copy's name ends with a key of
    the replaced text.
    """
    source = resources.files(package)
    texts = {f.name: f.read_text("utf-8") for f in source.iterdir() if f.name.endswith(".py")}
    missing = files.keys() - texts.keys()
    if missing:
        raise ValueError(f"{package} has no {sorted(missing)}")
    name = f"{package.replace('.', '_')}_{_key(files.values())}"
    for file, text in (texts | dict(files)).items():
        _write(_generated() / name / file, text)
    return importlib.import_module(name)


def specialised_module(module: ModuleType, imports: Mapping[str, str]) -> ModuleType:
    """Return a copy of ``module`` that imports from other packages (name to other name)."""
    text = resources.files(module.__package__ or "").joinpath(_file_name(module)).read_text("utf-8")
    for old, new in imports.items():
        # The whole name: another module's may begin with it.
        text, count = re.subn(rf"\b{re.escape(old)}\b", new, text)
        if not count:
            raise ValueError(f"{module.__name__} does not import from {old}")
    name = f"{module.__name__.replace('.', '_')}_{_key([text])}"
    _write(_generated() / f"{name}.py", text)
    return importlib.import_module(name)


def _generated() -> Path:
    """Return the folder of the generated source, which Python imports from."""
    folder = cache_folder() / "generated"
    folder.mkdir(exist_ok=True)
    if str(folder) not in sys.path:
        sys.path.append(str(folder))
    return folder


def _write(path: Path, text: str) -> None:
    """Write ``text`` unless it is there; whole or not at all, whoever else writes it too."""
    if path.exists():
        return
    path.parent.mkdir(exist_ok=True)
    handle, draft = tempfile.mkstemp(dir=path.parent)
    with os.fdopen(handle, "w", encoding="utf-8") as file:
        file.write(text)
    os.replace(draft, path)
    importlib.invalidate_caches()


def _key(texts: Iterable[str]) -> str:
    return hashlib.sha256("\0".join(texts).encode()).hexdigest()[:16]


def _file_name(module: ModuleType) -> str:
    return Path(module.__file__ or "").name
