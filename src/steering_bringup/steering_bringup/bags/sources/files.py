"""Which files a bag is made of: what metadata.yaml lists, else all of a folder; told by content."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from steering_bringup.bags.errors import BagError
from steering_bringup.bags.mcap_bytes import MAGIC as MCAP
from steering_bringup.bags.places import METADATA_FILE
from steering_bringup.bags.sources.metadata import Metadata, own_name, read_metadata
from steering_bringup.bags.sources.packed import ZSTD

SQLITE = b"SQLite format 3\0"
ROS1 = b"#ROSBAG V"
SUFFIXES = (".mcap", ".db3")
PACKED = (".zstd", ".zst")
OF_ROS1 = "a bag of ROS 1: rosbags-convert makes one of ROS 2 of it"


@dataclass
class BagFiles:
    """``files`` in the order in which they were recorded; ``notes``: what is left out and why.

    ``missing``: listed files that are not there.
    """

    path: Path
    files: list[Path]
    about: Metadata = field(default_factory=Metadata)
    notes: list[str] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)


def kind_of(file: Path) -> str:
    """Return "mcap", "sqlite", "zstd", "ros1", "empty" or "" by a file's first bytes. OSError."""
    with file.open("rb") as handle:
        head = handle.read(len(SQLITE))
    kinds = {MCAP: "mcap", SQLITE: "sqlite", ZSTD: "zstd", ROS1: "ros1"}
    if not head:
        return "empty"
    return next((kind for magic, kind in kinds.items() if head.startswith(magic)), "")


def bag_files(path: Path) -> BagFiles:
    """Return the files of a bag: a folder, its metadata.yaml, or one file.

    Raises BagError, naming the path, where there is no bag.
    """
    if not path.exists():
        raise BagError(f"there is no bag '{path}'")
    if path.name == METADATA_FILE:
        path = path.parent
    about = read_metadata((path if path.is_dir() else path.parent) / METADATA_FILE)
    if path.is_file():
        listed = path.name in map(own_name, about.files)
        return BagFiles(path, [path], Metadata(kept=about.kept) if listed else Metadata())
    found = BagFiles(path, [], about)
    if about.problem:
        found.notes.append(f"{METADATA_FILE} is not used: {about.problem}")
    there = sorted((f for f in path.iterdir() if _is_storage(f)), key=_number)
    found.files = _listed(found, there) or _each_once(found, there)
    if not found.files:
        raise BagError(_no_bag(path))
    return found


def _listed(found: BagFiles, there: list[Path]) -> list[Path]:
    """Return the files that metadata.yaml names; none where none of them is there."""
    files: list[Path] = []
    for name in found.about.files:
        file = _place(found.path, name)
        if file is None:
            count = found.about.counts.get(own_name(name))
            lost = "" if count is None else f", and its {count} messages with it"
            found.missing.append(own_name(name))
            found.notes.append(f"{own_name(name)} is listed in {METADATA_FILE} and missing{lost}")
        elif file not in files:
            files.append(file)
    if not files:
        return []
    beside = [f.name for f in there if f not in files]
    found.notes += [f"{name} is not listed in {METADATA_FILE}: left out" for name in beside]
    return files


def _place(folder: Path, name: str) -> Path | None:
    """Return where a listed file is: in the folder, under its name with or without .zstd."""
    inside = folder / own_name(name)
    bare = inside.with_suffix("") if inside.suffix in PACKED else inside
    places = [inside, bare, *(bare.with_name(bare.name + suffix) for suffix in PACKED)]
    return next((p for p in (*places, folder / name, Path(name)) if p.is_file()), None)


def _each_once(found: BagFiles, there: list[Path]) -> list[Path]:
    """Return all files but those that are there packed and unpacked too."""
    names = {file.name for file in there}
    files = []
    for file in there:
        if file.suffix in PACKED and file.stem in names:
            found.notes.append(f"{file.name} is {file.stem} packed: left out")
        else:
            files.append(file)
    return files


def _is_storage(file: Path) -> bool:
    bare = file.stem if file.suffix in PACKED else file.name
    return bare.endswith(SUFFIXES) and file.is_file()


def _number(file: Path) -> tuple[int, str]:
    last = file.name.partition(".")[0].rpartition("_")[2]
    return (int(last) if last.isdecimal() else 0, file.name)


def _no_bag(path: Path) -> str:
    if any(path.glob("*.bag")):
        return f"'{path}' holds {OF_ROS1}"
    inside = sorted({f.parent.name for suffix in SUFFIXES for f in path.glob(f"*/*{suffix}*")})
    hint = f"; its folder '{inside[0]}' does" if inside else ""
    return f"'{path}' is no bag: it holds no .mcap or .db3 file{hint}"
