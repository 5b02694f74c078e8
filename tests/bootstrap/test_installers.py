"""What installs the locked distributions: uv with pip's settings, and pip where uv cannot."""

from pathlib import Path

import pytest

from bootstrap import environment, installers
from bootstrap.errors import SetupError
from bootstrap.layout import Layout
from bootstrap.logged import LoggedRunner
from bootstrap.progress import Step

CONFIG = r"""
:env:.cert='/own/certificates.pem'
:env:.disable-pip-version-check='1'
global.cert='/everybody/certificates.pem'
global.extra-index-url='https://one.example/simple\nhttps://two.example/simple'
global.find-links='/wheels /more wheels'
global.index-url='https://global.example/simple'
global.no-binary=':none:'
install.index-url='https://mirror.example/simple'
download.index-url='https://other.example/simple'
"""


class Shown:
    """What ``pip config list`` gives."""

    stdout = CONFIG


def test_what_pip_is_told_of_indexes_is_told_to_uv():
    assert installers.uv_variables(CONFIG) == {
        "SSL_CERT_FILE": "/own/certificates.pem",
        "UV_INDEX": "https://one.example/simple https://two.example/simple",
        "UV_FIND_LINKS": "/wheels,/more,wheels",
        "UV_DEFAULT_INDEX": "https://mirror.example/simple",
    }
    assert installers.uv_variables("") == {}


def test_what_the_user_tells_uv_himself_counts_more(tmp_path, monkeypatch):
    monkeypatch.setattr("subprocess.run", lambda *_, **__: Shown)
    given = {"UV_DEFAULT_INDEX": "https://mine.example/simple"}
    command, variables = installers.uv_install(tmp_path, tmp_path / "wanted.txt", given)
    assert variables["UV_DEFAULT_INDEX"] == "https://mine.example/simple"
    assert variables["SSL_CERT_FILE"] == "/own/certificates.pem"
    assert "--require-hashes" in command


class Runner(LoggedRunner):
    """Notes the commands, and lets those of some program fail."""

    def __init__(self, failing=()) -> None:
        self.failing = failing
        self.ran: list[tuple[str, int]] = []

    def run(self, command, environ, shown, cwd):
        program = Path(command[0]).name
        if "pip" in command:
            wanted = Path(command[-1]).read_text()
            self.ran.append((program, sum(not x.startswith(" ") for x in wanted.splitlines())))
        if program in self.failing:
            raise SetupError(f"{program} failed")


@pytest.fixture
def layout(tmp_path):
    root = Path(__file__).parents[2]
    (tmp_path / "requirements").symlink_to(root / "requirements")
    (tmp_path / ".steer" / "tmp").mkdir(parents=True)
    return Layout(tmp_path)


SHOWN = Step("installing")
BOTH = (installers.uv_install, installers.pip_install)


@pytest.mark.parametrize("failing", [(), ("uv",)])
def test_pip_takes_over_where_uv_fails(layout, tmp_path, monkeypatch, failing):
    monkeypatch.setattr("subprocess.run", lambda *_, **__: Shown)
    runner = Runner(failing)
    environment.install(layout, tmp_path / "env", ["setuptools", "numpy"], runner, SHOWN, BOTH)
    expected = [("python", 2), ("uv", 1), *([("python", 1)] if failing else [])]
    assert runner.ran == expected


def test_the_last_installers_failure_is_told(layout, tmp_path):
    with pytest.raises(SetupError, match="python failed"):
        environment.install(layout, tmp_path / "env", ["numpy"], Runner(("python",)), SHOWN)


def test_a_repair_is_pips(layout, tmp_path):
    runner = Runner()
    environment.install(layout, tmp_path / "env", ["numpy"], runner, SHOWN)
    assert runner.ran == [("python", 2), ("python", 1)]
