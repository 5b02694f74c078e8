"""Bags in and out: writing, reading, recovering and comparing recorded runs, without ROS."""

from steering_bringup.bags.equality import Difference, first_difference
from steering_bringup.bags.errors import BagError
from steering_bringup.bags.notes import note_in_bag
from steering_bringup.bags.reader import read_bag
from steering_bringup.bags.recovery import Recovery, repair
from steering_bringup.bags.run_metadata import run_metadata
from steering_bringup.bags.trace import Gap, Trace
from steering_bringup.bags.writer import BagWriter

__all__ = [
    "BagError",
    "BagWriter",
    "Difference",
    "Gap",
    "Recovery",
    "Trace",
    "first_difference",
    "note_in_bag",
    "read_bag",
    "repair",
    "run_metadata",
]
