"""The virtual environment: made from the locks, checked, repaired."""

import os
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from bootstrap import cmake_paths, fingerprint, lockfile, records, stamp
from bootstrap.errors import SetupError
from bootstrap.installers import Installer, pip_install, uv_install
from bootstrap.layout import Layout, python_of, site_packages
from bootstrap.logged import LoggedRunner
from bootstrap.progress import Step, say, step
from bootstrap.removal import remove
from bootstrap.variables import for_build

FIRST = ("setuptools", "uv")
"""Installed by pip before the others: what builds and installs those."""


def build(layout: Layout, top: Path, runner: LoggedRunner) -> None:
    """Make the environment `top` from nothing; the stamp comes last."""
    remove(top)
    version = ".".join(map(str, sys.version_info[:3]))
    with step(f"making an environment with Python {version}") as shown:
        # The base interpreter, as this one may live in the environment that was just removed.
        base = getattr(sys, "_base_executable", sys.executable)
        options = ["--system-site-packages"] if layout.system_ros else []
        command = [base, "-m", "venv", *options, str(top)]
        runner.run(command, for_build(layout, top, os.environ), shown, layout.root)
    pinned = lockfile.blocks(layout.locks())
    with step(f"installing {len(pinned)} locked packages") as shown:
        install(layout, top, pinned, runner, shown, (uv_install, pip_install))
    finish(layout, top)


def install(
    layout: Layout,
    top: Path,
    names: Iterable[str],
    runner: LoggedRunner,
    shown: Step,
    installers: Sequence[Installer] = (pip_install,),
) -> None:
    """Install the named distributions of the locks, by the first of ``installers`` that can.

    pip replaces whatever is there of them; uv only adds to a new environment.
    """
    pinned = lockfile.blocks(layout.locks())
    environ = for_build(layout, top, os.environ)
    # The few packages without a wheel are built with the locked setuptools, not with another one.
    first = [name for name in FIRST if name in pinned]
    later = [name for name in names if name not in first]
    for part, able in ((first, (pip_install,)), (later, installers)):
        wanted = layout.state / "tmp" / "wanted.txt"
        wanted.write_text("".join(pinned[name] for name in part))
        if part:
            _by_one_of(able, layout, top, wanted, environ, runner, shown)
    compiled: list[str | Path] = [python_of(top), "-m", "compileall", "-q", "-j", "0"]
    # Some packages carry templates or tests that are no valid Python: no reason to stop.
    tolerant: list[str | Path] = ["sh", "-c", '"$@" || true', "sh", *compiled, site_packages(top)]
    runner.run(tolerant, environ, shown, layout.root)


def _by_one_of(
    installers: Sequence[Installer],
    layout: Layout,
    top: Path,
    wanted: Path,
    environ: Mapping[str, str],
    runner: LoggedRunner,
    shown: Step,
) -> None:
    """Install by the first installer that can; the error of the last one is everybody's."""
    for installer in installers:
        try:
            command, variables = installer(top, wanted, environ)
            runner.run(command, variables, shown, layout.root)
            break
        except (SetupError, OSError):
            if installer is installers[-1]:
                raise


def finish(layout: Layout, top: Path) -> None:
    """Repair the wheels' CMake files and write the stamp."""
    facts = stamp.read(top) or {}
    patched = dict(facts.get("patched", {}))
    if not layout.system_ros:
        includes = cmake_paths.includes_of(python_of(top), for_build(layout, top, os.environ))
        patched.update(cmake_paths.fix(top / "share", *includes))
    stamp.write(
        top, patched=patched, distributions=_versions(layout), python=fingerprint.python_name()
    )


def _versions(layout: Layout) -> dict[str, str]:
    pinned = lockfile.blocks(layout.locks())
    return {name: lockfile.version_in(block) for name, block in pinned.items()}


def full_check(layout: Layout, top: Path, facts: stamp.Facts) -> dict[str, list[str]]:
    """Damaged distributions and what is wrong with each; the interpreter counts as one."""
    result = records.damaged(top, _versions(layout), facts["patched"])
    if not os.access(python_of(top), os.X_OK) or not (top / "pyvenv.cfg").is_file():
        result["the interpreter"] = [f"{python_of(top)} does not run"]
    return result


def repair(layout: Layout, top: Path, facts: stamp.Facts, runner: LoggedRunner) -> None:
    """Install damaged distributions again; make everything anew where that is not enough."""
    wrong = full_check(layout, top, facts)
    names = [name for name in wrong if name in facts["distributions"]]
    for name in list(wrong)[:5]:
        say(f"damaged: {name}: {wrong[name][0]}")
    if names and len(names) == len(wrong) and len(names) <= len(facts["distributions"]) // 2:
        with step(f"installing {len(names)} damaged packages again") as shown:
            install(layout, top, names, runner, shown)
        finish(layout, top)
        if not full_check(layout, top, stamp.read(top) or facts):
            return
    build(layout, top, runner)
