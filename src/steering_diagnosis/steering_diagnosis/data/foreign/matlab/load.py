"""A MAT file's variables as Python has them: the one door to the libraries that read them."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from steering_core.errors import BenchError
from steering_diagnosis.data.foreign.matlab import outline


class Unreadable:
    """In the place of a variable that could not be read; ``why`` in a few words."""

    def __init__(self, why: object) -> None:
        self.why = " ".join(str(why).split()) or type(why).__name__


def load(path: Path, wanted: Iterable[str] | None = None) -> dict[str, Any]:
    """Return variables by name: those of which ``wanted`` names begin with theirs, or all.

    What each may be: docs of matio. One that is damaged comes as ``Unreadable``.
    Raises BenchError with what is wrong, where no variable can be read.
    """
    kind = outline.check(path)
    if kind in ("7.3", "HDF5"):
        outline.check_hdf5(path)
    if kind == "HDF5":
        return _plain(path, None)
    with warnings.catch_warnings():
        # The import warns of an option of pandas, reading of what the result tells as well.
        warnings.simplefilter("ignore")
        import matio

        # Bytes of damaged files make any error in there, so any is the file's.
        try:
            chosen = None if wanted is None else _beginning(list(matio.whosmat(path)), wanted)
            return dict(matio.load_from_mat(path, variable_names=chosen, add_table_attrs=True))
        except Exception as error:
            first = error
        return _one_by_one(path, kind, first)


def _one_by_one(path: Path, kind: outline.Kind, first: Exception) -> dict[str, Any]:
    """Return what can be read where one variable costs all; what cannot, with the reason."""
    import matio

    try:
        names = list(matio.whosmat(path))
    except Exception:
        names = _names(path) if kind == "7.3" else []
    found: dict[str, Any] = {}
    for name in names:
        try:
            found |= matio.load_from_mat(path, variable_names=[name], add_table_attrs=True)
        except Exception as error:
            found[name] = Unreadable(error)
            if kind == "7.3":
                found |= _plain(path, name)
    if all(isinstance(value, Unreadable) for value in found.values()):
        why = Unreadable(first).why
        raise BenchError(f"'{path}' cannot be read as a MAT file: it is damaged: {why}")
    return found


def _beginning(names: list[str], wanted: Iterable[str]) -> list[str]:
    queries = [query.lstrip("[") for query in wanted]
    return [
        name
        for name in names
        if any(q == name or q.startswith(tuple(name + sign for sign in ".({")) for q in queries)
    ]


def _names(path: Path) -> list[str]:
    import h5py

    with h5py.File(path, "r") as file:
        return [name for name in file if not name.startswith("#")]


def _plain(path: Path, name: str | None) -> dict[str, Any]:
    """Return groups as dicts and data sets as arrays, of an HDF5 file that MATLAB did not write."""
    import h5py

    def content(item: Any) -> Any:
        if isinstance(item, h5py.Group):
            return {key: content(child) for key, child in item.items()}
        try:
            # MATLAB's columns are HDF5's rows.
            return item[()].T if "MATLAB_class" in item.attrs else item[()]
        except Exception as error:
            return Unreadable(error)

    try:
        with h5py.File(path, "r") as file:
            return content(file) if name is None else {name: content(file[name])}
    except Exception as error:
        if name is None:
            raise BenchError(f"'{path}' cannot be read as a MAT file: {error}") from None
        return {name: Unreadable(error)}
