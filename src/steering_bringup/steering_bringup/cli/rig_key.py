"""``steer rig-key``: make the key that a rig and the bench have in common."""

from __future__ import annotations

import argparse
from pathlib import Path

EXAMPLES = """example:
  steer rig-key my_rig.key
  scp -p my_rig.key user@rig:        # the same file at the rig's end, by a way that nobody reads
  and in the rig's file: 'key: my_rig.key'

Only its owner can read the file. Whoever has it can move the rig. An emulated rig has a key of its
own without being told."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("file", metavar="FILE", type=Path, help="file to make; it must not exist")


def execute(options: argparse.Namespace) -> int:
    """Make the key and tell what to do with it."""
    from rig_bridge.trust.key_file import make_key

    make_key(options.file)
    print(
        f"{options.file}: a new key. Copy it to the rig's computer, readable by its owner alone, "
        f"and write 'key: {options.file.name}' into the rig's file, beside which it lies"
    )
    return 0
