"""The load's command at the load cell: how old it is there, and where it jumps at a tick."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from steering_diagnosis.data.record import Record
from steering_diagnosis.steering.smoothing import bridged

COMMAND = ("load_force", "load_stiffness", "load_position")

OLDEST = 12
"""Ticks that a command may be old, a bridge's way there and back included."""

USUAL = 1
"""Age in the bench itself: what acts until a tick was commanded at the tick before."""


class LoadCommand:
    """The force that the recorded command asks for at the rack.

    record: with the channels of COMMAND. position: of the rack as measured, smooth, (n,) [m].
    Its stiffness acts on where the rack is: an error of the position's sensor is one of the force.
    """

    def __init__(self, record: Record, position: np.ndarray) -> None:
        self._force, self._stiffness, at = (bridged(record[name]) for name in COMMAND)
        self._offset = self._force - self._stiffness * at
        self._position = position
        self._cell = record.channels.get("rack_force")

    def force(self, age: int, position: np.ndarray | None = None) -> np.ndarray:
        """Return the force [N] at every tick that the command ``age`` ticks ago asks for, (n,).

        position: where the rack is, (n,) [m]; None: where it was measured.
        """
        late = np.maximum(np.arange(len(self._force)) - age, 0)
        at = self._position if position is None else position
        return self._offset[late] + self._stiffness[late] * at

    @cached_property
    def age(self) -> int:
        """Ticks after which a command is measured: the age at which it fits the load cell best."""
        if self._cell is None:
            return USUAL
        misfits = [self._misfit(age) for age in range(OLDEST + 1)]
        best = int(np.argmin(misfits))
        return best if misfits[best] < 0.98 * misfits[USUAL] else USUAL

    def measured(self, position: np.ndarray | None = None) -> np.ndarray:
        """Return what the load cell should measure at every tick [N], (n,), see ``force``."""
        return self.force(self.age, position)

    @property
    def jump(self) -> np.ndarray:
        """By how much the force jumps just after each tick's measurement [N], (n,)."""
        if self.age == 0:
            return np.zeros(len(self._force))
        return self.force(self.age - 1) - self.force(self.age)

    def _misfit(self, age: int) -> float:
        """Return the squared error of the load cell against the command, gain and offset free."""
        assert self._cell is not None
        force, speed = self.force(age), np.gradient(self._position)
        reversing = np.sign(speed) * (np.abs(speed) > 0.1 * np.abs(speed).max())
        design = np.column_stack([force, np.ones(len(force)), reversing])
        known = np.isfinite(self._cell)
        known[: OLDEST + 1] = False
        solved = np.linalg.lstsq(design[known], self._cell[known], rcond=None)[0]
        return float(np.mean((self._cell[known] - design[known] @ solved) ** 2))
