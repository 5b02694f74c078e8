"""The compiled kernels' cache: never stale, and quick to start from."""

import os
import shutil
import subprocess
import sys
import tempfile
from importlib import resources
from pathlib import Path

import pytest

from steering_core.compiled import (
    CORE_PACKAGES,
    KEPT_CACHES,
    cache_folder,
    cache_root,
    content_key,
    core_sources,
)

SLOT = '    """Effective bulk modulus [Pa] at a pressure [Pa]."""\n    return value\n'
PROBE = """
import numpy as np
from steering_core.parameters import load_parameters
from steering_plant.model.chamber import stiffness
from steering_plant.plant import plant_record
par = plant_record(load_parameters(), "open_centre")
print(stiffness(par[0], 0.0, np.zeros(10), np.zeros(0)), sum(stiffness.stats.cache_hits.values()))
"""


@pytest.fixture
def copied(tmp_path):
    """Return a folder with a copy of the core packages, each beside the others."""
    for package in {name.split(".")[0] for name in CORE_PACKAGES}:
        source = Path(str(resources.files(package)))
        ignored = shutil.ignore_patterns("__pycache__")
        shutil.copytree(source, tmp_path / "src" / package, ignore=ignored)
    return tmp_path / "src"


def probed(sources, cache):
    environment = {
        **os.environ,
        "PYTHONPATH": str(sources),
        "STEER_KERNEL_CACHE": str(cache),
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    done = subprocess.run(
        [sys.executable, "-c", PROBE], env=environment, capture_output=True, text=True, check=True
    )
    value, hits = done.stdout.split()
    return float(value), int(hits)


def test_an_edit_in_another_file_is_seen(copied, tmp_path):
    """numba's own cache looks at one file only and would go on with the old slot."""
    cache = tmp_path / "cache"
    assert probed(copied, cache) == (1e9, 0)
    assert probed(copied, cache) == (1e9, 1)
    slots = copied / "steering_plant" / "model" / "slots.py"
    text = slots.read_text(encoding="utf-8")
    assert SLOT in text
    slots.write_text(text.replace(SLOT, SLOT.replace("value\n", "0.5 * value\n")), encoding="utf-8")
    assert probed(copied, cache) == (5e8, 0)
    slots.write_text(text, encoding="utf-8")
    assert probed(copied, cache) == (1e9, 1)
    assert len(list(cache.iterdir())) == 2


def test_any_edited_core_source_has_another_key(copied):
    sources = sorted(copied.rglob("*.py"))
    key = content_key(iter(sources))
    assert content_key(iter(sources)) == key
    for source in (sources[0], sources[-1]):
        text = source.read_text(encoding="utf-8")
        source.write_text(text + "\n", encoding="utf-8")
        assert content_key(iter(sources)) != key
        source.write_text(text, encoding="utf-8")
    assert content_key(iter(sources)) == key


def test_every_core_package_counts():
    folders = {path.parent.as_posix() for path in core_sources()}
    for package in CORE_PACKAGES:
        assert any(folder.endswith(package.replace(".", "/")) for folder in folders), package


def test_old_caches_are_removed(tmp_path, monkeypatch):
    monkeypatch.setenv("STEER_KERNEL_CACHE", str(tmp_path))
    for number in range(KEPT_CACHES + 3):
        (tmp_path / f"old{number}").mkdir()
        os.utime(tmp_path / f"old{number}", (number, number))
    present = cache_folder.__wrapped__()
    left = {folder.name for folder in tmp_path.iterdir()}
    assert present.name in left
    assert len(left) == KEPT_CACHES
    assert "old0" not in left


def test_a_temporary_cache_that_is_somebody_else_s_is_not_used(tmp_path, monkeypatch):
    """Without a home the cache is among everybody's temporary files, and what it holds is run."""
    (tmp_path / "file").touch()
    monkeypatch.delenv("STEER_KERNEL_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    own = tmp_path / f"steering-kernels-{os.getuid()}"
    assert cache_root() == own
    assert own.stat().st_mode & 0o077 == 0
    owner = os.getuid()
    monkeypatch.setattr(os, "getuid", lambda: owner + 1)
    (tmp_path / f"steering-kernels-{owner + 1}").mkdir()
    used = cache_root()
    assert used.parent == tmp_path
    assert used.name != f"steering-kernels-{owner + 1}"
