"""One case of a check: the node's process, the car and the arbiter in a run of their own."""

from __future__ import annotations

import math
import os
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from steering_bringup.check_node.car import APPLIED_TOPIC, Car
from steering_bringup.check_node.faults import (
    END,
    FIGHTING_HAND,
    START,
    STOP,
    Fault,
    Heard,
    changed,
)
from steering_bringup.check_node.link import BENCH, Link
from steering_bringup.check_node.program import Program
from steering_bringup.check_node.record import MEMBER, Record, Subject
from steering_bringup.node_parameters import changed_values
from steering_bringup.schema import NodeSet, Scenario
from steering_lockstep.domain import asked_domain, claim_domain
from steering_lockstep.graph import CLOCK, NodeSpec, check_graph
from steering_lockstep.graph_file import write_graph

TICK = 1e-3
LATE_START = 500
"""Ticks that the bench runs before a node that starts late."""
AFTER_LATE_START = 1300


class Case:
    """Runs one fault; ``patience`` [s]: for the node to come up, and to answer in lock step."""

    def __init__(
        self,
        subject: Subject,
        fault: Fault,
        scenario: Scenario,
        node_set: NodeSet,
        patience: float,
    ) -> None:
        self.subject, self.fault, self.patience = subject, fault, patience
        self.scenario = scenario
        period = subject.period if subject.style == "member" else None
        self.car = Car(scenario, node_set, period)
        self.record = Record(np.zeros((0, 0)))
        self._waiting: list[Heard] = []
        self._frozen: dict[str, Sequence[float]] = {}
        self._hand = 0.0

    def run(self) -> Record:
        """Run it to the end, or to where the node's process ended."""
        claim, topics = claim_domain(asked_domain(os.environ)), self.car.messages(0)
        guest = self.subject.style == "guest"
        try:
            with (
                tempfile.TemporaryDirectory() as folder,
                Link(topics, self.subject.wishes, claim.number, best_effort=guest) as link,
            ):
                (self._run_guest if guest else self._run_member)(link, claim.number, Path(folder))
        finally:
            claim.release()
        self.record.rows = np.array(self.car.rows)
        return self.record

    def _run_guest(self, link: Link, domain: int, folder: Path) -> None:
        tick = LATE_START if self.fault.starts_late else 0
        before = range(-tick, 0)
        clock = _Pace()
        for k in before:  # the bench runs, the car waits at its place
            link.publish(k + tick, self.car.messages(k + tick))
            clock.sleep()
        with Program(self.subject.command, domain) as program:
            if not self._matched(link, program):
                return
            clock, end = _Pace(), AFTER_LATE_START if self.fault.starts_late else END
            for k in range(end):
                self._note(link)
                link.publish(k + tick, self._shown(k))
                self._hear_guest(link.take(), k)
                self._disturb(program, k)
                self.car.step(k, self._hand)
                if self._is_over(program, k):
                    return
                clock.sleep()

    def _run_member(self, link: Link, domain: int, folder: Path) -> None:
        inputs = dict.fromkeys(self.subject.inputs, 0)
        kind, name = self.subject.command[0], self.subject.wishes
        nodes = [
            NodeSpec(BENCH, "bench", {name: 0}, (*self.subject.inputs, CLOCK)),
            NodeSpec(MEMBER, kind, inputs, (name,), self.subject.period),
        ]
        write_graph(check_graph(nodes), folder / "graph.json")
        values = changed_values(self.scenario) or {"vehicle.wind_force": 0.0}
        words = [word for k, v in values.items() for word in ("-p", f"{k}:={float(v)!r}")]
        command = (
            *(sys.executable, "-m", "steering_bringup.check_node.member", kind),
            *("--graph", str(folder / "graph.json"), "--ticks", str(END), "--ros-args", *words),
        )
        if self.fault.starts_late:
            link.tell_ready()
            time.sleep(LATE_START * TICK)
        with Program(command, domain) as program:
            if not self._matched(link, program):
                return
            link.tell_ready()
            for k in range(END):
                self._note(link)
                shown = self._shown(k)
                link.publish(k, {t: v for t, v in shown.items() if t in (*inputs, CLOCK)})
                if k % self.subject.period == 0 and not self._answered(link, program, k):
                    return
                self._disturb(program, k)
                self.car.step(k, self._hand)

    def _matched(self, link: Link, program: Program) -> bool:
        """Wait until the node publishes; False where it ended or said nothing."""
        deadline = time.monotonic() + self.patience
        while not (link.matched() and (self.subject.style == "guest" or self._reads(link))):
            if program.status is not None:
                self.record.ended = program.ending()
                return False
            if time.monotonic() > deadline:
                self.record.ended = (
                    f"nobody publishes on {self.subject.wishes} after {self.patience:g} s"
                )
                return False
            time.sleep(0.01)
        return True

    def _reads(self, link: Link) -> bool:
        return set(self.subject.inputs) <= set(link.read_by_node())

    def _note(self, link: Link) -> None:
        if len(self.car.rows) % 100 == 0:
            self.record.reads = sorted({*self.record.reads, *link.read_by_node()})

    def _shown(self, k: int) -> Mapping[str, Sequence[float]]:
        """Return what the node gets to see of the bench at tick ``k``."""
        fields = self.car.messages(k)
        if self.fault.inputs is None or not START <= k < STOP:
            return fields
        shown: dict[str, Sequence[float]] = {}
        for topic, now in fields.items():
            then = self._frozen.setdefault(topic, now)
            seen = now if topic == APPLIED_TOPIC else self.fault.inputs(now, then)
            if seen is not None:
                shown[topic] = seen
        return shown

    def _hear_guest(self, messages: Sequence[Any], k: int) -> None:
        for m in messages:
            heard = Heard(k, m.torque, m.priority, m.source)
            self.record.heard.append(heard)
            given = changed(self.fault, heard)
            if given is not None:
                self._waiting.append(given)
        due = [h for h in self._waiting if h.tick <= k]
        self._waiting = [h for h in self._waiting if h.tick > k]
        for h in due:
            self.car.arbiter.hear_guest(h.source or "unnamed", k, h.torque, h.priority)

    def _answered(self, link: Link, program: Program, k: int) -> bool:
        """Wait for a member's message of tick ``k`` and give it to the arbiter."""
        deadline = time.monotonic() + self.patience
        while not (messages := link.take()):
            if program.status is not None:
                self.record.ended = program.ending()
                return False
            if time.monotonic() > deadline:
                self.record.ended = f"no answer to tick {k} for {self.patience:g} s"
                return False
            time.sleep(2e-5)
        heard = Heard(k, messages[-1].torque, messages[-1].priority, messages[-1].source)
        self.record.heard.append(heard)
        given = changed(self.fault, heard)
        assert given is not None
        self.car.wish = [given.torque, given.priority]
        return True

    def _disturb(self, program: Program, k: int) -> None:
        """Move the driver's hands, or end the process, where that is the fault."""
        if self.fault.killed and k == START:
            program.kill()
        if self.fault.hand and k == START:
            self._hand = -math.copysign(FIGHTING_HAND, self.car.rows[-1][1])
        if k == STOP:
            self._hand = 0.0

    def _is_over(self, program: Program, k: int) -> bool:
        """Whether the node's process ended by itself, or never says a word."""
        if program.status is not None and not self.fault.killed:
            self.record.ended = program.ending()
        elif k == START and not self.record.heard:
            self.record.ended = f"no message in {START * TICK:g} s"
        return bool(self.record.ended)


class _Pace:
    """Paces ticks to the wall clock. A tick that is late moves all that follow: never in a hurry,
    so that a node's messages seem no rarer than they are."""

    def __init__(self) -> None:
        self.due = time.monotonic()

    def sleep(self) -> None:
        """Wait until the next tick is due."""
        self.due = max(self.due + TICK, time.monotonic())
        time.sleep(max(0.0, self.due - time.monotonic()))
