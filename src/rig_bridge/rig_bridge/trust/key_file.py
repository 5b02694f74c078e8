"""The key of a rig: 32 random bytes in a file that only its owner can read."""

from __future__ import annotations

import os
import secrets
import stat
import tempfile
from contextlib import suppress
from pathlib import Path

from steering_core.errors import BenchError

KEY_BYTES = 32
OTHERS = stat.S_IRWXG | stat.S_IRWXO
OWN_FOLDER, OWN_FILE = "steering-bench", "emulated_rig.key"


def make_key(path: Path) -> None:
    """Write a new key to ``path``, readable by its owner alone; an older one is never replaced."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        number = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    except FileExistsError:
        raise BenchError(f"'{path}' exists already: a key is never overwritten") from None
    except OSError as error:
        raise BenchError(f"'{path}' cannot be written: {error.strerror}") from None
    with open(number, "w", encoding="ascii") as file:
        os.fchmod(number, 0o600)
        file.write(secrets.token_hex(KEY_BYTES) + "\n")


def load_key(path: Path) -> bytes:
    """Return the key in a file; BenchError where others could read it, or it holds none."""
    try:
        with open(path, "rb") as file:
            state = os.fstat(file.fileno())
            text = file.read(4 * KEY_BYTES)
    except OSError as error:
        raise BenchError(f"the key '{path}' cannot be read: {error.strerror}") from None
    if state.st_uid not in (os.geteuid(), 0):
        raise BenchError(f"the key '{path}' belongs to another user: make one of your own")
    if state.st_mode & OTHERS:
        raise BenchError(f"others may read the key '{path}': chmod 600, and make a new one")
    try:
        key = bytes.fromhex(text.decode("ascii"))
    except ValueError:
        key = b""
    if len(key) != KEY_BYTES:
        raise BenchError(f"'{path}' holds no key of {2 * KEY_BYTES} hexadecimal digits")
    return key


def own_key() -> Path:
    """Return the key of this user's emulated rigs, made on first use.

    It lies in the user's configuration, or in a temporary folder of his where that cannot be
    written. Several processes may ask at once.
    """
    given = Path(os.environ.get("XDG_CONFIG_HOME", ""))
    base = given if given.is_absolute() else Path(os.path.expanduser("~/.config"))
    path = base / OWN_FOLDER / OWN_FILE
    if path.is_file():
        return path
    if base.is_absolute():
        with suppress(BenchError):
            return _made_once(path)
    return _made_once(_temporary() / OWN_FILE)


def _made_once(path: Path) -> Path:
    """Make the key unless another process has: nobody ever reads half of one."""
    if path.is_file():
        return path
    fresh = path.with_name(f"{path.name}.{secrets.token_hex(8)}")
    make_key(fresh)
    try:
        with suppress(FileExistsError):
            os.link(fresh, path)
    except OSError as error:
        raise BenchError(f"'{path}' cannot be written: {error.strerror}") from None
    finally:
        fresh.unlink()
    return path


def _temporary() -> Path:
    folder = Path(tempfile.gettempdir()) / f"{OWN_FOLDER}-{os.getuid()}"
    with suppress(FileExistsError):
        folder.mkdir(mode=0o700)
    state = folder.lstat()
    if not stat.S_ISDIR(state.st_mode) or state.st_uid != os.getuid() or state.st_mode & OTHERS:
        raise BenchError(
            f"'{folder}' is not this user's alone: set XDG_CONFIG_HOME to a folder of your own, "
            "where the key of emulated rigs can lie"
        )
    return folder
