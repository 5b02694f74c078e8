"""The virtual environment: made from the locks, checked, repaired."""

import os
import sys
from collections.abc import Iterable
from pathlib import Path

from bootstrap import cmake_paths, fingerprint, lockfile, records, stamp
from bootstrap.layout import Layout, python_of, site_packages
from bootstrap.logged import LoggedRunner
from bootstrap.progress import Step, say, step
from bootstrap.removal import remove
from bootstrap.variables import for_build


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
        install(layout, top, pinned, runner, shown)
    finish(layout, top)


def install(
    layout: Layout, top: Path, names: Iterable[str], runner: LoggedRunner, shown: Step
) -> None:
    """Install the named distributions of the locks, whatever is there of them."""
    pinned = lockfile.blocks(layout.locks())
    # The few packages without a wheel are built with the locked setuptools, not with another one.
    first = [name for name in ("setuptools",) if name in pinned]
    for part in (first, [name for name in names if name not in first]):
        wanted = layout.state / "tmp" / "wanted.txt"
        wanted.write_text("".join(pinned[name] for name in part))
        command: list[str | Path] = [
            python_of(top),
            "-m",
            "pip",
            "install",
            "--require-hashes",
            "--no-deps",
        ]
        command += ["--no-build-isolation", "--no-compile", "--force-reinstall"]
        command += ["--progress-bar", "off", "--requirement", wanted]
        if part:
            runner.run(command, for_build(layout, top, os.environ), shown, layout.root)
    compile_all: list[str | Path] = [
        python_of(top),
        "-m",
        "compileall",
        "-q",
        "-j",
        "0",
        site_packages(top),
    ]
    # Some packages carry templates or tests that are no valid Python: no reason to stop.
    tolerant = ["sh", "-c", '"$@" || true', "sh", *compile_all, str(site_packages(top))]
    runner.run(tolerant, for_build(layout, top, os.environ), shown, layout.root)


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
