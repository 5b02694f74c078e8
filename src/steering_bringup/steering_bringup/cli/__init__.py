"""The command line: ``steer COMMAND``. One command a file; only the chosen one is imported."""

from __future__ import annotations

import argparse
import contextlib
import os
import re
import sys
import traceback
from collections.abc import Iterable, Sequence
from importlib import import_module
from typing import Any

from steering_bringup.cli import streams
from steering_bringup.cli.ros_arguments import settled
from steering_bringup.errors import BenchError
from steering_bringup.interrupts import nothing_to_lose

COMMANDS = {
    "run": "run a scenario through the ROS graph (or --direct), record and compare",
    "graph": "write the graph of a run for its nodes' executables, as ros2 launch starts them",
    "node": "run one node of a run by hand, on this or another computer",
    "play": "publish a bag on ROS topics, at any rate",
    "check-node": "check an overlay node: feed it the bench, inject faults, give a verdict",
    "python": "run a Python program of one's own with rclpy and the bench's messages",
    "compare": "compare two bags or measured files on one HTML page",
    "list": "list scenarios, node sets, rigs, manoeuvres, loads, effects and parameters",
    "repeat": "repeat the run that a bag records and check that it is the same, bit for bit",
    "recover": "make a bag readable that a crash cut off",
    "schema": "write the JSON Schema of scenarios, node sets and rigs for an editor",
    "rig-key": "make the key that a rig and the bench have in common",
    "rig-test": "the source's rig tests on the simulated plant, each recorded to a bag",
    "identify": "what rig tests tell of a gear, as a parameter set that loads",
    "validate": "a model against a recorded system test, channel by channel",
    "design-valve": "step time against solenoid force: Pareto fronts of the valve's design",
    "study": "questions beyond the source: energy, heavy vehicle, ...; each on one page",
    "reproduce": "every figure of the source, with its numbers beside ours",
    "diagnose": "what the simulation gets wrong on a record, the cause, the extended model",
    "fleet": "several specimens: what the model gets wrong in all, and what one has alone",
    "diagnose-emps": "the diagnosis of a public benchmark's real axis",
    "plan": "the experiment that separates what a diagnosis could not",
    "linear": "Bode plots, margins, chattering, lag, latency and tolerances of valves and steering",
    "bench": "measure speed and accuracy against the targets",
}
"""Commands with their one line of help; the module of the same name implements each."""

PACKAGES: dict[str, str] = {
    "rig-test": "steering_studies",
    "identify": "steering_studies",
    "validate": "steering_studies",
    "linear": "steering_studies",
    "design-valve": "steering_studies",
    "study": "steering_studies",
    "reproduce": "steering_studies",
    "compare": "steering_diagnosis",
    "diagnose": "steering_diagnosis",
    "fleet": "steering_diagnosis",
    "diagnose-emps": "steering_diagnosis",
    "plan": "steering_diagnosis",
}
"""Packages above this one whose ``cli`` folder holds the command's module; others are here."""

FAILED, USAGE, INTERRUPTED = 1, 2, 130


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return the exit status: 0 only on success."""
    arguments = list(sys.argv[1:] if argv is None else argv)
    streams.prepare()
    with contextlib.suppress(OSError):
        # Last, so that it shadows nothing: where a node of one's own (MODULE:FUNCTION) is found.
        sys.path.append(os.getcwd())
    try:
        arguments = settled(arguments)
    except BenchError as error:
        print(f"steer: {error}", file=sys.stderr)
        return USAGE
    with nothing_to_lose():
        parser = _parser(arguments)
    options, unknown = parser.parse_known_args(arguments)
    if unknown:
        parser.refuse(unknown[0], options)
    if options.command is None:
        parser.print_help()
        return USAGE
    try:
        _check_outputs(options)
        status = int(options.implementation.execute(options) or 0)
        sys.stdout.flush()
        return status
    except KeyboardInterrupt:
        print("steer: interrupted", file=sys.stderr)
        return INTERRUPTED
    except Exception as error:
        if isinstance(error, BrokenPipeError) and streams.reader_is_gone():
            return 0
        if options.debug:
            traceback.print_exc()
        print(f"steer {options.command}: {_one_line(error)}", file=sys.stderr)
        try:
            sys.stdout.flush()
        except OSError:
            streams.be_quiet(sys.stdout)
        return FAILED


def console() -> int:
    """Run one command as an installed program; what is missing for an import is named."""
    try:
        return main()
    except ImportError as error:
        print(f"steer: {_missing(error)}", file=sys.stderr)
        return FAILED


def _check_outputs(options: argparse.Namespace) -> None:
    """Refuse places that cannot be written before the work, not after it."""
    from steering_bringup.outputs import check_file, check_folder

    out = next((a for a in options.parser._actions if a.dest == "out"), None)
    if out is not None and options.out is not None:
        (check_folder if out.metavar == "DIR" else check_file)(options.out)
    if getattr(options, "json", None) is not None:
        check_file(options.json)


def _parser(arguments: Sequence[str]) -> _Parser:
    parser = _Parser(
        prog="steer",
        description="Test bench for hydraulic power steering on ROS 2.",
        epilog="'steer COMMAND --help' explains a command. Start with: steer run",
    )
    common = _Parser(add_help=False)
    common.add_argument("--debug", action="store_true", help="show the traceback of an error")
    parser.set_defaults(command=None, debug=False)
    commands = parser.add_subparsers(metavar="COMMAND", dest="command", parser_class=_Parser)
    chosen = next((word for word in arguments if not word.startswith("-")), None)
    for name, text in COMMANDS.items():
        implementation = _import(name) if name == chosen else None
        command = commands.add_parser(
            name,
            help=text,
            description=text[:1].upper() + text[1:] + ".",
            epilog=getattr(implementation, "EXAMPLES", None),
            parents=[common],
            allow_abbrev=False,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        if implementation is not None:
            implementation.arguments(command)
            command.set_defaults(implementation=implementation, parser=command)
    return parser


def _import(command: str) -> Any:
    module = {"list": "listing"}.get(command, command.replace("-", "_"))
    return import_module(f"{PACKAGES.get(command, 'steering_bringup')}.cli.{module}")


class _Parser(argparse.ArgumentParser):
    """argparse with errors of one line that suggest the nearest command or option."""

    def error(self, message: str) -> Any:
        """Print one line and exit with status 2."""
        choice = re.match(r"argument (\S+): invalid choice: '(.*?)' \(choose from (.*)\)", message)
        if choice:
            what, word, known = choice.groups()
            names = [name.strip(" '") for name in known.split(",")]
            hint = _hint(word, names) or f"; choose from {', '.join(names)}"
            message = f"unknown {what.lower()} '{word}'{hint}"
        self.exit(USAGE, f"{self.prog}: {message}; see '{self.prog} --help'\n")

    def refuse(self, word: str, options: argparse.Namespace) -> None:
        """Exit with an error about an argument that the chosen command does not have."""
        command = getattr(options, "parser", self)
        known = [name for action in command._actions for name in action.option_strings]
        what = "option" if word.startswith("-") else "argument"
        command.error(f"unknown {what} '{word}'{_hint(word.split('=')[0], known)}")


def _hint(word: str, known: Iterable[str]) -> str:
    from difflib import get_close_matches

    near = get_close_matches(word, list(known), n=1)
    return f"; did you mean '{near[0]}'?" if near else ""


def _missing(error: ImportError) -> str:
    """Return what to install. Asked for only here: the question itself takes time at each start."""
    from steering_core.requirements import missing_text

    return missing_text(error)


def _one_line(error: Exception) -> str:
    """Return an error's text on one line; an unforeseen one tells how to see more."""
    if isinstance(error, ModuleNotFoundError):
        return _missing(error)
    text = " ".join(str(error).split()) or type(error).__name__
    if type(error).__module__.partition(".")[0] in OWN_PACKAGES:
        return text
    if isinstance(error, OSError) and error.filename is not None:
        return f"'{error.filename}': {error.strerror}"
    if isinstance(error, OSError) and streams.is_refused(sys.stdout, error):
        return f"standard output cannot be written: {error.strerror}"
    return f"{type(error).__name__}: {text} (--debug shows where)"


OWN_PACKAGES = (
    "balance_diagnosis",
    "steering_bringup",
    "steering_core",
    "steering_lockstep",
    "steering_plant",
    "pressure_control",
    "driver_model",
    "vehicle_model",
    "rig_bridge",
    "steering_studies",
    "steering_diagnosis",
)
