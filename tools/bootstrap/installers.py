"""The commands that install locked distributions: uv, and pip where uv cannot.

uv takes a third of pip's time. It does not read pip's configuration, so what a machine says there
of indexes, certificates and proxies is handed on in uv's own variables.
"""

import ast
import subprocess
from collections.abc import Callable, Mapping
from pathlib import Path

from bootstrap.layout import python_of

Installer = Callable[[Path, Path, Mapping[str, str]], tuple[list[str | Path], dict[str, str]]]
"""From environment, requirements and variables to a command and its variables."""

UV_NAMES = {
    "index-url": ("UV_DEFAULT_INDEX", " "),
    "extra-index-url": ("UV_INDEX", " "),
    "find-links": ("UV_FIND_LINKS", ","),
    "trusted-host": ("UV_INSECURE_HOST", " "),
    "no-index": ("UV_NO_INDEX", " "),
    "timeout": ("UV_HTTP_TIMEOUT", " "),
    "default-timeout": ("UV_HTTP_TIMEOUT", " "),
    "cert": ("SSL_CERT_FILE", " "),
    "client-cert": ("SSL_CLIENT_CERT", " "),
    "proxy": ("ALL_PROXY", " "),
}
"""pip's options: uv's variable, and what parts several values in it."""


def pip_install(
    top: Path, wanted: Path, environ: Mapping[str, str]
) -> tuple[list[str | Path], dict[str, str]]:
    """Return pip's command."""
    command: list[str | Path] = [python_of(top), "-m", "pip", "install", "--require-hashes"]
    command += ["--no-deps", "--no-build-isolation", "--no-compile", "--force-reinstall"]
    return [*command, "--progress-bar", "off", "--requirement", wanted], dict(environ)


def uv_install(
    top: Path, wanted: Path, environ: Mapping[str, str]
) -> tuple[list[str | Path], dict[str, str]]:
    """Return uv's command. Files are copied: damage in one must not reach uv's cache.

    Indexes are equal, as for pip; the locked hashes tell whether it is the right file.
    """
    command: list[str | Path] = [top / "bin" / "uv", "pip", "install", "--python", python_of(top)]
    command += ["--require-hashes", "--no-deps", "--no-build-isolation"]
    command += ["--link-mode", "copy", "--index-strategy", "unsafe-best-match"]
    shown = subprocess.run(
        [python_of(top), "-m", "pip", "config", "list"],
        env=dict(environ),
        capture_output=True,
        text=True,
        check=False,
    ).stdout
    return [*command, "--no-progress", "--requirement", wanted], uv_variables(shown) | dict(environ)


def uv_variables(config: str) -> dict[str, str]:
    """Return uv's variables for what ``pip config list`` prints.

    A command's section overrides the global one, and the environment both.
    """
    found: dict[str, tuple[int, str]] = {}
    for line in config.splitlines():
        name, _, value = line.partition("=")
        section, _, option = name.rpartition(".")
        rank = {"global": 0, "install": 1, ":env:": 2}.get(section, -1)
        if option in UV_NAMES and rank >= found.get(option, (0, ""))[0]:
            found[option] = rank, str(ast.literal_eval(value))
    return {
        UV_NAMES[option][0]: UV_NAMES[option][1].join(value.split())
        for option, (_, value) in found.items()
    }
