"""``--ros-args`` on the command line: what a launch file's Node adds to ``steer``.

Names are taken over; whatever else is ROS's own, such as the log level, means nothing here.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from steering_bringup.errors import BenchError

START, END = "--ros-args", "--"
OF_THE_PROGRAM = ("python", "check-node")
"""Commands whose arguments are another program's."""
RULES = ("-r", "--remap")
PARAMETERS = ("-p", "--param", "--params-file")
WITH_A_VALUE = (*RULES, *PARAMETERS, "-e", "--enclave", "--log-level", "--log-config-file")
OWN_NAMES = ("__node", "__name")
SIM_TIME = "use_sim_time:="


def settled(words: Sequence[str]) -> list[str]:
    """Return the words of a command line with ROS's arguments as the bench's own options.

    Raises BenchError for parameters, which a run takes by ``--set``.
    """
    if words and words[0] in OF_THE_PROGRAM:
        return list(words)
    own, options, in_ros = [], list[str](), False
    rest = iter(words)
    for word in rest:
        if word == START:
            in_ros = True
        elif in_ros and word == END:
            in_ros = False
        elif in_ros:
            options += _options(word, rest)
        else:
            own.append(word)
    return own + options


def _options(word: str, rest: Iterator[str]) -> list[str]:
    value = next(rest, "") if word in WITH_A_VALUE else ""
    if word in PARAMETERS and not value.startswith(SIM_TIME):  # the run is the clock
        raise BenchError(f"{word} {value}: values of a run are given as --set NAME=VALUE")
    if word not in RULES:
        return []
    old, _, new = value.partition(":=")
    if old == "__ns":
        return ["--namespace", new]
    return [] if old in OWN_NAMES else ["--remap", value]
